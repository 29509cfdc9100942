// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/resolve_depth, permutation farthest (FARTHEST)
// summary: A multisampled depth buffer to one depth a pixel, such that light scattered into the pixel is the mean of its samples'.
// source: Beer-Lambert law, thesis 2.4.2; see core/resolve_depth.
// note: A pixel whose samples agree keeps their depth, bit for bit.
// definition FARTHEST: depth of the farthest sample.
// binding camera: the camera, of any kind; its viewport is that of the buffer.
// binding samples: the depth buffer, multisampled; non-finite values count as far.
// binding resolved: out, r32float: depth 0..1 in the camera's convention.

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

// ---- core/resolve_depth ----

struct ResolveDepthParameters {
    /// Extinction in 1/m, not negative; zero for the depth of the mean distance.
    extinction: f32,
    /// Distances count up to here, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(2) var samples: texture_multisampled_2d<f32>;
@group(0) @binding(3) var resolved: texture_storage_2d<r32float, write>;

/// Depth of one sample, 0..1.
fn sample_depth(pixel: vec2<u32>, index: u32) -> f32 {
    let value = textureLoad(samples, pixel, i32(index)).x;
    return clamp(finite_or(value, camera.far_depth), 0.0, 1.0);
}

@compute @workgroup_size(16, 8)
fn resolve_depth(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(resolved)) {
        return;
    }
    let count = textureNumSamples(samples);
    var least = 1.0;
    var greatest = 0.0;
    for (var index = 0u; index < count; index++) {
        let value = sample_depth(id.xy, index);
        least = min(least, value);
        greatest = max(greatest, value);
    }
    let forward = camera.far_depth > camera.near_depth;
    let nearest_depth = select(greatest, least, forward);
    let farthest_depth = select(least, greatest, forward);
    let depth = farthest_depth;
    textureStore(resolved, id.xy, vec4<f32>(depth, 0.0, 0.0, 0.0));
}
