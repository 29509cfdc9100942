// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces in the light of real environment maps: occlusion, bent normals and bent cones of the screen against traced pictures.
//!
//! Maps are low-passed to 32x16 texels, for cones cannot follow what is finer. `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/cones.rs"]
mod cones;
#[path = "support/gpu.rs"]
mod gpu;

use airlight::ambient::{
    BentForm, BentPasses, Blurring, ConeLight, ConeLightForm, Method, OcclusionSettings, Sampling, ShadePass,
    SurfaceImages,
};
use airlight::core::{Camera, DepthRange, GeometryPass, MeshBuffers, PerspectiveView};
use airlight::data::{Environment, Mesh, load_mesh, plane};
use airlight_tests::reference::ambient::{
    Angle, Brightness, Environment as ReferenceEnvironment, Pixel, Reach, Scene, Settings, Surface, Triangle,
    picture, surfaces,
};
use cones::{real_map, reference_map};
use glam::{Mat4, Vec2, Vec3};
use gpu::{gpu, reference_camera, shaders, vector};
use std::path::Path;

const SIZE: [u32; 2] = [112, 84];

/// A model on a floor, and where it is seen from.
fn standing(name: &str, turn: f32) -> (Mesh, PerspectiveView) {
    let model = load_mesh(Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/assets").join(name)).unwrap();
    let bounds = model.bounds().unwrap();
    let scale = 1.0 / bounds.radius();
    let down = Vec3::new(bounds.center().x, bounds.min.y, bounds.center().z);
    let mut mesh = model.transformed(
        Mat4::from_rotation_y(turn) * Mat4::from_scale(Vec3::splat(scale)) * Mat4::from_translation(-down),
    );
    mesh.append(&plane(Vec2::splat(8.0), 1));
    (mesh, view(Vec3::new(0.4, 1.7, 3.0), Vec3::new(0.0, 0.55, 0.0)))
}

fn view(eye: Vec3, target: Vec3) -> PerspectiveView {
    PerspectiveView { eye, target, field_of_view: 40.0, near: 0.1, far: 20.0, depth: DepthRange::Reversed }
}

fn traced(mesh: &Mesh) -> Scene {
    let corner = |index: u32| (vector(mesh.positions[index as usize]), vector(mesh.normals[index as usize]));
    let triangle = |indices: &[u32]| {
        let corners = [0, 1, 2].map(|i| corner(indices[i]));
        Triangle { positions: corners.map(|c| c.0), normals: corners.map(|c| c.1) }
    };
    Scene::new(mesh.indices.chunks_exact(3).map(triangle).collect())
}

/// The picture of a method: linear RGB, row after row.
fn drawn(view: &PerspectiveView, mesh: &Mesh, light: &ConeLight, method: Method, printed: bool) -> Vec<f32> {
    let camera = Camera::new(&(*view).into(), SIZE).unwrap();
    let mesh = mesh.clone().with_albedo(Vec3::ONE);
    let geometry = GeometryPass::new(gpu(), shaders())
        .unwrap()
        .draw(gpu(), &camera, &[MeshBuffers::new(gpu(), &mesh)])
        .unwrap();
    let seen = SurfaceImages { camera: &camera, depth: &geometry.depth, normals: &geometry.normals };
    let form = BentForm {
        sampling: Sampling::Hemisphere,
        blurring: Blurring::Difference,
        occlusion_only: false,
        halved: false,
    };
    let mut encoder = gpu().encoder();
    let settings = OcclusionSettings { thickness: 1.0, ..OcclusionSettings::new(1.5) };
    let bent = BentPasses::new(gpu(), shaders(), form).unwrap();
    let bent = bent.record(gpu(), &mut encoder, seen, &settings).unwrap();
    let shade = ShadePass::new(gpu(), shaders(), method, printed).unwrap();
    let picture = shade.record(gpu(), &mut encoder, seen, &geometry.albedos, &bent, &light.cones).unwrap();
    gpu().submit(encoder).unwrap();
    picture.read(gpu()).unwrap()
}

/// RMSE of a picture of the RMS of what is true, over pixels that both see.
fn error(picture: &[f32], truth: &[Option<Pixel>]) -> f64 {
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

#[test]
fn bent_normals_and_cones_are_nearer_to_the_truth_than_occlusion() {
    let _turn = gpu::turn();
    for (name, turn) in [("bunny.obj", 0.3), ("suzanne.obj", 0.3)] {
        let (mesh, view) = standing(name, turn);
        let scene = traced(&mesh);
        let camera = reference_camera(&view, SIZE);
        let points: Vec<Option<Surface>> = surfaces(&scene, &camera, SIZE[0] as usize, SIZE[1] as usize);
        for file in ["forest.exr", "sunset.exr"] {
            let map: ReferenceEnvironment = reference_map(&real_map(file)).resized(16);
            let texels = map.texels().iter().map(|t| Vec3::from(t.map(|v| v as f32))).collect();
            let host_map = Environment::new([32, 16], texels).unwrap();
            let form = ConeLightForm { side: 33, sampled: false };
            let light = ConeLight::new(gpu(), shaders(), &host_map, form).unwrap();
            let settings = Settings {
                directions: 128,
                // The approximations of the reference are not looked at.
                light_directions: 1,
                reach: Reach::UNLIMITED,
                lift: 0.0,
                angle: Angle::Exact,
                brightness: Brightness::Cosine,
            };
            let truth = picture(&scene, &map, &points, SIZE[0] as usize, &settings);
            let of = |method, printed| error(&drawn(&view, &mesh, &light, method, printed), &truth);
            let occlusion = of(Method::Occlusion, false);
            println!("{name} {file}: occlusion {occlusion:.4}");
            for method in [Method::Normals, Method::Cones, Method::ExactCones] {
                let errors = [false, true].map(|printed| of(method, printed));
                println!(
                    "{name} {file}: {method:?} {:.4}, brightness as printed {:.4}",
                    errors[0], errors[1]
                );
                assert!(
                    errors.iter().all(|error| *error < 0.9 * occlusion),
                    "{method:?}: {errors:?} {occlusion}"
                );
            }
        }
    }
}
