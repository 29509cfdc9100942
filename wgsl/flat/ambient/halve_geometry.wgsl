// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: ambient/halve_geometry, permutation default
// summary: Depth and normals of half the size: of each four pixels the nearest and the farthest in turn.
// source: none; a mean of depths lies on no surface, so one of the four is taken with its normal.
// note: Dispatch over the halved picture, whose sides are half as long, rounded up. Near and far alternate like the squares of a chessboard,
// note: so that either side of every edge is found within two pixels.
// note: A halved pixel's middle is the corner that the four share: cameras take half the viewport. Its depth is that of the chosen pixel's tangent
// note: plane there, or else flat floors would be rough.
// binding camera: the camera of the whole picture: which depths are near.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding halved_depth: out, r32float.
// binding halved_normals: out, rgba16float.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

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

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::ambient::seen_surface ----
// summary: Surface points of a picture from its depth, and pixels from places.
// source: homogeneous unprojection.

/// What is seen at a pixel.
struct SeenSurface {
    /// Where it is in the world, metres.
    place: vec3<f32>,
    /// Whether there is anything.
    known: bool,
}

/// What is seen at a pixel with this depth.
fn seen_surface(camera: Camera, pixel: vec2<i32>, depth: f32) -> SeenSurface {
    let found = finite_or(depth, camera.far_depth);
    let point = camera.world_from_clip * vec4<f32>(ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5), found, 1.0);
    let known = found != camera.far_depth && abs(point.w) > 1e-20;
    return SeenSurface(point.xyz / select(1.0, point.w, known), known);
}

/// The unit normal that a texel holds; `otherwise` where it holds none of any length, or what is not finite.
fn seen_normal(texel: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    // So that squares do not overflow.
    let bounded = clamp(finite_or_rgb(texel, 0.0), vec3<f32>(-1e6), vec3<f32>(1e6));
    let size = length(bounded);
    return select(otherwise, bounded / max(size, 1e-20), size > 1e-6);
}

// ---- ambient/halve_geometry ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var depth: texture_2d<f32>;
@group(0) @binding(2) var normals: texture_2d<f32>;
@group(0) @binding(3) var halved_depth: texture_storage_2d<r32float, write>;
@group(0) @binding(4) var halved_normals: texture_storage_2d<rgba16float, write>;

/// Steepest slope of a tangent plane that is followed: cosine between the view ray and the normal.
const GRAZING: f32 = 0.05;

/// Depth of a pixel's tangent plane at a place of the picture in pixels; its own where that is nearly seen from the side.
fn depth_beside(pixel: vec2<u32>, found: f32, normal: vec3<f32>, place: vec2<f32>) -> f32 {
    let seen = seen_surface(camera, vec2<i32>(pixel), found);
    let ray = view_ray(camera, ndc_from_pixel(camera, place));
    let facing = dot(ray.direction, normal);
    let safe = select(facing, -1.0, abs(facing) < GRAZING);
    let point = ray.origin + ray.direction * (dot(seen.place - ray.origin, normal) / safe);
    let clip = camera.clip_from_world * vec4<f32>(point, 1.0);
    let kept = !seen.known || abs(facing) < GRAZING || clip.w <= 1e-20;
    let moved = clamp(clip.z / select(clip.w, 1.0, kept), 0.0, 1.0);
    // A surface never becomes the far plane.
    return select(moved, found, kept || moved == camera.far_depth);
}

@compute @workgroup_size(16, 8)
fn halve_geometry(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(halved_depth)) {
        return;
    }
    let last = textureDimensions(depth) - 1u;
    let nearer = select(-1.0, 1.0, camera.near_depth > camera.far_depth);
    // Sign by which the greatest is looked for: the nearest on white squares.
    let sign = select(-nearer, nearer, ((id.x + id.y) & 1u) == 0u);
    var chosen = min(2u * id.xy, last);
    var best = finite_or(textureLoad(depth, chosen, 0).x, camera.far_depth);
    for (var index = 1u; index < 4u; index++) {
        let at = min(2u * id.xy + vec2<u32>(index & 1u, index >> 1u), last);
        let found = finite_or(textureLoad(depth, at, 0).x, camera.far_depth);
        let better = found * sign > best * sign;
        best = select(best, found, better);
        chosen = select(chosen, at, better);
    }
    let normal = finite_or_rgb(textureLoad(normals, min(chosen, textureDimensions(normals) - 1u), 0).xyz, 0.0);
    let moved = depth_beside(chosen, best, seen_normal(normal, vec3<f32>(0.0)), vec2<f32>(2u * id.xy) + 1.0);
    textureStore(halved_depth, id.xy, vec4<f32>(moved, 0.0, 0.0, 1.0));
    textureStore(halved_normals, id.xy, vec4<f32>(clamp(normal, vec3<f32>(-65504.0), vec3<f32>(65504.0)), 1.0));
}
