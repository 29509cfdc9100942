// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/sliding_extremum, permutation epipolar (EPIPOLAR)
// summary: Minimum or maximum over a sliding window along rows, columns or epipolar lines, at a cost that does not depend on the window.
// source: van Herk (1992), Gil and Werman (1993): the extrema of the part of each window before and behind a border of blocks.
// note: A thread takes as many texels of a line as the window has, and keeps their running extrema: two reads a texel.
// note: Longer windows are windows of windows: see the stride. Dispatch lines in x, blocks of each residue of the stride in y.
// definition EPIPOLAR: epipolar lines, stored as rows of a texture, see stylize/epipolar_dilate.
// binding window: the window, the sign of the extremum; with EPIPOLAR for lines that run towards the eye, turned round for others.
// binding values: without EPIPOLAR the shadow map, a depth format or r32float; with it the lines, r32float.
// binding extrema: out, r32float, of the size of the map, or of the lines.
// binding epipole: the eye in the map; with EPIPOLAR only.
// binding shadow_map: the shadow map, a depth format or r32float; of its size alone without SHADOW_MAP; with EPIPOLAR only.

// ---- airlight::stylize::epipolar_dilate ----
// summary: Extrusion of blockers along view rays inside a shadow map, and its counterpart: depths carried along epipolar lines.
// source: stylized scattering, Eq. 3; thesis Eq. 6.1.

/// The eye in a shadow map: a homogeneous point in texels and depth. 16 bytes.
struct Epipole {
    /// Position in the map, texels, times the weight; the first texel's centre is at (0.5, 0.5).
    position: vec2<f32>,
    /// Depth in the map's own convention, times the weight.
    depth: f32,
    /// 1 for an eye that the map can see, 0 for one at infinity (position and depth are then a direction), below 0 for one
    /// behind the light.
    weight: f32,
}

/// The line from a texel towards the epipole.
struct EpipolarLine {
    /// One step towards the epipole, texels: 1 along the longer axis.
    step: vec2<f32>,
    /// Distance of the epipole along that axis in texels, times the absolute weight.
    distance: f32,
}

/// A line of the map from one of its sides on: towards the eye, or for one behind the light away from it, which is towards the
/// place of the epipole in both cases.
struct EpipolarRow {
    /// Side at which it begins: 0 greatest x, 1 least x, 2 greatest y, 3 least y.
    side: u32,
    /// Texel of that side.
    index: u32,
    /// Where it begins: the centre of that texel, or the middle of its edge where the line is longer along the side.
    begin: vec2<f32>,
    /// One step, texels: 1 along the longer axis.
    step: vec2<f32>,
    /// Distance of the epipole at the beginning, as in EpipolarLine.
    distance: f32,
    /// Steps inside the map, the first texel counted.
    length: u32,
}

/// Samples nearer to the epipole, in texels, cannot be told from it.
const LEAST_DISTANCE: f32 = 1e-3;

/// The line through `at`, in texels.
fn line_towards(epipole: Epipole, at: vec2<f32>) -> EpipolarLine {
    let towards = epipole.position - at * epipole.weight;
    let distance = max(abs(towards.x), abs(towards.y));
    return EpipolarLine(towards / max(distance, 1e-30), distance);
}

/// The least `distance` at which a sample is still told from the epipole.
fn least_distance(epipole: Epipole) -> f32 {
    return max(LEAST_DISTANCE * abs(epipole.weight), 1e-20);
}

/// 1 where rows run towards the eye, -1 where they run away from it.
fn row_sense(epipole: Epipole) -> f32 {
    return select(1.0, -1.0, epipole.weight < 0.0);
}

/// The line that begins at a texel of a side. `number`: side times the longer side of the map, plus the texel.
fn epipolar_row(epipole: Epipole, size: vec2<u32>, number: u32) -> EpipolarRow {
    let longer = max(size.x, size.y);
    let side = number / longer;
    let index = number % longer;
    let extent = vec2<f32>(size);
    let across = f32(index) + 0.5;
    // Steps fall onto the centres of texels along the longer axis of the line.
    let last = (side & 1u) == 0u;
    let centre = side_point(side, across, select(vec2<f32>(0.5), extent - 0.5, last));
    let slope = abs(line_towards(epipole, centre).step);
    let crossing = select(slope.x >= slope.y, slope.y >= slope.x, side >= 2u);
    let edge = side_point(side, across, select(vec2<f32>(0.0), extent, last));
    let begin = select(edge, centre, crossing);
    let line = line_towards(epipole, begin);
    let step = row_sense(epipole) * line.step;
    // Steps before the line leaves the map, and before it comes to the epipole.
    let room = select(begin, extent - begin, step > vec2<f32>(0.0)) / max(abs(step), vec2<f32>(1e-6));
    let least = least_distance(epipole);
    let free = (line.distance - least) / max(abs(epipole.weight), 1e-12);
    let steps = min(min(room.x, room.y), free);
    let exists = index < select(size.y, size.x, side >= 2u) && line.distance > least;
    let length = select(0u, u32(clamp(ceil(steps), 0.0, f32(longer))), exists);
    return EpipolarRow(side, index, begin, step, line.distance, length);
}

/// A point `across` along a side; `at` holds the side's coordinate.
fn side_point(side: u32, across: f32, at: vec2<f32>) -> vec2<f32> {
    return select(vec2<f32>(at.x, across), vec2<f32>(across, at.y), side >= 2u);
}

/// Where the texture of all lines, twice as wide and high as the longer side of the map, holds a step of a line.
fn row_place(size: vec2<u32>, row: EpipolarRow, along: u32) -> vec2<u32> {
    let longer = max(size.x, size.y);
    return vec2<u32>((row.side & 1u) * longer + along, (row.side >> 1u) * longer + row.index);
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
@group(0) @binding(3) var<uniform> epipole: Epipole;
@group(0) @binding(4) var shadow_map: texture_2d<f32>;

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

/// The value of a texel of a line, times the sign.
fn value_at(line: EpipolarRow, along: u32) -> f32 {
    return window.sign * textureLoad(values, place(line, along), 0).x;
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
