// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every buffer between a small scene under a map and its picture, against their snapshots: cones of light, bent normals by each
//! sampler, blurred and made whole from half the resolution, lit surfaces.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/snapshot.rs"]
mod snapshot;

use airlight::Texture;
use airlight::ambient::{
    BentForm, BentPasses, Blurring, ConeLight, ConeLightForm, Method, OcclusionSettings, Sampling, ShadePass,
    SurfaceImages,
};
use airlight::core::{Camera, DepthRange, GeometryPass, MeshBuffers, PerspectiveView};
use airlight::data::{Environment, cuboid, plane, sphere};
use glam::{Mat4, Vec2, Vec3};
use gpu::{gpu, shaders};
use snapshot::{assert_buffer, buffer, tolerance};

/// Half a warm sky, brighter towards one side, over a dim ground.
fn sky(direction: Vec3) -> Vec3 {
    let side = direction.dot(Vec3::new(0.6, 0.64, 0.48)).max(0.0).powi(8);
    Vec3::new(0.3, 0.45, 0.8) * (0.2 + direction.y.max(0.0)) + Vec3::new(3.0, 2.0, 1.0) * side
}

#[test]
fn a_ball_and_a_block_under_a_sky() {
    let mut mesh = plane(Vec2::splat(6.0), 1);
    mesh.append(&sphere(0.5, 32, 16).transformed(Mat4::from_translation(Vec3::new(-0.4, 0.5, 0.0))));
    mesh.append(&cuboid(Vec3::splat(0.8)).transformed(Mat4::from_translation(Vec3::new(0.6, 0.4, -0.3))));
    let mesh = mesh.with_albedo(Vec3::new(0.8, 0.6, 0.4));
    let view = PerspectiveView {
        eye: Vec3::new(0.3, 1.4, 2.6),
        target: Vec3::new(0.0, 0.35, 0.0),
        field_of_view: 45.0,
        near: 0.1,
        far: 20.0,
        depth: DepthRange::Reversed,
    };
    let camera = Camera::new(&view.into(), [48, 36]).unwrap();
    let geometry = GeometryPass::new(gpu(), shaders()).unwrap();
    let geometry = geometry.draw(gpu(), &camera, &[MeshBuffers::new(gpu(), &mesh)]).unwrap();
    let seen = SurfaceImages { camera: &camera, depth: &geometry.depth, normals: &geometry.normals };
    let settings = OcclusionSettings { thickness: 0.5, side: 4, ..OcclusionSettings::new(0.8) };
    let found = |sampling, blurring, halved| -> Texture {
        let form = BentForm { sampling, blurring, occlusion_only: false, halved };
        let mut encoder = gpu().encoder();
        let bent = BentPasses::new(gpu(), shaders(), form).unwrap();
        let bent = bent.record(gpu(), &mut encoder, seen, &settings).unwrap();
        gpu().submit(encoder).unwrap();
        bent
    };
    // One of eight directions may find another pixel on another adapter.
    let [sharp, smooth] = [tolerance(2e-3, 2e-3, 0.05), tolerance(5e-3, 5e-3, 0.05)];
    let normals = tolerance(2e-3, 2e-3, 0.02);
    assert_buffer("ambient_normals", &buffer(&geometry.normals, 0, 3, normals));
    assert_buffer("ambient_albedos", &buffer(&geometry.albedos, 0, 3, normals));
    for (name, sampling) in [
        ("disc", Sampling::Disc),
        ("hemisphere", Sampling::Hemisphere),
        ("horizon", Sampling::Horizon),
        ("bitmask", Sampling::Bitmask),
    ] {
        let bent = found(sampling, Blurring::Off, false);
        assert_buffer(&format!("ambient_{name}"), &buffer(&bent, 0, 4, sharp));
    }
    let bent = found(Sampling::Hemisphere, Blurring::Difference, false);
    assert_buffer("ambient_blurred", &buffer(&bent, 0, 4, smooth));
    let halved = found(Sampling::Hemisphere, Blurring::Difference, true);
    assert_buffer("ambient_halved", &buffer(&halved, 0, 4, smooth));

    let map = Environment::from_function([32, 16], sky).unwrap();
    for (name, sampled) in [("exact", false), ("sampled", true)] {
        let light = ConeLight::new(gpu(), shaders(), &map, ConeLightForm { side: 9, sampled }).unwrap();
        for layer in [0, 7] {
            let cones = buffer(&light.cones, layer, 3, tolerance(2e-3, 2e-3, 0.0));
            assert_buffer(&format!("ambient_cones_{name}_{layer}"), &cones);
        }
    }
    let light = ConeLight::new(gpu(), shaders(), &map, ConeLightForm { side: 17, sampled: false }).unwrap();
    for (name, method) in [
        ("ao", Method::Occlusion),
        ("normals", Method::Normals),
        ("cones", Method::Cones),
        ("exact_cones", Method::ExactCones),
    ] {
        let shade = ShadePass::new(gpu(), shaders(), method, false).unwrap();
        let mut encoder = gpu().encoder();
        let picture =
            shade.record(gpu(), &mut encoder, seen, &geometry.albedos, &bent, &light.cones).unwrap();
        gpu().submit(encoder).unwrap();
        assert_buffer(&format!("ambient_shaded_{name}"), &buffer(&picture, 0, 4, smooth));
    }
}
