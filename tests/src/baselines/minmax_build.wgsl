// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Min-max mipmaps along the rows of a rectified map, eight children a node, the bounds of all eight in one texel.
// source: Chen, Baran, Durand and Jarosz, "Real-time volumetric shadows using 1D min-max mipmaps" (2011), 3.
// note: Levels are cut to three: a leaf is 8 columns, a block 8 leaves, a group 8 blocks. A row of the texture
// note: holds the groups, then the blocks, then the leaves.
// note: A node's texel is the least depths of its even and of its odd children, then the greatest ones, each rounded
// note: down to 7 bits in a byte of its own; a leaf's is its columns' depths, rounded down to 15 bits, columns k and
// note: k + 4 in the halves of word k. Rounding down is monotone: unequal codes order the depths themselves, and equal ones are looked up.
// note: Columns beyond the map count as unblocked.
// binding rectified: the rectified map.
// binding nodes: out, the three levels, rgba32uint.

#import airlight::core::finite::finite_or

@group(#{GROUP}) @binding(0) var rectified: texture_2d<f32>;
@group(#{GROUP}) @binding(1) var nodes: texture_storage_2d<rgba32uint, write>;

/// A depth rounded down to 7 bits, in the byte of a child.
fn byte_of(depth: f32, child: u32) -> u32 {
    return min(u32(depth * 128.0), 127u) << (8u * (child >> 1u));
}

/// `texel` with the bounds of one of its eight children.
fn with_child(texel: vec4<u32>, child: u32, bounds: vec2<f32>) -> vec4<u32> {
    let low = byte_of(bounds.x, child);
    let high = byte_of(bounds.y, child);
    if (child & 1u) == 0u {
        return texel | vec4<u32>(low, 0u, high, 0u);
    }
    return texel | vec4<u32>(0u, low, 0u, high);
}

/// A thread takes one group: 512 columns of a row.
@compute @workgroup_size(32)
fn build(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let row = id.x;
    let group = id.y;
    if row >= size.y || group * 512u >= size.x {
        return;
    }
    let first_block = (size.x + 511u) / 512u;
    let first_leaf = first_block + (size.x + 63u) / 64u;
    var group_texel = vec4<u32>(0u);
    for (var block = 0u; block < 8u; block++) {
        var block_texel = vec4<u32>(0u);
        var block_bounds = vec2<f32>(1.0, 0.0);
        let block_column = group * 512u + block * 64u;
        for (var leaf = 0u; leaf < 8u; leaf++) {
            let column = block_column + leaf * 8u;
            var depths = array<vec4<f32>, 2>(vec4<f32>(1.0), vec4<f32>(1.0));
            for (var i = 0u; i < 8u; i++) {
                if column + i < size.x {
                    let depth = textureLoad(rectified, vec2<u32>(column + i, row), 0).x;
                    depths[i >> 2u][i & 3u] = clamp(finite_or(depth, 1.0), 0.0, 1.0);
                }
            }
            let low = min(depths[0], depths[1]);
            let high = max(depths[0], depths[1]);
            let bounds = vec2<f32>(min(min(low.x, low.y), min(low.z, low.w)), max(max(high.x, high.y), max(high.z, high.w)));
            if column < size.x {
                let a = min(vec4<u32>(depths[0] * 32768.0), vec4<u32>(32767u));
                let b = min(vec4<u32>(depths[1] * 32768.0), vec4<u32>(32767u));
                textureStore(nodes, vec2<u32>(first_leaf + column / 8u, row), a | (b << vec4<u32>(16u)));
            }
            block_texel = with_child(block_texel, leaf, bounds);
            block_bounds = vec2<f32>(min(block_bounds.x, bounds.x), max(block_bounds.y, bounds.y));
        }
        if block_column < size.x {
            textureStore(nodes, vec2<u32>(first_block + block_column / 64u, row), block_texel);
        }
        group_texel = with_child(group_texel, block, block_bounds);
    }
    textureStore(nodes, vec2<u32>(group, row), group_texel);
}
