// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// The competitor: min-max mipmaps along rows, traversed to the columns that neither side of a bound decides.
// binding rectified: the rectified map.
// binding nodes: its min-max mipmaps.

@group(#{GROUP}) @binding(6) var rectified: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var nodes: texture_2d<u32>;

fn row_columns() -> u32 {
    return textureDimensions(rectified).x;
}

/// The high bits of four bytes, of two halves.
const BYTES: u32 = 0x80808080u;
const HALVES: u32 = 0x80008000u;
/// Places of eight children in a mask: child c at bit 8 (c >> 1) + (c & 1).
const CHILDREN: u32 = 0x03030303u;

/// Lit columns among the first `columns` of a row for a ray of depth `ray`.
fn lit_columns(row: u32, ray: f32, columns: u32) -> u32 {
    let width = row_columns();
    let first_block = (width + 511u) / 512u;
    let first_leaf = first_block + (width + 63u) / 64u;
    let groups = (columns + 511u) / 512u;
    let byte_code = min(u32(ray * 128.0), 127u) * 0x01010101u;
    let half_code = min(u32(ray * 32768.0), 32767u) * 0x00010001u;
    var count = 0u;
    var next_group = 0u;
    var block = 0u;
    // Blocks of the last group, and leaves of `block`, that are still to be visited.
    var open_blocks = 0u;
    var open_leaves = 0u;
    // One node an iteration, whichever level it is of: lanes at different levels keep each other busy.
    while (next_group < groups) || ((open_blocks | open_leaves) != 0u) {
        let is_leaf = open_leaves != 0u;
        let is_block = (open_blocks != 0u) && !is_leaf;
        let open = select(open_blocks, open_leaves, is_leaf);
        let bit = firstTrailingBit(open);
        let child = (bit >> 2u) + (bit & 1u);
        let rest_open = open & (open - 1u);
        let parent = select(next_group - 1u, block, is_leaf);
        let node = select(next_group, 8u * parent + child, is_leaf || is_block);
        block = select(block, node, is_block);
        let level_start = select(select(0u, first_block, is_block), first_leaf, is_leaf);
        // Logarithm of the columns of a child.
        let shift = select(select(6u, 3u, is_block), 0u, is_leaf);
        let left = columns - (node << (shift + 3u));
        let texel = textureLoad(nodes, vec2<u32>(level_start + node, row), 0);

        // Eight comparisons at once: with the high bit of each code set, no difference borrows from the next,
        // and the bit stays where the code is at least as great.
        let high = vec4<u32>(select(BYTES, HALVES, is_leaf));
        let code = select(byte_code, half_code, is_leaf);
        let one = select(0x01010101u, 0x00010001u, is_leaf);
        let above = ((texel | high) - vec4<u32>(code + one)) & high;
        let reached = ((texel | high) - vec4<u32>(code)) & high;
        let lit_bounds = ((above.x >> 7u) | (above.y >> 6u)) & CHILDREN;
        let open_bounds = ((reached.z >> 7u) | (reached.w >> 6u)) & CHILDREN;
        let lit_depths = (above.x >> 15u) | (above.y >> 14u) | (above.z >> 7u) | (above.w >> 6u);
        let open_depths = (reached.x >> 15u) | (reached.y >> 14u) | (reached.z >> 7u) | (reached.w >> 6u);
        let lit = select(lit_bounds, lit_depths, is_leaf);
        let undecided = select(open_bounds, open_depths, is_leaf) & ~lit;

        // Children that the ray covers in full, and the one that it ends in.
        let full = min(left >> shift, 8u);
        let part = select(left - (full << shift), 0u, full == 8u);
        let end = 1u << (8u * (full >> 1u) + (full & 1u));
        let full_mask = select(end - 1u, CHILDREN, full == 8u);
        let end_mask = select(0u, end, part > 0u);
        count += countOneBits(lit & full_mask) << shift;
        count += select(0u, part, (lit & end_mask) != 0u);
        let mixed = undecided & (full_mask | end_mask);

        open_leaves = select(select(0u, mixed, is_block), rest_open, is_leaf);
        open_blocks = select(select(mixed, rest_open, is_block), open_blocks, is_leaf);
        next_group += select(1u, 0u, is_leaf || is_block);
        // Depths that 15 bits do not tell from the ray's: a few in a hundred thousand.
        var equal = select(0u, mixed, is_leaf);
        while equal != 0u {
            let at = firstTrailingBit(equal);
            equal &= equal - 1u;
            let column = 8u * node + (at >> 2u) + (at & 1u);
            count += select(0u, 1u, textureLoad(rectified, vec2<u32>(column, row), 0).x >= ray);
        }
    }
    return count;
}

/// Average visibility of a ray of depth `ray` over the first `texels` columns of a row, the last in part.
fn average_visibility(row: u32, ray: f32, texels: f32) -> f32 {
    let whole = min(u32(texels), row_columns() - 1u);
    let last = select(0.0, texels - f32(whole), finite_or(textureLoad(rectified, vec2<u32>(whole, row), 0).x, 1.0) >= ray);
    return (f32(lit_columns(row, ray, whole)) + last) / texels;
}
