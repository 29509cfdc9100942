// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::advection
// summary: Noise drawn out along a field of directions in the picture: line integral convolution.
// source: Cabral and Leedom, "Imaging vector fields using line integral convolution" (1993); dissertation on painterly volume rendering, 6.1.3.
// note: Directions have no sign: each step takes the one of both that turns less, and a line ends where it would turn by more than
// note: 60 degrees, where there is no direction, and at the edge of the picture. Steps are of the midpoint rule.
// equation: mean along the line: m = (n_0 + Σ n_i) / (1 + count), n hashed noise;  shown: ½ + g (m − ½),  g from 1 to √count by contrast
// equation: step: x ← x + h v(x + ½ h v(x)), the sign of v kept
// error: means along lines of a constant field within 1e-5; test painterly/advect::a_constant_field_gives_means_along_lines.
// error: where there is no direction within 1e-5; test painterly/advect::lines_end_where_there_is_no_direction_or_a_kink.
// parameter pixel: column and row, from 0.
// parameter seed: any bits.
// parameter curvature: in z and w (cos 2a, sin 2a) of the direction in the picture, 0 where there is none.
// parameter position: pixels.

#import airlight::core::finite::finite_or
#import airlight::core::noise::{hash_of_three, unit_from_hash}
#import airlight::painterly::curvature::half_angle

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
