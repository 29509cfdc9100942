// SPDX-License-Identifier: MIT OR Apache-2.0
//! Values where nothing is known, from those nearby (thesis 7.5.1).

use crate::command::inverse::field::Field;
use glam::Vec3;

/// The same field, whose voxels that are not `known` have what the nearest known ones have: means over cells that double in size until
/// one holds something known, straight in between. It is smooth, and so what a solver with a Laplacian may well begin with.
pub fn extended(field: &Field, known: &[bool]) -> Field {
    if field.size == [1; 3] || known.iter().all(|known| *known) || known.iter().all(|known| !*known) {
        return field.clone();
    }
    let size = field.size.map(|side| side.div_ceil(2));
    let cells = size.map(|side| side as usize);
    let mut sums = vec![(Vec3::ZERO, 0.0_f32); cells.iter().product()];
    let [width, height, _] = field.size.map(|side| side as usize);
    for (i, (value, known)) in field.values.iter().zip(known).enumerate() {
        let [x, y, z] = [i % width, i / width % height, i / (width * height)].map(|place| place / 2);
        if *known {
            let (sum, count) = &mut sums[(z * cells[1] + y) * cells[0] + x];
            (*sum, *count) = (*sum + *value, *count + 1.0);
        }
    }
    let coarse = Field { size, values: sums.iter().map(|(sum, count)| *sum / count.max(1.0)).collect() };
    let found: Vec<bool> = sums.iter().map(|(_, count)| *count > 0.0).collect();
    let filled = extended(&coarse, &found).resized(field.size);
    let values = field.values.iter().zip(known).zip(filled.values);
    let values = values.map(|((own, known), filled)| if *known { *own } else { filled }).collect();
    Field { size: field.size, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_stays_and_the_rest_is_between() {
        let size = [9, 6, 5];
        let at = |i: usize| Vec3::new((i % 9) as f32, (i / 9 % 6) as f32, (i / 54) as f32);
        let known: Vec<bool> = (0..270).map(|i| at(i).x < 2.0 || at(i).x > 6.0).collect();
        let value = |i: usize| if at(i).x < 4.0 { Vec3::X } else { Vec3::Y };
        let values = (0..270).map(|i| if known[i] { value(i) } else { Vec3::splat(100.0) }).collect();
        let found = extended(&Field { size, values }, &known);
        for (i, found) in found.values.iter().enumerate() {
            if known[i] {
                assert_eq!(*found, value(i));
            } else {
                assert!((found.x + found.y - 1.0).abs() < 1e-5 && found.min_element() >= 0.0, "{found}");
            }
        }
        // Nearer to one side, more of it.
        assert!(found.values[2].x > 0.6 && found.values[6].y > 0.6, "{:?}", &found.values[..9]);
        let nothing = Field { size: [2, 1, 1], values: vec![Vec3::X; 2] };
        assert_eq!(extended(&nothing, &[false; 2]), nothing);
    }
}
