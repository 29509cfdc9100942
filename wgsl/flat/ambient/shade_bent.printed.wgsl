// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: ambient/shade_bent, permutation printed (PRINTED)
// summary: Diffuse surfaces in the light of an environment, by bent cones, bent normals or occlusion alone.
// source: thesis 3.3.3 and 3.3.4, Eq. 3.7 to 3.10.
// note: Dispatch over the picture. The light of a direction and an angle comes from ambient/convolve_cones, whose light is the same for every
// note: angle under light that is the same from everywhere. So brightness is 2 * openness * dot(mean direction, normal), which is what an even light
// note: sends exactly, whatever is open: thesis Eq. 3.10's factor with the mean direction at twice its length. As printed, openness * dot(bent
// note: normal, normal) is too dark by up to a half inside cones; PRINTED keeps it.
// definition PRINTED: brightness as printed.
// binding camera: the camera; its viewport is the size of `depth`.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding albedos: linear RGB albedo 0..1, any float format.
// binding bent: of ambient/occlude, ambient/blur_bent or ambient/upsample_bent; with OCCLUSION only its openness counts.
// binding lights: of ambient/convolve_cones.
// binding light_sampler: linear, clamped to the edge.
// binding picture: out, rgba16float: linear RGB radiance of surfaces; alpha is 1 where there is a surface, else 0.

// ---- airlight::ambient::bent_cone ----
// summary: The mean direction in which nothing is in the way, and the cone that it stands for, beside any sampled occlusion.
// source: thesis 3.3.1 and 3.3.2, Eq. 3.2 to 3.6, Listing 3.1.

/// Half of pi.
const QUARTER_TURN: f32 = 1.5707964;

/// Half-angle of the cone, radians 0..pi/2, as printed in Eq. 3.6. `mean_length`: of the mean direction; 0 has no cone.
fn cone_angle(mean_length: f32) -> f32 {
    let angle = (1.0 - clamp(2.0 * mean_length - 1.0, 0.0, 1.0)) * QUARTER_TURN;
    return select(angle, 0.0, mean_length <= 0.0);
}

/// A unit vector along a mean direction; the normal where there is none.
fn bent_normal(mean: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let size = length(mean);
    return select(normal, mean / max(size, 1e-20), size > 1e-6);
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

// ---- airlight::ambient::octahedral ----
// summary: Directions as texels of a square: an octahedron unfolded about the y axis, whose edges are middles of texels.
// source: Engelhardt and Dachsbacher, "Octahedron environment maps" (2008).

/// -1 for negative numbers, else 1.
fn signs(x: vec2<f32>) -> vec2<f32> {
    return select(vec2<f32>(-1.0), vec2<f32>(1.0), x >= vec2<f32>(0.0));
}

/// Where a direction of any length lies in the square without border, -1..1.
fn octahedral_place(direction: vec3<f32>) -> vec2<f32> {
    let greatest = max(max(abs(direction.x), abs(direction.y)), abs(direction.z));
    let finite = is_finite(direction.x) && is_finite(direction.y) && is_finite(direction.z);
    if !finite || greatest < 1e-30 {
        return vec2<f32>(0.0);
    }
    // Scaled first: the sum of three great numbers may be infinite.
    let scaled = direction / greatest;
    let projected = scaled / (abs(scaled.x) + abs(scaled.y) + abs(scaled.z));
    if projected.y >= 0.0 {
        return projected.xz;
    }
    return (1.0 - abs(projected.zx)) * signs(projected.xz);
}

/// Coordinates 0..1 in a map of `side` texels, at least 2, for a linear sampler.
fn octahedral_coordinates(direction: vec3<f32>, side: u32) -> vec2<f32> {
    let place = 0.5 * octahedral_place(direction) + 0.5;
    return (place * f32(side - 1u) + 0.5) / f32(side);
}

// ---- airlight::ambient::cone_light ----
// summary: Light from far away that comes in through a cone, looked up by the cone's direction and angle.
// source: O. Klehm, thesis, Section 3.3.3 and 3.3.4, Eq. 3.7 to 3.10.

/// Number of angles.
const CONE_LAYERS: u32 = 8u;
/// From one layer's angle to the next: 11.25 degrees in radians.
const CONE_ANGLE_STEP: f32 = 0.19634954;

/// L_c of Eq. 3.9: mean radiance in the cone of half angle `angle` (radians) about `direction` (any length), weighted by
/// the cosine to it; linear RGB. Linear between the layers' angles; below the first that of the first, above the last, and for
/// an angle that is not finite, that of the last. A direction without length counts as +y.
fn cone_radiance(cones: texture_2d_array<f32>, cone_sampler: sampler, direction: vec3<f32>, angle: f32) -> vec3<f32> {
    let last = f32(CONE_LAYERS - 1u);
    let layer = select(last, clamp(angle / CONE_ANGLE_STEP - 1.0, 0.0, last), is_finite(angle));
    let begin = min(u32(layer), CONE_LAYERS - 2u);
    let coordinates = octahedral_coordinates(direction, textureDimensions(cones).x);
    let narrow = textureSampleLevel(cones, cone_sampler, coordinates, begin, 0.0).rgb;
    let wide = textureSampleLevel(cones, cone_sampler, coordinates, begin + 1u, 0.0).rgb;
    return mix(narrow, wide, layer - f32(begin));
}

/// The factor <N, n> of Eq. 3.10, 0..1: cosine between the bent normal and the normal. Both are normalised here, for N comes
/// with the length of a mean; 0 where one has no length.
fn geometric_term(bent_normal: vec3<f32>, normal: vec3<f32>) -> f32 {
    let squares = dot(bent_normal, bent_normal) * dot(normal, normal);
    if !is_finite(squares) || squares < 1e-30 {
        return 0.0;
    }
    return clamp(dot(bent_normal, normal) * inverseSqrt(squares), 0.0, 1.0);
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

// ---- ambient/shade_bent ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var depth: texture_2d<f32>;
@group(0) @binding(2) var normals: texture_2d<f32>;
@group(0) @binding(3) var albedos: texture_2d<f32>;
@group(0) @binding(4) var bent: texture_2d<f32>;
@group(0) @binding(5) var lights: texture_2d_array<f32>;
@group(0) @binding(6) var light_sampler: sampler;
@group(0) @binding(7) var picture: texture_storage_2d<rgba16float, write>;

/// Greatest half.
const BRIGHTEST: f32 = 65504.0;

/// Radiance that a white surface sends out. `found`: mean direction and openness.
fn radiance_of(found: vec4<f32>, normal: vec3<f32>) -> vec3<f32> {
    let share = found.w * geometric_term(found.xyz, normal);
    let towards = bent_normal(found.xyz, normal);
    let angle = cone_angle(length(found.xyz));
    return share * cone_radiance(lights, light_sampler, towards, angle);
}

@compute @workgroup_size(16, 8)
fn shade_bent(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(picture)) {
        return;
    }
    let pixel = vec2<i32>(min(id.xy, textureDimensions(depth) - 1u));
    let seen = seen_surface(camera, pixel, textureLoad(depth, pixel, 0).x);
    let towards = towards_viewer(camera, seen.place);
    let viewer = towards / max(length(towards), 1e-20);
    let normal = seen_normal(textureLoad(normals, min(id.xy, textureDimensions(normals) - 1u), 0).xyz, viewer);
    let albedo = clamp(finite_or_rgb(textureLoad(albedos, min(id.xy, textureDimensions(albedos) - 1u), 0).rgb, 0.0), vec3<f32>(0.0), vec3<f32>(1.0));
    let found = textureLoad(bent, min(id.xy, textureDimensions(bent) - 1u), 0);
    let radiance = min(albedo * radiance_of(found, normal), vec3<f32>(BRIGHTEST));
    textureStore(picture, id.xy, select(vec4<f32>(0.0), vec4<f32>(radiance, 1.0), seen.known));
}
