// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::ambient::bent_cone
// summary: The mean direction in which nothing is in the way, and the cone that it stands for, beside any sampled occlusion.
// source: thesis 3.3.1 and 3.3.2, Eq. 3.2 to 3.6, Listing 3.1.
// note: Directions are spread evenly over the solid angle of the hemisphere about the normal. Then an open one has a mean direction of length
// note: 1/2, a cone of half-angle a about it (1 + cos a) / 2, and the irradiance of light that is the same from everywhere is exactly
// note: 2 * openness * dot(mean direction, normal) of what an open surface has. Directions weighted by the cosine would have other lengths.
// note: Eq. 3.2 to 3.4 count occluders, though their mean is called the unoccluded part; here as in Listing 3.1 visibility is counted.
// note: Eq. 3.6 makes cones that are too narrow: 26.4 degrees of 45. `cone_angle` is its text, `cone_angle_exact` the inverse of the length.
// note: Where nothing is open the mean direction is 0; its cone has no angle.
// equation: N = Σ V d / Σ V;  openness A = Σ V / n
// equation: printed (Eq. 3.6): α = (1 − max(0, 2 |N| − 1)) π / 2;  exact: |N| = (1 + cos α) / 2, α = 2 atan2(√(1 − |N|), √|N|)
// equation: irradiance under constant light, of an open surface's: 2 A <N, n>
// error: angles by Eq. 3.6 within 1e-6, exact ones 8e-6 radians; test ambient/functions::cones_have_the_angles_of_their_mean_lengths.
// error: sums within 2e-6; test ambient/functions::outliers_are_visible_to_directions_and_unknown_to_openness.
// parameter direction: unit vector in the world.
// parameter outlier: whether nothing is known of the direction.
// parameter mean_length: of the mean direction, 0..1.
// parameter mean: mean direction, length 0..1.
// parameter open: openness, 0..1.
// parameter normal: unit vector in the world.

/// Half of pi.
const QUARTER_TURN: f32 = 1.5707964;

/// Directions so far.
struct BentSum {
    /// Sum of unit vectors, each times its visibility.
    direction: vec3<f32>,
    /// Sum of the visibility of all.
    visible: f32,
    /// Sum of the visibility of those that are known.
    open: f32,
    /// How much is known: the number of directions, or their weight.
    known: f32,
}

/// No direction.
fn bent_nothing() -> BentSum {
    return BentSum(vec3<f32>(0.0), 0.0, 0.0, 0.0);
}

/// Adds a direction. `visibility`: 0..1. Of an outlier nothing can be seen on the screen: it counts as visible for the mean
/// direction, and does not for openness.
fn bent_add(sum: BentSum, direction: vec3<f32>, visibility: f32, outlier: bool) -> BentSum {
    let seen = select(visibility, 1.0, outlier);
    return BentSum(
        sum.direction + direction * seen,
        sum.visible + seen,
        sum.open + select(visibility, 0.0, outlier),
        sum.known + select(1.0, 0.0, outlier)
    );
}

/// Adds several directions at once. `mean`: the sum of unit vectors that are visible; `visible` of them and `all`, their number or weight.
fn bent_add_all(sum: BentSum, mean: vec3<f32>, visible: f32, all: f32) -> BentSum {
    return BentSum(sum.direction + mean, sum.visible + visible, sum.open + visible, sum.known + all);
}

/// The visible part of the directions that are known, 0..1: the thesis's AO. 1 where none is.
fn openness(sum: BentSum) -> f32 {
    return select(clamp(sum.open / max(sum.known, 1e-20), 0.0, 1.0), 1.0, sum.known <= 0.0);
}

/// The mean of visible directions: its length is below 1, about 1/2 where all are. 0 where none is.
fn mean_direction(sum: BentSum) -> vec3<f32> {
    return sum.direction / max(sum.visible, 1e-20);
}

/// Half-angle of the cone, radians 0..pi/2, as printed in Eq. 3.6. `mean_length`: of the mean direction; 0 has no cone.
fn cone_angle(mean_length: f32) -> f32 {
    let angle = (1.0 - clamp(2.0 * mean_length - 1.0, 0.0, 1.0)) * QUARTER_TURN;
    return select(angle, 0.0, mean_length <= 0.0);
}

/// Half-angle of the cone whose directions have a mean of this length, radians 0..pi/2; 0 has no cone.
fn cone_angle_exact(mean_length: f32) -> f32 {
    // Sine and cosine of half of it: their angle keeps digits where acos of the length has none left.
    let squared = clamp(mean_length, 0.5, 1.0);
    return select(2.0 * atan2(sqrt(1.0 - squared), sqrt(squared)), 0.0, mean_length <= 0.0);
}

/// A mean direction times openness: with it in place of a normal, occlusion is in the shading (thesis 3.4).
fn scaled_direction(mean: vec3<f32>, open: f32) -> vec3<f32> {
    return mean * open;
}

/// Irradiance under light that is the same from everywhere, as a part of an open surface's: what the geometric term and visibility
/// amount to, exactly.
fn irradiance_share(mean: vec3<f32>, open: f32, normal: vec3<f32>) -> f32 {
    return 2.0 * open * max(dot(mean, normal), 0.0);
}

/// A unit vector along a mean direction; the normal where there is none.
fn bent_normal(mean: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let size = length(mean);
    return select(normal, mean / max(size, 1e-20), size > 1e-6);
}
