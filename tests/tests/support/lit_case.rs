// SPDX-License-Identifier: MIT OR Apache-2.0
//! A torus over a plane under any light, prefiltered, marched and in the references, for the tests of lights.
#![allow(dead_code)]

use super::gpu::{self, gpu, shaders};
use airlight::core::{Cascades, PerspectiveView, Sky};
use airlight::data::LightImage;
use airlight::scattering::{LightForm, March, Prefiltered, Settings, Weighting};
use airlight::{Lighting, Setting, Stage, Texture};
use airlight_tests::error;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::scattering as reference;
use glam::{Mat4, Vec3};
use reference::{Cone, LocalLight, LocalRows, LocalScene, ShadowMap};
use wgpu::TextureFormat::R32Float;

pub const PICTURE: [u32; 2] = [192, 108];
pub const MAP: [u32; 2] = [512, 512];
pub const SHADOW: [u32; 2] = [1024, 1024];
/// One pixel in so many, in both directions, is compared with the references that integrate.
pub const STRIDE: usize = 3;
/// Rank queries err by at most this part of what bases do, in plain means over the same rows.
pub const RANKED: f64 = 0.5;
/// Six moments err by at most this more than rank queries, in radiance; both share what rows themselves err by.
pub const MOMENTS: f64 = 0.003;

/// A scene with a light, on the GPU.
pub struct Case {
    pub name: &'static str,
    pub stage: Stage,
    pub view: PerspectiveView,
    pub form: LightForm,
    pub texture: Option<LightImage>,
}

impl Case {
    pub fn new(
        name: &'static str,
        light: Lighting,
        texture: Option<LightImage>,
        cascades: Option<Cascades>,
    ) -> Self {
        let scene = gpu::torus_over_plane();
        let stage = Stage::new(
            gpu(),
            gpu::raster(),
            &Setting {
                mesh: &scene.mesh,
                view: scene.view.into(),
                light,
                light_texture: texture.as_ref(),
                cascades,
                sky: Sky::new(Vec3::splat(0.3), Vec3::splat(0.4), Vec3::splat(0.1)),
                medium: scene.medium,
                samples: 1,
            },
            PICTURE,
            SHADOW,
        )
        .unwrap();
        let form = LightForm::of(&stage.light, &stage.inputs());
        LightForm::check_eye(&stage.camera, &stage.light).unwrap();
        Self { name, stage, view: scene.view, form, texture }
    }

    /// The same without blockers.
    pub fn empty(mut self) -> Self {
        self.stage.pictures.shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
        if self.stage.pictures.shadow_maps.is_some() {
            let maps = Texture::array(
                gpu(),
                [8, 8, 6],
                R32Float,
                wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
            );
            maps.write(gpu(), &[1.0; 384]).unwrap();
            self.stage.pictures.shadow_maps = Some(maps);
        }
        self
    }

    pub fn settings(&self) -> Settings {
        Settings { map: MAP, light: self.form, ..Settings::default() }
    }

    pub fn camera(&self) -> ReferenceCamera {
        gpu::reference_camera(&self.view, PICTURE)
    }

    /// Depths and matrix of every shadow map, as the references take them.
    pub fn maps(&self) -> Vec<(Vec<f32>, [usize; 2], Mat4)> {
        let read = |texture: &Texture, matrices: &[Mat4]| {
            let depths = texture.read(gpu()).unwrap();
            let [width, height, _] = texture.size().map(|side| side as usize);
            let layers = depths.chunks_exact(width * height);
            layers.zip(matrices).map(|(layer, m)| (layer.to_vec(), [width, height], *m)).collect()
        };
        match (&self.stage.pictures.shadow_maps, &self.stage.views) {
            (Some(maps), Some(views)) => read(maps, &views.clip_from_world[..views.count as usize]),
            _ => read(&self.stage.pictures.shadow_map, &[self.stage.light.clip_from_world]),
        }
    }

    pub fn light(&self) -> LocalLight {
        let light = &self.stage.light;
        let cosines = light.spot_cosines.to_array().map(f64::from);
        LocalLight {
            position: gpu::vector(light.position),
            radius: f64::from(light.radius),
            intensity: light.radiance.to_array().map(f64::from),
            cone: if self.form.spot {
                Cone::Spot { direction: gpu::vector(light.direction), cosines }
            } else {
                Cone::Point
            },
        }
    }

    /// What `compare` gives for the scene as the references see it.
    pub fn with_reference<R>(&self, compare: impl FnOnce(&LocalScene<'_>, &[ShadowMap<'_>]) -> R) -> R {
        let maps = self.maps();
        let maps: Vec<ShadowMap<'_>> = maps
            .iter()
            .map(|(depth, [width, height], matrix)| ShadowMap {
                depth,
                width: *width,
                height: *height,
                clip_from_world: gpu::matrix(*matrix),
                far_depth: 1.0,
            })
            .collect();
        let camera = self.camera();
        let depth = self.stage.pictures.depth.read(gpu()).unwrap();
        let rgb: Vec<f32> =
            self.texture.iter().flat_map(|t| t.texels().iter().flat_map(|texel| texel.to_array())).collect();
        let scene = LocalScene {
            camera: &camera,
            light: self.light(),
            texture: self.texture.as_ref().map(|texture| reference::LightTexture {
                rgb: &rgb,
                width: texture.size()[0] as usize,
                height: texture.size()[1] as usize,
                clip_from_world: Some(gpu::matrix(self.stage.light.clip_from_world)),
                outside: if self.form.local() { 0.0 } else { 1.0 },
            }),
            medium: gpu::reference_medium(&self.stage.medium),
            depth: &depth,
            width: PICTURE[0] as usize,
            height: PICTURE[1] as usize,
        };
        compare(&scene, &maps)
    }
}

pub fn sun() -> Lighting {
    Lighting::directional(Vec3::new(0.55, 0.75, -0.4), Vec3::new(12.0, 11.0, 10.0))
}

/// Soft coloured panes.
pub fn panes() -> LightImage {
    LightImage::from_function([16, 16], |uv| {
        let wave = |k: f32, at: f32| 0.5 + 0.5 * (k * at).sin();
        Vec3::new(wave(9.0, uv.x), wave(7.0, uv.y + 0.3), wave(5.0, uv.x + uv.y))
    })
}

pub struct Scattered {
    pub radiance: Vec<f32>,
}

pub fn scattered(texture: &Texture) -> Scattered {
    let values = texture.read(gpu()).unwrap();
    Scattered { radiance: values.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect() }
}

pub fn prefiltered(case: &Case, settings: Settings) -> (Prefiltered, Scattered) {
    let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
    let bound = method.bind(gpu(), &case.stage.inputs()).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    let result = scattered(&method.scattered);
    (method, result)
}

pub fn marched(case: &Case, steps: u32, weighting: Weighting) -> Scattered {
    let method = March::of_light(gpu(), shaders(), case.form, steps, weighting, PICTURE).unwrap();
    let along = airlight::scattering::Along::ShadowMap { steps };
    let bound = method.bind(gpu(), &case.stage.inputs(), &along).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    scattered(&method.scattered)
}

/// The reference's rows with the slices that the GPU computed.
pub fn rows(scene: &LocalScene<'_>, method: &Prefiltered) -> LocalRows {
    let size = MAP.map(|side| side as usize);
    let mut rows = LocalRows::new(scene.camera, scene.light, scene.medium.distance_limit, size).unwrap();
    let texels = method.rectification.slices.read(gpu()).unwrap();
    for (slice, texel) in rows.slices.iter_mut().zip(texels.chunks_exact(4)) {
        slice.theta_min = f64::from(texel[0]);
        slice.theta_max = f64::from(texel[1]);
        slice.alpha_min = f64::from(texel[2]);
        slice.alpha_max = f64::from(texel[3]);
    }
    rows
}

pub fn relative_rmse(found: &Scattered, exact: &reference::Picture) -> f64 {
    let found = exact.sample(&found.radiance, PICTURE[0] as usize, 3, 0..3);
    error::relative_rmse(&found, &exact.radiance())
}
