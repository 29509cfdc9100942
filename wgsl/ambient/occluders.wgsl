// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::ambient::occluders
// summary: Whether what is seen at a pixel is in a surface point's way, and how much.
// source: thesis Eq. 3.4 and Listing 3.1; Bavoil et al., "Image-space horizon-based ambient occlusion" (2008); Therrien et al., "Screen space indirect lighting with visibility bitmask" (2023).
// note: The thesis leaves the fall-off f open. Here f(d) = (1 - (d/r)^2)^2 up to the radius r, then 0: visibility is 1 - f of an occluder
// note: at the distance d, so it rises to 1 smoothly.
// equation: f(d) = (1 − (d / r)²)² up to r, else 0;  visibility = 1 − f
// equation: slice above the elevation h: open = 1 − sin h;  mean = tangent ½ (π/2 − h − sin h cos h) + normal ½ cos² h
// error: weights and elevations within 1e-6; test ambient/places::occluders_count_less_with_distance_and_by_their_elevation.
// error: slices within 2e-6; test ambient/functions::slices_above_a_horizon_are_their_integrals.
// error: sectors exact; test ambient/functions::sectors_are_those_whose_middles_are_between.
// parameter metres: distance of the occluder, from 0 up.
// parameter radius: metres, above 0.
// parameter towards: from the surface point to the other, metres in the world.
// parameter normal: unit vector in the world.
// parameter horizon_sine: sine of the horizon's elevation, 0..1.
// parameter low, high: angles as parts 0..1 of the half-circle.

/// Most directions a pixel.
const MOST_SAMPLES: u32 = 256u;
/// Most steps along each.
const MOST_STEPS: u32 = 256u;

/// How occlusion is looked for. 32 bytes.
struct OcclusionSettings {
    /// Occluders count up to this distance, metres, above 0.
    radius: f32,
    /// How thick what is seen is taken to be, metres, above 0: what lies further in front of a place does not say whether the place is free.
    thickness: f32,
    /// Sine of the elevation over the tangent plane from which on something occludes: 0..1.
    bias: f32,
    /// Directions a pixel, 1..MOST_SAMPLES; slices of the hemisphere with HORIZON and BITMASK.
    samples: u32,
    /// Steps along each, 1..MOST_STEPS.
    steps: u32,
    /// Side of the square of pixels that have different directions, from 1 up.
    side: u32,
    /// Frame of a temporal pattern; 0 for a static one.
    frame: u32,
    reserved_a: u32,
}

/// How much an occluder at a distance counts, 0..1.
fn occluder_weight(metres: f32, radius: f32) -> f32 {
    let part = metres / max(radius, 1e-20);
    let left = max(1.0 - part * part, 0.0);
    return left * left;
}

/// Sine of the elevation of a point over a surface; -1 for the surface point itself.
fn elevation_sine(towards: vec3<f32>, normal: vec3<f32>) -> f32 {
    let size = length(towards);
    return select(dot(towards, normal) / max(size, 1e-20), -1.0, size <= 0.0);
}

/// What is open of a slice of the hemisphere above a horizon. `mean`: sum of its directions, `open`: their share of the slice.
struct OpenSlice {
    /// Integral of unit vectors over the solid angle, of the whole slice's 1.
    mean: vec3<f32>,
    /// Share of the solid angle, 0..1.
    open: f32,
}

/// The slice between the normal and the unit vector `tangent` at right angles to it, open above the elevation whose sine is given, 0..1.
/// Solid angle falls off with the cosine of the elevation e: integrals of cos e, cos^2 e and sin e cos e from the horizon to 90 degrees.
fn open_slice(normal: vec3<f32>, tangent: vec3<f32>, horizon_sine: f32) -> OpenSlice {
    let sine = clamp(horizon_sine, 0.0, 1.0);
    let cosine = sqrt(1.0 - sine * sine);
    let along = 0.5 * (atan2(cosine, sine) - sine * cosine);
    return OpenSlice(tangent * along + normal * (0.5 * cosine * cosine), 1.0 - sine);
}

/// Sectors of a half-circle, one bit each.
const SECTORS: u32 = 32u;

/// Bits of the sectors between two angles as parts 0..1 of the half-circle: those whose middles lie between them.
fn sector_bits(low: f32, high: f32) -> u32 {
    let first = u32(clamp(ceil(low * f32(SECTORS) - 0.5), 0.0, f32(SECTORS)));
    let end = u32(clamp(ceil(high * f32(SECTORS) - 0.5), 0.0, f32(SECTORS)));
    let count = end - min(first, end);
    let ones = select((1u << (count & 31u)) - 1u, 0xffffffffu, count >= SECTORS);
    return select(ones << (first & 31u), 0u, first >= SECTORS);
}
