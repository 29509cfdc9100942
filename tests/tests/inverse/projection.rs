// SPDX-License-Identifier: MIT OR Apache-2.0
//! Renderings of the system `inverse` against a matrix in f64, and back-projections as their transpose: <Wx, y> = <x, W'y>.

use crate::gpu::{self, Probe, Random};
use crate::projectors::{Case, EXTINCTION, SIZE, cameras, errors, form, placed};
use airlight::inverse::{Basis, Channels, InverseError, SliceView, Solved, Transpose};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, View as Perspective};
use airlight_tests::reference::inverse::View;
use glam::Mat4;

#[test]
fn pictures_are_products_with_a_matrix_and_back_projections_with_its_transpose() {
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

#[test]
fn planes_that_go_on_behind_the_eye_are_collected_from_all_their_pixels() {
    let probe = Probe {
        head: "#import airlight::inverse::slice_steps::SliceView
               #import airlight::inverse::cg_backproject::{Support, pixels_of_plane}
               fn three(k: u32) -> vec3<f32> { return vec3<f32>(input(k), input(k + 1u), input(k + 2u)); }
               fn four(k: u32) -> vec4<f32> { return vec4<f32>(three(k), input(k + 3u)); }",
        body: "var view: SliceView;
               view.slices = 8u; view.width = 36u; view.height = 28u;
               view.axis = three(0u);
               view.column_of = four(3u); view.row_of = four(7u); view.divisor_of = four(11u);
               let pixels = pixels_of_plane(view, Support(three(15u), three(18u)), u32(input(21u)));
               output(0u, f32(pixels.x)); output(1u, f32(pixels.y));
               output(2u, f32(pixels.z)); output(3u, f32(pixels.w));",
        inputs: 22,
        outputs: 4,
    };
    let mut random_ = Random(11);
    let mut records = Vec::new();
    let mut cases = Vec::new();
    for _ in 0..3000 {
        let mut within = || Vec3::from([0; 3].map(|_| random_.between(0.0, 1.0)));
        let (eye, target, low, high) = (within(), within(), within().to_array(), within().to_array());
        let slice = random_.below(8);
        let up = Vec3::new(0.1, 1.0, 0.2);
        let view = Perspective {
            eye,
            target,
            up,
            fov_y: 1.9,
            aspect: 36.0 / 28.0,
            near: 1e-3,
            far: 10.0,
            reversed: false,
        };
        let camera = ReferenceCamera::perspective(&view);
        let seen = SliceView::new(&gpu::host_camera(&camera, SIZE), Mat4::IDENTITY, [1; 3], 8).unwrap();
        let support = [0, 1, 2].map(|i: usize| [low[i].min(high[i]), low[i].max(high[i])]);
        records.extend(seen.axis.to_array());
        for row in [seen.column_of, seen.row_of, seen.divisor_of] {
            records.extend(row.to_array());
        }
        records.extend([0, 1].into_iter().flat_map(|end| support.map(|ends| ends[end] as f32)));
        records.push(slice as f32);
        let axis = seen.axis.to_array().iter().position(|part| *part == 1.0).unwrap();
        cases.push((View::new(&camera, [36, 28]), support, axis, (slice as f64 + 0.5) / 8.0));
    }
    let found = probe.run(&records);
    let [mut met, mut behind] = [0; 2];
    for ((view, support, axis, plane), rectangle) in cases.iter().zip(found.chunks_exact(4)) {
        let reaches_behind = (0..4).any(|corner: usize| {
            let mut point = [*plane; 3];
            point[(axis + 1) % 3] = support[(axis + 1) % 3][corner & 1];
            point[(axis + 2) % 3] = support[(axis + 2) % 3][corner >> 1];
            let middle = view.through([0.0, 0.0]);
            (Vec3::from(point) - middle.origin).dot(middle.direction) < 0.0
        });
        for (x, y) in (0..28).flat_map(|y| (0..36).map(move |x| (x, y))) {
            let ray = view.ray(x, y);
            let way = (plane - ray.origin.to_array()[*axis]) / ray.direction.to_array()[*axis];
            let point = (ray.origin + ray.direction * way).to_array();
            // A little within the support, for rounding.
            let inside = |i: usize| point[i] > support[i][0] + 1e-4 && point[i] < support[i][1] - 1e-4;
            if way > 1e-4 && inside((axis + 1) % 3) && inside((axis + 2) % 3) {
                let pixel = [x as f32, y as f32];
                let held = (0..2).all(|i| pixel[i] >= rectangle[i] && pixel[i] <= rectangle[2 + i]);
                assert!(held, "{pixel:?} is not of {rectangle:?} for {support:?} at {plane}, axis {axis}");
                met += 1;
                behind += u32::from(reaches_behind);
            }
        }
    }
    println!("{met} pixels, {behind} of planes that go on behind the eye");
    assert!(met > 100_000 && behind > 10_000, "{met} {behind}");
}
