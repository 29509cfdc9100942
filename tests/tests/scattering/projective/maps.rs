// SPDX-License-Identifier: MIT OR Apache-2.0
//! Resampled maps against the reference, drawn maps against resampled ones, and blockers outside of the picture.

use super::stage::{Stage, gallery, level_foliage};
use crate::gpu::{self, gpu};
use airlight::core::{DepthRange, PerspectiveView, Sky};
use airlight::data::plane;
use airlight::scattering::{Medium, Settings, Weighting};
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;
use glam::{Mat4, Vec2, Vec3};

#[test]
fn resampled_maps_are_those_of_the_reference() {
    for (name, stage, splits) in [
        ("foliage", gallery("foliage"), 3),
        ("plane", gallery("plane"), 1),
        ("orthographic", level_foliage(), 1),
    ] {
        let size = [384, 256];
        let map = stage.map(size, splits);
        let shadow_map = stage.pictures.shadow_map.read(gpu()).unwrap();
        let [width, height, _] = stage.pictures.shadow_map.size();
        let standard = reference::ShadowMap {
            depth: &shadow_map,
            width: width as usize,
            height: height as usize,
            clip_from_world: gpu::matrix(stage.light.clip_from_world),
            far_depth: 1.0,
        };
        let expected = stage.reference_rows(size, splits).rectify(&[standard], 0.02);
        let found = map.rectified.read(gpu()).unwrap();
        let beyond = |(z, texel): (&f32, &reference::RectifiedTexel)| {
            (texel.low - f64::from(*z)).max(f64::from(*z) - texel.high)
        };
        let worst = found.iter().zip(&expected).map(beyond).fold(0.0, f64::max);
        let blocked = found.iter().filter(|z| **z < 1.0).count() as f64 / found.len() as f64;
        println!("resampled {name}: worst {worst:.2e}, {:.0} % blocked", 100.0 * blocked);
        assert!(worst <= 2e-5 && blocked > 0.02, "{name}: {worst}");
    }
}

#[test]
fn drawn_maps_are_the_resampled_ones() {
    for (name, mut stage) in
        [("terrain", gallery("terrain")), ("torus", gallery("torus")), ("orthographic", level_foliage())]
    {
        // The finest shadow map that fits.
        let sky = Sky::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        stage.pictures = gpu::raster()
            .render(gpu(), &stage.camera, &stage.light, &sky, &stage.meshes, [4096, 4096])
            .unwrap();
        for splits in if name == "orthographic" { vec![1] } else { vec![1, 3] } {
            let size = [512, 256];
            let drawn = stage.drawn(size, splits).rectified.read(gpu()).unwrap();
            let map = stage.map(size, splits).rectified.read(gpu()).unwrap();
            // A texel may take either side of a silhouette within a texel of the shadow map: the drawn depth must
            // lie between those of the neighbourhood that the resampled map has.
            let [width, height] = size.map(|side| side as usize);
            let mut wrong = 0;
            let mut sum = 0.0;
            for y in 0..height {
                for x in 0..width {
                    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
                    for near_y in y.saturating_sub(1)..(y + 2).min(height) {
                        for near_x in x.saturating_sub(1)..(x + 2).min(width) {
                            low = low.min(map[near_y * width + near_x]);
                            high = high.max(map[near_y * width + near_x]);
                        }
                    }
                    let z = drawn[y * width + x];
                    assert!((0.0..=1.0).contains(&z));
                    wrong += usize::from(z < low - 0.004 || z > high + 0.004);
                    sum += f64::from((z - map[y * width + x]).abs());
                }
            }
            let share = wrong as f64 / drawn.len() as f64;
            let mean = sum / drawn.len() as f64;
            println!(
                "drawn {name}, {splits} splits: {:.2} % beyond the neighbours, mean difference {mean:.4}",
                100.0 * share
            );
            assert!(share < 0.02 && mean < 0.02, "{name} {splits}: {share} {mean}");
        }
    }
}

#[test]
fn blockers_outside_of_the_frustum_cast_shadows() {
    // A plate high above the picture, and one far below it that casts none.
    let mut mesh = plane(Vec2::splat(3.0), 1).transformed(Mat4::from_translation(Vec3::new(0.0, 40.0, 0.0)));
    mesh.append(&plane(Vec2::splat(60.0), 1).transformed(Mat4::from_translation(Vec3::Y * -40.0)));
    let view = PerspectiveView {
        eye: Vec3::new(0.0, 1.0, 8.0),
        target: Vec3::new(0.0, 1.0, 0.0),
        field_of_view: 40.0,
        near: 0.1,
        far: 20.0,
        depth: DepthRange::Forward,
    };
    let picture = [96, 64];
    let medium = Medium::new(0.02, Vec3::ONE, 0.0, 20.0).unwrap();
    let stage = Stage::new(&mesh, gpu::reference_camera(&view, picture), Vec3::Y, medium, picture, 1024);
    for splits in 1..=4 {
        let drawn = stage.drawn([264, 128], splits);
        let values = drawn.rectified.read(gpu()).unwrap();
        let (near, rest): (Vec<f32>, Vec<f32>) = values.iter().partition(|z| **z < 0.05);
        assert!(near.iter().all(|z| *z == 0.0) && near.len() > 50, "{} blocked", near.len());
        // What lies below all rays is clamped to 1, where nothing is told from it.
        assert!(rest.iter().all(|z| *z == 1.0));
        let exact = stage.exact(&drawn.rectified, splits);
        let (found, _) =
            stage.prefiltered(drawn, Settings { weighting: Weighting::Average, ..Settings::default() });
        let (least, error) = (
            found.visibility.iter().fold(1.0_f32, |a, b| a.min(*b)),
            error::mean_absolute(&found.visibility, &exact.average()),
        );
        // The shadow is 3 of the 20 metres; darkest where rays run through all of it.
        println!("{splits} splits: least visibility {least:.3}, mean error {error:.4}");
        assert!(least < 0.93 && error < 0.004);
    }
}
