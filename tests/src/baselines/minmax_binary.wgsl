// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// The competitor: min-max mipmaps along rows, two children a node, climbed and descended without a stack.
// binding rectified: the rectified map, for its size.
// binding nodes: its min-max mipmaps.

@group(#{GROUP}) @binding(6) var rectified: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var nodes: texture_2d<f32>;

/// Greatest level.
const TOP: u32 = 7u;

fn row_columns() -> u32 {
    return textureDimensions(rectified).x;
}

/// Average visibility of a ray of depth `ray` over the first `texels` columns of a row, the last in part.
fn average_visibility(row: u32, ray: f32, texels: f32) -> f32 {
    let size = textureDimensions(rectified);
    let padded = select(1u << (32u - countLeadingZeros(size.x - 1u)), 1u, size.x == 1u);
    let end = u32(ceil(texels));
    var column = 0u;
    let top = min(TOP, firstLeadingBit(padded));
    var level = top;
    var sum = 0.0;
    while column < end {
        let start = select(padded - ((2u * padded) >> level), 0u, level == 0u);
        let at = vec2<u32>(start + (column >> level), row + select(size.y, 0u, level == 0u));
        let node = textureLoad(nodes, at, 0).xy;
        let lit = node.x >= ray;
        if lit || (node.y < ray) {
            let next = column + (1u << level);
            sum += select(0.0, min(f32(next), texels) - f32(column), lit);
            column = next;
            // Back up where the node that follows begins a pair.
            level = min(level + select(1u, 0u, ((column >> level) & 1u) == 1u), top);
        } else {
            level -= 1u;
        }
    }
    return sum / texels;
}
