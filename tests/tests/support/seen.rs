// SPDX-License-Identifier: MIT OR Apache-2.0
//! Depth and normals of surfaces in closed form, for tests of the system `ambient`.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{self, gpu, shaders};
use airlight::ambient::{BentForm, BentPasses, Blurring, OcclusionSettings, Sampling, SurfaceImages};
use airlight::core::Camera;
use airlight::validate::Definitions;
use airlight::{Pass, Resource, Texture};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, OrthographicView, View};
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::TextureFormat::{R32Float, Rgba32Float};

/// A surface: the distance along a ray of a unit direction from an origin, and the unit normal there.
pub type Surface<'a> = &'a dyn Fn(Vec3, Vec3) -> Option<(f64, Vec3)>;

/// What a camera sees of a surface.
pub struct SeenImages {
    pub reference: ReferenceCamera,
    pub camera: Camera,
    pub size: [u32; 2],
    pub depths: Vec<f32>,
    pub depth: Texture,
    pub normals: Texture,
    /// Where pixels see it, in the world, and its normals.
    pub surfaces: Vec<Option<(Vec3, Vec3)>>,
}

/// The pictures of a surface.
pub fn seen(reference: ReferenceCamera, size: [u32; 2], surface: Surface<'_>) -> SeenImages {
    let parallel = u32::from(reference.is_orthographic());
    let camera = Camera { projection: parallel, ..gpu::host_camera(&reference, size) };
    let [width, height] = size.map(|side| side as usize);
    let mut depths = Vec::new();
    let mut normals = Vec::new();
    let mut surfaces = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let ndc = ReferenceCamera::pixel_ndc(x, y, width, height);
        let (origin, direction) = (reference.origin(ndc), reference.ray(ndc));
        let met =
            surface(origin, direction).map(|(distance, normal)| (origin + direction * distance, normal));
        let depth = met.and_then(|(place, _)| reference.project(place)).map_or(reference.far_depth, |p| p[2]);
        depths.push(depth as f32);
        let normal = met.map_or([0.0; 3], |(_, normal)| normal.to_array());
        normals.extend([normal[0] as f32, normal[1] as f32, normal[2] as f32, 1.0]);
        surfaces.push(met);
    }
    let image = |format, values: &[f32]| {
        let texture = Texture::storage(gpu(), size, format);
        texture.write(gpu(), values).unwrap();
        texture
    };
    let (depth, normals) = (image(R32Float, &depths), image(Rgba32Float, &normals));
    SeenImages { reference, camera, size, depths, depth, normals, surfaces }
}

impl SeenImages {
    /// As the passes take it.
    pub fn images(&self) -> SurfaceImages<'_> {
        SurfaceImages { camera: &self.camera, depth: &self.depth, normals: &self.normals }
    }

    /// Mean direction and openness of each pixel.
    pub fn bent(&self, form: BentForm, settings: &OcclusionSettings) -> Vec<(Vec3, f64)> {
        self.bent_of(self.images(), form, settings)
    }

    /// The same of other images.
    pub fn bent_of(
        &self,
        images: SurfaceImages<'_>,
        form: BentForm,
        settings: &OcclusionSettings,
    ) -> Vec<(Vec3, f64)> {
        let mut encoder = gpu().encoder();
        let bent = passes(form).record(gpu(), &mut encoder, images, settings).unwrap();
        gpu().submit(encoder).unwrap();
        let texels = bent.read(gpu()).unwrap();
        let texel = |t: &[f32]| (Vec3::from([t[0], t[1], t[2]].map(f64::from)), f64::from(t[3]));
        texels.chunks_exact(4).map(texel).collect()
    }

    /// Mean direction and openness about a place: of all directions of the 8x8 pixels around it.
    pub fn bent_at(&self, form: BentForm, settings: &OcclusionSettings, place: Vec3) -> (Vec3, f64) {
        let all = self.bent(form, settings);
        let at = self.reference.project(place).unwrap();
        let column = (0.5 + 0.5 * at[0]) * f64::from(self.size[0]);
        let row = (0.5 - 0.5 * at[1]) * f64::from(self.size[1]);
        let (mut sum, mut open) = (Vec3::default(), 0.0);
        for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x, y))) {
            let pixel = (row as usize + y - 4) * self.size[0] as usize + column as usize + x - 4;
            sum = sum + all[pixel].0 * all[pixel].1;
            open += all[pixel].1;
        }
        (sum * (1.0 / open), open / 64.0)
    }
}

/// What is seen by parallel rays from straight above: columns along x, rows along z, the origin in the middle. `heights`: at (x, z) the
/// height, below 4 m, and the unit normal. `half_height`: metres.
pub fn from_above(
    size: [u32; 2],
    half_height: f64,
    reversed: bool,
    heights: &dyn Fn(f64, f64) -> Option<(f64, Vec3)>,
) -> SeenImages {
    let camera = ReferenceCamera::orthographic(&OrthographicView {
        eye: Vec3::new(0.0, 4.0, 0.0),
        target: Vec3::default(),
        up: Vec3::new(0.0, 0.0, -1.0),
        half_height,
        aspect: f64::from(size[0]) / f64::from(size[1]),
        depth: 8.0,
        reversed,
    });
    let surface =
        |from: Vec3, _: Vec3| heights(from.x, from.z).map(|(height, normal)| (from.y - height, normal));
    seen(camera, size, &surface)
}

/// The passes of a form, composed once.
pub fn passes(form: BentForm) -> Arc<BentPasses> {
    static COMPOSED: Mutex<Vec<(BentForm, Arc<BentPasses>)>> = Mutex::new(Vec::new());
    let mut composed = COMPOSED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, passes)) = composed.iter().find(|(of, _)| *of == form) {
        return passes.clone();
    }
    let passes = Arc::new(BentPasses::new(gpu(), shaders(), form).unwrap());
    composed.push((form, passes.clone()));
    passes
}

/// Runs a pass of the system by itself over `size`.
pub fn run_alone(name: &str, flags: &[(&str, bool)], size: [u32; 2], resources: &[(&str, Resource<'_>)]) {
    let pass = Pass::compute_with(gpu(), shaders(), name, &Definitions::new().flags(flags)).unwrap();
    let bound = pass.bind(gpu(), resources).unwrap();
    let mut encoder = gpu().encoder();
    pass.dispatch(&mut encoder, &bound, [size[0], size[1], 1]);
    gpu().submit(encoder).unwrap();
}

/// A form without a blur.
pub fn sharp(sampling: Sampling) -> BentForm {
    BentForm { sampling, blurring: Blurring::Off, occlusion_only: false, halved: false }
}

/// Many directions in every 8x8 pixels.
pub fn many(radius: f32) -> OcclusionSettings {
    OcclusionSettings { samples: 8, steps: 96, side: 8, bias: 0.01, ..OcclusionSettings::new(radius) }
}

/// Cameras that look at a place from `eye`: forward and reversed depth, and parallel rays.
pub fn cameras(eye: Vec3, target: Vec3, half_height: f64) -> [(&'static str, ReferenceCamera); 3] {
    let up = Vec3::new(0.05, 0.2, 1.0);
    let away = (target - eye).length();
    let fov_y = 2.0 * (half_height / away).atan();
    let (near, far) = (0.05 * away, 3.0 * away);
    let view = |reversed| View { eye, target, up, fov_y, aspect: 1.0, near, far, reversed };
    let parallel = OrthographicView { eye, target, up, half_height, aspect: 1.0, depth: far, reversed: true };
    [
        ("perspective", ReferenceCamera::perspective(&view(false))),
        ("reversed", ReferenceCamera::perspective(&view(true))),
        ("parallel", ReferenceCamera::orthographic(&parallel)),
    ]
}
