// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/iso_raycast, permutation skipping_deferred (DEFERRED SKIPPING)
// summary: Casts view rays at an iso-surface of a volume: colour, normal, flow and distance of what they hit, in one pass.
// source: dissertation on painterly volume rendering, 4.1: ray casting, classification, gradients, Phong, optical flow.
// note: Rays meet the box of the volume in the shader, and are stepped from where they enter by steps of equal length, of the
// note: volume's step at most; the step in which opacity first reaches the iso-value is halved and cut by a secant.
// note: What is lit, told and written is found after the march. Where a ray enters what is solid, on a face of the box or at a
// note: clip plane, the normal is that of the face; where it begins there, it points at the eye.
// note: All targets have 24 bytes a pixel, and with CURVATURE the 32 of WebGPU. Faces of the box and clip planes do not bend.
// note: Texels that are not finite count as 0, and so does what a filter makes of them. With SKIPPING every target holds the same
// note: bits: samples in empty bricks are passed over, and no others.
// definition DEFERRED: the colour is what the table says, for `shade` to light; without `lighting`.
// definition SKIPPING: bricks in which nothing is solid are passed over.
// binding camera: the camera, perspective or orthographic.
// binding previous_camera: that of the previous frame; not with DISTANCE_ONLY.
// binding volume: where the volume lies, its step and the scale of its texels.
// binding surface: which surface is seen, and where the volume lay.
// binding values: the volume, of any float format that filters.
// binding transfer: finite colour and opacity of values 0..1, one row, rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.
// binding brick_distances: of each brick to the nearest in which anything is solid, in bricks, r32uint; with SKIPPING only.

// ---- airlight::core::bricks ----
// summary: Bricks of voxels over a volume, by which a march passes over empty space without a change of what it meets.
// source: Levoy, "Efficient ray tracing of volume data" (1990); distances after Cohen and Sheffer, "Proximity clouds" (1994).

/// Voxels along a brick.
const BRICK: u32 = 8u;
/// What samples of a march may lie beyond the place that they are reckoned to be, in samples.
const MARGIN: f32 = 0.01;

/// Bricks along each axis of a volume of `size` voxels.
fn brick_count(size: vec3<u32>) -> vec3<u32> {
    return (size + vec3<u32>(BRICK - 1u)) / BRICK;
}

/// The brick of a place in unit space; outside of the volume the nearest inside.
fn brick_at(unit: vec3<f32>, size: vec3<u32>) -> vec3<u32> {
    let last = vec3<f32>(max(brick_count(size), vec3<u32>(1u)) - 1u);
    return vec3<u32>(clamp(floor(unit * vec3<f32>(size) / f32(BRICK)), vec3<f32>(0.0), last));
}

/// How many samples of a march, with that at `unit`, lie among bricks that are alike: in this one if it is occupied
/// (`distance` 0), else among the empty ones around it. At least 1. `step`: from sample to sample, in unit space.
fn samples_alike(unit: vec3<f32>, step: vec3<f32>, size: vec3<u32>, distance: u32) -> u32 {
    let side = f32(BRICK) / vec3<f32>(size);
    let brick = vec3<f32>(brick_at(unit, size));
    let reach = f32(max(distance, 1u));
    let wall = side * select(brick - (reach - 1.0), brick + reach, step > vec3<f32>(0.0));
    let still = abs(step) < vec3<f32>(1e-12);
    let samples = select((wall - unit) / select(step, vec3<f32>(1.0), still), vec3<f32>(8192.0), still);
    return 1u + u32(clamp(min(min(samples.x, samples.y), samples.z) - MARGIN, 0.0, 8192.0));
}

/// Samples of a march that lie among bricks that are alike.
struct Run {
    /// The first that may hold something; `end` where none does.
    begin: u32,
    /// The first of the next run.
    end: u32,
}

/// The run that begins with sample `i` of `steps`, at `unit`. `distances`: of the bricks of a volume of `size` voxels; `step`:
/// from sample to sample, in unit space.
fn run_of_samples(
    distances: texture_3d<u32>, size: vec3<u32>, unit: vec3<f32>, step: vec3<f32>, i: u32, steps: u32
) -> Run {
    let brick = min(brick_at(unit, size), textureDimensions(distances) - 1u);
    let distance = textureLoad(distances, brick, 0).x;
    let end = min(i + samples_alike(unit, step, size, distance), steps);
    return Run(select(end, i, distance == 0u), end);
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

// ---- airlight::core::picture ----
// summary: One triangle over the whole picture, for passes in fragment form.
// source: the usual full-screen triangle.

/// Clip-space position of corner `index`, 0..2, of a triangle that covers the picture.
fn picture_corner(index: u32) -> vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

// ---- airlight::core::transfer_function ----
// summary: What colour and opacity a value of a volume has, by a table.
// source: none; the usual 1D transfer function, dissertation on painterly volume rendering, 4.1.1.

/// Colour, linear RGB, and opacity 0..1 of a value 0..1; beyond that the end of the table. `transfer`: one row, linear RGB and
/// opacity, rgba16float or rgba8unorm; `linear_sampler`: linear, clamped to the edge.
fn classified(transfer: texture_2d<f32>, linear_sampler: sampler, value: f32) -> vec4<f32> {
    let width = f32(textureDimensions(transfer).x);
    return textureSampleLevel(transfer, linear_sampler, vec2<f32>((value * (width - 1.0) + 0.5) / width, 0.5), 0.0);
}

// ---- airlight::core::volume ----
// summary: A volume in the world: its box, voxels and how a ray passes it.
// source: none; the slab test of ray tracing.

/// A volume in the world. 144 bytes.
struct VolumeSpace {
    /// World, metres, to unit space; affine.
    unit_from_world: mat4x4<f32>,
    /// Its inverse.
    world_from_unit: mat4x4<f32>,
    /// What values of the texture are multiplied by: to give extinction in 1/m, say; from 0 up.
    value_scale: f32,
    /// Metres from one sample of a march to the next at most, positive: a voxel.
    step_length: f32,
    reserved_a: f32,
    reserved_b: f32,
}

/// Most samples of a march through one volume.
const MOST_STEPS: f32 = 8192.0;

/// The part of a segment that lies in the box: from and to, 0..1; equal where it misses. `origin`, `along`: of the
/// segment, in unit space.
fn segment_in_box(origin: vec3<f32>, along: vec3<f32>) -> vec2<f32> {
    let still = abs(along) < vec3<f32>(1e-20);
    let safe = select(along, vec3<f32>(1.0), still);
    let a = -origin / safe;
    let b = (vec3<f32>(1.0) - origin) / safe;
    let inside = (origin >= vec3<f32>(0.0)) & (origin <= vec3<f32>(1.0));
    let enters = select(min(a, b), vec3<f32>(0.0), still);
    let leaves = select(max(a, b), select(vec3<f32>(-1.0), vec3<f32>(1.0), inside), still);
    let begins = max(max(enters.x, enters.y), max(enters.z, 0.0));
    return vec2<f32>(begins, max(begins, min(min(leaves.x, leaves.y), min(leaves.z, 1.0))));
}

/// How many samples a march of `metres` takes.
fn march_steps(metres: f32, volume: VolumeSpace) -> u32 {
    // A whole number of voxels stays that number.
    return u32(clamp(ceil(metres / max(volume.step_length, 1e-6) - 1e-3), 1.0, MOST_STEPS));
}

/// A length in metres that no segment in the box exceeds.
fn metres_across(volume: VolumeSpace) -> f32 {
    let space = volume.world_from_unit;
    return length(space[0].xyz) + length(space[1].xyz) + length(space[2].xyz);
}

// ---- airlight::painterly::iso_surface ----
// summary: Iso-surface of classified opacity in a volume: crossing, gradient, Phong lighting, flow and occlusion of a surface point.
// source: dissertation on painterly volume rendering, 4.1.1 to 4.1.6, Eq. 4.1 and 4.2.

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

/// Where a point of the world lies in the picture, pixels from its top left corner, and its clip w; z > 0 before the eye.
fn pixel_of_point(camera: Camera, point: vec3<f32>) -> vec3<f32> {
    let clip = camera.clip_from_world * vec4<f32>(point, 1.0);
    let ndc = clip.xy / select(1.0, clip.w, clip.w > 0.0);
    return vec3<f32>((ndc * vec2<f32>(0.5, -0.5) + 0.5) * camera.viewport, clip.w);
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

// ---- painterly/iso_raycast ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(2) var<uniform> volume: VolumeSpace;
@group(0) @binding(3) var<uniform> surface: IsoSurface;
@group(0) @binding(5) var values: texture_3d<f32>;
@group(0) @binding(6) var transfer: texture_2d<f32>;
@group(0) @binding(7) var linear_sampler: sampler;
@group(0) @binding(1) var<uniform> previous_camera: Camera;
@group(0) @binding(9) var brick_distances: texture_3d<u32>;

/// The part of a view ray that is marched.
struct March {
    /// World, metres.
    origin: vec3<f32>,
    /// Unit, world.
    direction: vec3<f32>,
    /// Metres along the ray where it begins and ends.
    part: vec2<f32>,
    /// Normal of a clip plane that it begins at, else 0.
    clip_normal: vec3<f32>,
    /// Unit space, where it begins.
    enters: vec3<f32>,
    /// Unit space, from sample to sample.
    stride: vec3<f32>,
    /// Samples lie at `clamp(i - shift, 0, steps)` strides.
    steps: f32,
    /// 0..1.
    shift: f32,
    /// Samples, 0 where nothing of the volume is seen.
    count: u32,
}

/// What a ray meets.
struct Hit {
    /// Whether anything is met.
    found: bool,
    /// In strides from where the ray enters.
    at: f32,
    /// 1 where greater values are solid, -1 where lesser ones are; 0 where the ray begins in what is solid.
    rise: f32,
}

/// Value 0..1 at a place in unit space.
fn value_at(unit: vec3<f32>) -> f32 {
    return value_of_texel(textureSampleLevel(values, linear_sampler, unit, 0.0).x, volume.value_scale, surface.value_offset);
}

fn opacity_of_value(value: f32) -> f32 {
    return classified(transfer, linear_sampler, value).w;
}

/// Where a pixel's samples lie, 0..1 of a step before whole steps.
fn start_shift(pixel: vec2<u32>) -> f32 {
    return 0.0;
}

fn begin_march(pixel: vec2<u32>) -> March {
    let ray = view_ray(camera, ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5));
    // No longer than it must be, for the precision of shares of it.
    let centre = (volume.world_from_unit * vec4<f32>(vec3<f32>(0.5), 1.0)).xyz;
    let reach = min(length(centre - ray.origin) + metres_across(volume), surface.distance_limit);
    let origin = (volume.unit_from_world * vec4<f32>(ray.origin, 1.0)).xyz;
    let along = (volume.unit_from_world * vec4<f32>(ray.direction, 0.0)).xyz;
    var clipped = ClippedRay(segment_in_box(origin, along * reach) * reach, vec3<f32>(0.0));
    for (var i = 0u; i < min(surface.clip_count, MOST_CLIP_PLANES); i++) {
        clipped = clip_ray(clipped, ray.origin, ray.direction, surface.clip_planes[i]);
    }
    let metres = clipped.part.y - clipped.part.x;
    let shift = start_shift(pixel);
    let steps = march_steps(metres, volume);
    return March(
        ray.origin, ray.direction, clipped.part, clipped.normal,
        origin + clipped.part.x * along, along * (metres / f32(steps)),
        f32(steps), shift, select(0u, steps + select(1u, 2u, shift > 0.0), metres > 0.0),
    );
}

fn sample_place(march: March, index: u32) -> f32 {
    return clamp(f32(index) - march.shift, 0.0, march.steps);
}

fn value_along(march: March, at: f32) -> f32 {
    return value_at(march.enters + at * march.stride);
}

/// Whether the sample `index` is solid.
fn is_solid(march: March, index: u32) -> bool {
    return opacity_of_value(value_along(march, sample_place(march, index))) >= surface.iso_value;
}

/// Samples that are read from where a run begins that may hold something.
const TOGETHER: u32 = 8u;

fn next_run(march: March, index: u32) -> Run {
    let unit = march.enters + sample_place(march, index) * march.stride;
    return run_of_samples(brick_distances, textureDimensions(values), unit, march.stride, index, march.count);
}

/// The first sample that is solid; `count` where none is.
fn first_solid(march: March) -> u32 {
    var i = 0u;
    var found = false;
    while !found && i < march.count {
        var run = next_run(march, i);
        // To the next brick that may hold something, before any sample is read: neighbouring rays then read together.
        while run.begin == run.end && run.end < march.count {
            run = next_run(march, run.end);
        }
        i = run.begin;
        // As many samples for all: some lie beyond the brick, where nothing is solid, but neighbouring rays stay together.
        let end = min(i + TOGETHER, march.count);
        while i < end {
            if is_solid(march, i) {
                found = true;
                break;
            }
            i++;
        }
    }
    return i;
}

/// Where a ray crosses the surface before sample `index`, the first that is solid.
fn refine(march: March, index: u32) -> Hit {
    let found = index < march.count;
    let before = sample_place(march, max(index, 1u) - 1u);
    let place = sample_place(march, index);
    let value_before = value_along(march, before);
    let value_solid = value_along(march, place);
    let from_outside = found && index > 0u;
    var bracket = Bracket(before, place, opacity_of_value(value_before), opacity_of_value(value_solid));
    // Loops, not branches: some adapters run a branch where no lane takes it, but no such loop.
    let refinements = select(0u, min(surface.refinements, 32u), from_outside);
    for (var i = 0u; i < refinements; i++) {
        let middle = 0.5 * (bracket.outside + bracket.inside);
        bracket = narrowed(bracket, middle, opacity_of_value(value_along(march, middle)), surface.iso_value);
    }
    let at = select(place, secant(bracket, surface.iso_value), from_outside);
    return Hit(found, at, select(0.0, select(-1.0, 1.0, value_solid >= value_before), from_outside));
}

fn distance_of_hit(march: March, hit: Hit) -> f32 {
    return mix(march.part.x, march.part.y, hit.at / march.steps);
}

struct Targets {
    /// Linear RGB, premultiplied, and 1 where the surface is seen, else 0; rgba16float.
    @location(0) color: vec4<f32>,
    /// Unit normal in the world, and change of value a voxel; rgba16float.
    @location(1) surface: vec4<f32>,
    /// Pixels since the previous frame, x right, y down; rg16float.
    @location(2) flow: vec2<f32>,
    /// Metres along the view ray, negative where nothing is seen; r32float.
    @location(3) distance: f32,
}

/// Change of the value between two places of unit space that differ along one axis, over their difference there.
fn slope_between(lower: vec3<f32>, upper: vec3<f32>, apart: f32) -> f32 {
    return select(0.0, (value_at(upper) - value_at(lower)) / max(apart, 1e-20), apart > 0.0);
}

/// Change of the value a metre, world, by central differences of a voxel to both sides; shorter where there is no voxel.
fn gradient_at(unit: vec3<f32>) -> vec3<f32> {
    let voxel = 1.0 / vec3<f32>(textureDimensions(values));
    let lower = clamp(unit - voxel, 0.5 * voxel, 1.0 - 0.5 * voxel);
    let upper = clamp(unit + voxel, 0.5 * voxel, 1.0 - 0.5 * voxel);
    let apart = upper - lower;
    let slopes = vec3<f32>(
        slope_between(vec3<f32>(lower.x, unit.yz), vec3<f32>(upper.x, unit.yz), apart.x),
        slope_between(vec3<f32>(unit.x, lower.y, unit.z), vec3<f32>(unit.x, upper.y, unit.z), apart.y),
        slope_between(vec3<f32>(unit.xy, lower.z), vec3<f32>(unit.xy, upper.z), apart.z),
    );
    return world_gradient(slopes, volume.unit_from_world);
}

/// The normal towards the eye's side of a hit: against the gradient, or that of the face by which the ray enters what is
/// solid, or against the ray where it begins there.
fn normal_of_hit(march: March, hit: Hit, gradient: vec3<f32>) -> vec3<f32> {
    let size = length(gradient);
    let flat = size < 1e-20;
    let sloped = select(-hit.rise * gradient / select(size, 1.0, flat), -march.direction, flat);
    let clipped = dot(march.clip_normal, march.clip_normal) > 0.0;
    let face = select(face_normal(march.enters, volume.unit_from_world), march.clip_normal, clipped);
    let entered = select(-march.direction, face, march.part.x > 0.0);
    return select(sloped, entered, hit.rise == 0.0);
}

fn targets(march: March, hit: Hit) -> Targets {
    var written: Targets;
    written.distance = -1.0;
    for (var seen = hit.found; seen; seen = false) {
        let unit = march.enters + hit.at * march.stride;
        let distance = distance_of_hit(march, hit);
        let gradient = gradient_at(unit);
        let normal = normal_of_hit(march, hit, gradient);
        let albedo = max(classified(transfer, linear_sampler, value_at(unit)).xyz, vec3<f32>(0.0));
        let color = albedo;
        let place = (volume.world_from_unit * vec4<f32>(unit, 1.0)).xyz;
        let previous_place = (surface.previous_world_from_unit * vec4<f32>(unit, 1.0)).xyz;
        written.color = vec4<f32>(min(color, vec3<f32>(65504.0)), 1.0);
        written.surface = vec4<f32>(normal, min(length(gradient) * surface.voxel, 65504.0));
        written.flow = surface_flow(camera, previous_camera, place, previous_place);
        written.distance = distance;
    }
    return written;
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_iso_raycast(@builtin(position) position: vec4<f32>) -> Targets {
    let march = begin_march(vec2<u32>(position.xy));
    let hit = refine(march, first_solid(march));
    return targets(march, hit);
}
