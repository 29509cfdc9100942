// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Minimum or maximum over a disc, level by level: two reads for each row of the disc.
// source: Urbach and Wilkinson, "Efficient 2-D grayscale morphological transformations with arbitrary flat structuring elements" (2008).
// note: The table of level p holds the extremum over 2^p texels of a row around each texel. Two of them, overlapping, make any
// note: chord of 2^p to 2^(p+1) - 1 texels. Each dispatch takes the chords that its table serves, and makes the next table.
// binding disc: radius, level and rows.
// binding table: the table of this level; of level 0 the shadow map, a depth format or r32float.
// binding accumulated: the extrema over the rows taken so far, r32float; not read at level 0.
// binding next_table: out, r32float: the table of the next level; not written where none follows.
// binding next_accumulated: out, r32float: the extrema with the rows of this level; after the last the result.

#import airlight::core::finite::finite_or
#import airlight::stylize::morphology::{Disc, disc_half_chord, table_before, table_after}

@group(#{GROUP}) @binding(0) var<uniform> disc: Disc;
@group(#{GROUP}) @binding(1) var table: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var accumulated: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var next_table: texture_storage_2d<r32float, write>;
@group(#{GROUP}) @binding(4) var next_accumulated: texture_storage_2d<r32float, write>;

/// The table at a texel; beyond the border that of the border.
fn table_at(x: i32, y: i32) -> f32 {
    let last = vec2<i32>(textureDimensions(table)) - 1;
    return textureLoad(table, clamp(vec2<i32>(x, y), vec2<i32>(0), last), 0).x;
}

/// A value as it is compared: tables behind the first are so already.
fn compared(value: f32) -> f32 {
    return select(value, disc.sign * finite_or(value, disc.far_depth), disc.begins == 1u);
}

@compute @workgroup_size(16, 8)
fn disc_extremum(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(table);
    if any(id.xy >= size) {
        return;
    }
    let at = vec2<i32>(id.xy);
    let before = table_before(disc.level);
    let after = table_after(disc.level);
    // Every disc holds its own texel.
    var extremum = compared(table_at(at.x, at.y));
    if disc.begins == 0u {
        extremum = textureLoad(accumulated, id.xy, 0).x;
    }
    let end_row = min(disc.end_row, size.y);
    for (var row = disc.first_row; row < end_row; row++) {
        let half = i32(min(disc_half_chord(disc.radius, row), size.x - 1u));
        let left = at.x - half + before;
        let right = at.x + half - after;
        let above = at.y - i32(row);
        let below = at.y + i32(row);
        let upper = min(compared(table_at(left, above)), compared(table_at(right, above)));
        let lower = min(compared(table_at(left, below)), compared(table_at(right, below)));
        extremum = min(extremum, min(upper, lower));
    }
    if disc.ends == 1u {
        textureStore(next_accumulated, id.xy, vec4<f32>(disc.sign * extremum, 0.0, 0.0, 0.0));
        return;
    }
    textureStore(next_accumulated, id.xy, vec4<f32>(extremum, 0.0, 0.0, 0.0));
    // From the reach of this table to that of the next, on both sides.
    let left = at.x - (table_before(disc.level + 1u) - before);
    let right = at.x + (table_after(disc.level + 1u) - after);
    let next = min(compared(table_at(left, at.y)), compared(table_at(right, at.y)));
    textureStore(next_table, id.xy, vec4<f32>(next, 0.0, 0.0, 0.0));
}
