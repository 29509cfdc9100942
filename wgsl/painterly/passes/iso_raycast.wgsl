// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Casts view rays at an iso-surface of a volume: colour, normal, flow and distance of what they hit, in one pass.
// source: dissertation on painterly volume rendering, 4.1: ray casting, classification, gradients, Phong, optical flow.
// note: Rays meet the box of the volume in the shader, and are stepped from where they enter by steps of equal length, of the
// note: volume's step at most; the step in which opacity first reaches the iso-value is halved and cut by a secant.
// note: What is lit, told and written is found after the march. Where a ray enters what is solid, on a face of the box or at a
// note: clip plane, the normal is that of the face; where it begins there, it points at the eye.
// note: All targets have 24 bytes a pixel, and with CURVATURE the 32 of WebGPU. Faces of the box and clip planes do not bend.
// note: Texels that are not finite count as 0, and so does what a filter makes of them. With SKIPPING every target holds the same
// note: bits: samples in empty bricks are passed over, and no others.
// definition DISTANCE_ONLY: nothing but the distance is written, at location 0.
// definition DEFERRED: the colour is what the table says, for `shade` to light; without `lighting`.
// definition CURVATURE: principal curvatures and their direction are written, at location 4; not with DISTANCE_ONLY.
// definition SKIPPING: bricks in which nothing is solid are passed over.
// definition JITTER_GRADIENT: steps begin at a part of a step that differs from pixel to pixel, by gradient noise.
// definition JITTER_BLUE_NOISE: the same by blue noise.
// binding camera: the camera, perspective or orthographic.
// binding previous_camera: that of the previous frame; not with DISTANCE_ONLY.
// binding volume: where the volume lies, its step and the scale of its texels.
// binding surface: which surface is seen, and where the volume lay.
// binding lighting: how it is lit; not with DEFERRED or DISTANCE_ONLY.
// binding values: the volume, of any float format that filters.
// binding transfer: finite colour and opacity of values 0..1, one row, rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.
// binding brick_distances: of each brick to the nearest in which anything is solid, in bricks, r32uint; with SKIPPING only.
// binding blue_noise: a tile of blue noise, 0..1, r32float or r8unorm; with JITTER_BLUE_NOISE only.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::picture::picture_corner
#import airlight::core::transfer_function::classified
#import airlight::core::volume::{VolumeSpace, segment_in_box, march_steps, metres_across}
#import airlight::painterly::iso_surface::{
    IsoSurface, Bracket, ClippedRay, MOST_CLIP_PLANES, value_of_texel, narrowed, secant, clip_ray,
    face_normal, world_gradient
}
#ifndef DISTANCE_ONLY
#import airlight::painterly::iso_surface::surface_flow
#ifdef CURVATURE
#import airlight::painterly::curvature::{world_curvatures, curvature_texel}
#import airlight::painterly::spline::spline_jet
#endif
#ifndef DEFERRED
#import airlight::painterly::iso_surface::{SurfaceLighting, phong}
#endif
#endif
#ifdef SKIPPING
#import airlight::core::bricks::{Run, run_of_samples}
#endif
#ifdef JITTER_GRADIENT
#import airlight::core::jitter::gradient_noise_offset
#endif
#ifdef JITTER_BLUE_NOISE
#import airlight::core::jitter::blue_noise_offset
#endif

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(2) var<uniform> volume: VolumeSpace;
@group(#{GROUP}) @binding(3) var<uniform> surface: IsoSurface;
@group(#{GROUP}) @binding(5) var values: texture_3d<f32>;
@group(#{GROUP}) @binding(6) var transfer: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var linear_sampler: sampler;
#ifndef DISTANCE_ONLY
@group(#{GROUP}) @binding(1) var<uniform> previous_camera: Camera;
#ifndef DEFERRED
@group(#{GROUP}) @binding(4) var<uniform> lighting: SurfaceLighting;
#endif
#endif
#ifdef JITTER_BLUE_NOISE
@group(#{GROUP}) @binding(8) var blue_noise: texture_2d<f32>;
#endif
#ifdef SKIPPING
@group(#{GROUP}) @binding(9) var brick_distances: texture_3d<u32>;
#endif

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
#ifdef JITTER_GRADIENT
    return gradient_noise_offset(pixel, surface.frame);
#else ifdef JITTER_BLUE_NOISE
    return blue_noise_offset(blue_noise, pixel, surface.frame);
#else
    return 0.0;
#endif
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

#ifdef SKIPPING
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
#else
/// The first sample that is solid; `count` where none is.
fn first_solid(march: March) -> u32 {
    var i = 0u;
    while i < march.count {
        if is_solid(march, i) {
            break;
        }
        i++;
    }
    return i;
}
#endif

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

#ifdef DISTANCE_ONLY
struct Targets {
    @location(0) distance: f32,
}

fn targets(march: March, hit: Hit) -> Targets {
    return Targets(select(-1.0, distance_of_hit(march, hit), hit.found));
}
#else
struct Targets {
    /// Linear RGB, premultiplied, and 1 where the surface is seen, else 0; rgba16float.
    @location(0) color: vec4<f32>,
    /// Unit normal in the world, and change of value a voxel; rgba16float.
    @location(1) surface: vec4<f32>,
    /// Pixels since the previous frame, x right, y down; rg16float.
    @location(2) flow: vec2<f32>,
    /// Metres along the view ray, negative where nothing is seen; r32float.
    @location(3) distance: f32,
#ifdef CURVATURE
    /// Principal curvatures, the greater first, 1/m, positive where the surface is convex towards the eye's side; (cos 2a,
    /// sin 2a) of the direction of the greater absolute one in the picture, x right, y down, 0 where there is none; rgba16float.
    @location(4) curvature: vec4<f32>,
#endif
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

#ifdef CURVATURE
/// What is written of the curvature at a hit. `unit`, `place`: where it is, in unit space and in the world.
fn curvature_of_hit(march: March, hit: Hit, unit: vec3<f32>, place: vec3<f32>) -> vec4<f32> {
    var texel = vec4<f32>(0.0);
    for (var bends = hit.rise != 0.0; bends; bends = false) {
        let jet = spline_jet(values, unit, volume.value_scale, surface.value_offset);
        let size = vec3<f32>(textureDimensions(values));
        let curvatures = world_curvatures(jet, size, volume.unit_from_world, -hit.rise);
        texel = curvature_texel(curvatures, camera, place, march.direction);
    }
    return texel;
}
#endif

fn targets(march: March, hit: Hit) -> Targets {
    var written: Targets;
    written.distance = -1.0;
    for (var seen = hit.found; seen; seen = false) {
        let unit = march.enters + hit.at * march.stride;
        let distance = distance_of_hit(march, hit);
        let gradient = gradient_at(unit);
        let normal = normal_of_hit(march, hit, gradient);
        let albedo = max(classified(transfer, linear_sampler, value_at(unit)).xyz, vec3<f32>(0.0));
#ifdef DEFERRED
        let color = albedo;
#else
        let color = phong(lighting, albedo, normal, march.direction);
#endif
        let place = (volume.world_from_unit * vec4<f32>(unit, 1.0)).xyz;
        let previous_place = (surface.previous_world_from_unit * vec4<f32>(unit, 1.0)).xyz;
        written.color = vec4<f32>(min(color, vec3<f32>(65504.0)), 1.0);
        written.surface = vec4<f32>(normal, min(length(gradient) * surface.voxel, 65504.0));
        written.flow = surface_flow(camera, previous_camera, place, previous_place);
        written.distance = distance;
#ifdef CURVATURE
        written.curvature = curvature_of_hit(march, hit, unit, place);
#endif
    }
    return written;
}
#endif

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
