// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes that the tests of several rooms share.

use super::*;
use crate::linear::{Mat4, Vec3};
use crate::reference::camera::{Camera, View as Perspective};

/// Even numbers from 0 to 1, the same in every run.
pub(super) fn numbers(seed: u64) -> impl Iterator<Item = f64> {
    let mut state = seed;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    })
}

/// The box 0..1 of the world itself.
pub(super) fn unit_box() -> VolumeBox {
    let diagonal = [0, 1, 2, 3].map(|r| [0, 1, 2, 3].map(|c| if r == c { 1.0 } else { 0.0 }));
    VolumeBox::new(Mat4::from_rows(diagonal)).expect("regular")
}

/// A box with no right angle and sides of 2 to 3 metres, about the world's origin.
pub(super) fn sheared_box() -> VolumeBox {
    let rows = [[2.0, 0.4, -0.1, -1.2], [-0.3, 2.6, 0.5, -1.4], [0.2, -0.6, 3.0, -1.3], [0.0, 0.0, 0.0, 1.0]];
    VolumeBox::new(Mat4::from_rows(rows)).expect("regular")
}

/// The sheared box from one side, 6 x 5 pixels.
pub(super) fn view() -> View {
    let camera = Camera::perspective(&Perspective {
        eye: Vec3::new(3.0, 1.5, 5.0),
        target: Vec3::default(),
        up: Vec3::new(0.0, 1.0, 0.0),
        fov_y: 0.6,
        aspect: 1.2,
        near: 0.1,
        far: 50.0,
        reversed: false,
    });
    View::new(&camera, [6, 5])
}

/// Uneven extinction and light.
pub(super) fn medium() -> Medium {
    let mut numbers = numbers(7);
    let mut grid =
        |size: [usize; 3]| Grid { size, values: numbers.by_ref().take(size.iter().product()).collect() };
    Medium { extinction: grid([4, 5, 6]), scattered: grid([3, 2, 4]) }
}

/// Straight and bent rays of the view.
pub(super) fn paths() -> [Vec<Vec<Sample>>; 2] {
    let (volume, view) = (sheared_box(), view());
    let slices = Slices::of_view(&volume, &view, [4, 5, 6], 9);
    let index = Grid::from_fn([4, 4, 4], |p| 1.0 + 0.3 * (p.x * (2.0 - p.y) + 0.5 * p.z));
    [view.rays(|ray| straight(&volume, &slices, ray)), view.rays(|ray| bent(&volume, &index, 0.17, ray))]
}
