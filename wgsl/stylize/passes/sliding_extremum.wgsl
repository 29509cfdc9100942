// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Minimum or maximum over a sliding window along rows, columns or epipolar lines, at a cost that does not depend on the window.
// source: van Herk (1992), Gil and Werman (1993): the extrema of the part of each window before and behind a border of blocks.
// note: A thread takes as many texels of a line as the window has, and keeps their running extrema: two reads a texel.
// note: Longer windows are windows of windows: see the stride. Dispatch lines in x, blocks of each residue of the stride in y.
// definition COLUMNS: columns instead of rows.
// definition EPIPOLAR: epipolar lines, stored as rows of a texture, see stylize/epipolar_dilate.
// definition SHADOW_MAP: with EPIPOLAR, reads the lines from the shadow map, and stores depths carried to their ends.
// binding window: the window, the sign of the extremum; with EPIPOLAR for lines that run towards the eye, turned round for others.
// binding values: without EPIPOLAR the shadow map, a depth format or r32float; with it the lines, r32float.
// binding extrema: out, r32float, of the size of the map, or of the lines.
// binding epipole: the eye in the map; with EPIPOLAR only.
// binding shadow_map: the shadow map, a depth format or r32float; of its size alone without SHADOW_MAP; with EPIPOLAR only.

#import airlight::core::finite::finite_or
#import airlight::stylize::morphology::{Window, LONGEST}
#import airlight::stylize::epipolar_dilate::{
    Epipole, EpipolarRow, epipolar_row, row_place, row_sense, blocker_from_stored, depth_at_row_end
}

@group(#{GROUP}) @binding(0) var<uniform> window: Window;
#ifndef SHADOW_MAP
@group(#{GROUP}) @binding(1) var values: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(2) var extrema: texture_storage_2d<r32float, write>;
#ifdef EPIPOLAR
@group(#{GROUP}) @binding(3) var<uniform> epipole: Epipole;
@group(#{GROUP}) @binding(4) var shadow_map: texture_2d<f32>;

/// A line, by its number.
fn line_at(number: u32) -> EpipolarRow {
    return epipolar_row(epipole, textureDimensions(shadow_map), number);
}

/// Texels of the window before the own one, and behind it.
fn window_reach() -> vec2<u32> {
    return select(vec2<u32>(window.before, window.after), vec2<u32>(window.after, window.before), row_sense(epipole) < 0.0);
}

/// How many lines there are.
fn line_count() -> u32 {
    let size = textureDimensions(shadow_map);
    return 4u * max(size.x, size.y);
}

/// Where a texel of a line is stored.
fn place(line: EpipolarRow, along: u32) -> vec2<u32> {
    return row_place(textureDimensions(shadow_map), line, along);
}
#else
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
#ifdef COLUMNS
    return PlainLine(number, size.y);
#else
    return PlainLine(number, size.x);
#endif
}

/// How many lines there are.
fn line_count() -> u32 {
    let size = textureDimensions(values);
#ifdef COLUMNS
    return size.x;
#else
    return size.y;
#endif
}

/// Where a texel of a line is stored.
fn place(line: PlainLine, along: u32) -> vec2<u32> {
#ifdef COLUMNS
    return vec2<u32>(line.number, along);
#else
    return vec2<u32>(along, line.number);
#endif
}
#endif

#ifdef SHADOW_MAP
/// The value of a texel of a line, times the sign.
fn value_at(line: EpipolarRow, along: u32) -> f32 {
    let last = vec2<f32>(textureDimensions(shadow_map)) - 1.0;
    let at = line.begin + f32(along) * line.step;
    let stored = textureLoad(shadow_map, vec2<u32>(clamp(at, vec2<f32>(0.0), last)), 0).x;
    let blocker = blocker_from_stored(stored, window.far_depth);
    return window.sign * depth_at_row_end(epipole, window.far_depth, line, blocker, f32(along));
}
#else ifdef EPIPOLAR
/// The value of a texel of a line, times the sign.
fn value_at(line: EpipolarRow, along: u32) -> f32 {
    return window.sign * textureLoad(values, place(line, along), 0).x;
}
#else
/// The value of a texel of a line, times the sign.
fn value_at(line: PlainLine, along: u32) -> f32 {
    return window.sign * finite_or(textureLoad(values, place(line, along), 0).x, window.far_depth);
}
#endif

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
