// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::stroke_expand
// summary: A stroke as a quad of the picture: corners, texture coordinates, brush and tint.
// source: Ramalhao (2010), 4.2.6.
// note: There are no geometry shaders here: six vertices a stroke, or a triangle around it, drawn indirectly.
// equation: corner = position · picture size + size ((i − ½) (cos φ, sin φ) + aspect (j − ½) (−sin φ, cos φ)),  i, j = 0, 1
// equation: tint = 1 + variation ν₁, size = size (1 + variation ν₂),  ν in −1..1 of the stroke's hash
// error: corners within 1e-3 of the picture's size, and as many;
// error: test painterly/stroke_functions::quads_have_their_place_size_and_orientation.
// parameter vertex: 0..5.
// parameter corner: 0..3.
// parameter place: pixels, (0, 0) the top left corner.
// parameter picture_size: pixels.
// parameter hash: the stroke's own, any bits.
// parameter count: layers of the brush texture.

#import airlight::painterly::stroke::Stroke
#import airlight::painterly::stroke_placement::own_variation

/// Which number of a stroke's own varies its tint.
const TINT: u32 = 1u;
/// The same for its length.
const LENGTH: u32 = 2u;

/// Corner 0..3 of vertex 0..5, two triangles: bit 0 is the far end of the length, bit 1 of the width.
fn quad_corner(vertex: u32) -> u32 {
    return select(vertex, select(5u - vertex, 3u, vertex > 4u), vertex > 2u);
}

/// Where a corner lies, pixels of a picture of `picture_size`.
fn corner_position(stroke: Stroke, corner: u32, picture_size: vec2<f32>) -> vec2<f32> {
    let side = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) - 0.5;
    let along = vec2<f32>(cos(stroke.orientation), sin(stroke.orientation));
    let across = vec2<f32>(-along.y, along.x);
    let offset = stroke.size * (side.x * along + stroke.aspect * side.y * across);
    return stroke.position * picture_size + offset;
}

/// Clip position of a place in a picture, pixels.
fn clip_from_picture(place: vec2<f32>, picture_size: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(place / picture_size * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0), 0.5, 1.0);
}

/// Texture coordinates of a corner, 0..1; two bits of the hash mirror the brush.
fn brush_coordinates(corner: u32, hash: u32) -> vec2<f32> {
    let mirrored = corner ^ (hash >> 30u);
    return vec2<f32>(f32(mirrored & 1u), f32((mirrored >> 1u) & 1u));
}

/// Layer of the brush texture. `given`: that of the style; negative for any of `count`.
fn brush_layer(given: f32, hash: u32, count: u32) -> u32 {
    let chosen = select(u32(max(given, 0.0)), (hash & 0xffffu) % max(count, 1u), given < 0.0);
    return min(chosen, max(count, 1u) - 1u);
}

/// Factor on the colour of a stroke. `variation`: 0..1.
fn tint_factor(hash: u32, variation: f32) -> f32 {
    return 1.0 + variation * own_variation(hash, TINT);
}

/// Length of a stroke, pixels. `size`: of its layer. `variation`: 0..1.
fn varied_size(size: f32, hash: u32, variation: f32) -> f32 {
    return size * (1.0 + variation * own_variation(hash, LENGTH));
}
