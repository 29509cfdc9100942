// SPDX-License-Identifier: MIT OR Apache-2.0
//! Models on a floor in the light of real environment maps, traced and lit by bent cones.
//!
//! Maps are low-passed to 32x16 texels, for cones cannot follow what is finer.
#![allow(dead_code, clippy::unwrap_used)]

use crate::cones::{real_map, reference_map};
use crate::gpu::{gpu, reference_camera, shaders, vector};
use airlight::Texture;
use airlight::ambient::{
    BentForm, BentPasses, Blurring, Method, OcclusionSettings, Sampling, ShadePass, SurfaceImages,
};
use airlight::core::{Camera, DepthRange, Geometry, GeometryPass, MeshBuffers, PerspectiveView};
use airlight::data::{Environment, Mesh, load_mesh, plane};
use airlight_tests::reference::ambient::{
    Angle, Brightness, Environment as ReferenceEnvironment, Pixel, Reach, Scene, Settings, Surface, Triangle,
    picture, surfaces,
};
use glam::{Mat4, Vec2, Vec3};
use std::path::Path;

/// A white model on a white floor, as the rasteriser and the rays see it.
pub struct Standing {
    size: [u32; 2],
    camera: Camera,
    pub geometry: Geometry,
    scene: Scene,
    points: Vec<Option<Surface>>,
}

impl Standing {
    /// The mesh of a file, as large as a ball of radius 1. `turn`: radians about the vertical.
    pub fn new(name: &str, turn: f32, size: [u32; 2]) -> Self {
        let model =
            load_mesh(Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/assets").join(name)).unwrap();
        let bounds = model.bounds().unwrap();
        let scale = 1.0 / bounds.radius();
        let down = Vec3::new(bounds.center().x, bounds.min.y, bounds.center().z);
        let mut mesh = model.transformed(
            Mat4::from_rotation_y(turn)
                * Mat4::from_scale(Vec3::splat(scale))
                * Mat4::from_translation(-down),
        );
        mesh.append(&plane(Vec2::splat(8.0), 1));
        let view = PerspectiveView {
            eye: Vec3::new(0.4, 1.7, 3.0),
            target: Vec3::new(0.0, 0.55, 0.0),
            field_of_view: 40.0,
            near: 0.1,
            far: 20.0,
            depth: DepthRange::Reversed,
        };
        let scene = traced(&mesh);
        let reference = reference_camera(&view, size);
        let points = surfaces(&scene, &reference, size[0] as usize, size[1] as usize);
        let camera = Camera::new(&view.into(), size).unwrap();
        let mesh = mesh.with_albedo(Vec3::ONE);
        let geometry = GeometryPass::new(gpu(), shaders())
            .unwrap()
            .draw(gpu(), &camera, &[MeshBuffers::new(gpu(), &mesh)])
            .unwrap();
        Self { size, camera, geometry, scene, points }
    }

    /// As the passes take it.
    pub fn images(&self) -> SurfaceImages<'_> {
        SurfaceImages { camera: &self.camera, depth: &self.geometry.depth, normals: &self.geometry.normals }
    }

    /// The traced picture; the approximations of the reference are not looked at.
    pub fn truth(&self, map: &ReferenceEnvironment) -> Vec<Option<Pixel>> {
        let settings = Settings {
            directions: 128,
            light_directions: 1,
            reach: Reach::UNLIMITED,
            lift: 0.0,
            angle: Angle::Exact,
            brightness: Brightness::Cosine,
        };
        picture(&self.scene, map, &self.points, self.size[0] as usize, &settings)
    }

    /// The picture of a method: linear RGB and whether there is a surface, row after row.
    pub fn drawn(
        &self,
        cones: &Texture,
        method: Method,
        printed: bool,
        settings: &OcclusionSettings,
    ) -> Vec<f32> {
        let form = BentForm {
            sampling: Sampling::Hemisphere,
            blurring: Blurring::Difference,
            occlusion_only: false,
            halved: false,
        };
        let mut encoder = gpu().encoder();
        let bent = BentPasses::new(gpu(), shaders(), form).unwrap();
        let bent = bent.record(gpu(), &mut encoder, self.images(), settings).unwrap();
        let shade = ShadePass::new(gpu(), shaders(), method, printed).unwrap();
        let albedos = &self.geometry.albedos;
        let picture = shade.record(gpu(), &mut encoder, self.images(), albedos, &bent, cones).unwrap();
        gpu().submit(encoder).unwrap();
        picture.read(gpu()).unwrap()
    }
}

/// Eight directions of three steps, for models of this size.
pub fn settings() -> OcclusionSettings {
    OcclusionSettings { thickness: 1.0, ..OcclusionSettings::new(1.5) }
}

/// A real map of 32x16 texels, for rays and for the passes.
pub fn low_passed(file: &str) -> (ReferenceEnvironment, Environment) {
    let map = reference_map(&real_map(file)).resized(16);
    let texels = map.texels().iter().map(|t| Vec3::from(t.map(|v| v as f32))).collect();
    let host_map = Environment::new([32, 16], texels).unwrap();
    (map, host_map)
}

fn traced(mesh: &Mesh) -> Scene {
    let corner = |index: u32| (vector(mesh.positions[index as usize]), vector(mesh.normals[index as usize]));
    let triangle = |indices: &[u32]| {
        let corners = [0, 1, 2].map(|i| corner(indices[i]));
        Triangle { positions: corners.map(|c| c.0), normals: corners.map(|c| c.1) }
    };
    Scene::new(mesh.indices.chunks_exact(3).map(triangle).collect())
}

/// RMSE of a picture of the RMS of what is true, over pixels that both see.
pub fn error(picture: &[f32], truth: &[Option<Pixel>]) -> f64 {
    let (mut wrong, mut all) = (0.0, 0.0);
    for (texel, pixel) in picture.chunks_exact(4).zip(truth) {
        let Some(pixel) = pixel.filter(|_| texel[3] == 1.0) else { continue };
        for (value, expected) in texel.iter().zip(pixel.truth) {
            wrong += (f64::from(*value) - expected).powi(2);
            all += expected * expected;
        }
    }
    (wrong / all).sqrt()
}
