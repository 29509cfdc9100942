// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Min-max mipmaps along the rows of a rectified map, two children a node, full precision.
// source: Chen, Baran, Durand and Jarosz, "Real-time volumetric shadows using 1D min-max mipmaps" (2011), 3.
// note: Level k covers 2^k columns a node; levels are cut at TOP, or where one node covers the map. Row j of level 0 is row j of the texture, the
// note: levels 1 .. TOP lie one after the other in row H + j: with P, the least power of two of at least W columns,
// note: level k begins at column P - P / 2^(k - 1). Columns beyond the map take part in no bound.
// binding rectified: the rectified map.
// binding nodes: out, least and greatest depth of each node, rg32float.

#import airlight::core::finite::finite_or

@group(#{GROUP}) @binding(0) var rectified: texture_2d<f32>;
@group(#{GROUP}) @binding(1) var nodes: texture_storage_2d<rg32float, write>;

/// Greatest level.
const TOP: u32 = 7u;

/// A thread takes one node of level TOP, and all below it.
@compute @workgroup_size(8, 8)
fn build(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let first = id.x << TOP;
    if first >= size.x || id.y >= size.y {
        return;
    }
    let padded = select(1u << (32u - countLeadingZeros(size.x - 1u)), 1u, size.x == 1u);
    // Nodes whose sibling is still to come, one a level.
    var open = array<vec2<f32>, TOP + 1u>();
    for (var column = first; column < first + (1u << TOP); column++) {
        var value = vec2<f32>(2.0, -1.0);
        if column < size.x {
            let depth = textureLoad(rectified, vec2<u32>(column, id.y), 0).x;
            value = vec2<f32>(clamp(finite_or(depth, 1.0), 0.0, 1.0));
            textureStore(nodes, vec2<u32>(column, id.y), vec4<f32>(value, 0.0, 0.0));
        }
        // As carries run through a binary counter.
        var level = 0u;
        while (level < TOP) && (((column >> level) & 1u) == 1u) {
            value = vec2<f32>(min(open[level].x, value.x), max(open[level].y, value.y));
            level++;
            let node = column >> level;
            if ((node << level) < size.x) && ((padded >> level) > 0u) {
                let start = padded - ((2u * padded) >> level);
                textureStore(nodes, vec2<u32>(start + node, size.y + id.y), vec4<f32>(value, 0.0, 0.0));
            }
        }
        open[level] = value;
    }
}
