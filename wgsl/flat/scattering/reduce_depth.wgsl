// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/reduce_depth, permutation default
// summary: Depth of the pixels that a reduced picture evaluates, for passes that then run at that size with its camera.
// source: joint bilateral upsampling, Kopf, Cohen, Lischinski and Uyttendaele (2007); see scattering/upsample.
// note: The camera that goes with it is the host's `Camera::reduced`: its pixel centres are those of the evaluated pixels.
// binding camera: the camera of the full picture, any.
// binding reduction: the factor.
// binding depth: depth buffer of the full picture, a depth format or r32float; non-finite values count as far.
// binding reduced_depth: out, r32float: depth 0..1 of the evaluated pixels; ceil(size / factor) texels a side.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// A camera, as an engine hands it over. 160 bytes.
struct Camera {
    /// View-projection matrix, world to clip.
    clip_from_world: mat4x4<f32>,
    /// Its inverse, clip to world.
    world_from_clip: mat4x4<f32>,
    /// Position of the eye in the world, metres; unused by an orthographic camera.
    eye: vec3<f32>,
    /// Clip depth of the near plane: 0 forward, 1 reversed.
    near_depth: f32,
    /// Width and height of the picture in pixels.
    viewport: vec2<f32>,
    /// Clip depth of the far plane: 1 forward, 0 reversed.
    far_depth: f32,
    /// PERSPECTIVE or ORTHOGRAPHIC.
    projection: u32,
}

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

// ---- airlight::scattering::upsample ----
// summary: Scattered light at a fraction of the resolution: which pixels are evaluated, and how the others are found from them.
// source: joint bilateral upsampling, Kopf, Cohen, Lischinski and Uyttendaele (2007), with distance along the ray as guide.

/// How the picture is reduced. 16 bytes.
struct Reduction {
    /// Pixels of the full picture from one evaluated pixel to the next, in x and in y: 2 or 4.
    factor: u32,
    /// Relative difference of distance at which a neighbour counts half, positive.
    tolerance: f32,
    reserved_a: u32,
    reserved_b: u32,
}

/// The pixel of the full picture that a pixel of the low resolution evaluates.
fn evaluated_pixel(reduction: Reduction, pixel: vec2<u32>) -> vec2<u32> {
    return pixel * max(reduction.factor, 1u);
}

// ---- scattering/reduce_depth ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> reduction: Reduction;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var reduced_depth: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn reduce_depth(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(reduced_depth)) {
        let source = min(evaluated_pixel(reduction, id.xy), textureDimensions(depth) - 1u);
        let value = clamp(finite_or(textureLoad(depth, source, 0).x, camera.far_depth), 0.0, 1.0);
        textureStore(reduced_depth, id.xy, vec4<f32>(value, 0.0, 0.0, 0.0));
    }
}
