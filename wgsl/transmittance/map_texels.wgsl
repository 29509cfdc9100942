// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::map_texels
// summary: The texels of a map around a place, and bilinear means of their layers.
// source: none; rgba32float is not filterable in core WebGPU, so that means are taken by loads.
// note: What is not finite, as an overflown half float, is read as 0.

#import airlight::core::finite::finite_or

/// The four texels of a bilinear read.
struct Footprint {
    /// First and second column.
    columns: vec2<u32>,
    /// First and second row.
    rows: vec2<u32>,
    /// Share of the second column and of the second row, 0..1.
    share: vec2<f32>,
}

/// The texels around `place`, texel i at i + 0.5; outside of the map of `size` texels the nearest inside.
fn footprint(size: vec2<u32>, place: vec2<f32>) -> Footprint {
    let last = size - vec2<u32>(1u);
    let at = clamp(place - 0.5, vec2<f32>(0.0), vec2<f32>(last));
    let begin = min(vec2<u32>(at), last);
    let next = min(begin + 1u, last);
    return Footprint(vec2<u32>(begin.x, next.x), vec2<u32>(begin.y, next.y), at - vec2<f32>(begin));
}

/// The texel nearest to `place` alone.
fn footprint_nearest(size: vec2<u32>, place: vec2<f32>) -> Footprint {
    let last = vec2<f32>(size - vec2<u32>(1u));
    let at = vec2<u32>(clamp(floor(place), vec2<f32>(0.0), last));
    return Footprint(at.xx, at.yy, vec2<f32>(0.0));
}

/// Texel `corner` 0..3 of the footprint: 0 and 1 in the first row.
fn footprint_texel(at: Footprint, corner: u32) -> vec2<u32> {
    return vec2<u32>(select(at.columns.x, at.columns.y, (corner & 1u) == 1u), select(at.rows.x, at.rows.y, corner > 1u));
}

/// Share 0..1 of texel `corner` in a bilinear mean.
fn footprint_weight(at: Footprint, corner: u32) -> f32 {
    let across = select(1.0 - at.share.x, at.share.x, (corner & 1u) == 1u);
    return across * select(1.0 - at.share.y, at.share.y, corner > 1u);
}

/// A texel of a layer, finite.
fn finite_texel(map: texture_2d_array<f32>, texel: vec2<u32>, layer: u32) -> vec4<f32> {
    let value = textureLoad(map, texel, layer, 0);
    return vec4<f32>(
        finite_or(value.x, 0.0), finite_or(value.y, 0.0), finite_or(value.z, 0.0), finite_or(value.w, 0.0)
    );
}

/// The bilinear mean of a layer; of one texel where the footprint has no other.
fn mixed_texel(map: texture_2d_array<f32>, at: Footprint, layer: u32) -> vec4<f32> {
    let first = finite_texel(map, vec2<u32>(at.columns.x, at.rows.x), layer);
    if all(at.share == vec2<f32>(0.0)) {
        return first;
    }
    let second = finite_texel(map, vec2<u32>(at.columns.y, at.rows.x), layer);
    let third = finite_texel(map, vec2<u32>(at.columns.x, at.rows.y), layer);
    let fourth = finite_texel(map, vec2<u32>(at.columns.y, at.rows.y), layer);
    return mix(mix(first, second, at.share.x), mix(third, fourth, at.share.x), at.share.y);
}
