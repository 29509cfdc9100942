// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Running means along rows of the moments of depth, or of its exponential warps.
// source: Donnelly and Lauritzen, "Variance shadow maps" (2006); Lauritzen and McCool, "Layered variance shadow maps" (2008); thesis Fig. 4.3.
// note: Texel i holds the means over the texels 0 .. i. One thread takes one row.
// definition EXPONENTIAL: moments of both warps instead of depth's own.
// binding rectified: the rectified map.
// binding moments: out: mean depth and mean squared depth, rg32float; with EXPONENTIAL those of both warps, rgba32float.

#import airlight::core::finite::finite_or
#import airlight::core::prefix_sum::{row_weights, row_weights_next, running_mean}

@group(#{GROUP}) @binding(0) var rectified: texture_2d<f32>;
#ifdef EXPONENTIAL
@group(#{GROUP}) @binding(1) var moments: texture_storage_2d<rgba32float, write>;
#else
@group(#{GROUP}) @binding(1) var moments: texture_storage_2d<rg32float, write>;
#endif

/// Depth 0..1, warped in both directions.
fn warped(depth: f32) -> vec2<f32> {
    let x = 2.0 * depth - 1.0;
    return vec2<f32>(exp(40.0 * x), -exp(-5.0 * x));
}

@compute @workgroup_size(32)
fn filter_rows(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let row = id.x;
    if row >= size.y {
        return;
    }
    var weights = row_weights(0.0);
    var means = vec4<f32>(0.0);
    for (var column = 0u; column < size.x; column++) {
        let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), 0.0, 1.0);
#ifdef EXPONENTIAL
        let warp = warped(depth);
        let value = vec4<f32>(warp.x, warp.x * warp.x, warp.y, warp.y * warp.y);
#else
        let value = vec4<f32>(depth, depth * depth, 0.0, 0.0);
#endif
        means = running_mean(means, value, weights);
        textureStore(moments, vec2<u32>(column, row), means);
        weights = row_weights_next(weights);
    }
}
