// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::iso_surface
// summary: Iso-surface of classified opacity in a volume: crossing, gradient, Phong lighting, flow and occlusion of a surface point.
// source: dissertation on painterly volume rendering, 4.1.1 to 4.1.6, Eq. 4.1 and 4.2.
// note: A value 0..1 is classified by a table of colour and opacity, linear between its texels, the first of which is value 0
// note: and the last value 1. Solid is where opacity >= iso-value; the surface is where a ray first meets what is solid.
// note: Eq. 4.1 lacks the division by h: here gradients are changes of the value a metre, and h is two voxels, with which
// note: central differences of quadratic fields are exact between voxels too.
// note: 4.1.6 compares depths after projection of two frames, which change with every movement; here the distance that is
// note: predicted for a point along its view ray is compared with the distance found there.
// equation: solid: opacity(v(x)) ≥ iso;  secant: t = t₀ + (t₁ − t₀) (iso − o₀) / (o₁ − o₀)
// equation: Phong: albedo (k_d max(0, <n, l>) E + A) + k_s max(0, <r, l>)^α E
// equation: flow = pixel now − pixel before;  tolerance = pixels side √(1 − c²) / c + voxel
// error: hits within 0.1 voxel of dense sampling; test painterly/iso_raycast::hits_are_those_of_dense_sampling.
// error: gradients of quadratic fields within a degree and 2 %; test painterly/iso_raycast::gradients_of_quadratic_fields_are_within_a_degree.
// error: flow within 0.1 pixel; test painterly/iso_raycast::flow_is_the_motion_of_the_point.
// error: Phong lighting within 2e-4; test painterly/edges/shading::light_is_phong_s.
// parameter texel: of the volume, any float.
// parameter scale, offset: from texels to values 0..1.
// parameter iso_value: opacity, above 0 up to 1.
// parameter least, greatest: values 0..1.
// parameter at: place along the ray.
// parameter opacity: 0..1.
// parameter origin, direction: of the view ray in the world, metres and unit vector.
// parameter plane: normal and offset in the world, metres.
// parameter unit: place in unit space.
// parameter unit_from_world: world, metres, to unit space; affine.
// parameter unit_gradient: change of the value over the volume, along each axis.
// parameter point: metres in the world.
// parameter voxel: shortest side of a voxel, metres.
// parameter tolerance: metres, from 0 up.
// parameter entries: of the table, from 1 up.

#import airlight::core::camera::{Camera, matrix_row}
#import airlight::core::finite::finite_or

/// Clip planes at most.
const MOST_CLIP_PLANES: u32 = 8u;

/// Which surface of a volume is seen, and how it is found. 224 bytes.
struct IsoSurface {
    /// Unit space of the volume to the world, metres, in the previous frame; affine.
    previous_world_from_unit: mat4x4<f32>,
    /// Planes in the world: what lies where dot(xyz, point) + w < 0 is cut away. The first `clip_count` of them.
    clip_planes: array<vec4<f32>, 8>,
    /// Opacity from which on the volume is solid, above 0.
    iso_value: f32,
    /// Added to texels after their scale to give values 0..1.
    value_offset: f32,
    /// Shortest side of a voxel, metres.
    voxel: f32,
    /// View rays end here, metres, positive.
    distance_limit: f32,
    /// How many clip planes there are, 0..8.
    clip_count: u32,
    /// How often the step in which the surface is met is halved before the secant, 0..32.
    refinements: u32,
    /// Number of the frame, for jittered starts.
    frame: u32,
    reserved: u32,
}

/// How a surface is lit. 48 bytes.
struct SurfaceLighting {
    /// Unit vector TOWARDS the directional light.
    direction: vec3<f32>,
    /// Share of diffuse reflection, k_d, from 0 up.
    diffuse: f32,
    /// Irradiance of the light at normal incidence over pi, linear RGB.
    radiance: vec3<f32>,
    /// Share of mirror-like reflection, k_s, from 0 up.
    specular: f32,
    /// Radiance from all around, linear RGB.
    ambient: vec3<f32>,
    /// Exponent of mirror-like reflection, alpha, from 1 up.
    shininess: f32,
}

/// A stretch of a ray that goes from what is not solid into what is.
struct Bracket {
    /// Place along the ray that is not solid.
    outside: f32,
    /// Place along the ray that is solid.
    inside: f32,
    /// Opacity at `outside`, less than the iso-value.
    opacity_outside: f32,
    /// Opacity at `inside`, at least the iso-value.
    opacity_inside: f32,
}

/// A stretch of a ray that is left by clip planes.
struct ClippedRay {
    /// Where it begins and ends, metres along the ray; nothing is left where it does not end later.
    part: vec2<f32>,
    /// Unit normal towards the eye of the plane that cut its beginning, world; 0 where none did.
    normal: vec3<f32>,
}

/// The value 0..1 of a texel; one that is not finite counts as 0.
fn value_of_texel(texel: f32, scale: f32, offset: f32) -> f32 {
    return clamp(finite_or(texel, 0.0) * scale + offset, 0.0, 1.0);
}

/// What is counted of the table's entries for solid values, lower than the iso-value by more than filters round.
fn solid_threshold(iso_value: f32) -> f32 {
    return iso_value * (1.0 - 1e-5);
}

/// Entries of a table of `entries` that lie between two values 0..1, ends excluded: the first and the one behind the last.
fn entries_between(least: f32, greatest: f32, entries: u32) -> vec2<u32> {
    let last = f32(max(entries, 1u) - 1u);
    let first = clamp(floor(least * last) + 1.0, 0.0, last + 1.0);
    return vec2<u32>(u32(first), u32(clamp(ceil(greatest * last), first, last + 1.0)));
}

/// A bracket, narrowed by the opacity at a place within it.
fn narrowed(bracket: Bracket, at: f32, opacity: f32, iso_value: f32) -> Bracket {
    let solid = opacity >= iso_value;
    return Bracket(
        select(at, bracket.outside, solid),
        select(bracket.inside, at, solid),
        select(opacity, bracket.opacity_outside, solid),
        select(bracket.opacity_inside, opacity, solid),
    );
}

/// The place in a bracket where the straight line through both opacities meets the iso-value.
fn secant(bracket: Bracket, iso_value: f32) -> f32 {
    let rise = max(bracket.opacity_inside - bracket.opacity_outside, 1e-20);
    let share = clamp((iso_value - bracket.opacity_outside) / rise, 0.0, 1.0);
    return mix(bracket.outside, bracket.inside, share);
}

/// The part of a ray, `part` in metres, that is left by a clip plane: normal and offset, world, keeping dot + w >= 0.
fn clip_ray(ray: ClippedRay, origin: vec3<f32>, direction: vec3<f32>, plane: vec4<f32>) -> ClippedRay {
    let height = dot(plane.xyz, origin) + plane.w;
    let rise = dot(plane.xyz, direction);
    let along = abs(rise) < 1e-20;
    let at = -height / select(rise, 1.0, along);
    let begins = !along && rise > 0.0 && at > ray.part.x;
    let ends = !along && rise < 0.0;
    let begin = select(ray.part.x, at, begins);
    let end = select(ray.part.y, min(ray.part.y, at), ends);
    // Parallel to the plane a ray is cut away whole or not at all.
    let gone = along && height < 0.0;
    let normal = -plane.xyz / max(length(plane.xyz), 1e-20);
    return ClippedRay(vec2<f32>(begin, select(end, begin, gone)), select(ray.normal, normal, begins));
}

/// Unit normal in the world, towards the outside, of the face of the box that is nearest to `unit`, a place on it.
fn face_normal(unit: vec3<f32>, unit_from_world: mat4x4<f32>) -> vec3<f32> {
    let away = abs(unit - 0.5);
    let along_x = away.x >= away.y && away.x >= away.z;
    let along_y = !along_x && away.y >= away.z;
    let axis = select(select(vec3<f32>(0.0, 0.0, 1.0), vec3<f32>(0.0, 1.0, 0.0), along_y), vec3<f32>(1.0, 0.0, 0.0), along_x);
    return normalize(world_gradient(axis * sign(unit - 0.5), unit_from_world));
}

/// A gradient in unit space as one in the world, a metre.
fn world_gradient(unit_gradient: vec3<f32>, unit_from_world: mat4x4<f32>) -> vec3<f32> {
    return (transpose(unit_from_world) * vec4<f32>(unit_gradient, 0.0)).xyz;
}

/// Phong lighting of a surface, Eq. 4.2: linear RGB radiance towards the eye. `albedo`: linear RGB; `normal`: unit;
/// `view`: unit direction of the view ray, away from the eye.
fn phong(lighting: SurfaceLighting, albedo: vec3<f32>, normal: vec3<f32>, view: vec3<f32>) -> vec3<f32> {
    let facing = dot(normal, lighting.direction);
    let mirrored = max(dot(reflect(view, normal), lighting.direction), 0.0);
    let lobe = select(0.0, pow(max(mirrored, 1e-6), lighting.shininess), facing > 0.0 && mirrored > 0.0);
    let diffuse = lighting.diffuse * max(facing, 0.0) * lighting.radiance + lighting.ambient;
    return albedo * diffuse + lighting.specular * lobe * lighting.radiance;
}

/// Where a point of the world lies in the picture, pixels from its top left corner, and its clip w; z > 0 before the eye.
fn pixel_of_point(camera: Camera, point: vec3<f32>) -> vec3<f32> {
    let clip = camera.clip_from_world * vec4<f32>(point, 1.0);
    let ndc = clip.xy / select(1.0, clip.w, clip.w > 0.0);
    return vec3<f32>((ndc * vec2<f32>(0.5, -0.5) + 0.5) * camera.viewport, clip.w);
}

/// Direction in a picture of `size` pixels, x right, y down, of any length, of a `direction` of the world at a point before the camera.
fn direction_in_picture(camera: Camera, point: vec3<f32>, direction: vec3<f32>, size: vec2<f32>) -> vec2<f32> {
    let clip = camera.clip_from_world * vec4<f32>(point, 1.0);
    let change = camera.clip_from_world * vec4<f32>(direction, 0.0);
    // The derivative of xy / w, times w squared.
    return (change.xy * clip.w - clip.xy * change.w) * size * vec2<f32>(1.0, -1.0);
}

/// Greatest motion that is told, pixels.
const GREATEST_FLOW: f32 = 16384.0;

/// Motion of a surface point in pixels of the picture, x right, y down: position now minus position in the previous frame,
/// 0 where it then was not before the eye. `point` and `previous_point`: where it is and was in the world.
fn surface_flow(camera: Camera, previous: Camera, point: vec3<f32>, previous_point: vec3<f32>) -> vec2<f32> {
    let now = pixel_of_point(camera, point);
    let before = pixel_of_point(previous, previous_point);
    // The previous picture may have had another size.
    let flow = now.xy - before.xy * camera.viewport / previous.viewport;
    let known = now.z > 0.0 && before.z > 0.0;
    return select(vec2<f32>(0.0), clamp(flow, vec2<f32>(-GREATEST_FLOW), vec2<f32>(GREATEST_FLOW)), known);
}

/// Side in metres of what a pixel shows at right angles to the view at a point of the world; 0 behind the eye.
fn pixel_side(camera: Camera, point: vec3<f32>) -> f32 {
    let w = dot(matrix_row(camera.clip_from_world, 3u), vec4<f32>(point, 1.0));
    return max(2.0 * w / (camera.viewport.y * length(matrix_row(camera.clip_from_world, 1u).xyz)), 0.0);
}

/// How much distances of a surface may differ within `pixels` pixels, metres: slope times pixel, and a voxel for what the
/// surface bends. `side`: of `pixel_side`; `cosine`: of normal and view ray, any sign.
fn distance_tolerance(side: f32, cosine: f32, pixels: f32, voxel: f32) -> f32 {
    let c = max(abs(cosine), 0.05);
    return pixels * side * sqrt(max(1.0 - c * c, 0.0)) / c + voxel;
}

/// Whether a surface point is hidden by something nearer. `predicted`: its distance along the view ray through the pixel
/// where it lies now; `found`: the distance seen in that pixel, negative where there is none; metres all.
fn is_occluded(predicted: f32, found: f32, tolerance: f32) -> bool {
    return found >= 0.0 && found < predicted - tolerance;
}
