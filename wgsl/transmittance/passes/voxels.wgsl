// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Builds a transmittance map from a volume: the light ray of each texel is marched and projected.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 1; Delalandre et al. (2011) with FUNCTION.
// note: Steps are of a voxel at most and of equal length from where the ray enters the volume to where it leaves it; the sample in
// note: the middle stands for the whole step, whose projection is exact. Values that are not finite or negative are 0.
// note: Runs of samples among empty bricks are passed over; what is found is the same without them.
// note: BOUNDED marches twice: for the steps that hold anything, then for the projection.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition FUNCTION: transmittance function map; without this and the next four an extinction map of cosines.
// definition PERIODIC: the series of the full period instead of cosines: a Fourier opacity map, or with FUNCTION.
// definition POWER: six power moments.
// definition TRIGONOMETRIC: two trigonometric moments.
// definition BOUNDED: an extinction map over the occupied interval of each texel.
// definition LINEAR: trilinear reads; else the nearest voxel.
// definition RGBA16FLOAT: half floats; not for moments, which need 32 bits.
// binding light: the directional light of the map.
// binding volume: where the volume lies.
// binding extinction: the volume, any float format; with LINEAR one that filters.
// binding volume_sampler: linear, clamped to the edge; with LINEAR only.
// binding brick_distances: of core/brick_distances, for the volume; or a single 0.
// binding coefficients: out, the layers of the map.
// binding intervals: out, least and greatest occupied depth, 0..1; 1 and 0 where there is none. With BOUNDED only.

#import airlight::core::bricks::run_of_samples
#import airlight::core::light::Light
#import airlight::core::volume::{VolumeSpace, segment_in_box, march_steps, voxel_at}
#import airlight::transmittance::light_space::{map_point, map_range}
#import airlight::transmittance::map_form::{
    Contribution, contribution, walk_add, walk_from, walk_on, walk_sum, LAYERS
}
#import airlight::transmittance::medium::extinction_of_value
#ifdef BOUNDED
#import airlight::transmittance::bounded_map::LEAST_INTERVAL
#endif
#ifdef FUNCTION
#import airlight::transmittance::function_map::mean_transmittance
#endif

@group(#{GROUP}) @binding(0) var<uniform> light: Light;
@group(#{GROUP}) @binding(1) var<uniform> volume: VolumeSpace;
@group(#{GROUP}) @binding(2) var extinction: texture_3d<f32>;
#ifdef LINEAR
@group(#{GROUP}) @binding(3) var volume_sampler: sampler;
#endif
#ifdef RGBA16FLOAT
@group(#{GROUP}) @binding(4) var coefficients: texture_storage_2d_array<rgba16float, write>;
/// The greatest half float.
const GREATEST: f32 = 65504.0;
#else
@group(#{GROUP}) @binding(4) var coefficients: texture_storage_2d_array<rgba32float, write>;
const GREATEST: f32 = 1e30;
#endif
#ifdef BOUNDED
@group(#{GROUP}) @binding(5) var intervals: texture_storage_2d<rg32float, write>;
#endif

@group(#{GROUP}) @binding(6) var brick_distances: texture_3d<u32>;

/// Extinction at a place in unit space, 1/m.
fn extinction_at(unit: vec3<f32>) -> f32 {
#ifdef LINEAR
    let value = textureSampleLevel(extinction, volume_sampler, unit, 0.0).x;
#else
    let value = textureLoad(extinction, voxel_at(unit, textureDimensions(extinction)), 0).x;
#endif
    return extinction_of_value(value, volume);
}

@compute @workgroup_size(16, 8)
fn march_voxels(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(coefficients);
    if any(id.xy >= size) {
        return;
    }
    let texels = vec2<f32>(id.xy) + 0.5;
    let near = map_point(light, vec2<f32>(size), texels, 0.0);
    let far = map_point(light, vec2<f32>(size), texels, 1.0);
    let origin = (volume.unit_from_world * vec4<f32>(near, 1.0)).xyz;
    let along = (volume.unit_from_world * vec4<f32>(far - near, 0.0)).xyz;
    let part = segment_in_box(origin, along);
    let range = map_range(light);
    let steps = march_steps((part.y - part.x) * range, volume);
    let depth_step = (part.y - part.x) / f32(steps);
    let metres = depth_step * range;
    let step = depth_step * along;

#ifdef BOUNDED
    var interval = vec2<f32>(1.0, 0.0);
    for (var next = 0u; next < steps;) {
        let at = origin + (part.x + (f32(next) + 0.5) * depth_step) * along;
        let run = run_of_samples(brick_distances, textureDimensions(extinction), at, step, next, steps);
        for (var i = run.begin; i < run.end; i++) {
            let depth = part.x + (f32(i) + 0.5) * depth_step;
            let occupied = extinction_at(origin + depth * along) * metres > 0.0;
            let reached = vec2<f32>(depth - 0.5 * depth_step, depth + 0.5 * depth_step);
            interval = select(interval, vec2<f32>(min(interval.x, reached.x), max(interval.y, reached.y)), occupied);
        }
        next = run.end;
    }
    textureStore(intervals, id.xy, vec4<f32>(interval, 0.0, 0.0));
#endif

#ifdef BOUNDED
    let scale = 1.0 / max(interval.y - interval.x, LEAST_INTERVAL);
    let near_side = interval.x;
#else
    let scale = 1.0;
    let near_side = 0.0;
#endif
    let walk_step = depth_step * scale;
    var sums: Contribution;
    for (var layer = 0u; layer < LAYERS; layer++) {
        sums.layers[layer] = vec4<f32>(0.0);
    }
#ifdef FUNCTION
    // Clear up to where the volume begins, and the same from where it ends. Where nothing is, transmittance stays.
    var clear = contribution(0.5 * part.x, 0.5 * part.x);
    for (var layer = 0u; layer < LAYERS; layer++) {
        clear.layers[layer] *= part.x;
    }
    var passed = 0.0;
#endif
    for (var next = 0u; next < steps;) {
        let at = origin + (part.x + (f32(next) + 0.5) * depth_step) * along;
        let run = run_of_samples(brick_distances, textureDimensions(extinction), at, step, next, steps);
#ifdef FUNCTION
        let half = 0.5 * f32(run.begin - next) * depth_step;
        let stays = contribution(part.x + f32(next) * depth_step + half, half);
        for (var layer = 0u; layer < LAYERS; layer++) {
            clear.layers[layer] += 2.0 * half * exp(-passed) * stays.layers[layer];
        }
#endif
        // A run among occupied bricks is at most some 14 voxels long: what a walk may be.
        var walk = walk_from((part.x + (f32(run.begin) + 0.5) * depth_step - near_side) * scale, walk_step);
        for (var i = run.begin; i < run.end; i++) {
            let depth = part.x + (f32(i) + 0.5) * depth_step;
            let optical_depth = extinction_at(origin + depth * along) * metres;
#ifdef FUNCTION
            let weight = depth_step * exp(-passed) * mean_transmittance(optical_depth);
            passed += optical_depth;
#else
            let weight = optical_depth;
#endif
            sums = walk_add(sums, walk, weight);
            walk = walk_on(walk);
        }
        next = run.end;
    }
    sums = walk_sum(sums, walk_step);
#ifdef FUNCTION
    let rest = 1.0 - part.y;
    let behind = contribution(part.y + 0.5 * rest, 0.5 * rest);
    for (var layer = 0u; layer < LAYERS; layer++) {
        sums.layers[layer] += clear.layers[layer] + rest * exp(-passed) * behind.layers[layer];
    }
#endif
    for (var layer = 0u; layer < LAYERS; layer++) {
        textureStore(coefficients, id.xy, layer, clamp(sums.layers[layer], vec4<f32>(-GREATEST), vec4<f32>(GREATEST)));
    }
}
