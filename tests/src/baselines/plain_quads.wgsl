// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Quads with a texture and a tint, whose corners are all known: what drawing strokes cannot do without.
// source: none.
// note: Four corners a quad from a vertex buffer, two triangles by an index buffer, in the order of the quads; blended as
// note: source + (1 - source alpha) * destination.
// binding brushes: brushes, premultiplied.
// binding brush_sampler: linear, with mipmaps.

@group(#{GROUP}) @binding(0) var brushes: texture_2d_array<f32>;
@group(#{GROUP}) @binding(1) var brush_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) coordinates: vec2<f32>,
    @location(1) @interpolate(flat) brush: u32,
    @location(2) @interpolate(flat) tint: vec4<f32>,
}

@vertex
fn vertex_quad(
    @location(0) place: vec2<f32>, @location(1) coordinates: vec2<f32>, @location(2) tint: vec4<f32>,
    @location(3) brush: u32
) -> Corner {
    return Corner(vec4<f32>(place, 0.5, 1.0), coordinates, brush, tint);
}

@fragment
fn fragment_quad(corner: Corner) -> @location(0) vec4<f32> {
    return corner.tint * textureSample(brushes, brush_sampler, corner.coordinates, corner.brush);
}
