// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Draws strokes with brush textures, coarse layers first.
// source: Ramalhao (2010), 4.2.6.
// note: Drawn indirectly with `counts` as arguments over a background, blended as source + (1 - source alpha) * destination.
// note: Within a layer older strokes come first. The picture may be larger than what the ray caster wrote (4.1.7).
// binding frame: the frame.
// binding style: the style.
// binding strokes: the strokes.
// binding order: numbers of strokes, in the order that they are drawn in.
// binding brushes: brushes, premultiplied linear RGB that the stroke's colour tints, and opacity; what is not finite counts as 0.
// binding brush_sampler: linear, with mipmaps.

#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::painterly::stroke::{Stroke, StrokeFrame, StrokeStyle, of_layer}
#import airlight::painterly::stroke_expand::{
    quad_corner, corner_position, clip_from_picture, brush_coordinates, brush_layer, tint_factor
}

@group(#{GROUP}) @binding(0) var<uniform> frame: StrokeFrame;
@group(#{GROUP}) @binding(1) var<uniform> style: StrokeStyle;
@group(#{GROUP}) @binding(2) var<storage, read> strokes: array<Stroke>;
@group(#{GROUP}) @binding(3) var<storage, read> order: array<u32>;
@group(#{GROUP}) @binding(4) var brushes: texture_2d_array<f32>;
@group(#{GROUP}) @binding(5) var brush_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) coordinates: vec2<f32>,
    @location(1) @interpolate(flat) brush: u32,
    @location(2) @interpolate(flat) tint: vec4<f32>,
}

@vertex
fn vertex_stroke(@builtin(vertex_index) vertex: u32) -> Corner {
    let number = order[min(vertex / 6u, arrayLength(&order) - 1u)];
    let stroke = strokes[min(number, arrayLength(&strokes) - 1u)];
    let corner = quad_corner(vertex % 6u);
    let place = corner_position(stroke, corner, frame.picture_size);
    let color = stroke.color * tint_factor(stroke.hash, style.color_variation);
    return Corner(
        clip_from_picture(place, frame.picture_size),
        brush_coordinates(corner, stroke.hash),
        brush_layer(of_layer(style.brush, stroke.layer), stroke.hash, textureNumLayers(brushes)),
        vec4<f32>(min(color, vec3<f32>(65504.0)), 1.0) * stroke.opacity
    );
}

@fragment
fn fragment_stroke(corner: Corner) -> @location(0) vec4<f32> {
    let brush = textureSample(brushes, brush_sampler, corner.coordinates, corner.brush);
    return corner.tint * vec4<f32>(finite_or_rgb(brush.rgb, 0.0), finite_or(brush.a, 0.0));
}
