// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/sliding_extremum, permutation columns (COLUMNS)
// summary: Minimum or maximum over a sliding window along rows, columns or epipolar lines, at a cost that does not depend on the window.
// source: van Herk (1992), Gil and Werman (1993): the extrema of the part of each window before and behind a border of blocks.
// note: A thread takes as many texels of a line as the window has, and keeps their running extrema: two reads a texel.
// note: Longer windows are windows of windows: see the stride. Dispatch lines in x, blocks of each residue of the stride in y.
// definition COLUMNS: columns instead of rows.
// binding window: the window, the sign of the extremum; with EPIPOLAR for lines that run towards the eye, turned round for others.
// binding values: without EPIPOLAR the shadow map, a depth format or r32float; with it the lines, r32float.
// binding extrema: out, r32float, of the size of the map, or of the lines.

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

/// Texels of a row or column over which an extremum is taken. 32 bytes.
struct Window {
    /// Texels before the own one, each `stride` from the next.
    before: u32,
    /// Texels behind it; with `before` and the own one at most LONGEST.
    after: u32,
    /// Texels from one to the next, at least 1.
    stride: u32,
    reserved_a: u32,
    /// 1 for minima, -1 for maxima.
    sign: f32,
    /// What non-finite values count as: the depth of an empty texel.
    far_depth: f32,
    reserved_b: f32,
    reserved_c: f32,
}

/// The most texels of a Window.
const LONGEST: u32 = 64u;

// ---- stylize/sliding_extremum ----

@group(0) @binding(0) var<uniform> window: Window;
@group(0) @binding(1) var values: texture_2d<f32>;
@group(0) @binding(2) var extrema: texture_storage_2d<r32float, write>;

/// Texels of the window before the own one, and behind it.
fn window_reach() -> vec2<u32> {
    return vec2<u32>(window.before, window.after);
}

/// A row or column.
struct PlainLine {
    /// Which.
    number: u32,
    /// Its texels.
    length: u32,
}

/// A line, by its number.
fn line_at(number: u32) -> PlainLine {
    let size = textureDimensions(values);
    return PlainLine(number, size.y);
}

/// How many lines there are.
fn line_count() -> u32 {
    let size = textureDimensions(values);
    return size.x;
}

/// Where a texel of a line is stored.
fn place(line: PlainLine, along: u32) -> vec2<u32> {
    return vec2<u32>(line.number, along);
}

/// The value of a texel of a line, times the sign.
fn value_at(line: PlainLine, along: u32) -> f32 {
    return window.sign * finite_or(textureLoad(values, place(line, along), 0).x, window.far_depth);
}

@compute @workgroup_size(64)
fn sliding_extremum(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= line_count() {
        return;
    }
    let line = line_at(id.x);
    // The texels of one residue of the stride are a row of their own; this is a block of it.
    let asked = min(window_reach(), vec2<u32>(LONGEST - 1u));
    let reach = vec2<u32>(asked.x, min(asked.y, LONGEST - 1u - asked.x));
    let width = reach.x + reach.y + 1u;
    // From the length of the line on all strides are one.
    let stride = clamp(window.stride, 1u, max(line.length, 1u));
    let residue = id.y % stride;
    let first = (id.y / stride) * width;
    let begin = i32(residue + first * stride);
    if begin >= i32(line.length) {
        return;
    }
    let last = i32(line.length) - 1;
    let step = i32(stride);

    // Extrema from each texel on to the end of the first window: of what lies in it before its last texel.
    var suffix: array<f32, LONGEST>;
    let back = begin - i32(reach.x) * step;
    var extremum = value_at(line, u32(clamp(back + i32(width - 1u) * step, 0, last)));
    suffix[width - 1u] = extremum;
    for (var k = i32(width) - 2; k >= 0; k--) {
        extremum = min(extremum, value_at(line, u32(clamp(back + k * step, 0, last))));
        suffix[k] = extremum;
    }
    // That last texel lies in the windows of the whole block.
    extremum = suffix[width - 1u];
    let ahead = begin + i32(reach.y) * step;
    for (var k = 0; k < i32(width); k++) {
        let along = begin + k * step;
        if along > last {
            break;
        }
        if k > 0 {
            extremum = min(extremum, value_at(line, u32(clamp(ahead + k * step, 0, last))));
        }
        let result = window.sign * min(suffix[k], extremum);
        textureStore(extrema, place(line, u32(along)), vec4<f32>(result, 0.0, 0.0, 0.0));
    }
}
