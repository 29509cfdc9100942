// SPDX-License-Identifier: MIT OR Apache-2.0
//! Renderings of the system `inverse` against a matrix in f64, and back-projections as their transpose: <Wx, y> = <x, W'y>.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

#[path = "support/inverse.rs"]
mod projectors;

use airlight::inverse::{Basis, Channels, InverseError, SliceView, Solved, Transpose};
use glam::Mat4;
use gpu::Random;
use projectors::{Case, EXTINCTION, cameras, errors, form, placed};

#[test]
fn pictures_are_products_with_a_matrix_and_back_projections_with_its_transpose() {
    let _turn = gpu::turn();
    let mut random_ = Random(7);
    for solved in [Solved::Emission, Solved::Albedo, Solved::Both, Solved::Extinction] {
        for (basis, channels, slices, surfaces) in [
            (Basis::Triangle, Channels::One, 10, false),
            (Basis::Triangle, Channels::Rgb, 23, true),
            (Basis::Box, Channels::One, 16, true),
            (Basis::Box, Channels::Rgb, 8, false),
        ] {
            let form = form(solved, basis, channels, Transpose::Collect);
            let case = Case { form, slices, surfaces, extinction: 2.5 };
            let mut worst = [0.0_f64; 2];
            for (name, reference, camera) in cameras() {
                let found = errors(&case, &reference, &camera, &mut random_);
                println!(
                    "{solved:?} {basis:?} {channels:?} {slices} slices, {name}: {:.1e} {:.1e}",
                    found[0], found[1]
                );
                worst = [0, 1].map(|i| worst[i].max(found[i]));
            }
            assert!(worst[0] < 1e-3 && worst[1] < 1e-5, "{solved:?} {basis:?} {channels:?}: {worst:?}");
        }
    }
}

#[test]
fn haze_is_not_lost_in_rounding() {
    let _turn = gpu::turn();
    for solved in [Solved::Emission, Solved::Albedo] {
        let form = form(solved, Basis::Triangle, Channels::Rgb, Transpose::Collect);
        // Of steps of a depth of about 1e-6, 1 - exp(-depth) has one digit.
        let case = Case { form, slices: 23, surfaces: false, extinction: 1e-5 };
        let (name, reference, camera) = cameras().remove(0);
        let [picture, pair] = errors(&case, &reference, &camera, &mut Random(3));
        println!("{solved:?} of haze, {name}: {picture:.1e} {pair:.1e}");
        assert!(picture < 1e-5 && pair < 1e-5, "{solved:?}: {picture:e} {pair:e}");
    }
}

#[test]
fn impossible_views_are_refused() {
    let (_, _, camera) = cameras().remove(0);
    for slices in [0, 5000] {
        assert!(matches!(
            SliceView::new(&camera, placed(), EXTINCTION, slices),
            Err(InverseError::Setting(_))
        ));
    }
    let flat = Mat4::from_scale(glam::Vec3::new(1.0, 0.0, 1.0));
    assert!(matches!(SliceView::new(&camera, flat, EXTINCTION, 8), Err(InverseError::Camera)));
}
