// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/underpaint, permutation default
// summary: What lies under strokes: a canvas of one colour, and on it the surface as rays saw it, at any size.
// source: none; the thesis shows strokes on white, and names no ground.
// note: Rays may be fewer than pixels: between them colours are filtered, premultiplied, so that edges do not darken.
// binding canvas: colour of the canvas, and how much of the surface is put on it.
// binding color: premultiplied linear RGB, and 1 where the surface is seen, at any size.
// binding linear_sampler: linear, clamped to the edge.

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::core::picture ----
// summary: One triangle over the whole picture, for passes in fragment form.
// source: the usual full-screen triangle.

/// Clip-space position of corner `index`, 0..2, of a triangle that covers the picture.
fn picture_corner(index: u32) -> vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

// ---- painterly/underpaint ----

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

@group(0) @binding(0) var<uniform> canvas: Canvas;
@group(0) @binding(1) var color: texture_2d<f32>;
@group(0) @binding(2) var linear_sampler: sampler;

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
