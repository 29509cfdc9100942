// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The mask of random holes by itself, to look at and to measure.
// source: stylized scattering, Eq. 4 and 5; thesis, Fig. 6.7.
// definition NOISE: the noise before it is thresholded, 0..1.
// binding holes: what holes look like.
// binding mask: out, r32float: 1 in a hole, else 0; with NOISE the noise.

#ifdef NOISE
#import airlight::stylize::perlin_holes::{HoleParameters, hole_noise}
#else
#import airlight::stylize::perlin_holes::{HoleParameters, discards_hole}
#endif

@group(#{GROUP}) @binding(0) var<uniform> holes: HoleParameters;
@group(#{GROUP}) @binding(1) var mask: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn hole_mask(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(mask);
    if any(id.xy >= size) {
        return;
    }
    let uv = (vec2<f32>(id.xy) + 0.5) / vec2<f32>(size);
#ifdef NOISE
    let value = hole_noise(holes, uv);
#else
    let value = select(0.0, 1.0, discards_hole(holes, uv));
#endif
    textureStore(mask, id.xy, vec4<f32>(value, 0.0, 0.0, 0.0));
}
