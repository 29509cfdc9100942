// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The frame of the epipolar slices and the bounds of each, one thread a slice.
// source: thesis 4.4.1 (bounds), 4.3.2 Eq. 4.12 (reference ray).
// definition BISECTRIX: the reference ray is the bisectrix instead of the optimum of Eq. 4.12.
// binding camera: the camera, perspective.
// binding light: the directional light.
// binding medium: the medium; its distance limit bounds the slices.
// binding frame: out, the frame that later passes read as a uniform.
// binding slices: out, one texel a slice (width rows, height 1): angle_min, angle_max, radius_max, reference.

#import airlight::core::camera::Camera
#import airlight::core::light::Light
#import airlight::scattering::rectify::{Frame, epipolar_frame, row_azimuth, slice_bounds, slice_texel, reference_bisectrix}
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
    let around = epipolar_frame(camera, light.direction, rows);
    var bounds = slice_bounds(camera, around, row_azimuth(around, f32(id.x)), medium.distance_limit);
#ifdef BISECTRIX
    bounds.reference = reference_bisectrix(bounds.angle_min, bounds.angle_max);
#endif
    textureStore(slices, vec2<u32>(id.x, 0u), slice_texel(bounds));
    if id.x == 0u {
        frame = around;
    }
}
