// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--downsample`: fewer voxels in the same box.

use crate::data::Volume;

/// The mean over `factor` voxels along each axis. Where a side is no multiple of it, voxels are wider by a little less, so that the
/// box stays as it is; a side of fewer voxels becomes one.
pub fn shrunk(volume: Volume, factor: u32) -> Volume {
    let Volume { mut size, mut values, world_from_unit } = volume;
    for axis in 0..3 {
        let count = size[axis].div_ceil(factor.max(1));
        if count != size[axis] {
            values = along(&values, size, axis, count as usize);
            size[axis] = count;
        }
    }
    Volume { size, values, world_from_unit }
}

/// Means along an axis, of `count` stretches of one length.
fn along(values: &[f32], size: [u32; 3], axis: usize, count: usize) -> Vec<f32> {
    let size = size.map(|side| side as usize);
    let (stride, side): (usize, usize) = (size[..axis].iter().product(), size[axis]);
    let mut result = Vec::with_capacity(values.len() / side * count);
    for slab in values.chunks_exact(stride * side) {
        for index in 0..count {
            let weights = weights(index, count, side);
            for lane in 0..stride {
                let sum: f64 =
                    weights.iter().map(|(at, weight)| weight * f64::from(slab[at * stride + lane])).sum();
                result.push(sum as f32);
            }
        }
    }
    result
}

/// Which of `side` voxels lie in stretch `index` of `count`, with their shares of it.
fn weights(index: usize, count: usize, side: usize) -> Vec<(usize, f64)> {
    let length = side as f64 / count as f64;
    let (begin, end) = (index as f64 * length, (index + 1) as f64 * length);
    (begin as usize..(end.ceil() as usize).min(side))
        .map(|at| (at, ((at as f64 + 1.0).min(end) - (at as f64).max(begin)) / length))
        .filter(|(_, weight)| *weight > 1e-9)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat4;

    fn volume(size: [u32; 3]) -> Volume {
        let values = (0..size.iter().product::<u32>()).map(|i| i as f32).collect();
        Volume { size, values, world_from_unit: Mat4::from_rotation_y(1.0) }
    }

    #[test]
    fn blocks_become_their_means() {
        let small = shrunk(volume([4, 2, 2]), 2);
        // Of x 0 and 1: (0 + 1 + 4 + 5 + 8 + 9 + 12 + 13) / 8.
        assert_eq!((small.size, small.values), ([2, 1, 1], vec![6.5, 8.5]));
        assert_eq!(small.world_from_unit, Mat4::from_rotation_y(1.0));
        assert_eq!(shrunk(volume([3, 4, 5]), 1), volume([3, 4, 5]));
        assert_eq!(shrunk(volume([1, 1, 3]), 8).values, [1.0]);
    }

    #[test]
    fn what_is_no_multiple_keeps_its_box_and_its_mean() {
        let wide = shrunk(volume([5, 1, 1]), 2);
        // Three stretches of five thirds.
        let expected = [0.4, 2.0, 3.6];
        assert_eq!(wide.size, [3, 1, 1]);
        assert!(wide.values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{:?}", wide.values);
        for factor in 2..9 {
            let small = shrunk(volume([7, 5, 11]), factor);
            let mean = small.values.iter().sum::<f32>() / small.values.len() as f32;
            assert!((mean - 192.0).abs() < 1e-3, "{factor}: {mean}");
            assert_eq!(small.size, [7, 5, 11].map(|side: u32| side.div_ceil(factor)));
        }
    }
}
