// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces in the light of real environment maps: occlusion, bent normals and bent cones of the screen against traced pictures.

use crate::cones;
use crate::standing::{Standing, error, low_passed};
use airlight::ambient::Method;
use airlight::scenes::ambient_scenes;

const SIZE: [u32; 2] = [112, 84];

#[test]
fn cones_are_nearer_to_the_truth_than_normals_and_these_than_occlusion() {
    for scene in ambient_scenes().unwrap() {
        let (name, standing) = (scene.name, Standing::new(&scene, SIZE));
        for file in ["forest.exr", "sunset.exr"] {
            let (map, host_map) = low_passed(file);
            let light = cones::lit(&host_map, 33, false);
            let truth = standing.truth(&map);
            let of = |method, printed| {
                error(&standing.drawn(&light.cones, method, printed, &standing.settings), &truth)
            };
            let occlusion = of(Method::Occlusion, false);
            println!("{name} {file}: occlusion {occlusion:.4}");
            // Brightness as the thesis prints it, and the exact share of even light.
            let [[normals, cones, exact], shared] = [true, false]
                .map(|printed| [Method::Normals, Method::Cones, Method::ExactCones].map(|m| of(m, printed)));
            println!("{name} {file}: normals {normals:.4}, cones {cones:.4}, exact cones {exact:.4}");
            println!("{name} {file}: with the exact share of even light {shared:.4?}");
            assert!(cones < normals && exact < normals, "{cones} {exact} {normals}");
            assert!(normals < 0.9 * occlusion, "{normals} {occlusion}");
            assert!(shared.iter().all(|error| *error < occlusion), "{shared:?} {occlusion}");
        }
    }
}
