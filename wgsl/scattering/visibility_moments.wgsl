// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::visibility_moments
// summary: Mean visibility of a view ray from six filtered moments of the stored depths: bounds of the share beyond it.
// source: Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).
// note: lit if and only if z_ray <= z_stored, so that the mean visibility is the share of stored depths >= z_ray.
// note: Depths are signed, z in -1..1; core/moment_bounds has the moments, the bounds and their derivation.
// note: Bias: storage takes at most sqrt(15) / (2^21 - 1) = 1.9e-6 from the least eigenvalue, and MOMENT_BIAS / 2 is added.
// note: Blend. A lower bound of visibility darkens every ray that ends on a lit surface, whose own depth is among those
// note: stored. For single scattering the paper blends both bounds; MOMENT_BLEND is what erred least over the scenes of
// note: docs/src/moments.md. Near a depth that many texels share visibility is too low by MOMENT_BLEND times their share.
// note: Storage. 21 bits a moment, 126 of the 128 of one rgba32uint texel. With 16 bits, or as two rgba16float layers
// note: (the same 16 bytes), the bias that rounding asks for is 12 or 200 times as large; the page has the errors.
// note: Bits do not filter: bilinear reads are four loads, and one solution for the mean of the four.
// note: Fall-off. Where a light's fall-off differs from column to column, the moments are means weighted by it too, and a
// note: layer more holds its mean: their product is the mean of visibility times fall-off, for each colour.
// equation: V̄ between the bounds of the share of stored depths ≥ z_ray: upper + MOMENT_BLEND (lower − upper)
// equation: stored: round((m · ½ + ½) (2²¹ − 1)), six of 21 bits in 128
// error: stored moments within 0.57 steps; test scattering/moments/filter::texels_hold_the_moments.
// error: prefix means within 1e-4; test scattering/moments/filter::filter_writes_prefix_means.
// error: visibility read within 2e-3; test scattering/moments/filter::reads_are_nearest_or_bilinear.
// parameter depth: of the ray or texel, 0..1.
// parameter texel: as `pack_moments` made it.
// parameter map: packed moments, rgba32uint.
// parameter color: 0 .. colors - 1.
// parameter colors: 1 or 3.
// parameter place: column and row; fractional as of `texels_around`.
// parameter size: columns and rows of the map.
// parameter moments: means of Chebyshev polynomials, -1..1.

#import airlight::core::fourier_basis::GUARD
#import airlight::core::moment_bounds::{Moments, mix_moments, moments_at, share_bounds}

/// Place of the estimate between the upper bound of visibility, 0, and the lower, 1.
const MOMENT_BLEND: f32 = 0.15;
/// View rays keep this far from the ends of the signed depths, in depth 0..1.
const MARGIN: f32 = 0.01;
/// Steps of a moment's 21 bits.
const STEPS: f32 = 2097151.0;

/// Depth 0..1 to -1..1. Blockers in the guard beyond every view ray are all the same.
fn signed_depth(depth: f32) -> f32 {
    return clamp((depth - 0.5) / (0.5 - GUARD + MARGIN), -1.0, 1.0);
}

/// Moments of a single stored `depth`, 0..1.
fn moments_from_depth(depth: f32) -> Moments {
    return moments_at(signed_depth(depth));
}

/// Moments as one texel of an rgba32uint texture: the first four in the low 21 bits, the last two in what is left.
fn pack_moments(moments: Moments) -> vec4<u32> {
    let low = vec3<u32>(round(clamp(moments.low * 0.5 + 0.5, vec3<f32>(0.0), vec3<f32>(1.0)) * STEPS));
    let high = vec3<u32>(round(clamp(moments.high * 0.5 + 0.5, vec3<f32>(0.0), vec3<f32>(1.0)) * STEPS));
    return vec4<u32>(
        low.x | ((high.y & 0x7ffu) << 21u), low.y | ((high.y >> 11u) << 21u),
        low.z | ((high.z & 0x7ffu) << 21u), high.x | ((high.z >> 11u) << 21u)
    );
}

/// What `pack_moments` did, undone. Any bits give moments in -1..1.
fn unpack_moments(texel: vec4<u32>) -> Moments {
    let first = texel & vec4<u32>(0x1fffffu);
    let rest = texel >> vec4<u32>(21u);
    let last = (rest.xz | (rest.yw << vec2<u32>(11u))) & vec2<u32>(0x1fffffu);
    let scale = 2.0 / STEPS;
    return Moments(
        vec3<f32>(first.xyz) * scale - 1.0,
        vec3<f32>(vec3<u32>(first.w, last)) * scale - 1.0
    );
}

/// Least and greatest share of stored depths at or beyond `depth`, both 0..1, that are possible with these moments.
fn moment_bounds(moments: Moments, depth: f32) -> vec2<f32> {
    return share_bounds(moments, signed_depth(depth));
}

/// Mean visibility 0..1 of a ray at `depth`, 0..1, over texels of which these are the moments.
fn moment_visibility(moments: Moments, depth: f32) -> f32 {
    let bounds = moment_bounds(moments, depth);
    return mix(bounds.y, bounds.x, MOMENT_BLEND);
}

/// Mean visibility by a read of the texel at `place`: column and row.
fn moments_visibility_nearest(map: texture_2d<u32>, place: vec2<u32>, depth: f32) -> f32 {
    return moment_visibility(unpack_moments(textureLoad(map, place, 0)), depth);
}

/// The four texels of a bilinear read.
struct Around {
    /// First and second column.
    columns: vec2<u32>,
    /// First and second row.
    rows: vec2<u32>,
    /// Share of the second column and of the second row, 0..1.
    share: vec2<f32>,
}

/// The texels around `place` of a map of `size` texels. `place`: column in texels, texel i at i + 0.5, and row, row j at j;
/// outside of the map the nearest inside. `wraps`: the last row is followed by the first.
fn texels_around(size: vec2<u32>, place: vec2<f32>, wraps: bool) -> Around {
    let last = size - vec2<u32>(1u);
    let greatest = vec2<f32>(f32(last.x), select(f32(last.y), f32(size.y), wraps));
    let at = clamp(place - vec2<f32>(0.5, 0.0), vec2<f32>(0.0), greatest);
    let begin = min(vec2<u32>(at), vec2<u32>(last.x, size.y));
    let row = select(min(begin.y, last.y), begin.y % size.y, wraps);
    let next = select(min(begin.y + 1u, last.y), (begin.y + 1u) % size.y, wraps);
    return Around(vec2<u32>(begin.x, min(begin.x + 1u, last.x)), vec2<u32>(row, next), at - vec2<f32>(begin));
}

/// Mean visibility by a bilinear read. `place` and `wraps` as of `texels_around`.
fn moments_visibility(map: texture_2d<u32>, place: vec2<f32>, wraps: bool, depth: f32) -> f32 {
    let around = texels_around(textureDimensions(map), place, wraps);
    let here = mix_moments(
        unpack_moments(textureLoad(map, vec2<u32>(around.columns.x, around.rows.x), 0)),
        unpack_moments(textureLoad(map, vec2<u32>(around.columns.y, around.rows.x), 0)),
        around.share.x
    );
    let beside = mix_moments(
        unpack_moments(textureLoad(map, vec2<u32>(around.columns.x, around.rows.y), 0)),
        unpack_moments(textureLoad(map, vec2<u32>(around.columns.y, around.rows.y), 0)),
        around.share.x
    );
    return moment_visibility(mix_moments(here, beside, around.share.y), depth);
}

/// Mean of visibility times the fall-off of one `color` by a read of the texel at `place`: column and row. `colors`: how
/// many colours the map has, a layer each; the mean fall-off of all is the layer behind them.
fn moments_color_nearest(
    map: texture_2d_array<u32>, place: vec2<u32>, color: u32, colors: u32, depth: f32
) -> f32 {
    let falloff = bitcast<vec4<f32>>(textureLoad(map, place, colors, 0))[color];
    return clamp(falloff, 0.0, 1.0) * moment_visibility(unpack_moments(textureLoad(map, place, color, 0)), depth);
}

/// The same by a bilinear read, `place` and `wraps` as of `texels_around`. Fall-off times moments is what is interpolated,
/// the mean of both over light rays, so that each texel's moments count as much as light falls on it.
fn moments_color(
    map: texture_2d_array<u32>, place: vec2<f32>, wraps: bool, color: u32, colors: u32, depth: f32
) -> f32 {
    let around = texels_around(textureDimensions(map), place, wraps);
    let a = vec2<u32>(around.columns.x, around.rows.x);
    let b = vec2<u32>(around.columns.y, around.rows.x);
    let c = vec2<u32>(around.columns.x, around.rows.y);
    let d = vec2<u32>(around.columns.y, around.rows.y);
    let falloff = vec4<f32>(
        bitcast<vec4<f32>>(textureLoad(map, a, colors, 0))[color],
        bitcast<vec4<f32>>(textureLoad(map, b, colors, 0))[color],
        bitcast<vec4<f32>>(textureLoad(map, c, colors, 0))[color],
        bitcast<vec4<f32>>(textureLoad(map, d, colors, 0))[color]
    );
    let columns = vec2<f32>(1.0 - around.share.x, around.share.x);
    let shares = vec4<f32>(columns * (1.0 - around.share.y), columns * around.share.y);
    let parts = shares * clamp(falloff, vec4<f32>(0.0), vec4<f32>(1.0));
    let mean = dot(parts, vec4<f32>(1.0));
    // Where no light falls any moments do.
    let weights = parts / max(mean, 1e-30);
    let at_a = unpack_moments(textureLoad(map, a, color, 0));
    let at_b = unpack_moments(textureLoad(map, b, color, 0));
    let at_c = unpack_moments(textureLoad(map, c, color, 0));
    let at_d = unpack_moments(textureLoad(map, d, color, 0));
    let mixed = Moments(
        weights.x * at_a.low + weights.y * at_b.low + weights.z * at_c.low + weights.w * at_d.low,
        weights.x * at_a.high + weights.y * at_b.high + weights.z * at_c.high + weights.w * at_d.high
    );
    return min(mean, 1.0) * moment_visibility(mixed, depth);
}
