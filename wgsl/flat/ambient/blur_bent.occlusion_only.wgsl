// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: ambient/blur_bent, permutation occlusion_only (OCCLUSION_ONLY)
// summary: Blurs bent normals and openness along one axis, not over edges of depth and normals.
// source: thesis 3.4; Laine et al., "Incremental instant radiosity" (2007) for the weights.
// note: Dispatch over the picture along x, then along y from what came out: with as many pixels as the sampling pattern is wide every pixel's set
// note: counts once. What is blurred is how bent normals differ from normals (thesis Fig. 3.6), so that details of normals stay; an open
// note: surface has a mean direction of half its normal.
// definition OCCLUSION_ONLY: only openness.
// binding camera: the camera; its viewport is the size of `depth`.
// binding blur: along which axis and how far.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding bent: of ambient/occlude.
// binding blurred: out, like `bent`.

// ---- airlight::ambient::bent_blur ----
// summary: A blur that stops at edges, of how mean directions differ from half their normals: what neighbours count, and the way back.
// source: thesis 3.4; Laine et al., "Incremental instant radiosity" (2007).

/// Most pixels that are averaged.
const MOST_TAPS: u32 = 16u;

/// A blur along an axis. 32 bytes.
struct BentBlur {
    /// (1, 0) or (0, 1).
    axis: vec2<u32>,
    /// Pixels that are averaged, 1..MOST_TAPS: the side of the sampling pattern.
    taps: u32,
    /// Metres from the tangent plane at which a neighbour counts no more, above 0.
    reach: f32,
    /// Cosine between normals at which a neighbour counts no more, below 1.
    least_cosine: f32,
    reserved_a: f32,
    reserved_b: f32,
    reserved_c: f32,
}

/// Weight 0..1 of a neighbour; 1 of a pixel itself.
fn edge_weight(blur: BentBlur, place: vec3<f32>, normal: vec3<f32>, other: vec3<f32>, other_normal: vec3<f32>) -> f32 {
    let away = max(abs(dot(other - place, normal)), abs(dot(other - place, other_normal)));
    let near = clamp(1.0 - away / max(blur.reach, 1e-20), 0.0, 1.0);
    // Of the difference of the normals, so that normals of any length are alike to themselves.
    let unlike = 0.5 * dot(normal - other_normal, normal - other_normal);
    let alike = clamp(1.0 - unlike / max(1.0 - blur.least_cosine, 1e-6), 0.0, 1.0);
    return near * alike;
}

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

/// Normalised device coordinates of a position in pixels: (0, 0) is the top left corner of the picture.
fn ndc_from_pixel(camera: Camera, pixel: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(2.0, -2.0) * pixel / camera.viewport + vec2<f32>(-1.0, 1.0);
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

// ---- ambient/blur_bent ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> blur: BentBlur;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normals: texture_2d<f32>;
@group(0) @binding(4) var bent: texture_2d<f32>;
@group(0) @binding(5) var blurred: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn blur_bent(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = vec2<i32>(textureDimensions(depth));
    let pixel = vec2<i32>(id.xy);
    if any(id.xy >= textureDimensions(blurred)) {
        return;
    }
    let own = min(pixel, size - 1);
    let last_normal = vec2<i32>(textureDimensions(normals)) - 1;
    let here = seen_surface(camera, own, textureLoad(depth, own, 0).x);
    let normal = seen_normal(textureLoad(normals, min(own, last_normal), 0).xyz, vec3<f32>(0.0));
    var sum = vec4<f32>(0.0);
    var weights = 0.0;
    let taps = min(blur.taps, MOST_TAPS);
    for (var tap = 0u; tap < taps; tap++) {
        let at = own + vec2<i32>(blur.axis) * (i32(tap) - i32(taps / 2u));
        let inside = all(at >= vec2<i32>(0)) && all(at < size);
        let other = clamp(at, vec2<i32>(0), size - 1);
        let there = seen_surface(camera, other, textureLoad(depth, other, 0).x);
        let facing = seen_normal(textureLoad(normals, min(other, last_normal), 0).xyz, vec3<f32>(0.0));
        let counts = inside && here.known && there.known;
        let weight = select(0.0, edge_weight(blur, here.place, normal, there.place, facing), counts);
        sum.w += weight * textureLoad(bent, other, 0).x;
        weights += weight;
    }
    // A pixel always counts itself, but where nothing is seen.
    let nothing = weights <= 0.0;
    let mean = sum / select(weights, 1.0, nothing);
    textureStore(blurred, id.xy, vec4<f32>(select(mean.w, 1.0, nothing), 0.0, 0.0, 1.0));
}
