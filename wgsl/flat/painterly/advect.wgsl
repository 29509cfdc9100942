// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/advect, permutation default
// summary: Draws noise out along the directions of greatest curvature in the picture.
// source: as painterly/advection.
// binding parameters: how far and how clearly.
// binding curvature: of `iso_raycast` with CURVATURE, or any field of (cos 2a, sin 2a) in z and w.
// binding streaks: out, r32float: 0..1, and 0.5 where there is no direction.

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

// ---- airlight::painterly::curvature ----
// summary: Principal curvatures of iso-surfaces and their directions, in the world and in the picture.
// source: Kindlmann, Whitaker, Tasdizen and Moller, "Curvature-based transfer functions for direct volume rendering" (2003); dissertation on painterly volume rendering, 6.1.3.

/// Half the angle of a unit vector, as a unit vector.
fn half_angle(double: vec2<f32>) -> vec2<f32> {
    // Of two forms the one in which nothing cancels.
    return normalize(select(vec2<f32>(abs(double.y), 1.0 - double.x), vec2<f32>(1.0 + double.x, abs(double.y)), double.x >= 0.0))
        * vec2<f32>(1.0, select(-1.0, 1.0, double.y >= 0.0));
}

// ---- airlight::painterly::advection ----
// summary: Noise drawn out along a field of directions in the picture: line integral convolution.
// source: Cabral and Leedom, "Imaging vector fields using line integral convolution" (1993); dissertation on painterly volume rendering, 6.1.3.

/// How far and how clearly noise is drawn out. 16 bytes.
struct StreakParameters {
    /// Steps each way, 0..MOST_STREAK_STEPS.
    steps: u32,
    /// Length of a step, pixels, 0.1..8.
    step_length: f32,
    /// Which noise.
    seed: u32,
    /// 0 for the mean along a line, which is the greyer the longer it is; 1 for the contrast of the noise itself.
    contrast: f32,
}

/// Steps each way at most.
const MOST_STREAK_STEPS: u32 = 256u;
/// Least cosine of a turn within a step.
const LEAST_COSINE: f32 = 0.5;

/// Hashed noise, 0..1, one number a pixel.
fn pixel_noise(pixel: vec2<u32>, seed: u32) -> f32 {
    return unit_from_hash(hash_of_three(vec3<u32>(pixel, seed)).x);
}

/// The direction in the pixel of a position, unit, either way; 0 where there is none. `curvature`: in z and w (cos 2a, sin 2a);
/// `position`: pixels.
fn direction_at(curvature: texture_2d<f32>, position: vec2<f32>) -> vec2<f32> {
    let inside = all(position >= vec2<f32>(0.0)) && all(position < vec2<f32>(textureDimensions(curvature)));
    let texel = textureLoad(curvature, vec2<u32>(select(vec2<f32>(0.0), position, inside)), 0).zw;
    let double = clamp(vec2<f32>(finite_or(texel.x, 0.0), finite_or(texel.y, 0.0)), vec2<f32>(-1.0), vec2<f32>(1.0));
    let size = length(double);
    let known = inside && size > 0.1;
    return select(vec2<f32>(0.0), half_angle(select(vec2<f32>(1.0, 0.0), double / select(1.0, size, known), known)), known);
}

/// The direction at a position that goes on from `heading`, unit; 0 where a line ends.
fn direction_onwards(curvature: texture_2d<f32>, position: vec2<f32>, heading: vec2<f32>) -> vec2<f32> {
    let found = direction_at(curvature, position);
    let turn = dot(found, heading);
    return select(vec2<f32>(0.0), select(-found, found, turn >= 0.0), abs(turn) >= LEAST_COSINE);
}

/// Sum and count of the noise on one side of a line. `start`: pixels, not counted itself; `heading`: unit, along the line there.
fn half_line(curvature: texture_2d<f32>, start: vec2<f32>, heading: vec2<f32>, parameters: StreakParameters) -> vec2<f32> {
    let stride = clamp(parameters.step_length, 0.1, 8.0);
    var position = start;
    var along = heading;
    var sum = vec2<f32>(0.0);
    for (var i = 0u; i < min(parameters.steps, MOST_STREAK_STEPS); i++) {
        let middle = direction_onwards(curvature, position + 0.5 * stride * along, along);
        position += stride * middle;
        along = direction_onwards(curvature, position, middle);
        if dot(along, along) == 0.0 {
            break;
        }
        sum += vec2<f32>(pixel_noise(vec2<u32>(position), parameters.seed), 1.0);
    }
    return sum;
}

/// Noise drawn out through the middle of a pixel, 0..1; 0.5 where there is no direction.
fn streak(curvature: texture_2d<f32>, pixel: vec2<u32>, parameters: StreakParameters) -> f32 {
    let centre = vec2<f32>(pixel) + 0.5;
    let heading = direction_at(curvature, centre);
    var mean = 0.5;
    for (var drawn = dot(heading, heading) > 0.0; drawn; drawn = false) {
        let line = vec2<f32>(pixel_noise(pixel, parameters.seed), 1.0)
            + half_line(curvature, centre, heading, parameters) + half_line(curvature, centre, -heading, parameters);
        // Means of n have the n-th part of the variance.
        let gain = mix(1.0, sqrt(line.y), clamp(parameters.contrast, 0.0, 1.0));
        mean = clamp(0.5 + gain * (line.x / line.y - 0.5), 0.0, 1.0);
    }
    return mean;
}

// ---- painterly/advect ----

@group(0) @binding(0) var<uniform> parameters: StreakParameters;
@group(0) @binding(1) var curvature: texture_2d<f32>;
@group(0) @binding(2) var streaks: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn advect(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(streaks)) {
        return;
    }
    textureStore(streaks, id.xy, vec4<f32>(streak(curvature, id.xy, parameters)));
}
