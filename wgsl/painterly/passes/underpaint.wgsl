// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What lies under strokes: a canvas of one colour, and on it the surface as rays saw it, at any size.
// source: none; the thesis shows strokes on white, and names no ground.
// note: Rays may be fewer than pixels: between them colours are filtered, premultiplied, so that edges do not darken.
// binding canvas: colour of the canvas, and how much of the surface is put on it.
// binding color: premultiplied linear RGB, and 1 where the surface is seen, at any size.
// binding linear_sampler: linear, clamped to the edge.

#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::core::picture::picture_corner

/// What strokes are put on. 32 bytes.
struct Canvas {
    /// Linear RGB.
    color: vec3<f32>,
    /// How much of the surface is painted under strokes, 0..1.
    underpainting: f32,
    /// Columns and rows of the picture.
    picture_size: vec2<f32>,
    reserved: vec2<f32>,
}

@group(#{GROUP}) @binding(0) var<uniform> canvas: Canvas;
@group(#{GROUP}) @binding(1) var color: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var linear_sampler: sampler;

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_underpaint(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let texel = textureSampleLevel(color, linear_sampler, position.xy / max(canvas.picture_size, vec2<f32>(1.0)), 0.0);
    let covered = clamp(finite_or(texel.a, 0.0), 0.0, 1.0);
    let seen = finite_or_rgb(texel.rgb, 0.0) + (1.0 - covered) * canvas.color;
    let ground = mix(canvas.color, seen, clamp(canvas.underpainting, 0.0, 1.0));
    return vec4<f32>(clamp(ground, vec3<f32>(0.0), vec3<f32>(65504.0)), 1.0);
}
