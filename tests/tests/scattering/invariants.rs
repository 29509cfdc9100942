// SPDX-License-Identifier: MIT OR Apache-2.0
//! What holds in every scene: blockers take light away, thicker air scatters more.

use crate::gpu::{self, gpu};
use crate::methods::{all_methods, prefiltered};
use airlight::scattering::Settings;
use wgpu::TextureFormat::R32Float;

#[test]
fn blockers_only_take_light_away() {
    for scene in [gpu::torus_over_plane(), gpu::small_tree()] {
        let picture = [120, 80];
        let mut stage = scene.stage(picture, [256, 256]);
        let with = all_methods(&stage, picture, [128, 128]);
        stage.pictures.shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
        let without = all_methods(&stage, picture, [128, 128]);
        for ((name, weighted, shadowed), (_, _, lit)) in with.iter().zip(&without) {
            let over = shadowed.radiance.iter().zip(&lit.radiance).map(|(s, l)| s - l * (1.0 + 2.0 / 255.0));
            let over = over.fold(0.0, f32::max);
            assert!(over <= 1e-3, "{name}, weighted {weighted}: {over} more with blockers");
            let dark = shadowed.visibility.iter().filter(|v| **v < 0.98).count();
            assert!(dark > shadowed.visibility.len() / 20, "{name}: the blockers block nothing");
        }
    }
}

#[test]
fn thicker_air_scatters_more_of_a_lit_ray() {
    let scene = gpu::torus_over_plane();
    let picture = [60, 40];
    let mut stage = scene.stage(picture, [64, 64]);
    stage.pictures.shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
    let mut before = vec![0.0_f32; 60 * 40 * 3];
    for extinction in [0.0, 1e-3, 1e-2, 0.1, 1.0, 10.0] {
        stage.medium.extinction = extinction;
        stage.medium_buffer.write(gpu(), &stage.medium);
        let settings = Settings { map: [64, 64], ..Settings::default() };
        let now = prefiltered(&stage.inputs(), settings, picture).radiance;
        assert!(
            now.iter().zip(&before).all(|(n, b)| *n >= b * (1.0 - 2.0 / 255.0)),
            "extinction {extinction}"
        );
        assert!(extinction > 0.0 || now.iter().all(|n| *n == 0.0));
        before = now;
    }
}
