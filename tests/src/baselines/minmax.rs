// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sizes of the textures of min-max mipmaps along rows (Chen, Baran, Durand and Jarosz 2011).

/// Columns of a group, the coarsest node of the form with eight children a node.
pub const GROUP_COLUMNS: u32 = 512;

/// Columns of the coarsest node of the form with two children a node.
pub const BINARY_COLUMNS: u32 = 128;

/// Texels of the form with eight children a node, for a map of so many columns and rows: groups of 512
/// columns, blocks of 64 and leaves of 8 side by side.
#[must_use]
pub fn size([columns, rows]: [u32; 2]) -> [u32; 2] {
    [columns.div_ceil(GROUP_COLUMNS) + columns.div_ceil(64) + columns.div_ceil(8), rows]
}

/// Texels of the form with two children a node: the depths above, all coarser levels below.
#[must_use]
pub fn binary_size([columns, rows]: [u32; 2]) -> [u32; 2] {
    [columns.next_power_of_two(), 2 * rows]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_hold_every_node() {
        assert_eq!(size([1024, 7]), [2 + 16 + 128, 7]);
        assert_eq!(size([1, 1]), [3, 1]);
        assert_eq!(size([513, 1]), [2 + 9 + 65, 1]);
        // The levels above level 0 take all but one of its columns, padded.
        for columns in 1..300_u32 {
            let coarser: u32 = (1..=7).map(|level| columns.next_power_of_two() >> level).sum();
            assert!(coarser <= binary_size([columns, 1])[0]);
        }
    }
}
