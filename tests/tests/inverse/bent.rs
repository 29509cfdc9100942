// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that an index of refraction bends: pictures and back-projections against f64, paths against curves in closed form.

use crate::gpu::{self, Random, gpu, shaders};
use crate::projectors::{
    Case, EXTINCTION, SIZE, cameras, count, errors, form, index_volume, placed, random, volume,
};
use airlight::core::Camera;
use airlight::inverse::{
    Basis, Channels, Collected, Fields, InverseError, Medium, Projector, ProjectorForm, SliceView, Solved,
    Transpose,
};
use airlight::{Buffer, Texture};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, OrthographicView};
use airlight_tests::reference::inverse::{Grid, VolumeBox, bent};
use glam::Mat4;

fn bent_form(solved: Solved, basis: Basis, channels: Channels, step: f32) -> ProjectorForm {
    ProjectorForm { refraction: Some(step), ..form(solved, basis, channels, Transpose::Collect) }
}

#[test]
fn bent_rays_are_those_of_the_reference_and_scatter_with_the_same_weights() {
    let mut random_ = Random(17);
    for solved in [Solved::Emission, Solved::Albedo, Solved::Both, Solved::Extinction] {
        for (basis, channels, transpose, step, surfaces) in [
            (Basis::Triangle, Channels::One, Transpose::Collect, 0.11, false),
            (Basis::Triangle, Channels::Rgb, Transpose::FixedPoint, 0.07, true),
            (Basis::Box, Channels::One, Transpose::Swap, 0.09, true),
            (Basis::Box, Channels::Rgb, Transpose::FixedPoint, 0.13, false),
        ] {
            let form = ProjectorForm { transpose, ..bent_form(solved, basis, channels, step) };
            let case = Case { form, slices: 8, surfaces, extinction: 2.5 };
            let mut worst = [0.0_f64; 2];
            for (name, reference, camera) in cameras() {
                let found = errors(&case, &reference, &camera, &mut random_);
                println!(
                    "{solved:?} {basis:?} {channels:?} {transpose:?}, {name}: {:.1e} {:.1e}",
                    found[0], found[1]
                );
                worst = [0, 1].map(|i| worst[i].max(found[i]));
            }
            assert!(worst[0] < 1e-4 && worst[1] < 1e-6, "{solved:?} {basis:?} {channels:?}: {worst:?}");
        }
    }
}

/// Rays of metres along x through the box 0..1 of the world, four rows from y = 0.125 to 0.875.
fn along_x() -> (ReferenceCamera, Camera) {
    let view = OrthographicView {
        eye: Vec3::new(-1.0, 0.5, 0.5),
        target: Vec3::new(0.5, 0.5, 0.5),
        up: Vec3::new(0.0, 1.0, 0.0),
        half_height: 0.5,
        aspect: 1.0,
        depth: 4.0,
        reversed: true,
    };
    let camera = ReferenceCamera::orthographic(&view);
    let host = Camera { projection: 1, ..gpu::host_camera(&camera, [4, 4]) };
    (camera, host)
}

/// Lengths of one pixel's ray by voxel: its back-projection through extinction. `depth`: metres to a surface.
fn lengths(
    index: ([u32; 3], &[f32]),
    step: f32,
    [column, row]: [u32; 2],
    grid: [u32; 3],
    depth: f32,
) -> Vec<f32> {
    let form = bent_form(Solved::Extinction, Basis::Triangle, Channels::One, step);
    let projector = Projector::new(gpu(), shaders(), form).unwrap();
    let view = SliceView::new(&along_x().1, Mat4::IDENTITY, EXTINCTION, 8).unwrap();
    let images = projector.view(gpu(), &view, Some(&[depth; 16])).unwrap();
    let mut values = vec![0.0; 16];
    values[(row * 4 + column) as usize] = 1.0;
    let picture = Texture::storage(gpu(), [4, 4], wgpu::TextureFormat::R32Float);
    picture.write(gpu(), &values).unwrap();
    let nothing = || volume([1; 3], &[0.0], Channels::One);
    let medium =
        Medium { extinction: nothing(), scattered: nothing(), index: Some(index_volume(index.0, index.1)) };
    let sums = Buffer::storage(gpu(), 4 * count(grid) as u64);
    let ones: Vec<u8> = (0..count(grid)).flat_map(|_| 1_f32.to_le_bytes()).collect();
    let wanted = Buffer::with_bytes(gpu(), &ones, wgpu::BufferUsages::STORAGE);
    let part = Collected { grid, wanted: &wanted, sums: &sums };
    let mut encoder = gpu().encoder();
    projector.backproject(gpu(), &mut encoder, &images, &medium, &picture, &[part]).unwrap();
    gpu().submit(encoder).unwrap();
    let mut all = sums.read_floats(gpu()).unwrap();
    all.truncate(count(grid));
    all
}

#[test]
fn an_index_that_rises_evenly_bends_rays_upwards_along_catenaries() {
    let (low, slope) = (1.1_f64, 0.9_f64);
    let index: Vec<f32> = (0..8).map(|i| (low + slope * (f64::from(i) + 0.5) / 8.0) as f32).collect();
    let (columns, rows) = (4_u32, 64_u32);
    let mut worst = Vec::new();
    for step in [0.02_f32, 0.01, 0.005] {
        let found = lengths(([1, 8, 1], &index), step, [1, 2], [columns, rows, 1], 1e9);
        let begin = 0.375;
        let kept = low + slope * begin;
        let height = |x: f64| begin + kept / slope * ((slope * x / kept).cosh() - 1.0);
        // Lengths by triangles about the middles of four columns, and the mean height in each, from the curve in short pieces.
        let mut off = 0.0_f64;
        for column in 0..columns {
            let share = |x: f64| {
                let place = (x * f64::from(columns) - 0.5).clamp(0.0, f64::from(columns - 1));
                (1.0 - (place - f64::from(column)).abs()).max(0.0)
            };
            let (mut length, mut moment) = (0.0, 0.0);
            for piece in 0..20_000 {
                let [a, x, b] = [0.0, 0.5, 1.0].map(|part| (f64::from(piece) + part) / 20_000.0);
                let way = (b - a).hypot(height(b) - height(a));
                length += share(x) * way;
                moment += share(x) * way * height(x);
            }
            let of = |row: u32| f64::from(found[(row * columns + column) as usize]);
            let own: f64 = (0..rows).map(of).sum();
            let middle = |row: u32| (f64::from(row) + 0.5) / f64::from(rows);
            let mean = (0..rows).map(|row| of(row) * middle(row)).sum::<f64>() / own;
            off = off.max((mean - moment / length).abs()).max((own - length).abs());
        }
        println!(
            "steps of {step}: off by {off:.1e}, the last height is {:.3} above the first",
            height(1.0) - begin
        );
        worst.push(off / f64::from(step));
    }
    // Errors of the first order in the step.
    assert!(worst.iter().all(|ratio| *ratio < 0.4), "{worst:?}");
}

#[test]
fn surfaces_end_rays_by_the_metres_along_the_bend() {
    let index: Vec<f32> = (0..8).map(|i| 1.1 + 0.9 * (i as f32 + 0.5) / 8.0).collect();
    for (depth, expected) in [(1.5_f32, 0.5_f32), (1.73, 0.73), (1.0, 0.0), (0.0, 0.0), (-1.0, 0.0)] {
        let sum: f32 = lengths(([1, 8, 1], &index), 0.02, [1, 2], [4, 4, 1], depth).iter().sum();
        assert!((sum - expected).abs() < 1e-5, "{depth}: {sum}");
    }
}

/// Pictures of emission of a medium, by straight rays and by bent ones.
fn pictures(camera: &Camera, step: f32, index: f32, slices: u32) -> [Vec<f32>; 2] {
    let random_ = &mut Random(5);
    let [extinction, emission] = [2.0, 1.0].map(|high| random(random_, count(EXTINCTION), high));
    [None, Some(step)].map(|refraction| {
        let form =
            ProjectorForm { refraction, ..bent_form(Solved::Emission, Basis::Triangle, Channels::One, step) };
        let projector = Projector::new(gpu(), shaders(), form).unwrap();
        let view = SliceView::new(camera, placed(), EXTINCTION, slices).unwrap();
        let images = projector.view(gpu(), &view, None).unwrap();
        let medium = Medium {
            extinction: volume(EXTINCTION, &extinction, Channels::One),
            scattered: volume([1; 3], &[0.0], Channels::One),
            index: refraction.map(|_| index_volume([2, 3, 2], &[index; 12])),
        };
        let unknown = volume(EXTINCTION, &emission, Channels::One);
        let fields = Fields { emission: &unknown, albedo: &unknown, extinction: &unknown };
        let mut encoder = gpu().encoder();
        projector.render(gpu(), &mut encoder, &images, &medium, fields).unwrap();
        gpu().submit(encoder).unwrap();
        images.rendered.read(gpu()).unwrap()
    })
}

#[test]
fn an_even_index_makes_the_pictures_of_straight_rays() {
    // The last camera's outer rays run along slices, of which straight rays have one sample each: no reference for bent ones.
    for (name, _, camera) in cameras().into_iter().filter(|(name, ..)| *name != "within, diagonal") {
        for index in [1.0, 1.7] {
            let off = [0.08, 0.01].map(|step| {
                let [straight, bent] = pictures(&camera, step, index, 1600);
                let most = straight.iter().fold(0.0_f32, |most, value| most.max(*value));
                straight.iter().zip(&bent).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / most
            });
            println!("{name}, index {index}: {:.1e} {:.1e}", off[0], off[1]);
            assert!(off[0] < 0.05 && off[1] < 3e-4, "{name}, {index}: {off:?}");
        }
    }
}

#[test]
fn rays_that_go_round_and_impossible_indices_end() {
    // Around the middle of n = 1 / r rays keep their distance.
    let side = 48_u32;
    let ring: Vec<f32> = (0..side * side)
        .map(|i| {
            let [x, y] = [i % side, i / side].map(|k| (k as f32 + 0.5) / side as f32 - 0.5);
            0.2 / x.hypot(y).max(0.02)
        })
        .collect();
    let most = (4.0 * 3.0_f32.sqrt() / 0.02).ceil() * 0.02;
    for row in 0..4 {
        let found = lengths(([side, side, 1], &ring), 0.02, [1, row], [3, 3, 3], 1e9);
        let sum: f32 = found.iter().sum();
        assert!(found.iter().all(|v| v.is_finite()) && sum > 0.5 && sum < most * 1.0001, "{row}: {sum}");
    }
    // Indices that there are not.
    for value in [0.0, -3.0, f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX, 1e-30] {
        // The same everywhere it bends nothing, whatever it is.
        let straight: f32 = lengths(([2, 2, 2], &[value; 8]), 0.05, [2, 1], [3, 3, 3], 1e9).iter().sum();
        assert!((straight - 1.0).abs() < 1e-5, "{value}: {straight}");
        let index = [1.0, value, 1.3, value, value, 2.0, 1.0, value];
        for row in 0..4 {
            let found = lengths(([2, 2, 2], &index), 0.05, [2, row], [3, 3, 3], 1e9);
            let sum: f32 = found.iter().sum();
            assert!(found.iter().all(|v| v.is_finite() && *v >= 0.0), "{value} {row}: {found:?}");
            assert!(sum > 0.0 && sum < 4.0 * 3.0_f32.sqrt() + 0.06, "{value} {row}: {sum}");
        }
    }
}

#[test]
fn a_ray_that_goes_round_has_the_steps_of_the_reference() {
    // A ring that catches: the index falls off to all sides of a circle about the middle.
    let side = 24_u32;
    let values: Vec<f32> = (0..side * side)
        .map(|i| {
            let [x, y] = [i % side, i / side].map(|k| (k as f32 + 0.5) / side as f32 - 0.5);
            1.0 + 2.0 * (-((x.hypot(y) - 0.25) / 0.1).powi(2)).exp()
        })
        .collect();
    let volume_box = VolumeBox::new(gpu::matrix(Mat4::IDENTITY)).unwrap();
    let slow = Grid {
        size: [side as usize, side as usize, 1],
        values: values.iter().map(|v| f64::from(*v)).collect(),
    };
    let view = airlight_tests::reference::inverse::View::new(&along_x().0, [4, 4]);
    for row in 0..4 {
        let expected: f64 = bent(&volume_box, &slow, 0.01, &view.ray(1, row)).iter().map(|s| s.length).sum();
        let found: f32 =
            lengths(([side, side, 1], &values), 0.01, [1, row as u32], [2, 2, 2], 1e9).iter().sum();
        assert!((f64::from(found) - expected).abs() < 2e-3 * expected, "{row}: {found} {expected}");
    }
}

#[test]
fn impossible_bends_are_refused() {
    let of = |step| {
        Projector::new(gpu(), shaders(), bent_form(Solved::Emission, Basis::Triangle, Channels::One, step))
    };
    for step in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(of(step), Err(InverseError::Setting(_))), "{step}");
    }
    let (_, _, camera) = cameras().remove(0);
    let view = SliceView::new(&camera, placed(), EXTINCTION, 8).unwrap();
    for step in [1e-4, 1e-30] {
        assert!(
            matches!(of(step).unwrap().view(gpu(), &view, None), Err(InverseError::Setting(_))),
            "{step}"
        );
    }
    let projector = of(0.1).unwrap();
    let images = projector.view(gpu(), &view, None).unwrap();
    let nothing = || volume([1; 3], &[0.0], Channels::One);
    let medium = Medium { extinction: nothing(), scattered: nothing(), index: None };
    let field = nothing();
    let fields = Fields { emission: &field, albedo: &field, extinction: &field };
    let mut encoder = gpu().encoder();
    let refused = projector.render(gpu(), &mut encoder, &images, &medium, fields);
    assert!(matches!(refused, Err(InverseError::Index)));
    let buffer = Buffer::storage(gpu(), 16);
    let part = Collected { grid: [1; 3], wanted: &buffer, sums: &buffer };
    let picture = Texture::storage(gpu(), SIZE, wgpu::TextureFormat::R32Float);
    let refused = projector.backproject(gpu(), &mut encoder, &images, &medium, &picture, &[part]);
    assert!(matches!(refused, Err(InverseError::Index)));
}
