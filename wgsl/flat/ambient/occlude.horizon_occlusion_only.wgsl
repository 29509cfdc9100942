// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: ambient/occlude, permutation horizon_occlusion_only (HORIZON OCCLUSION_ONLY)
// summary: Openness and bent normals of what is seen, from its depth and normals alone.
// source: thesis 3.2 to 3.4, Eq. 3.2 to 3.5, Listing 3.1; see ambient/occluders for the other samplers.
// note: Dispatch over the picture. A direction is marched in a few steps and is blocked where a place on it lies behind what is seen there, by less
// note: than its thickness; only what rises over the tangent plane blocks, so that flat surfaces do not block themselves.
// note: What is seen too far in front says nothing: Listing 3.1's outlier. Where a march leaves the picture it goes on freely, so that openness and
// note: mean directions are of the same visibility, by which irradiance under even light is exact (ambient/bent_cone).
// note: Pixels without geometry, with a depth of the far plane or none that is finite, are open with a mean direction of 0. A normal of length 0 or
// note: none that is finite counts as one towards the viewer.
// note: For a picture of half the resolution give depth, normals and the camera's viewport of that size; ambient/upsample_bent makes it whole.
// definition HORIZON: directions across the normal are marched to the greatest elevation (HBAO); what is above is open.
// definition OCCLUSION_ONLY: only openness, without bent normals.
// binding camera: the camera; its viewport is the size of `depth`.
// binding settings: how occlusion is looked for.
// binding depth: depth buffer, a depth format or r32float, as the camera has it.
// binding normals: unit normals in the world, any float format.
// binding bent: out, rgba16float: mean direction in the world, whose length is about 1/2 where all is open, and in alpha openness 0..1; with OCCLUSION_ONLY r32float, openness.

// ---- airlight::ambient::bent_cone ----
// summary: The mean direction in which nothing is in the way, and the cone that it stands for, beside any sampled occlusion.
// source: thesis 3.3.1 and 3.3.2, Eq. 3.2 to 3.6, Listing 3.1.

/// Directions so far.
struct BentSum {
    /// Sum of unit vectors, each times its visibility.
    direction: vec3<f32>,
    /// Sum of the visibility of all.
    visible: f32,
    /// Sum of the visibility of those that are known.
    open: f32,
    /// How much is known: the number of directions, or their weight.
    known: f32,
}

/// No direction.
fn bent_nothing() -> BentSum {
    return BentSum(vec3<f32>(0.0), 0.0, 0.0, 0.0);
}

/// Adds several directions at once. `mean`: the sum of unit vectors that are visible; `visible` of them and `all`, their number or weight.
fn bent_add_all(sum: BentSum, mean: vec3<f32>, visible: f32, all: f32) -> BentSum {
    return BentSum(sum.direction + mean, sum.visible + visible, sum.open + visible, sum.known + all);
}

/// The visible part of the directions that are known, 0..1: the thesis's AO. 1 where none is.
fn openness(sum: BentSum) -> f32 {
    return select(clamp(sum.open / max(sum.known, 1e-20), 0.0, 1.0), 1.0, sum.known <= 0.0);
}

// ---- airlight::ambient::occluders ----
// summary: Whether what is seen at a pixel is in a surface point's way, and how much.
// source: thesis Eq. 3.4 and Listing 3.1; Bavoil et al., "Image-space horizon-based ambient occlusion" (2008); Therrien et al., "Screen space indirect lighting with visibility bitmask" (2023).

/// Most directions a pixel.
const MOST_SAMPLES: u32 = 256u;
/// Most steps along each.
const MOST_STEPS: u32 = 256u;

/// How occlusion is looked for. 32 bytes.
struct OcclusionSettings {
    /// Occluders count up to this distance, metres, above 0.
    radius: f32,
    /// How thick what is seen is taken to be, metres, above 0: what lies further in front of a place does not say whether the place is free.
    thickness: f32,
    /// Sine of the elevation over the tangent plane from which on something occludes: 0..1.
    bias: f32,
    /// Directions a pixel, 1..MOST_SAMPLES; slices of the hemisphere with HORIZON and BITMASK.
    samples: u32,
    /// Steps along each, 1..MOST_STEPS.
    steps: u32,
    /// Side of the square of pixels that have different directions, from 1 up.
    side: u32,
    /// Frame of a temporal pattern; 0 for a static one.
    frame: u32,
    reserved_a: u32,
}

/// How much an occluder at a distance counts, 0..1.
fn occluder_weight(metres: f32, radius: f32) -> f32 {
    let part = metres / max(radius, 1e-20);
    let left = max(1.0 - part * part, 0.0);
    return left * left;
}

/// Sine of the elevation of a point over a surface; -1 for the surface point itself.
fn elevation_sine(towards: vec3<f32>, normal: vec3<f32>) -> f32 {
    let size = length(towards);
    return select(dot(towards, normal) / max(size, 1e-20), -1.0, size <= 0.0);
}

/// What is open of a slice of the hemisphere above a horizon. `mean`: sum of its directions, `open`: their share of the slice.
struct OpenSlice {
    /// Integral of unit vectors over the solid angle, of the whole slice's 1.
    mean: vec3<f32>,
    /// Share of the solid angle, 0..1.
    open: f32,
}

/// The slice between the normal and the unit vector `tangent` at right angles to it, open above the elevation whose sine is given, 0..1.
/// Solid angle falls off with the cosine of the elevation e: integrals of cos e, cos^2 e and sin e cos e from the horizon to 90 degrees.
fn open_slice(normal: vec3<f32>, tangent: vec3<f32>, horizon_sine: f32) -> OpenSlice {
    let sine = clamp(horizon_sine, 0.0, 1.0);
    let cosine = sqrt(1.0 - sine * sine);
    let along = 0.5 * (atan2(cosine, sine) - sine * cosine);
    return OpenSlice(tangent * along + normal * (0.5 * cosine * cosine), 1.0 - sine);
}

// ---- airlight::ambient::sample_pattern ----
// summary: Directions about a normal, other ones for each pixel of a repeated square.
// source: Keller and Heidrich, "Interleaved sampling" (2001), as in thesis 3.4; Roberts, the R2 sequence (2018).

/// One over the plastic number, and its square: steps of the R2 sequence, by 2^32.
const FIRST_STEP: u32 = 3242174889u;
const SECOND_STEP: u32 = 2447445414u;
/// One over the golden ratio by 2^32: how much a frame shifts.
const GOLDEN_STEP: u32 = 2654435769u;

/// Where a pixel's set is shifted to.
struct SampleShift {
    /// Of both coordinates of directions, [0, 1).
    directions: vec2<f32>,
    /// Of steps along each, [0, 1).
    steps: f32,
}

/// A whole number's bits as a fraction, [0, 1).
fn fraction_of(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0 / 16777216.0);
}

/// The shift of a pixel in a square of `side` pixels, from 1 up.
fn sample_shift(pixel: vec2<u32>, side: u32, frame: u32) -> SampleShift {
    let within = pixel % max(side, 1u);
    // Odd multiples scatter neighbours over the sequence.
    let index = within.y * side + within.x;
    // From the middle on: a pattern of one pixel has its set in the middle of its strata.
    let turn = 2147483648u + frame * GOLDEN_STEP;
    return SampleShift(
        vec2<f32>(fraction_of(index * FIRST_STEP + turn), fraction_of(index * SECOND_STEP + turn)),
        fraction_of((within.x * 5u + within.y * 3u) * GOLDEN_STEP + turn)
    );
}

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

/// Normalised device coordinates of a position in pixels: (0, 0) is the top left corner of the picture.
fn ndc_from_pixel(camera: Camera, pixel: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(2.0, -2.0) * pixel / camera.viewport + vec2<f32>(-1.0, 1.0);
}

/// Vector from `point`, metres in the world, TOWARDS the viewer, of any length: to the eye, or against the parallel
/// rays of an orthographic camera.
fn towards_viewer(camera: Camera, point: vec3<f32>) -> vec3<f32> {
    let parallel = camera.world_from_clip[2].xyz * (camera.near_depth - camera.far_depth);
    return select(camera.eye - point, parallel, camera.projection == ORTHOGRAPHIC);
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

/// A place of the world in pixels.
struct SeenPlace {
    /// From the top left corner of the picture.
    pixel: vec2<f32>,
    /// Whether it is in the picture, and before the eye.
    inside: bool,
}

/// Where a place of the world, metres, is in the picture.
fn seen_place(camera: Camera, place: vec3<f32>) -> SeenPlace {
    let clip = camera.clip_from_world * vec4<f32>(place, 1.0);
    let before = clip.w > 1e-20;
    let ndc = clip.xy / select(1.0, clip.w, before);
    let inside = before && all(abs(ndc) < vec2<f32>(1.0));
    return SeenPlace(select(vec2<f32>(0.0), (ndc * vec2<f32>(0.5, -0.5) + 0.5) * camera.viewport, inside), inside);
}

/// The unit normal that a texel holds; `otherwise` where it holds none of any length, or what is not finite.
fn seen_normal(texel: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    // So that squares do not overflow.
    let bounded = clamp(finite_or_rgb(texel, 0.0), vec3<f32>(-1e6), vec3<f32>(1e6));
    let size = length(bounded);
    return select(otherwise, bounded / max(size, 1e-20), size > 1e-6);
}

// ---- airlight::core::tangent_frame ----
// summary: Directions at right angles to a normal.
// source: Duff et al., "Building an orthonormal basis, revisited" (2017).

/// Columns: three unit vectors at right angles, the last of which is `normal`, unit.
fn tangent_frame(normal: vec3<f32>) -> mat3x3<f32> {
    let side = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (side + normal.z);
    let b = normal.x * normal.y * a;
    return mat3x3<f32>(
        vec3<f32>(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x),
        vec3<f32>(b, side + normal.y * normal.y * a, -normal.y),
        normal,
    );
}

// ---- ambient/occlude ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> settings: OcclusionSettings;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normals: texture_2d<f32>;
@group(0) @binding(4) var bent: texture_storage_2d<r32float, write>;

/// What is seen at a pixel of the picture.
fn seen_at(pixel: vec2<i32>) -> SeenSurface {
    let at = clamp(pixel, vec2<i32>(0), vec2<i32>(textureDimensions(depth)) - 1);
    return seen_surface(camera, at, textureLoad(depth, at, 0).x);
}

/// Adds the slice of a direction across the normal, open above its horizon.
fn add_sample(sum: BentSum, index: u32, place: vec3<f32>, normal: vec3<f32>, viewer: vec3<f32>, shift: SampleShift) -> BentSum {
    let turn = 6.2831855 * (f32(index) + shift.directions.x) / f32(max(settings.samples, 1u));
    let tangent = tangent_frame(normal) * vec3<f32>(cos(turn), sin(turn), 0.0);
    var horizon = 0.0;
    for (var step = 0u; step < min(settings.steps, MOST_STEPS); step++) {
        let part = (f32(step) + shift.steps) / f32(settings.steps);
        let at = seen_place(camera, place + tangent * (settings.radius * part * part));
        let seen = seen_at(vec2<i32>(floor(at.pixel)));
        let towards = seen.place - place;
        let sine = elevation_sine(towards, normal);
        let rises = at.inside && seen.known && sine > settings.bias;
        horizon = max(horizon, select(0.0, sine * occluder_weight(length(towards), settings.radius), rises));
    }
    let slice = open_slice(normal, tangent, horizon);
    return bent_add_all(sum, slice.mean, slice.open, 1.0);
}

@compute @workgroup_size(16, 8)
fn occlude(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(bent)) {
        return;
    }
    let seen = seen_at(vec2<i32>(id.xy));
    let towards = towards_viewer(camera, seen.place);
    let viewer = towards / max(length(towards), 1e-20);
    let texel = textureLoad(normals, min(id.xy, textureDimensions(normals) - 1u), 0).xyz;
    let normal = seen_normal(texel, viewer);
    let shift = sample_shift(id.xy, settings.side, settings.frame);
    var sum = bent_nothing();
    let samples = select(0u, min(settings.samples, MOST_SAMPLES), seen.known);
    for (var index = 0u; index < samples; index++) {
        sum = add_sample(sum, index, seen.place, normal, viewer, shift);
    }
    textureStore(bent, id.xy, vec4<f32>(openness(sum), 0.0, 0.0, 1.0));
}
