// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::ambient::bent_blur
// summary: A blur that stops at edges, of how mean directions differ from half their normals: what neighbours count, and the way back.
// source: thesis 3.4; Laine et al., "Incremental instant radiosity" (2007).
// note: A neighbour counts by how far it lies from the tangent plane and how alike its normal is, smoothly down to 0.
// equation: weight = max(0, 1 − away / reach) max(0, 1 − ½ |n − n'|² / (1 − least_cosine)),  away: distance of either point from the other's plane
// equation: mean = difference + ½ n, no longer than 1
// error: weights within 5e-6; test ambient/functions::neighbours_count_by_distance_from_the_plane_and_by_normal.
// error: a whole blur within 1.5e-3; test ambient/passes::a_blur_takes_the_mean_of_what_counts_in_its_row_or_column.
// parameter place, other: metres in the world.
// parameter normal, other_normal: unit vectors in the world.
// parameter difference: mean direction less half the normal, length up to 1.5.

/// Most pixels that are averaged.
const MOST_TAPS: u32 = 16u;

/// A blur along an axis. 32 bytes.
struct BentBlur {
    /// (1, 0) or (0, 1).
    axis: vec2<u32>,
    /// Pixels that are averaged, 1..MOST_TAPS: the side of the sampling pattern.
    taps: u32,
    /// Metres from the tangent plane at which a neighbour counts no more, above 0.
    reach: f32,
    /// Cosine between normals at which a neighbour counts no more, below 1.
    least_cosine: f32,
    reserved_a: f32,
    reserved_b: f32,
    reserved_c: f32,
}

/// Weight 0..1 of a neighbour; 1 of a pixel itself.
fn edge_weight(blur: BentBlur, place: vec3<f32>, normal: vec3<f32>, other: vec3<f32>, other_normal: vec3<f32>) -> f32 {
    let away = max(abs(dot(other - place, normal)), abs(dot(other - place, other_normal)));
    let near = clamp(1.0 - away / max(blur.reach, 1e-20), 0.0, 1.0);
    // Of the difference of the normals, so that normals of any length are alike to themselves.
    let unlike = 0.5 * dot(normal - other_normal, normal - other_normal);
    let alike = clamp(1.0 - unlike / max(1.0 - blur.least_cosine, 1e-6), 0.0, 1.0);
    return near * alike;
}

/// The mean direction that differs from half the normal by this. Of few directions, a difference to another normal may lead out of the
/// unit sphere: it goes no further.
fn mean_from_difference(difference: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let mean = difference + 0.5 * normal;
    return mean / max(length(mean), 1.0);
}
