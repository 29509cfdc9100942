// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::ambient::octahedral
// summary: Directions as texels of a square: an octahedron unfolded about the y axis, whose edges are middles of texels.
// source: Engelhardt and Dachsbacher, "Octahedron environment maps" (2008).
// note: +y lies in the middle of the square, -y in its four corners, and the horizon joins the middles of its edges; x runs along
// note: columns, z along rows. Middles of the outer texels lie on the edges of the square, each of which is folded at its middle: texels
// note: there have a twin with the same direction, so a bilinear sampler finds no seam and needs no border. With an odd number of
// note: texels a side the creases of the octahedron run through middles of texels too, and filtering does not cut across them.
// note: A direction that is not finite, or shorter than 1e-30, counts as +y.
// equation: p = d / (|x| + |y| + |z|);  (u, v) = (p.x, p.z) above the horizon, (1 − |p.z|, 1 − |p.x|) with the signs of p below
// equation: coordinate = (½ (u + 1) (side − 1) + ½) / side
// error: directions and angles are found within 5e-3 of light; test ambient/light::look_ups_find_directions_and_angles.
// error: no seam: edges differ by less than 2e-3; test ambient/light::nothing_shows_where_the_maps_edges_meet.
// parameter x: any number.
// parameter direction: any length; not finite or shorter than 1e-30 counts as +y.
// parameter place: in the square, -1..1.
// parameter texel: column and row, 0 .. side - 1.
// parameter side: texels a side, at least 2.

#import airlight::core::finite::is_finite

/// -1 for negative numbers, else 1.
fn signs(x: vec2<f32>) -> vec2<f32> {
    return select(vec2<f32>(-1.0), vec2<f32>(1.0), x >= vec2<f32>(0.0));
}

/// Where a direction of any length lies in the square without border, -1..1.
fn octahedral_place(direction: vec3<f32>) -> vec2<f32> {
    let greatest = max(max(abs(direction.x), abs(direction.y)), abs(direction.z));
    let finite = is_finite(direction.x) && is_finite(direction.y) && is_finite(direction.z);
    if !finite || greatest < 1e-30 {
        return vec2<f32>(0.0);
    }
    // Scaled first: the sum of three great numbers may be infinite.
    let scaled = direction / greatest;
    let projected = scaled / (abs(scaled.x) + abs(scaled.y) + abs(scaled.z));
    if projected.y >= 0.0 {
        return projected.xz;
    }
    return (1.0 - abs(projected.zx)) * signs(projected.xz);
}

/// The unit vector of a place in the square, -1..1.
fn octahedral_direction(place: vec2<f32>) -> vec3<f32> {
    let height = 1.0 - abs(place.x) - abs(place.y);
    let below = (1.0 - abs(place.yx)) * signs(place);
    let flat_part = select(below, place, height >= 0.0);
    return normalize(vec3<f32>(flat_part.x, height, flat_part.y));
}

/// Coordinates 0..1 in a map of `side` texels, at least 2, for a linear sampler.
fn octahedral_coordinates(direction: vec3<f32>, side: u32) -> vec2<f32> {
    let place = 0.5 * octahedral_place(direction) + 0.5;
    return (place * f32(side - 1u) + 0.5) / f32(side);
}

/// The unit vector of the middle of texel 0..side-1 of the map.
fn octahedral_texel_direction(texel: vec2<u32>, side: u32) -> vec3<f32> {
    return octahedral_direction(2.0 * vec2<f32>(texel) / f32(side - 1u) - 1.0);
}
