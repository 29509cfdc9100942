// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::upsample
// summary: Scattered light at a fraction of the resolution: which pixels are evaluated, and how the others are found from them.
// source: joint bilateral upsampling, Kopf, Cohen, Lischinski and Uyttendaele (2007), with distance along the ray as guide.
// note: Low-resolution pixel (x, y) is the full-resolution pixel (factor x, factor y), centre and depth: nothing
// note: is averaged, and a pixel that was evaluated keeps its value where its depth is as near as ever.
// note: The mean visibility over a ray of length s is off by at most |s - t| / max(s, t) as that over a length t:
// note: relative difference of distance is what a neighbour may be trusted by.
// equation: closeness = 1 / (1 + ((s' − s) / (tolerance s))²);  weights ∝ b_i c_i + LEAST_WEIGHT (1 − Σ b c) c_i
// error: weights within the budget that the test derives; test scattering/resolution/upsampling::upsampling_is_joint_bilateral.
// parameter pixel: column and row, from 0.
// parameter bilinear: weights 0..1 that add up to 1.
// parameter closeness: above 0 up to 1.
// parameter size: columns and rows of the low resolution.

/// How the picture is reduced. 16 bytes.
struct Reduction {
    /// Pixels of the full picture from one evaluated pixel to the next, in x and in y: 2 or 4.
    factor: u32,
    /// Relative difference of distance at which a neighbour counts half, positive.
    tolerance: f32,
    reserved_a: u32,
    reserved_b: u32,
}

/// Share of neighbours that bilinear weights leave out, where all others are at other distances.
const LEAST_WEIGHT: f32 = 0.01;

/// The four evaluated pixels around a pixel.
struct Neighbours {
    /// Pixel of the low resolution at or before it, in x and y.
    before: vec2<u32>,
    /// The next one in x and y; the same at the end of the picture.
    behind: vec2<u32>,
    /// Bilinear weights: before and behind in x; then both in the row behind. They add up to one.
    bilinear: vec4<f32>,
}

/// The pixel of the full picture that a pixel of the low resolution evaluates.
fn evaluated_pixel(reduction: Reduction, pixel: vec2<u32>) -> vec2<u32> {
    return pixel * max(reduction.factor, 1u);
}

/// The evaluated pixels around a `pixel` of the full picture. `size`: of the low resolution, at least 1.
fn evaluated_neighbours(reduction: Reduction, pixel: vec2<u32>, size: vec2<u32>) -> Neighbours {
    let factor = max(reduction.factor, 1u);
    let last = size - 1u;
    let before = min(pixel / factor, last);
    let part = clamp(vec2<f32>(pixel - before * factor) / f32(factor), vec2<f32>(0.0), vec2<f32>(1.0));
    let rest = 1.0 - part;
    let bilinear = vec4<f32>(rest.x * rest.y, part.x * rest.y, rest.x * part.y, part.x * part.y);
    return Neighbours(before, min(before + 1u, last), bilinear);
}

/// How far neighbours with rays of the lengths `others` can stand in for a ray of the length `distance`,
/// all in metres: 1 for equal lengths, 1/2 at the relative difference `tolerance`, never 0.
fn closeness(distance: f32, others: vec4<f32>, tolerance: f32) -> vec4<f32> {
    let scale = max(distance, 1e-6) * max(tolerance, 1e-4);
    let off = min(abs(others - distance) / scale, vec4<f32>(1e15));
    return 1.0 / (1.0 + off * off);
}

/// Weights of the neighbours, adding up to one. Where those that the bilinear weights prefer are at other
/// distances, the one at the most similar distance takes over.
fn upsampling_weights(bilinear: vec4<f32>, closeness: vec4<f32>) -> vec4<f32> {
    let near = bilinear * closeness;
    let trusted = dot(near, vec4<f32>(1.0));
    let weights = near + LEAST_WEIGHT * max(1.0 - trusted, 0.0) * closeness;
    return weights / max(dot(weights, vec4<f32>(1.0)), 1e-37);
}
