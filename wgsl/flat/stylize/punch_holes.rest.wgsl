// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/punch_holes, permutation rest (REST)
// summary: Random holes in the shadow map of an object, which is then put together with that of the rest of the scene.
// source: stylized scattering 4.1, Eq. 4 and 5; thesis 6.2.1.
// note: Several objects with holes of their own: the result for one is the rest for the next.
// note: Texels without a hole keep their bits.
// definition REST: puts the object together with the rest of the scene: the nearer to the light of both.
// binding holes: what holes look like.
// binding object: shadow map of the object alone, a depth format or r32float; non-finite values count as far.
// binding rest: with REST only: shadow map of the rest, of the same size, a depth format or r32float; non-finite values count as far.
// binding punched: out, r32float, of the same size: depth in the convention of the maps.

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

// ---- airlight::core::noise ----
// summary: Gradient noise in two dimensions, in -1/sqrt 2 .. 1/sqrt 2, of an integer hash.
// source: Perlin, "An image synthesizer" (1985); fade: Perlin, "Improving noise" (2002); hash: Jarzynski and Olano, "Hash functions for GPU rendering" (2020), PCG3D.

/// Positions are held to this, cells: from here on floats are whole numbers.
const FARTHEST_CELL: f32 = 16777216.0;

/// Three hashes of three whole numbers; high bits are better than low ones.
fn hash_of_three(key: vec3<u32>) -> vec3<u32> {
    var v = key * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v = v ^ (v >> vec3<u32>(16u));
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

/// The upper 24 bits of a hash as a number in [0, 1), exact.
fn unit_from_hash(hash: u32) -> f32 {
    return f32(hash >> 8u) * (1.0 / 16777216.0);
}

/// A unit vector of a hash: its angle is the hash over 2^32 of a turn, less an eighth. Within 2e-7.
fn direction_from_hash(hash: u32) -> vec2<f32> {
    // The upper two bits are the quarter; within it at most an eighth of a turn to either side.
    let angle = (unit_from_hash(hash << 2u) - 0.5) * 1.5707963267948966;
    let square = angle * angle;
    let sine = angle * (1.0 + square * (-0.16666667 + square * (8.333333e-3 + square * (-1.9841270e-4 + square * 2.7557319e-6))));
    let cosine = 1.0 + square * (-0.5 + square * (4.1666668e-2 + square * (-1.3888889e-3 + square * 2.4801587e-5)));
    let quarter = hash >> 30u;
    let upright = select(vec2<f32>(cosine, sine), vec2<f32>(-sine, cosine), (quarter & 1u) != 0u);
    return select(upright, -upright, (quarter & 2u) != 0u);
}

/// 6 t^5 - 15 t^4 + 10 t^3: 0 to 1 with no slope and no curvature at either end. `t`: 0..1.
fn quintic_fade(t: vec2<f32>) -> vec2<f32> {
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0);
}

/// What a corner of a cell adds before it is weighted. `offset`: from the corner, cells.
fn corner_slope(corner: vec2<i32>, seed: u32, offset: vec2<f32>) -> f32 {
    let hash = hash_of_three(vec3<u32>(bitcast<vec2<u32>>(corner), seed)).x;
    return dot(direction_from_hash(hash), offset);
}

/// Gradient noise, -1/sqrt 2 .. 1/sqrt 2, at a place inside a cell. `inside`: 0..1, cells. Cell numbers wrap at 2^32.
fn gradient_noise_in_cell(cell: vec2<i32>, inside: vec2<f32>, seed: u32) -> f32 {
    let fade = quintic_fade(inside);
    let left = corner_slope(cell, seed, inside);
    let right = corner_slope(cell + vec2<i32>(1, 0), seed, inside - vec2<f32>(1.0, 0.0));
    let left_above = corner_slope(cell + vec2<i32>(0, 1), seed, inside - vec2<f32>(0.0, 1.0));
    let right_above = corner_slope(cell + vec2<i32>(1, 1), seed, inside - vec2<f32>(1.0, 1.0));
    return mix(mix(left, right, fade.x), mix(left_above, right_above, fade.x), fade.y);
}

/// Gradient noise, -1/sqrt 2 .. 1/sqrt 2. `position`: in cells of the lattice, any; what is not finite counts as 0.
fn gradient_noise(position: vec2<f32>, seed: u32) -> f32 {
    let finite = vec2<f32>(finite_or(position.x, 0.0), finite_or(position.y, 0.0));
    let held = clamp(finite, vec2<f32>(-FARTHEST_CELL), vec2<f32>(FARTHEST_CELL));
    let cell = floor(held);
    return gradient_noise_in_cell(vec2<i32>(cell), held - cell, seed);
}

// ---- airlight::stylize::perlin_holes ----
// summary: Random holes in the shadow of an object: where octaves of gradient noise lie below a threshold.
// source: stylized scattering 4.1, Eq. 4 and 5; thesis 6.2.1, Eq. 6.2 and 6.3.

/// Octaves at most.
const MOST_OCTAVES: u32 = 8u;
/// Between the seeds of octaves: 2^32 over the golden ratio.
const OCTAVE_SEED: u32 = 2654435769u;
/// Tells the hashes of offsets from those of gradients.
const OFFSET_KEY: u32 = 0x6f666673u;
/// Tells the travelling noise from the octaves.
const TRAVEL_KEY: u32 = 0x74726176u;

/// What holes look like.
struct HoleParameters {
    /// Cells of the first octave across the width and the height of the map, g f of Eq. 4; positive.
    cells: vec2<f32>,
    /// Noise below it is a hole: nothing at 0 and below, all above 1.
    threshold: f32,
    /// Weight of an octave over that of the one before, 0..1.
    persistence: f32,
    /// Number of octaves, 1..8.
    octaves: u32,
    /// Any number: other holes.
    seed: u32,
    /// How far the first look-up has travelled, whole cells, modulo 2^32.
    travel: u32,
    /// The rest of it, 0..1, cells.
    travel_part: f32,
    /// How far the second look-up is displaced at most, cells; 0 for holes that stand still.
    displacement: f32,
    /// By how much the displacement turns from the noise's middle to its end, radians.
    turn: f32,
    /// Depth of an empty texel: 1 forward, 0 reversed.
    far_depth: f32,
    reserved: f32,
}

/// Where the lattice of an octave lies, cells, 0..1.
fn octave_offset(seed: u32) -> vec2<f32> {
    let hash = hash_of_three(vec3<u32>(OFFSET_KEY, seed, OFFSET_KEY));
    return vec2<f32>(unit_from_hash(hash.x), unit_from_hash(hash.y));
}

/// Octaves of noise (Eq. 5), mapped to 0..1. `position`: cells of the first octave.
fn octave_noise(holes: HoleParameters, position: vec2<f32>) -> f32 {
    let octaves = clamp(holes.octaves, 1u, MOST_OCTAVES);
    var sum = 0.0;
    var weights = 0.0;
    let persistence = clamp(holes.persistence, 0.0, 1.0);
    var power = 1.0;
    var scale = 1.0;
    for (var octave = 0u; octave < octaves; octave++) {
        let seed = holes.seed + octave * OCTAVE_SEED;
        let weight = power / f32(max(octaves - octave, 2u) - 1u);
        sum += weight * gradient_noise(scale * position + octave_offset(seed), seed);
        weights += weight;
        power *= persistence;
        scale *= 2.0;
    }
    return clamp(0.5 + 0.70710678 * sum / weights, 0.0, 1.0);
}

/// Where the second look-up reads, for a position in cells of the first octave.
fn displaced(holes: HoleParameters, position: vec2<f32>) -> vec2<f32> {
    let seed = holes.seed ^ TRAVEL_KEY;
    let start = position + octave_offset(seed) + vec2<f32>(holes.travel_part, 0.0);
    let cell = floor(start);
    let travelled = vec2<i32>(cell) + vec2<i32>(bitcast<i32>(holes.travel), 0);
    // -1..1.
    let value = 1.4142135 * gradient_noise_in_cell(travelled, start - cell, seed);
    let angle = holes.turn * value;
    return position + holes.displacement * value * vec2<f32>(cos(angle), sin(angle));
}

/// The noise that is thresholded, 0..1. `uv`: place in the map, 0..1 across and down.
fn hole_noise(holes: HoleParameters, uv: vec2<f32>) -> f32 {
    let position = uv * holes.cells;
    if holes.displacement == 0.0 {
        return octave_noise(holes, position);
    }
    return octave_noise(holes, displaced(holes, position));
}

/// H of Eq. 4: true in a hole. `uv`: place in the map, 0..1 across and down. For fragment shaders that draw an object into a
/// shadow map with others, to discard what falls into a hole: `if discards_hole(holes, position.xy / size) { discard; }`.
fn discards_hole(holes: HoleParameters, uv: vec2<f32>) -> bool {
    return hole_noise(holes, uv) < holes.threshold;
}

/// Depth of an object with its holes: far where there is one. `depth`: finite.
fn punched_depth(holes: HoleParameters, uv: vec2<f32>, depth: f32) -> f32 {
    return select(depth, holes.far_depth, discards_hole(holes, uv));
}

/// The depth nearer to the light of two, in the convention of `far_depth`: 1 forward, 0 reversed.
fn nearer_depth(far_depth: f32, a: f32, b: f32) -> f32 {
    return select(max(a, b), min(a, b), far_depth > 0.5);
}

// ---- stylize/punch_holes ----

@group(0) @binding(0) var<uniform> holes: HoleParameters;
@group(0) @binding(1) var object: texture_2d<f32>;
@group(0) @binding(2) var rest: texture_2d<f32>;
@group(0) @binding(3) var punched: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn punch_holes(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(punched);
    if any(id.xy >= size) {
        return;
    }
    let uv = (vec2<f32>(id.xy) + 0.5) / vec2<f32>(size);
    let own = finite_or(textureLoad(object, id.xy, 0).x, holes.far_depth);
    var depth = own;
    // Noise is dear, and most of an object's map is empty.
    if own != holes.far_depth {
        depth = punched_depth(holes, uv, own);
    }
    let other = finite_or(textureLoad(rest, id.xy, 0).x, holes.far_depth);
    depth = nearer_depth(holes.far_depth, depth, other);
    textureStore(punched, id.xy, vec4<f32>(depth, 0.0, 0.0, 0.0));
}
