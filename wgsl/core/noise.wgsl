// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::noise
// summary: Gradient noise in two dimensions, in -1/sqrt 2 .. 1/sqrt 2, of an integer hash.
// source: Perlin, "An image synthesizer" (1985); fade: Perlin, "Improving noise" (2002); hash: Jarzynski and Olano, "Hash functions for GPU rendering" (2020), PCG3D.
// note: Range: with unit gradients |P| is at most the mean of the distances d to the corners of the cell with the weights w,
// note: and by Jensen's inequality P^2 <= sum of w d^2 = g(x) + g(y) with g(x) = (1 - s) x^2 + s (1 - x)^2 and s the fade.
// note: g(x) - 1/4 = (1 - 2x) (s - (1 + 2x) / 4). For x <= 1/2 the fade is convex from 0 to 1/2, so that s <= x <= (1 + 2x) / 4
// note: and g <= 1/4; x > 1/2 is the mirror image. So P^2 <= 1/2, met in the middle of a cell.
// note: Gradients have any direction, evenly, from polynomials: adapters differ by rounding alone, not by their sines.
// note: On whole coordinates the noise is 0. f32 has 1/8 of a cell left at 2^20; from 2^24 on the noise is 0.
// equation: v = key · 1664525 + 1013904223; twice v.x += v.y v.z, v.y += v.z v.x, v.z += v.x v.y, with v ^= v >> 16 between (PCG3D)
// equation: P(q) = mix over the corners c of the cell of dot(g_c, q − c), weights by fade(t) = 6 t⁵ − 15 t⁴ + 10 t³
// equation: g_c = unit vector of the angle 2π (hash / 2³² − 1/8)
// error: hashes exact; test core/noise::hashes_are_those_of_the_definition.
// error: directions within 3e-7, fade 8e-7; test core/noise::directions_have_length_one_and_the_angle_of_the_hash.
// error: noise within 1.5e-6; test core/noise::noise_is_that_of_the_reference.
// parameter key: three whole numbers, any bits.
// parameter hash: any bits.
// parameter corner, cell: whole cells, wrapping at 2^32.
// parameter seed: any bits: another noise.

#import airlight::core::finite::finite_or

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
