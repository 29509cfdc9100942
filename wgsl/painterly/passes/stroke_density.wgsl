// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Density of strokes: their quads, added up, a layer of strokes a channel.
// source: Ramalhao (2010), 4.2.4.
// note: Drawn indirectly with `density_draw` of `counts` as arguments, a triangle around each quad, since two small ones cost more, into an rgba16float target that is cleared to 0, blended as source +
// note: destination, for core WebGPU blends no 32-bit floats. A sum of n strokes is rounded n times by at most 2^-10 of it, for
// note: adapters may round half floats to nearest or towards 0.
// note: The target may be a fraction of the picture: density changes over the width of a stroke.
// binding frame: the frame.
// binding style: the style.
// binding strokes: the strokes, in any order.
// binding brushes: brushes, premultiplied; opacity in alpha.
// binding brush_sampler: linear, with mipmaps.

#import airlight::core::finite::finite_or
#import airlight::painterly::stroke::{Stroke, StrokeFrame, StrokeStyle, STROKE_GONE, of_layer, target_opacity}
#import airlight::painterly::stroke_density::density_of_stroke
#import airlight::painterly::stroke_expand::{
    corner_position, clip_from_picture, brush_coordinates, brush_layer
}

@group(#{GROUP}) @binding(0) var<uniform> frame: StrokeFrame;
@group(#{GROUP}) @binding(1) var<uniform> style: StrokeStyle;
@group(#{GROUP}) @binding(2) var<storage, read> strokes: array<Stroke>;
@group(#{GROUP}) @binding(3) var brushes: texture_2d_array<f32>;
@group(#{GROUP}) @binding(4) var brush_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) coordinates: vec2<f32>,
    @location(1) @interpolate(flat) brush: u32,
    @location(2) @interpolate(flat) density: vec4<f32>,
}

@vertex
fn vertex_density(@builtin(vertex_index) vertex: u32) -> Corner {
    let stroke = strokes[min(vertex / 3u, arrayLength(&strokes) - 1u)];
    // The corner 0 of the quad, and those that lie twice as far from it along its sides.
    let corner = vertex % 3u;
    let near = corner_position(stroke, 0u, frame.picture_size);
    let place = near + 2.0 * (corner_position(stroke, corner, frame.picture_size) - near);
    let first = brush_coordinates(0u, stroke.hash);
    let fades_to = target_opacity(style, stroke.layer, stroke.state);
    let density = density_of_stroke(style.density_unit, stroke.opacity, fades_to, style.anticipation, 1.0);
    // What adds nothing has no area, and lies beside the picture.
    let counts = density > 0.0 && stroke.state != STROKE_GONE;
    let channel = vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(stroke.layer);
    return Corner(
        select(vec4<f32>(-2.0, -2.0, 0.5, 1.0), clip_from_picture(place, frame.picture_size), counts),
        first + 2.0 * (brush_coordinates(corner, stroke.hash) - first),
        brush_layer(of_layer(style.brush, stroke.layer), stroke.hash, textureNumLayers(brushes)),
        select(vec4<f32>(0.0), vec4<f32>(density), channel)
    );
}

@fragment
fn fragment_density(corner: Corner) -> @location(0) vec4<f32> {
    let opacity = finite_or(textureSample(brushes, brush_sampler, corner.coordinates, corner.brush).a, 0.0);
    let inside = all(corner.coordinates >= vec2<f32>(0.0)) && all(corner.coordinates <= vec2<f32>(1.0));
    return corner.density * select(0.0, opacity, inside);
}
