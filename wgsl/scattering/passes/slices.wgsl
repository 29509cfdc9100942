// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The frame of the epipolar slices and the bounds of each, one thread a slice.
// source: thesis 4.4.1 (bounds), 4.3.2 Eq. 4.12 (reference ray).
// definition LOCAL: a spot or point light; its slices are bounded by light angles.
// definition OPTIMUM: the reference ray is the optimum of Eq. 4.12 instead of the bisectrix, which errs less on pictures.
// binding camera: the camera, perspective.
// binding light: the light, directional without LOCAL.
// binding medium: the medium; its distance limit bounds the slices.
// binding frame: out, the frame that later passes read as a uniform.
// binding slices: out, one texel a slice (width rows, height 1): angle_min, angle_max, radius_max, reference; with LOCAL angle_min, angle_max, light_angle_min, light_angle_max.

#import airlight::core::camera::{Camera, forward_direction}
#import airlight::core::light::{Light, SPOT}
#import airlight::scattering::local_light::{
    place_of_light, distance_to_light, local_slice_bounds, local_slice_texel
}
#import airlight::scattering::rectify::{
    Frame, epipolar_frame, row_azimuth, slice_bounds, slice_texel, reference_optimum
}
#import airlight::scattering::single_scatter::Medium

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(3) var<storage, read_write> frame: Frame;
@group(#{GROUP}) @binding(4) var slices: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64)
fn slices_main(@builtin(global_invocation_id) id: vec3<u32>) {
    let rows = textureDimensions(slices).x;
    if id.x >= rows {
        return;
    }
#ifdef LOCAL
    let place = place_of_light(light.position, camera.eye, forward_direction(camera));
    let around = epipolar_frame(camera, place.xyz, rows);
    // Everything is within an angle whose cosine is -1.
    let cosine = select(-1.0, light.spot_cosines.y, light.kind == SPOT);
    let away = distance_to_light(around, light.position);
    let bounds = local_slice_bounds(
        camera, around, row_azimuth(around, f32(id.x)), medium.distance_limit, away, -light.direction, cosine
    );
    textureStore(slices, vec2<u32>(id.x, 0u), local_slice_texel(bounds));
#else
    let around = epipolar_frame(camera, light.direction, rows);
    var bounds = slice_bounds(camera, around, row_azimuth(around, f32(id.x)), medium.distance_limit);
#ifdef OPTIMUM
    bounds.reference = reference_optimum(bounds.angle_min, bounds.angle_max);
#endif
    textureStore(slices, vec2<u32>(id.x, 0u), slice_texel(bounds));
#endif
    if id.x == 0u {
        frame = around;
    }
}
