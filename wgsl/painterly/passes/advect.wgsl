// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Draws noise out along the directions of greatest curvature in the picture.
// source: as painterly/advection.
// binding parameters: how far and how clearly.
// binding curvature: of `iso_raycast` with CURVATURE, or any field of (cos 2a, sin 2a) in z and w.
// binding streaks: out, r32float: 0..1, and 0.5 where there is no direction.

#import airlight::painterly::advection::{StreakParameters, streak}

@group(#{GROUP}) @binding(0) var<uniform> parameters: StreakParameters;
@group(#{GROUP}) @binding(1) var curvature: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var streaks: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn advect(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(streaks)) {
        return;
    }
    textureStore(streaks, id.xy, vec4<f32>(streak(curvature, id.xy, parameters)));
}
