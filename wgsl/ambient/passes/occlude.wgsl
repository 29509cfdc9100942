// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Openness and bent normals of what is seen, from its depth and normals alone.
// source: thesis 3.2 to 3.4, Eq. 3.2 to 3.5, Listing 3.1; see ambient/occluders for the other samplers.
// note: Dispatch over the picture. A direction is marched in a few steps and is blocked where a place on it lies behind what is seen there, by less
// note: than its thickness; only what rises over the tangent plane blocks, so that flat surfaces do not block themselves.
// note: What is seen too far in front says nothing: Listing 3.1's outlier. Where a march leaves the picture it goes on freely, so that openness and
// note: mean directions are of the same visibility, by which irradiance under even light is exact (ambient/bent_cone).
// note: Pixels without geometry, with a depth of the far plane or none that is finite, are open with a mean direction of 0. A normal of length 0 or
// note: none that is finite counts as one towards the viewer.
// note: For a picture of half the resolution give depth, normals and the camera's viewport of that size; ambient/upsample_bent makes it whole.
// definition DISC: a 2D pattern (Crytek 2D): points of a disc across the normal; what is seen there blocks all that is above it.
// definition HORIZON: directions across the normal are marched to the greatest elevation (HBAO); what is above is open.
// definition BITMASK: slices through the view direction with a bit a sector; light passes behind what is thin. Without these three a 3D pattern (Crytek 3D) is marched.
// definition OCCLUSION_ONLY: only openness, without bent normals.
// binding camera: the camera; its viewport is the size of `depth`.
// binding settings: how occlusion is looked for.
// binding depth: depth buffer, a depth format or r32float, as the camera has it.
// binding normals: unit normals in the world, any float format.
// binding bent: out, rgba16float: mean direction in the world, whose length is about 1/2 where all is open, and in alpha openness 0..1; with OCCLUSION_ONLY r32float, openness.

#import airlight::core::camera::{Camera, towards_viewer}
#import airlight::core::tangent_frame::tangent_frame
#import airlight::ambient::bent_cone::{BentSum, bent_nothing, openness}
#import airlight::ambient::occluders::{OcclusionSettings, MOST_SAMPLES, occluder_weight, elevation_sine}
#import airlight::ambient::sample_pattern::{SampleShift, sample_shift}
#import airlight::ambient::seen_surface::{SeenSurface, seen_surface, seen_place, seen_normal}
#ifndef OCCLUSION_ONLY
#import airlight::ambient::bent_cone::mean_direction
#endif
#ifdef HORIZON
#import airlight::ambient::bent_cone::bent_add_all
#import airlight::ambient::occluders::{open_slice, MOST_STEPS}
#else
#ifdef BITMASK
#import airlight::ambient::bent_cone::bent_add_all
#import airlight::ambient::occluders::{sector_bits, SECTORS, MOST_STEPS}
#else
#import airlight::ambient::bent_cone::bent_add
#import airlight::ambient::sample_pattern::{sample_place, hemisphere_direction}
#ifndef DISC
#import airlight::ambient::occluders::MOST_STEPS
#endif
#endif
#endif

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> settings: OcclusionSettings;
@group(#{GROUP}) @binding(2) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var normals: texture_2d<f32>;
#ifdef OCCLUSION_ONLY
@group(#{GROUP}) @binding(4) var bent: texture_storage_2d<r32float, write>;
#else
@group(#{GROUP}) @binding(4) var bent: texture_storage_2d<rgba16float, write>;
#endif

/// What is seen at a pixel of the picture.
fn seen_at(pixel: vec2<i32>) -> SeenSurface {
    let at = clamp(pixel, vec2<i32>(0), vec2<i32>(textureDimensions(depth)) - 1);
    return seen_surface(camera, at, textureLoad(depth, at, 0).x);
}

#ifdef DISC
/// Adds a direction: what is seen beside the surface blocks it as soon as it rises over the tangent plane.
fn add_sample(sum: BentSum, index: u32, place: vec3<f32>, normal: vec3<f32>, viewer: vec3<f32>, shift: SampleShift) -> BentSum {
    let local = hemisphere_direction(sample_place(index, settings.samples, shift));
    let basis = tangent_frame(normal);
    let at = seen_place(camera, place + basis * vec3<f32>(local.xy * settings.radius, 0.0));
    let seen = seen_at(vec2<i32>(floor(at.pixel)));
    let towards = seen.place - place;
    let blocks = at.inside && seen.known && elevation_sine(towards, normal) > settings.bias;
    let blocked = select(0.0, occluder_weight(length(towards), settings.radius), blocks);
    return bent_add(sum, basis * local, 1.0 - blocked, false);
}
#else
#ifdef HORIZON
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
#else
#ifdef BITMASK
/// Adds a slice through the view direction. Angles are from the direction towards the viewer.
fn add_sample(sum: BentSum, index: u32, place: vec3<f32>, normal: vec3<f32>, viewer: vec3<f32>, shift: SampleShift) -> BentSum {
    let turn = 3.1415927 * (f32(index) + shift.directions.x) / f32(max(settings.samples, 1u));
    let aside = tangent_frame(viewer) * vec3<f32>(cos(turn), sin(turn), 0.0);
    let upright = vec2<f32>(dot(normal, viewer), dot(normal, aside));
    // A normal at right angles to the slice leaves its middle open to choice.
    let middle = select(atan2(upright.y, upright.x), 0.0, dot(upright, upright) < 1e-12);
    var blocked = 0u;
    for (var step = 0u; step < 2u * min(settings.steps, MOST_STEPS); step++) {
        let side = select(-1.0, 1.0, (step & 1u) == 0u);
        let part = (f32(step >> 1u) + shift.steps) / f32(settings.steps);
        // Beside the tangent plane's projection, so that steps are even on the screen.
        let at = seen_place(camera, place + aside * (side * settings.radius * part * part));
        let seen = seen_at(vec2<i32>(floor(at.pixel)));
        let front = seen.place - place;
        let back = front - viewer * settings.thickness;
        let ends = vec2<f32>(atan2(dot(front, aside), dot(front, viewer)), atan2(dot(back, aside), dot(back, viewer))) - middle;
        // What is behind turns further away from the viewer, on the same side: beyond the ends of the half-circle there is nothing.
        let parts = ends * (1.0 / 3.1415927) + 0.5;
        let counts = occluder_weight(length(front), settings.radius) > shift.directions.y;
        let blocks = at.inside && seen.known && counts && elevation_sine(front, normal) > settings.bias;
        blocked |= select(0u, sector_bits(min(parts.x, parts.y), max(parts.x, parts.y)), blocks);
    }
    var mean = vec3<f32>(0.0);
    var open = 0.0;
    var all_of_it = 0.0;
    for (var sector = 0u; sector < SECTORS; sector++) {
        let angle = middle + 3.1415927 * ((f32(sector) + 0.5) / f32(SECTORS) - 0.5);
        let share = abs(sin(angle));
        let free = select(share, 0.0, ((blocked >> sector) & 1u) == 1u);
        mean += (viewer * cos(angle) + aside * sin(angle)) * free;
        open += free;
        all_of_it += share;
    }
    return bent_add_all(sum, mean, open, all_of_it);
}
#else
/// Adds a direction, marched in a few steps.
fn add_sample(sum: BentSum, index: u32, place: vec3<f32>, normal: vec3<f32>, viewer: vec3<f32>, shift: SampleShift) -> BentSum {
    let direction = tangent_frame(normal) * hemisphere_direction(sample_place(index, settings.samples, shift));
    var visibility = 1.0;
    var outlier = false;
    for (var step = 0u; step < min(settings.steps, MOST_STEPS); step++) {
        let part = (f32(step) + shift.steps) / f32(settings.steps);
        let reached = place + direction * (settings.radius * part * part);
        let at = seen_place(camera, reached);
        let seen = seen_at(vec2<i32>(floor(at.pixel)));
        let towards = seen.place - place;
        let before = dot(seen.place - reached, viewer);
        let rises = at.inside && seen.known && before > 0.0 && elevation_sine(towards, normal) > settings.bias;
        let blocks = rises && before < settings.thickness;
        visibility = min(visibility, select(1.0, 1.0 - occluder_weight(length(towards), settings.radius), blocks));
        outlier = outlier || (rises && !blocks);
    }
    // What is blocked is known to be.
    return bent_add(sum, direction, visibility, outlier && visibility >= 1.0);
}
#endif
#endif
#endif

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
#ifdef OCCLUSION_ONLY
    textureStore(bent, id.xy, vec4<f32>(openness(sum), 0.0, 0.0, 1.0));
#else
    textureStore(bent, id.xy, vec4<f32>(mean_direction(sum), openness(sum)));
#endif
}
