// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which voxels of emission and albedo matter: those whose basis function is not 0 where there is extinction.

use super::{Basis, InverseError};

/// Whether each voxel of a volume of `size`, x fastest, meets extinction in the same box. `dense`: whether there is extinction in each
/// voxel of `dense_size`, between whose middles it goes straight.
///
/// # Errors
/// [`InverseError::Count`] where `dense` has another number of voxels than its size.
pub fn touched(
    size: [u32; 3],
    basis: Basis,
    dense_size: [u32; 3],
    dense: &[bool],
) -> Result<Vec<bool>, InverseError> {
    let needed: usize = dense_size.iter().map(|side| *side as usize).product();
    if dense.len() != needed {
        return Err(InverseError::Count { name: "voxels of extinction", needed, given: dense.len() });
    }
    // Supports are boxes, so that axes can be widened one after another.
    let (mut flags, mut now) = (dense.to_vec(), dense_size.map(|side| side as usize));
    for axis in 0..3 {
        let met = met(basis, size[axis], dense_size[axis]);
        flags = widened(&flags, now, axis, &met);
        now[axis] = size[axis] as usize;
    }
    Ok(flags)
}

/// Of each of `count` basis functions along an axis the first and the one past the last of `others` triangles that it meets.
fn met(basis: Basis, count: u32, others: u32) -> Vec<[usize; 2]> {
    let reach = match basis {
        Basis::Triangle => 2,
        Basis::Box => 1,
    };
    // In halves of a voxel; the outermost go on to the faces.
    let support = |index: u64, reach: u64, count: u64| {
        [(2 * index + 1).saturating_sub(reach), (2 * index + 1 + reach).min(2 * count)]
    };
    let [count, others] = [count, others].map(u64::from);
    let range = |index: u64| {
        let [low, high] = support(index, reach, count);
        let meets = |other: u64| {
            let [least, most] = support(other, 2, others);
            low * others < most * count && least * count < high * others
        };
        let near = (index * others / count).min(others - 1);
        let first = (0..=near).rev().take_while(|other| meets(*other)).last().unwrap_or(near);
        let last = (near..others).take_while(|other| meets(*other)).last().unwrap_or(near);
        [first as usize, last as usize + 1]
    };
    (0..count).map(range).collect()
}

/// Whether any flag along an axis is set in the range of each new place.
fn widened(flags: &[bool], size: [usize; 3], axis: usize, ranges: &[[usize; 2]]) -> Vec<bool> {
    let inner: usize = size[..axis].iter().product();
    let outer: usize = size[axis + 1..].iter().product();
    let mut found = Vec::with_capacity(inner * ranges.len() * outer);
    for block in 0..outer {
        for [first, past] in ranges {
            let any =
                |place: usize| (*first..*past).any(|at| flags[(block * size[axis] + at) * inner + place]);
            found.extend((0..inner).map(any));
        }
    }
    found
}
