// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/disc, permutation default
// summary: Minimum or maximum over a disc, level by level: two reads for each row of the disc.
// source: Urbach and Wilkinson, "Efficient 2-D grayscale morphological transformations with arbitrary flat structuring elements" (2008).
// note: The table of level p holds the extremum over 2^p texels of a row around each texel. Two of them, overlapping, make any
// note: chord of 2^p to 2^(p+1) - 1 texels. Each dispatch takes the chords that its table serves, and makes the next table.
// binding disc: radius, level and rows.
// binding table: the table of this level; of level 0 the shadow map, a depth format or r32float.
// binding accumulated: the extrema over the rows taken so far, r32float; not read at level 0.
// binding next_table: out, r32float: the table of the next level; not written where none follows.
// binding next_accumulated: out, r32float: the extrema with the rows of this level; after the last the result.

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

// ---- airlight::stylize::morphology ----
// summary: Dilation and erosion of shadow maps with a box or a disc: windows of rows, and the chords of a disc.
// source: stylized scattering, section 3, thesis 6.2.1; van Herk (1992), Gil and Werman (1993); Urbach and Wilkinson (2008).

/// Rows of a disc whose chords are read from one table of running extrema. 32 bytes.
struct Disc {
    /// Radius, texels.
    radius: u32,
    /// The table holds extrema over windows of 2^level texels.
    level: u32,
    /// The least distance of rows from the middle that this table serves, texels.
    first_row: u32,
    /// The distance at which it ends, texels, at most the height of the map.
    end_row: u32,
    /// 1 for minima, -1 for maxima.
    sign: f32,
    /// What non-finite values count as: the depth of an empty texel.
    far_depth: f32,
    /// 1 where the table is the map itself, of level 0.
    begins: u32,
    /// 1 where no level follows.
    ends: u32,
}

/// Half the chord of a disc at `row` texels from its middle, row <= radius: the greatest w with w^2 + row^2 <= radius^2.
/// `radius`: below 32768.
fn disc_half_chord(radius: u32, row: u32) -> u32 {
    let square = radius * radius - row * row;
    var root = u32(sqrt(f32(square)));
    // The root of a rounded number may be one off.
    if root * root > square {
        root -= 1u;
    }
    if (root + 1u) * (root + 1u) <= square {
        root += 1u;
    }
    return root;
}

/// How many texels before the own one a table of `level` reaches: it holds extrema over 2^level texels.
fn table_before(level: u32) -> i32 {
    return i32((1u << max(level, 1u)) >> 1u) - 1;
}

/// How many texels behind the own one a table of `level` reaches.
fn table_after(level: u32) -> i32 {
    return i32((1u << level) >> 1u);
}

// ---- stylize/disc ----

@group(0) @binding(0) var<uniform> disc: Disc;
@group(0) @binding(1) var table: texture_2d<f32>;
@group(0) @binding(2) var accumulated: texture_2d<f32>;
@group(0) @binding(3) var next_table: texture_storage_2d<r32float, write>;
@group(0) @binding(4) var next_accumulated: texture_storage_2d<r32float, write>;

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
