// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// The competitor: Chebyshev's one-sided bound from prefiltered moments, one look-up a ray.
// definition EXPONENTIAL: of both exponential warps, the lesser of the two bounds.
// binding moments: the filtered moments.

@group(#{GROUP}) @binding(6) var moments: texture_2d<f32>;

/// Least variance of depth: a standard deviation of 0.0045 of its range, against acne.
const LEAST_VARIANCE: f32 = 2e-5;
/// Least standard deviation of a warp, in units of the slope of the warp at the ray.
const LEAST_DEVIATION: f32 = 1e-4;

fn row_columns() -> u32 {
    return textureDimensions(moments).x;
}

/// Upper bound of the share of values of at least `x`. `mean`, `square`: of the values and of their squares.
fn chebyshev(mean: f32, square: f32, least: f32, x: f32) -> f32 {
    let variance = max(square - mean * mean, least);
    let beyond = x - mean;
    return select(variance / (variance + beyond * beyond), 1.0, beyond <= 0.0);
}

/// Average visibility of a ray of depth `ray` over the first `texels` columns of a row, to the nearest column.
fn average_visibility(row: u32, ray: f32, texels: f32) -> f32 {
    let last = clamp(u32(texels + 0.5), 1u, row_columns()) - 1u;
    let means = textureLoad(moments, vec2<u32>(last, row), 0);
#ifdef EXPONENTIAL
    let x = 2.0 * ray - 1.0;
    let warp = vec2<f32>(exp(40.0 * x), -exp(-5.0 * x));
    let least = LEAST_DEVIATION * vec2<f32>(40.0, 5.0) * warp;
    return min(
        chebyshev(means.x, means.y, least.x * least.x, warp.x),
        chebyshev(means.z, means.w, least.y * least.y, warp.y)
    );
#else
    return chebyshev(means.x, means.y, LEAST_VARIANCE, ray);
#endif
}
