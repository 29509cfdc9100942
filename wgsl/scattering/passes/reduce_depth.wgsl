// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Depth of the pixels that a reduced picture evaluates, for passes that then run at that size with its camera.
// source: joint bilateral upsampling, Kopf, Cohen, Lischinski and Uyttendaele (2007); see scattering/upsample.
// note: The camera that goes with it is the host's `Camera::reduced`: its pixel centres are those of the evaluated pixels.
// binding camera: the camera of the full picture, any.
// binding reduction: the factor.
// binding depth: depth buffer of the full picture, a depth format or r32float; non-finite values count as far.
// binding reduced_depth: out, r32float: depth 0..1 of the evaluated pixels; ceil(size / factor) texels a side.

#import airlight::core::camera::Camera
#import airlight::core::finite::finite_or
#import airlight::scattering::upsample::{Reduction, evaluated_pixel}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> reduction: Reduction;
@group(#{GROUP}) @binding(2) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var reduced_depth: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn reduce_depth(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(reduced_depth)) {
        let source = min(evaluated_pixel(reduction, id.xy), textureDimensions(depth) - 1u);
        let value = clamp(finite_or(textureLoad(depth, source, 0).x, camera.far_depth), 0.0, 1.0);
        textureStore(reduced_depth, id.xy, vec4<f32>(value, 0.0, 0.0, 0.0));
    }
}
