// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::ambient::environment
// summary: Environment maps: directions and solid angles of the texels of a latitude-longitude picture.
// source: the unit sphere; a zone between two elevations has 2 pi times the difference of their sines (Archimedes).
// note: Twice as wide as high. Rows run from the zenith (+y) to the nadir, columns to the right as someone inside sees them: -z is
// note: in the middle, +x a quarter of the width to the right of that, and the left and right edges meet at +z.
// equation: direction = (sin θ sin φ, cos θ, −sin θ cos φ),  φ = 2π (u − ½), θ = π v
// equation: solid angle of a column of width w between v₀ and v₁: 2π w (cos π v₀ − cos π v₁)
// error: sums over texels within 5e-3 of the integral; test ambient/light::the_sum_over_texels_is_the_references_integral.
// parameter coordinates: 0..1 from the upper left corner.
// parameter direction: unit vector in the world, y up.

/// Half a turn, radians.
const HALF_TURN: f32 = 3.14159265;

/// The unit vector towards a place of the map, in coordinates 0..1 from its upper left corner.
fn environment_direction(coordinates: vec2<f32>) -> vec3<f32> {
    let right_of_middle = 2.0 * HALF_TURN * (coordinates.x - 0.5);
    let down = HALF_TURN * coordinates.y;
    let level = sin(down);
    return vec3<f32>(level * sin(right_of_middle), cos(down), -level * cos(right_of_middle));
}

/// Coordinates 0..1 in the map of a unit vector; to be read with a sampler that repeats in the first.
fn environment_coordinates(direction: vec3<f32>) -> vec2<f32> {
    // The angle of the null vector is undefined: at the poles any column will do.
    let level = select(direction.xz, vec2<f32>(0.0, -1.0), all(direction.xz == vec2<f32>(0.0)));
    let right_of_middle = atan2(level.x, -level.y);
    let down = atan2(max(length(direction.xz), 1e-20), direction.y);
    return vec2<f32>(0.5 + 0.5 * right_of_middle / HALF_TURN, down / HALF_TURN);
}

/// Difference of the sines of elevation between two heights of the map, 0..1 from the top, `begin` above `end`: over
/// a column of width w (0..1) the solid angle is 2 pi w times this.
fn zone_height(begin: f32, end: f32) -> f32 {
    // The difference of two cosines, without its cancellation.
    return 2.0 * sin(0.5 * HALF_TURN * (begin + end)) * sin(0.5 * HALF_TURN * (end - begin));
}
