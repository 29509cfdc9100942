// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bricks of a volume against brute force, and what their functions and those of volumes do, in closed form.

use crate::gpu::{Probe, Random, gpu, shaders};
use airlight::Texture;
use airlight::core::{Bricks, brick_count};

/// Voxels along a brick.
const BRICK: usize = 8;

/// A 3D texture of floats.
fn volume(size: [u32; 3], values: &[f32]) -> Texture {
    let texture = Texture::volume(gpu(), size, wgpu::TextureFormat::R32Float);
    texture.write(gpu(), values).unwrap();
    texture
}

/// Every place of a grid, x fastest.
fn places(size: [usize; 3]) -> Vec<[usize; 3]> {
    let rows = (0..size[2]).flat_map(|z| (0..size[1]).map(move |y| (y, z)));
    rows.flat_map(|(y, z)| (0..size[0]).map(move |x| [x, y, z])).collect()
}

fn wide(size: [u32; 3]) -> [usize; 3] {
    size.map(|side| side as usize)
}

/// Values few of which are above 0, some of them not finite.
fn sparse(random: &mut Random, size: [u32; 3], share: f64) -> Vec<f32> {
    places(wide(size))
        .iter()
        .map(|_| {
            let value = if random.unit() < share { random.between(0.1, 5.0) } else { -random.unit() };
            if random.unit() < 0.01 { [f32::NAN, f32::INFINITY][random.below(2)] } else { value as f32 }
        })
        .collect()
}

const SIZES: [[u32; 3]; 5] = [[1, 1, 1], [8, 9, 17], [20, 7, 33], [64, 40, 24], [3, 100, 1]];

#[test]
fn ranges_hold_all_that_a_trilinear_read_in_a_brick_touches() {
    let bricks = Bricks::new(gpu(), shaders()).unwrap();
    let mut random = Random(3);
    for size in SIZES {
        let values = sparse(&mut random, size, 0.5);
        let mut encoder = gpu().encoder();
        let ranges = bricks.record_ranges(gpu(), &mut encoder, &volume(size, &values)).unwrap();
        gpu().submit(encoder).unwrap();
        assert_eq!(ranges.size(), brick_count(size));
        let found = ranges.read(gpu()).unwrap();
        let voxels = places(wide(size));
        for (brick, found) in places(wide(ranges.size())).iter().zip(found.chunks_exact(2)) {
            let (mut least, mut greatest) = (f32::INFINITY, f32::NEG_INFINITY);
            for (voxel, value) in voxels.iter().zip(&values) {
                // One voxel before the brick to one behind it.
                let near = |axis: usize| {
                    (brick[axis] * BRICK..=(brick[axis] + 1) * BRICK + 1).contains(&(voxel[axis] + 1))
                };
                if near(0) && near(1) && near(2) {
                    let value = if value.is_finite() { *value } else { 0.0 };
                    (least, greatest) = (least.min(value), greatest.max(value));
                }
            }
            assert_eq!(found, [least, greatest], "{brick:?} of {size:?}");
        }
    }
}

#[test]
fn distances_are_chebyshevs() {
    let bricks = Bricks::new(gpu(), shaders()).unwrap();
    let mut random = Random(5);
    for (size, share) in
        [([1, 1, 1], 1.0), ([9, 4, 13], 0.01), ([12, 20, 6], 0.003), ([17, 5, 5], 0.2), ([7, 7, 7], 0.0)]
    {
        let cells = places(wide(size));
        let ranges = Texture::volume(gpu(), size, wgpu::TextureFormat::Rg32Float);
        let occupied: Vec<bool> = cells.iter().map(|_| random.unit() < share).collect();
        // A threshold of 2, met exactly by the empty ones.
        let values: Vec<f32> =
            occupied.iter().flat_map(|on| [-1.0, if *on { 2.000_1 } else { 2.0 }]).collect();
        ranges.write(gpu(), &values).unwrap();
        let mut encoder = gpu().encoder();
        let distances = bricks.record_above(gpu(), &mut encoder, &ranges, 2.0).unwrap();
        gpu().submit(encoder).unwrap();
        let found = distances.read_words(gpu()).unwrap();
        let marked: Vec<_> =
            cells.iter().zip(&occupied).filter(|(_, on)| **on).map(|(cell, _)| *cell).collect();
        for (cell, found) in cells.iter().zip(found) {
            let away =
                |other: &[usize; 3]| (0..3).map(|axis| cell[axis].abs_diff(other[axis])).max().unwrap();
            let expected = marked.iter().map(away).min().unwrap_or(4096);
            assert_eq!(found as usize, expected, "{cell:?} of {size:?}");
        }
    }
}

#[test]
fn runs_of_samples_stay_among_bricks_that_are_alike_and_end_no_sooner_than_they_must() {
    let probe = Probe {
        head: "#import airlight::core::bricks::{brick_at, brick_count, samples_alike}",
        body: "let size = vec3<u32>(u32(input(0u)), u32(input(1u)), u32(input(2u)));
               let unit = vec3<f32>(input(3u), input(4u), input(5u));
               let step = vec3<f32>(input(6u), input(7u), input(8u));
               output(0u, f32(samples_alike(unit, step, size, u32(input(9u)))));
               let brick = brick_at(unit, size); let count = brick_count(size);
               output(1u, f32(brick.x)); output(2u, f32(brick.y)); output(3u, f32(brick.z));
               output(4u, f32(count.x)); output(5u, f32(count.y)); output(6u, f32(count.z));",
        inputs: 10,
        outputs: 7,
    };
    let mut random = Random(7);
    let mut inputs = Vec::new();
    for i in 0..4000 {
        let size = [0; 3].map(|_| 1 + random.below(200) as u32);
        let mut direction = random.direction().to_array();
        if i % 5 == 0 {
            direction[i / 5 % 3] = 0.0;
        }
        inputs.extend(size.map(|side| side as f32));
        inputs.extend([0; 3].map(|_| random.unit() as f32));
        // About a voxel a step.
        let length = random.between(0.3, 1.5);
        inputs.extend((0..3).map(|axis| (length * direction[axis] / f64::from(size[axis])) as f32));
        inputs.push([0.0, 1.0, 2.0, 5.0][random.below(4)]);
    }
    let found = probe.run(&inputs);
    for (record, found) in inputs.chunks_exact(10).zip(found.chunks_exact(7)) {
        let side = |axis: usize| f64::from(record[axis]);
        let brick = |axis: usize| (f64::from(record[3 + axis]) * side(axis) / BRICK as f64).floor();
        let reach = f64::from(record[9]).max(1.0);
        let mut exact = f64::INFINITY;
        for axis in 0..3 {
            // A place within rounding of a wall may count to either side.
            let at = f64::from(record[3 + axis]) * side(axis) / BRICK as f64;
            if (at - at.round()).abs() > 1e-5 {
                assert_eq!(f64::from(found[1 + axis]), brick(axis), "{record:?}");
            }
            assert_eq!(f64::from(found[4 + axis]), (side(axis) / BRICK as f64).ceil());
            let step = f64::from(record[6 + axis]);
            let low = (f64::from(found[1 + axis]) - reach + 1.0) * BRICK as f64 / side(axis);
            let high = (f64::from(found[1 + axis]) + reach) * BRICK as f64 / side(axis);
            if step != 0.0 {
                let wall = if step > 0.0 { high } else { low };
                exact = exact.min((wall - f64::from(record[3 + axis])) / step);
            }
        }
        // Samples 0 .. n - 1 lie before the wall: n - 1 < exact.
        let samples = f64::from(found[0]);
        assert!(samples == 1.0 || samples - 1.0 < exact - 1e-3, "{record:?}: {samples} of {exact}");
        assert!(samples >= (exact - 0.02).floor().min(8192.0), "{record:?}: {samples} of {exact}");
    }
}

#[test]
fn segments_enter_and_leave_the_box_where_they_do_in_f64() {
    let probe = Probe {
        head: "#import airlight::core::volume::segment_in_box",
        body: "let part = segment_in_box(vec3<f32>(input(0u), input(1u), input(2u)), vec3<f32>(input(3u), input(4u), input(5u)));
               output(0u, part.x); output(1u, part.y);",
        inputs: 6,
        outputs: 2,
    };
    let mut random = Random(11);
    let mut inputs = Vec::new();
    for i in 0..3000 {
        let mut along = [0; 3].map(|_| random.between(-3.0, 3.0) as f32);
        if i % 4 == 0 {
            along[i / 4 % 3] = 0.0;
        }
        inputs.extend([0; 3].map(|_| random.between(-1.0, 2.0) as f32));
        inputs.extend(along);
    }
    let found = probe.run(&inputs);
    let mut met = 0;
    for (record, found) in inputs.chunks_exact(6).zip(found.chunks_exact(2)) {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let (origin, along) = (f64::from(record[axis]), f64::from(record[3 + axis]));
            let walls = [-origin / along, (1.0 - origin) / along];
            if along != 0.0 {
                from = from.max(walls[0].min(walls[1]));
                to = to.min(walls[0].max(walls[1]));
            } else if !(0.0..=1.0).contains(&origin) {
                to = -1.0;
            }
        }
        let part = found.iter().map(|value| f64::from(*value)).collect::<Vec<_>>();
        if from < to {
            met += 1;
            assert!((part[0] - from).abs() < 1e-5 && (part[1] - to).abs() < 1e-5, "{record:?}: {part:?}");
        } else {
            assert!(part[1] - part[0] < 1e-5, "{record:?}: {part:?}");
        }
    }
    assert!(met > 300, "{met}");
}

#[test]
fn steps_and_voxels_are_counted() {
    let probe = Probe {
        head: "#import airlight::core::volume::{VolumeSpace, march_steps, voxel_at, metres_across}",
        body: "var space: VolumeSpace;
               space.world_from_unit = mat4x4<f32>(vec4<f32>(0.0, 3.0, 4.0, 0.0), vec4<f32>(2.0, 0.0, 0.0, 0.0),
                   vec4<f32>(0.0, 0.0, 1.0, 0.0), vec4<f32>(9.0, 9.0, 9.0, 1.0));
               space.step_length = input(1u);
               output(0u, f32(march_steps(input(0u), space)));
               output(1u, metres_across(space));
               let voxel = voxel_at(vec3<f32>(input(2u), 0.5, -input(2u)), vec3<u32>(10u, 7u, 4u));
               output(2u, f32(voxel.x)); output(3u, f32(voxel.y)); output(4u, f32(voxel.z));",
        inputs: 3,
        outputs: 5,
    };
    // Metres, metres a step, place; steps, voxels. The box is crossed in at most 5 + 2 + 1 m.
    let cases = [
        ([1.0, 0.25, 0.999], [4.0, 9.0, 3.0, 0.0]),
        ([1.01, 0.25, 0.1], [5.0, 1.0, 3.0, 0.0]),
        ([0.0, 0.25, 0.099], [1.0, 0.0, 3.0, 0.0]),
        ([1e9, 0.25, 1.0], [8192.0, 9.0, 3.0, 0.0]),
        ([1.0, 0.0, 7.0], [8192.0, 9.0, 3.0, 0.0]),
        ([1.0, 0.5, -0.5], [2.0, 0.0, 3.0, 2.0]),
        ([1.0, 0.5, -1.5], [2.0, 0.0, 3.0, 3.0]),
    ];
    let inputs: Vec<f32> = cases.iter().flat_map(|(given, _)| *given).collect();
    for ((given, expected), found) in cases.iter().zip(probe.run(&inputs).chunks_exact(5)) {
        assert_eq!([found[0], found[2], found[3], found[4]], *expected, "{given:?}");
        assert_eq!(found[1], 8.0);
    }
}
