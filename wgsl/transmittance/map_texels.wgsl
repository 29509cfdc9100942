// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::map_texels
// summary: Callback: the texels of a map around a place, and bilinear means of their layers.
// source: none; rgba32float is not filterable in core WebGPU, so that means are taken by loads but with FILTERED.
// note: A mean with what is not finite, as an overflown half float, is 0.
// equation: value = Σ corners (share x)(share y) texel; with FILTERED one read by the texture unit
// error: without FILTERED to rounding, with it within 1e-3; test transmittance/forms::half_floats_are_filtered_as_single_ones_are_mixed.
// parameter size: columns and rows of the map, from 1 up.
// parameter texel: column and row, inside the map.
// parameter value: any, NaN and infinities too.
// parameter map: layers of four numbers.
// parameter layer: of the map, from 0.
// parameter place: position in the map in texels, texel i at i + 0.5.
// parameter corner: 0..3.
// definition FILTERED: means are read through a sampler: for maps of rgba16float, not BOUNDED.
// binding map_sampler: linear, clamped to the edge; with FILTERED only.

#import airlight::core::finite::finite_or

#ifdef FILTERED
@group(#{GROUP}) @binding(11) var map_sampler: sampler;
#endif

/// The four texels of a bilinear read.
struct Footprint {
    /// First and second column.
    columns: vec2<u32>,
    /// First and second row.
    rows: vec2<u32>,
    /// Share of the second column and of the second row, 0..1.
    share: vec2<f32>,
#ifdef FILTERED
    /// The place over the map, 0..1.
    uv: vec2<f32>,
#endif
}

/// The texels around `place`, texel i at i + 0.5; outside of the map of `size` texels the nearest inside.
fn footprint(size: vec2<u32>, place: vec2<f32>) -> Footprint {
    let last = size - vec2<u32>(1u);
    let at = clamp(place - 0.5, vec2<f32>(0.0), vec2<f32>(last));
    let begin = min(vec2<u32>(at), last);
    let next = min(begin + 1u, last);
    let share = at - vec2<f32>(begin);
#ifdef FILTERED
    return Footprint(vec2<u32>(begin.x, next.x), vec2<u32>(begin.y, next.y), share, place / vec2<f32>(size));
#else
    return Footprint(vec2<u32>(begin.x, next.x), vec2<u32>(begin.y, next.y), share);
#endif
}

/// One texel alone.
fn footprint_alone(size: vec2<u32>, texel: vec2<u32>) -> Footprint {
#ifdef FILTERED
    return Footprint(texel.xx, texel.yy, vec2<f32>(0.0), (vec2<f32>(texel) + 0.5) / vec2<f32>(size));
#else
    return Footprint(texel.xx, texel.yy, vec2<f32>(0.0));
#endif
}

/// The texel nearest to `place` alone.
fn footprint_nearest(size: vec2<u32>, place: vec2<f32>) -> Footprint {
    return footprint_alone(size, vec2<u32>(clamp(floor(place), vec2<f32>(0.0), vec2<f32>(size - vec2<u32>(1u)))));
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

/// Zeros for what is not finite.
fn finite_parts(value: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(
        finite_or(value.x, 0.0), finite_or(value.y, 0.0), finite_or(value.z, 0.0), finite_or(value.w, 0.0)
    );
}

/// The bilinear mean of a layer; of one texel where the footprint has no other.
fn mixed_texel(map: texture_2d_array<f32>, at: Footprint, layer: u32) -> vec4<f32> {
#ifdef FILTERED
    return finite_parts(textureSampleLevel(map, map_sampler, at.uv, layer, 0.0));
#else
    let first = textureLoad(map, vec2<u32>(at.columns.x, at.rows.x), layer, 0);
    if all(at.share == vec2<f32>(0.0)) {
        return finite_parts(first);
    }
    let second = textureLoad(map, vec2<u32>(at.columns.y, at.rows.x), layer, 0);
    let third = textureLoad(map, vec2<u32>(at.columns.x, at.rows.y), layer, 0);
    let fourth = textureLoad(map, vec2<u32>(at.columns.y, at.rows.y), layer, 0);
    return finite_parts(mix(mix(first, second, at.share.x), mix(third, fourth, at.share.x), at.share.y));
#endif
}
