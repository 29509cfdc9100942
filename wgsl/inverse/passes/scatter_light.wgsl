// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Radiance that each voxel would scatter in every direction if its albedo were 1: light of one view of a light is added.
// source: thesis 2.4.3, Eq. 2.16 with an isotropic phase function; see inverse/light_layers.
// note: Dispatch over the voxels for each view of each light. Irradiance over 4 pi, times transmittance, times what surfaces let pass.
// definition RGB: three channels; else the first alone.
// definition SURFACES: there are surfaces that cast shadows.
// binding view: of the light, as in inverse/light_depths.
// binding layers: where they lie, and how many voxels there are.
// binding light: the light, with the matrix of its shadow map.
// binding depths: of inverse/light_depths.
// binding sums: in and out, numbers a voxel, x fastest: one; four with RGB, of which the last stays as it is.
// binding shadow_map: depth of surfaces in the view, depth32float, forward; with SURFACES.
// binding shadow_sampler: comparison sampler, linear, less-equal; with SURFACES.

#import airlight::core::light::{Light, direction_to_light, light_falloff, shadow_position}
#import airlight::inverse::slice_steps::SliceView
#import airlight::inverse::light_layers::{LightLayers, layers_to, pixel_of, place_in_layers, face_holds}
#import airlight::inverse::channels::{channels_of, all_channels}
#import airlight::inverse::basis::triangle_field

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var<uniform> layers: LightLayers;
@group(#{GROUP}) @binding(2) var<uniform> light: Light;
@group(#{GROUP}) @binding(3) var depths: texture_3d<f32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> sums: array<f32>;
#ifdef SURFACES
@group(#{GROUP}) @binding(5) var shadow_map: texture_depth_2d;
@group(#{GROUP}) @binding(6) var shadow_sampler: sampler_comparison;
#endif

/// One over all directions, 1/sr.
const ISOTROPIC: f32 = 0.07957747;

@compute @workgroup_size(8, 4, 4)
fn scatter_light(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= layers.size) {
        return;
    }
    let unit = (vec3<f32>(id) + 0.5) / vec3<f32>(layers.size);
    let point = (layers.world_from_unit * vec4<f32>(unit, 1.0)).xyz;
    if !face_holds(layers, -direction_to_light(light, point)) {
        return;
    }
    let pixel = pixel_of(view, unit);
    let between = layers_to(layers, view, unit, pixel);
    let behind = channels_of(triangle_field(depths, place_in_layers(view, pixel, between.x)));
    let before = channels_of(triangle_field(depths, place_in_layers(view, pixel, between.y)));
    let depth = max(behind - before, all_channels(0.0));
    var share = ISOTROPIC * light_falloff(light, point);
#ifdef SURFACES
    let shadow = shadow_position(light, vec2<f32>(1.0), point);
    share *= textureSampleCompareLevel(shadow_map, shadow_sampler, shadow.xy, clamp(shadow.z, 0.0, 1.0));
#endif
    let radiance = share * channels_of(vec4<f32>(light.radiance, 0.0)) * exp(-depth);
    let index = (id.z * layers.size.y + id.y) * layers.size.x + id.x;
#ifdef RGB
    for (var channel = 0u; channel < 3u; channel++) {
        sums[min(4u * index + channel, arrayLength(&sums) - 1u)] += radiance[channel];
    }
#else
    sums[min(index, arrayLength(&sums) - 1u)] += radiance;
#endif
}
