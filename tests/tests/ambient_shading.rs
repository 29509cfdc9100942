// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces in the light of real environment maps: occlusion, bent normals and bent cones of the screen against traced pictures.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/cones.rs"]
mod cones;
#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/standing.rs"]
mod standing;

use airlight::ambient::Method;
use standing::{Standing, error, low_passed, settings};

const SIZE: [u32; 2] = [112, 84];

#[test]
fn bent_normals_and_cones_are_nearer_to_the_truth_than_occlusion() {
    let _turn = gpu::turn();
    for (name, turn) in [("bunny.obj", 0.3), ("suzanne.obj", 0.3)] {
        let standing = Standing::new(name, turn, SIZE);
        for file in ["forest.exr", "sunset.exr"] {
            let (map, host_map) = low_passed(file);
            let light = cones::lit(&host_map, 33, false);
            let truth = standing.truth(&map);
            let of =
                |method, printed| error(&standing.drawn(&light.cones, method, printed, &settings()), &truth);
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
