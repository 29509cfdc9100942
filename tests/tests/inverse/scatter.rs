// SPDX-License-Identifier: MIT OR Apache-2.0
//! Back-projections in which rays scatter: products with the transpose, sums that never overflow, the same bits in every run.

use crate::gpu::{Random, gpu, shaders};
use crate::projectors::{
    Case, EXTINCTION, GRIDS, SIZE, cameras, count, errors, form, placed, random, spread, volume,
};
use airlight::inverse::{
    Basis, Channels, Collected, InverseError, Medium, Projector, SliceView, Solved, Transpose,
};
use airlight::{Buffer, Texture};

#[test]
fn rays_scatter_with_the_weights_of_pictures() {
    let mut random_ = Random(11);
    for transpose in [Transpose::FixedPoint, Transpose::Swap] {
        for solved in [Solved::Emission, Solved::Albedo, Solved::Both, Solved::Extinction] {
            for (basis, channels, slices, surfaces) in [
                (Basis::Triangle, Channels::One, 10, true),
                (Basis::Triangle, Channels::Rgb, 17, false),
                (Basis::Box, Channels::One, 16, false),
                (Basis::Box, Channels::Rgb, 8, true),
            ] {
                let case = Case {
                    form: form(solved, basis, channels, transpose),
                    slices,
                    surfaces,
                    extinction: 2.5,
                };
                let mut worst = 0.0_f64;
                for (_, reference, camera) in cameras() {
                    worst = worst.max(errors(&case, &reference, &camera, &mut random_)[1]);
                }
                println!("{transpose:?} {solved:?} {basis:?} {channels:?}: {worst:.1e}");
                assert!(worst < 1e-5, "{transpose:?} {solved:?} {basis:?} {channels:?}: {worst:.1e}");
            }
        }
    }
}

/// What was there before.
const BEFORE: f32 = 0.25;

/// A volume of one value and a picture of signed ones, sent back several times over.
struct Scene {
    solved: Solved,
    channels: Channels,
    grid: [u32; 3],
    extinction: f32,
    /// Bound of what scatters, and of the picture.
    scales: [f32; 2],
}

impl Scene {
    /// Sums after a picture was sent back from all cameras, from `BEFORE` times the scale on. Every third voxel is not solved for.
    fn sums(&self, transpose: Transpose, values: &[f32]) -> Vec<f32> {
        let form = form(self.solved, Basis::Triangle, self.channels, transpose);
        let projector = Projector::new(gpu(), shaders(), form).unwrap();
        let of = |high: f32, size: [u32; 3]| -> Vec<f32> {
            random(&mut Random(3), count(size), 1.0).into_iter().map(|v| high * (0.5 + 0.5 * v)).collect()
        };
        let medium = Medium {
            extinction: volume(EXTINCTION, &of(self.extinction, EXTINCTION), self.channels),
            scattered: volume([3, 4, 2], &of(self.scales[0], [3, 4, 2]), self.channels),
            index: None,
        };
        let bytes = |values: Vec<f32>| -> Vec<u8> { values.into_iter().flat_map(f32::to_le_bytes).collect() };
        let voxels = count(self.grid);
        let before = BEFORE * self.scales[1];
        let sums = Buffer::with_bytes(
            gpu(),
            &bytes(vec![before; voxels * self.channels.numbers()]),
            wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        );
        let solved = (0..voxels).map(|voxel| f32::from(u8::from(voxel % 3 != 1))).collect();
        let wanted = Buffer::with_bytes(gpu(), &bytes(solved), wgpu::BufferUsages::STORAGE);
        for (_, _, camera) in cameras() {
            let view = SliceView::new(&camera, placed(), EXTINCTION, 13).unwrap();
            let images = projector.view(gpu(), &view, None).unwrap();
            let picture = Texture::storage(gpu(), SIZE, images.rendered.raw.format());
            picture.write(gpu(), &spread(values, self.channels)).unwrap();
            let part = Collected { grid: self.grid, wanted: &wanted, sums: &sums };
            let mut encoder = gpu().encoder();
            projector.backproject(gpu(), &mut encoder, &images, &medium, &picture, &[part]).unwrap();
            gpu().submit(encoder).unwrap();
        }
        let mut all = sums.read_floats(gpu()).unwrap();
        all.truncate(voxels * self.channels.numbers());
        all
    }
}

fn signed(scale: f32) -> Vec<f32> {
    let mut random_ = Random(29);
    (0..SIZE[0] * SIZE[1]).map(|_| scale * random_.between(-1.0, 1.0) as f32).collect()
}

/// Greatest difference of the greatest of other sums.
fn difference(found: &[f32], expected: &[f32], sizes: &[f32]) -> f32 {
    let most = sizes.iter().fold(0.0_f32, |most, value| most.max(value.abs()));
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0_f32, f32::max);
    off / most
}

#[test]
fn fixed_point_is_what_voxels_collect_and_the_same_bits_in_every_run() {
    for (solved, channels) in [
        (Solved::Emission, Channels::One),
        (Solved::Albedo, Channels::Rgb),
        (Solved::Extinction, Channels::One),
        (Solved::Emission, Channels::Rgb),
    ] {
        for scale in [1.0, 1e-6, 1e6] {
            for light in [1.0, 3e-5, 4e4] {
                let scene = Scene {
                    solved,
                    channels,
                    grid: GRIDS[1],
                    extinction: 2.0,
                    scales: [light, if solved == Solved::Albedo { scale * light } else { scale }],
                };
                let values = signed(scale);
                let collected = scene.sums(Transpose::Collect, &values);
                let fixed = scene.sums(Transpose::FixedPoint, &values);
                let swapped = scene.sums(Transpose::Swap, &values);
                // Signs let sums be much smaller than what is added up.
                let sizes: Vec<f32> = values.iter().map(|value| value.abs()).collect();
                let sizes = scene.sums(Transpose::Collect, &sizes);
                let off = [&fixed, &swapped].map(|sums| difference(sums, &collected, &sizes));
                println!(
                    "{solved:?} {channels:?} picture {scale:e} light {light:e}: {:.1e} {:.1e}",
                    off[0], off[1]
                );
                assert!(off[0] < 1e-6 && off[1] < 1e-6, "{solved:?} {channels:?} {scale} {light}: {off:?}");
                let bits = |sums: &[f32]| sums.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                let again = scene.sums(Transpose::FixedPoint, &values);
                assert_eq!(bits(&fixed), bits(&again), "{solved:?} {channels:?} {scale}");
                // What is not solved for stays, and so does the fourth channel.
                let numbers = channels.numbers();
                for (place, sum) in fixed.iter().enumerate() {
                    let stays = place / numbers % 3 == 1 || place % numbers == 3;
                    assert!(!stays || *sum == BEFORE * scene.scales[1]);
                }
                if solved != Solved::Albedo {
                    // Light does not matter.
                    break;
                }
            }
        }
    }
}

#[test]
fn sums_do_not_overflow_where_all_rays_meet_one_voxel() {
    for (solved, extinction, value) in [
        (Solved::Emission, 300.0, -1.999_999_f32),
        (Solved::Emission, 300.0, 1.999_999),
        (Solved::Albedo, 300.0, -1.999_999),
        (Solved::Extinction, 1.0, -1.999_999),
        (Solved::Extinction, 1.0, -1e30),
    ] {
        let light = 1.999_999;
        let scene =
            Scene { solved, channels: Channels::One, grid: [1, 1, 1], extinction, scales: [light, value] };
        let values = vec![value; (SIZE[0] * SIZE[1]) as usize];
        let [collected, fixed] =
            [Transpose::Collect, Transpose::FixedPoint].map(|transpose| scene.sums(transpose, &values)[0]);
        println!("{solved:?} {value}: {collected} {fixed}");
        assert!((fixed / collected - 1.0).abs() < 1e-5 && (fixed / value) > 1500.0, "{solved:?}: {fixed}");
    }
}

#[test]
fn black_and_broken_pictures_send_back_nothing() {
    for solved in [Solved::Emission, Solved::Albedo, Solved::Extinction] {
        let scene =
            Scene { solved, channels: Channels::One, grid: GRIDS[0], extinction: 2.0, scales: [1.0, 1.0] };
        for value in [0.0, -0.0, f32::NAN, f32::INFINITY] {
            let sums = scene.sums(Transpose::FixedPoint, &vec![value; (SIZE[0] * SIZE[1]) as usize]);
            assert!(sums.iter().all(|sum| *sum == BEFORE), "{solved:?} {value}");
        }
        // No light at all.
        let dark = Scene { scales: [0.0, 1.0], ..scene };
        let sums = dark.sums(Transpose::FixedPoint, &signed(1.0));
        assert_eq!(sums.iter().all(|sum| *sum == BEFORE), solved == Solved::Albedo);
        assert!(sums.iter().all(|sum| sum.is_finite()));
    }
}

#[test]
fn sums_that_need_too_much_are_refused() {
    let (_, _, camera) = cameras().remove(0);
    let little = Buffer::storage(gpu(), 16);
    for (channels, transpose, grid, bytes) in [
        (Channels::Rgb, Transpose::FixedPoint, [256, 256, 256], 1 << 24_u64),
        (Channels::One, Transpose::Swap, [512, 512, 256], 1 << 26_u64),
    ] {
        let form = form(Solved::Extinction, Basis::Triangle, channels, transpose);
        let projector = Projector::new(gpu(), shaders(), form).unwrap();
        let view = SliceView::new(&camera, placed(), EXTINCTION, 13).unwrap();
        let images = projector.view(gpu(), &view, None).unwrap();
        let medium = Medium {
            extinction: volume([1; 3], &[1.0], channels),
            scattered: volume([1; 3], &[1.0], channels),
            index: None,
        };
        let picture = Texture::storage(gpu(), SIZE, images.rendered.raw.format());
        let part = Collected { grid, wanted: &little, sums: &little };
        let mut encoder = gpu().encoder();
        let refused = projector.backproject(gpu(), &mut encoder, &images, &medium, &picture, &[part]);
        let factor = if transpose == Transpose::Swap { 4 } else { 24 };
        assert!(
            matches!(&refused, Err(InverseError::Memory { bytes: needed, .. }) if *needed == bytes * factor),
            "{refused:?}"
        );
    }
}
