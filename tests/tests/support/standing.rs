// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes of the gallery in the light of real environment maps, traced and lit by bent cones.
//!
//! Maps are low-passed to 32x16 texels, for cones cannot follow what is finer.
#![allow(dead_code, clippy::unwrap_used)]

use crate::cones::{real_map, reference_map};
use crate::gpu::{gpu, reference_camera, shaders, vector};
use airlight::Texture;
use airlight::ambient::{
    BentForm, BentPasses, Blurring, Method, OcclusionSettings, Sampling, ShadePass, SurfaceImages,
};
use airlight::core::{Camera, Geometry, GeometryPass, MeshBuffers};
use airlight::data::{Environment, Mesh};
use airlight::scenes::AmbientScene;
use airlight_tests::reference::ambient::{
    Angle, Brightness, Environment as ReferenceEnvironment, Pixel, Reach, Scene, Settings, Surface, Triangle,
    picture, surfaces,
};
use glam::Vec3;

/// A scene without colours, as the rasteriser and the rays see it.
pub struct Standing {
    size: [u32; 2],
    /// Eight directions of three steps as far as the scene needs.
    pub settings: OcclusionSettings,
    camera: Camera,
    pub geometry: Geometry,
    scene: Scene,
    points: Vec<Option<Surface>>,
}

impl Standing {
    /// A scene of the gallery, white.
    pub fn new(scene: &AmbientScene, size: [u32; 2]) -> Self {
        let (mesh, view) = (&scene.mesh, &scene.view);
        let settings =
            OcclusionSettings { thickness: scene.thickness, ..OcclusionSettings::new(scene.radius) };
        let scene = traced(mesh);
        let reference = reference_camera(view, size);
        let points = surfaces(&scene, &reference, size[0] as usize, size[1] as usize);
        let camera = Camera::new(&(*view).into(), size).unwrap();
        let mesh = mesh.clone().with_albedo(Vec3::ONE);
        let geometry = GeometryPass::new(gpu(), shaders())
            .unwrap()
            .draw(gpu(), &camera, &[MeshBuffers::new(gpu(), &mesh)])
            .unwrap();
        Self { size, settings, camera, geometry, scene, points }
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
