// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/resolve_depth, permutation default
// summary: A multisampled depth buffer to one depth a pixel, such that light scattered into the pixel is the mean of its samples'.
// source: Beer-Lambert law, thesis 2.4.2; see core/resolve_depth.
// note: A pixel whose samples agree keeps their depth, bit for bit.
// binding camera: the camera, of any kind; its viewport is that of the buffer.
// binding parameters: extinction and distance limit of the medium; without NEAREST and FARTHEST only.
// binding samples: the depth buffer, multisampled; non-finite values count as far.
// binding resolved: out, r32float: depth 0..1 in the camera's convention.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Perspective projection: all view rays leave the eye.
const PERSPECTIVE: u32 = 0u;
/// Orthographic projection: view rays are parallel and leave the near plane.
const ORTHOGRAPHIC: u32 = 1u;

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

/// A view ray: world-space origin in metres, unit direction.
struct Ray {
    /// Where it starts in the world, metres.
    origin: vec3<f32>,
    /// Unit vector, away from the eye.
    direction: vec3<f32>,
}

/// Normalised device coordinates of a position in pixels: (0, 0) is the top left corner of the picture.
fn ndc_from_pixel(camera: Camera, pixel: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(2.0, -2.0) * pixel / camera.viewport + vec2<f32>(-1.0, 1.0);
}

/// The view ray through `ndc`, of any camera.
fn view_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    // Values, not branches: some drivers compile a shader anew for every value of a uniform that a branch depends on.
    let parallel = camera.projection == ORTHOGRAPHIC;
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let near = camera.world_from_clip * vec4<f32>(ndc, camera.near_depth, 1.0);
    let origin = select(camera.eye, near.xyz / select(1.0, near.w, parallel), parallel);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(origin, normalize(far.xyz - select(camera.eye * far.w, near.xyz, parallel)));
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

// ---- airlight::core::ray_depth ----
// summary: Distance along one view ray from depth-buffer values and back, for any camera, in a few operations each.
// source: homogeneous unprojection: on a view ray numerator and denominator of the distance are affine in the depth.

/// Distance over depth on one view ray: (along + along_slope x) / (w + w_slope x), x = depth - far_depth.
struct RayDepth {
    /// Homogeneous distance at the far plane, metres times w.
    along: f32,
    /// Its change per depth; 0 for a perspective camera.
    along_slope: f32,
    /// Homogeneous w at the far plane; 0 where that is at infinity.
    w: f32,
    /// Its change per depth; 0 for an orthographic camera.
    w_slope: f32,
    /// Clip depth of the far plane.
    far_depth: f32,
    /// Clip depth of the near plane.
    near_depth: f32,
}

/// What turns depths into distances on `ray`, the view ray through `ndc`.
fn ray_depth(camera: Camera, ray: Ray, ndc: vec2<f32>) -> RayDepth {
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let column = camera.world_from_clip[2];
    let along = dot(far.xyz - ray.origin * far.w, ray.direction);
    let slope = dot(column.xyz - ray.origin * column.w, ray.direction);
    // From the eye the product is the same at every depth: what is left of its slope is rounding.
    let perspective = camera.projection == PERSPECTIVE;
    return RayDepth(along, select(slope, 0.0, perspective), far.w, column.w, camera.far_depth, camera.near_depth);
}

/// Distance in metres along the ray at `depth`, 0..1; at most `limit`, which also stands for infinity.
fn distance_on_ray(ray: RayDepth, depth: f32, limit: f32) -> f32 {
    let beyond_far = depth - ray.far_depth;
    let along = ray.along + ray.along_slope * beyond_far;
    let w = ray.w + ray.w_slope * beyond_far;
    let beyond = along >= limit * w;
    return select(max(along / select(w, 1.0, beyond), 0.0), limit, beyond);
}

/// Depth 0..1 of the point at `distance` metres along the ray, clamped to the near and the far plane.
fn depth_on_ray(ray: RayDepth, distance: f32) -> f32 {
    let slope = ray.along_slope - distance * ray.w_slope;
    let change = distance * ray.w - ray.along;
    // Division by zero only at the eye, which lies before the near plane.
    let depth = ray.far_depth + change / select(slope, 1.0, slope == 0.0);
    return select(clamp(depth, 0.0, 1.0), ray.near_depth, slope == 0.0);
}

// ---- airlight::core::resolve_depth ----
// summary: One distance for the samples of a pixel: that at which the transmittance is the mean of theirs.
// source: Beer-Lambert law, thesis 2.4.2; light scattered into a lit ray is affine in transmittance (thesis Eq. 4.2).

/// Optical spread of the samples below which the mean of distances stands in for that of transmittances.
const LEAST_SPREAD: f32 = 1e-3;

/// The extinction in 1/m to average with for samples between the distances `nearest` and `farthest` in
/// metres: `extinction`, but at least so much that the samples differ; the mean distance is then off by
/// less than 2e-4 of their spread.
fn averaging_extinction(extinction: f32, nearest: f32, farthest: f32) -> f32 {
    return max(extinction, LEAST_SPREAD / max(farthest - nearest, 1e-6));
}

/// Distance in metres at which the transmittance from `nearest` on is `mean_transmittance`, 0..1, at the
/// `extinction` that `averaging_extinction` gave.
fn distance_of_transmittance(nearest: f32, extinction: f32, mean_transmittance: f32) -> f32 {
    return nearest - log(clamp(mean_transmittance, 1e-30, 1.0)) / extinction;
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
@group(0) @binding(1) var<uniform> parameters: ResolveDepthParameters;
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
    let ndc = ndc_from_pixel(camera, vec2<f32>(id.xy) + 0.5);
    let ray = ray_depth(camera, view_ray(camera, ndc), ndc);
    let nearest = distance_on_ray(ray, nearest_depth, parameters.distance_limit);
    let farthest = distance_on_ray(ray, farthest_depth, parameters.distance_limit);
    let extinction = averaging_extinction(parameters.extinction, nearest, farthest);
    var transmittance = 0.0;
    for (var index = 0u; index < count; index++) {
        let distance = distance_on_ray(ray, sample_depth(id.xy, index), parameters.distance_limit);
        transmittance += exp(-extinction * (distance - nearest));
    }
    let mean = distance_of_transmittance(nearest, extinction, transmittance / f32(count));
    let depth = select(depth_on_ray(ray, mean), least, least == greatest);
    textureStore(resolved, id.xy, vec4<f32>(depth, 0.0, 0.0, 0.0));
}
