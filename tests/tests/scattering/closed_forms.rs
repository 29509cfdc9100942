// SPDX-License-Identifier: MIT OR Apache-2.0
//! Slabs of air and a half-plane blocker, in closed form.

use crate::gpu::{self};
use crate::methods::all_methods;
use crate::synthetic::Synthetic;
use airlight::scattering::Medium;
use airlight_tests::error;
use glam::Vec3;

#[test]
fn an_empty_shadow_map_lights_everything_and_a_slab_has_its_closed_form() {
    let lights = [Vec3::Y, Vec3::new(0.4, 0.3, 0.2).normalize(), Vec3::new(-0.9, -0.2, 0.1).normalize()];
    for (g, extinction, light) in [(0.0, 0.1, lights[0]), (0.7, 0.6, lights[1]), (-0.4, 0.004, lights[2])] {
        let medium = Medium::new(extinction, Vec3::splat(0.8), g, 20.0).unwrap();
        let case = Synthetic::new(medium, light, |_, _| false);
        let rays = case.rays();
        let (medium, light) = (gpu::reference_medium(&medium), gpu::reference_light(&case.stage.light));
        let expected: Vec<f64> =
            rays.iter().flat_map(|(direction, s)| medium.radiance(&light, *direction, *s, 1.0)).collect();
        for (name, weighted, found) in all_methods(&case.stage, Synthetic::PICTURE, [256, 256]) {
            // Bases of 8 bits hold visibility to 2/255; a march but for the step of a half float.
            let budget = if name == "prefiltered" { 2.0 / 255.0 } else { 4.9e-4 };
            let ones = vec![1.0_f32; found.visibility.len()];
            let visibility = error::max_absolute(&found.visibility, &ones);
            let radiance = found
                .radiance
                .iter()
                .zip(&expected)
                .map(|(f, e)| (f64::from(*f) / e - 1.0).abs())
                .fold(0.0, f64::max);
            println!(
                "slab g {g}, {name}, weighted {weighted}: visibility off by {visibility:.1e}, radiance {radiance:.1e}"
            );
            assert!(visibility <= budget, "{name}: {visibility}");
            assert!(radiance <= budget + 1e-3, "{name}: {radiance}");
        }
    }
}

#[test]
fn a_half_plane_blocker_has_its_closed_form() {
    let medium = Medium::new(0.15, Vec3::splat(0.8), 0.2, 20.0).unwrap();
    // Everything beyond x = 0 lies in shadow, whatever the height.
    let case = Synthetic::new(medium, Vec3::Y, |x, _| x > 0.0);
    let rays = case.rays();
    let sigma = f64::from(medium.extinction);
    let expected = |weighted: bool| -> Vec<f64> {
        rays.iter()
            .map(|(direction, s)| {
                let lit = if direction.x > 0.0 { (3.0 / direction.x).min(*s) } else { *s };
                if weighted { (-sigma * lit).exp_m1() / (-sigma * s).exp_m1() } else { lit / s }
            })
            .collect()
    };
    for (name, weighted, found) in all_methods(&case.stage, Synthetic::PICTURE, [1024, 1024]) {
        let expected = expected(weighted);
        let mean = error::mean_absolute(&found.visibility, &expected);
        let worst = error::worst(&found.visibility, &expected, Synthetic::PICTURE[0] as usize).unwrap();
        println!("half plane, {name}, weighted {weighted}: mean {mean:.2e}, {worst}");
        // One texel of 1024 of the row, two neighbouring rows; for the series the ringing of one edge.
        let budget = match (name, weighted) {
            ("prefiltered", false) => 4e-3,
            ("prefiltered", true) => 0.012,
            _ => 1e-3,
        };
        assert!(mean <= budget, "{name}, weighted {weighted}: {mean}");
    }
}
