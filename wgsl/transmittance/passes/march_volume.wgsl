// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Picture of a volume lit through a transmittance map: view rays are marched from the eye.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 3 for the light of each step.
// note: Steps are of a voxel at most and of equal length from where the ray enters the volume to where it leaves it or meets
// note: the surface; a march ends where less than LEAST_TRANSMITTANCE is left. Alpha is the transmittance to the background.
// note: Runs of samples among empty bricks are passed over; what is found is the same without them.
// note: REFERENCE marches to the light from every step, by steps of a voxel: what maps are measured against.
// note: A depth that is not finite counts as far; extinctions that are not finite or negative as 0.
// definition REFERENCE: marches to the light instead of a map, without the next seven and COEFFICIENTS.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition FUNCTION: transmittance function map; without this and the next four an extinction map of cosines.
// definition PERIODIC: the series of the full period instead of cosines: a Fourier opacity map, or with FUNCTION.
// definition POWER: six power moments.
// definition TRIGONOMETRIC: two trigonometric moments.
// definition BOUNDED: an extinction map over the occupied interval of each texel.
// definition MONOTONE: with the Fejer window, extinction maps only.
// definition FILTERED: bilinear means are read through a sampler: for maps of rgba16float, not BOUNDED.
// definition NEAREST: the nearest texel of the map instead of a bilinear read.
// definition LINEAR: trilinear reads of the volume; else the nearest voxel.
// binding coefficients: the layers of the map, rgba32float or rgba16float; not with REFERENCE.
// binding map_sampler: linear, clamped to the edge; with FILTERED only.
// binding intervals: least and greatest occupied depth, 0..1, rg32float; with BOUNDED only.
// binding camera: the camera, perspective or orthographic.
// binding light: the directional light, of the map.
// binding lighting: how the medium scatters.
// binding volume: where the volume lies.
// binding extinction: the volume, any float format; with LINEAR one that filters.
// binding volume_sampler: linear, clamped to the edge; with LINEAR only.
// binding brick_distances: of core/brick_distances, for the volume; or a single 0.
// binding depth: depth buffer of the picture, a depth format or r32float.
// binding picture: out of the compute entry point (the fragment entry point returns it), rgba16float: premultiplied linear RGB radiance, and in alpha the transmittance to the background.

#import airlight::core::bricks::run_of_samples
#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel, distance_from_depth}
#import airlight::core::finite::finite_or
#import airlight::core::light::Light
#import airlight::core::picture::picture_corner
#import airlight::core::volume::{VolumeSpace, segment_in_box, march_steps, voxel_at, metres_across}
#import airlight::transmittance::medium::{
    MediumLighting, source_radiance, marched_nothing, marched_on, medium_pixel, extinction_of_value
}
#ifndef REFERENCE
#import airlight::transmittance::light_space::map_position
#import airlight::transmittance::transmittance_map::{transmittance, transmittance_map_size}
#endif

@group(#{GROUP}) @binding(2) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(3) var<uniform> light: Light;
@group(#{GROUP}) @binding(4) var<uniform> lighting: MediumLighting;
@group(#{GROUP}) @binding(5) var<uniform> volume: VolumeSpace;
@group(#{GROUP}) @binding(6) var extinction: texture_3d<f32>;
#ifdef LINEAR
@group(#{GROUP}) @binding(7) var volume_sampler: sampler;
#endif
@group(#{GROUP}) @binding(8) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(9) var picture: texture_storage_2d<rgba16float, write>;

@group(#{GROUP}) @binding(10) var brick_distances: texture_3d<u32>;

/// What lies behind so little of the ray's light is not marched.
const LEAST_TRANSMITTANCE: f32 = 1e-4;
/// Marches to the light end at this optical depth.
const DARK: f32 = 16.0;

/// Extinction at a place in unit space, 1/m.
fn extinction_at(unit: vec3<f32>) -> f32 {
#ifdef LINEAR
    return extinction_of_value(textureSampleLevel(extinction, volume_sampler, unit, 0.0).x, volume);
#else
    return extinction_of_value(textureLoad(extinction, voxel_at(unit, textureDimensions(extinction)), 0).x, volume);
#endif
}

#ifdef REFERENCE
/// Transmittance from the light to a place in unit space, 0..1, by a march.
fn marched_to_light(unit: vec3<f32>) -> f32 {
    let reach = metres_across(volume);
    let along = (volume.unit_from_world * vec4<f32>(reach * light.direction, 0.0)).xyz;
    let end = segment_in_box(unit, along).y;
    let steps = march_steps(end * reach, volume);
    let metres = end * reach / f32(steps);
    var passed = 0.0;
    let step = end / f32(steps) * along;
    for (var next = 0u; next < steps && passed < DARK;) {
        let first = unit + (f32(next) + 0.5) * step;
        let run = run_of_samples(brick_distances, textureDimensions(extinction), first, step, next, steps);
        for (var i = run.begin; i < run.end && passed < DARK; i++) {
            passed += metres * extinction_at(unit + (f32(i) + 0.5) * step);
        }
        next = run.end;
    }
    return exp(-passed);
}
#endif

/// Premultiplied radiance of a pixel, and transmittance to its background.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let ray = view_ray(camera, ndc);
    let at_depth = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let distance = distance_from_depth(camera, ray, ndc, at_depth, lighting.distance_limit);
    let origin = (volume.unit_from_world * vec4<f32>(ray.origin, 1.0)).xyz;
    let along = (volume.unit_from_world * vec4<f32>(distance * ray.direction, 0.0)).xyz;
    let part = segment_in_box(origin, along);
    let metres = (part.y - part.x) * distance;
    let steps = march_steps(metres, volume);
    let enters = origin + part.x * along;
    let leaves = origin + part.y * along;
#ifndef REFERENCE
    // A directional light's map is affine, so that places in it lie evenly along the ray.
    let size = vec2<f32>(transmittance_map_size());
    let map_enters = map_position(light, size, ray.origin + part.x * distance * ray.direction);
    let map_leaves = map_position(light, size, ray.origin + part.y * distance * ray.direction);
#endif
    var marched = marched_nothing();
    let step = (leaves - enters) / f32(steps);
    for (var next = 0u; next < steps && marched.transmittance > LEAST_TRANSMITTANCE;) {
        let first = mix(enters, leaves, (f32(next) + 0.5) / f32(steps));
        let run = run_of_samples(brick_distances, textureDimensions(extinction), first, step, next, steps);
        for (var i = run.begin; i < run.end && marched.transmittance > LEAST_TRANSMITTANCE; i++) {
            let share = (f32(i) + 0.5) / f32(steps);
            let unit = mix(enters, leaves, share);
            let optical_depth = extinction_at(unit) * metres / f32(steps);
#ifdef REFERENCE
            var lit = 1.0;
            // A loop, not a branch: some adapters run a branch where no lane takes it, but no such loop.
            for (var dense = optical_depth > 0.0; dense; dense = false) {
                lit = marched_to_light(unit);
            }
#else
            let at = mix(map_enters, map_leaves, share);
            let lit = transmittance(at.xy, at.z);
#endif
            marched = marched_on(marched, optical_depth, lit);
        }
        next = run.end;
    }
    return medium_pixel(source_radiance(lighting, light.radiance, dot(ray.direction, light.direction)), marched);
}

@compute @workgroup_size(16, 8)
fn march_volume(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(picture)) {
        textureStore(picture, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_march_volume(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
