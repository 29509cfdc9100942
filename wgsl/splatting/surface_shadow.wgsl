// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::surface_shadow
// summary: Which part of a sheet lies before a surface, and what arrives of the light at a point where surfaces block it.
// source: Zhang and Crawfis, 4.1, Fig. 6 and 7, Table 1.
// note: Heights along the sheets' normal take the place of depths: light climbs along every ray, so that of two points on one light ray
// note: the lower is the nearer. Footprints end at surfaces, so that a texel of the shadow buffer keeps what reached its
// note: surface. A comparison of heights then is right before, within and behind the volume (regions 1, 2 and 3).
// equation: share = (h₁ − h₀) / thickness;  mean before the surface = mean / share;  light = Σ corners weight [surface not in range] reached
// error: shadows of polygons are those of rays, 1 % of what is lit; test splatting/polygons::shadows_of_polygons_are_those_of_rays.
// error: what lies behind a surface shades it by less than 3 %; test splatting/surfaces::what_lies_behind_a_surface_does_not_shade_it.
// parameter height: metres along the sheets' normal.
// parameter index: number of the sheet, from 0.
// parameter climbs: whether the ray's height grows along it.
// parameter surface: metres along the normal; NO_SURFACE for none.
// parameter heights: of a sheet's or a part's ends, metres; of `light_on_surface` r32float, of the first surface along light rays.
// parameter mean: of the sheet's values, from 0 up.
// parameter point: metres in the world.
// parameter place: in the buffer, 0..1.
// parameter size: columns and rows.
// parameter tap: 0..3.
// parameter range: heights, metres.
// parameter reach: metres, from 0 up.
// parameter share: 0..1.
// parameter reached: linear RGB light.

#import airlight::splatting::sheets::{Sheets, sheet_heights}

/// Height where a ray meets no surface, metres.
const NO_SURFACE: f32 = 1e30;
/// Texels by which heights of one surface differ from one to the next at most, where it counts as lit: some 83 degrees from across the light.
const STEEPEST_TEXELS: f32 = 8.0;

/// Whether there is a surface at a height.
fn is_surface(height: f32) -> bool {
    return height < 0.5 * NO_SURFACE;
}

/// Heights between which a ray that climbs or descends sees a sheet, metres: up to the surface at `surface`, NO_SURFACE where there is none.
fn heights_before_surface(sheets: Sheets, index: u32, climbs: bool, surface: f32) -> vec2<f32> {
    let heights = sheet_heights(sheets, index);
    let cut = select(max(heights, vec2<f32>(surface)), min(heights, vec2<f32>(surface)), climbs);
    return select(heights, cut, is_surface(surface));
}

/// Share of a sheet's thickness between two heights, 0..1.
fn share_of_sheet(sheets: Sheets, heights: vec2<f32>) -> f32 {
    return clamp((heights.y - heights.x) / sheets.thickness, 0.0, 1.0);
}

/// The mean over the part of a sheet before a surface, from that over all of it; `share`: of that part.
fn mean_before_surface(mean: f32, share: f32) -> f32 {
    return mean / max(share, 1e-3);
}

/// A surface's point moved off it by what a texel of the shadow buffer may be mistaken, metres. `texel`: its side there, metres; `normal`: unit,
/// to the side that is seen; `towards`: unit vector TOWARDS the light.
fn off_surface(texel: f32, point: vec3<f32>, normal: vec3<f32>, towards: vec3<f32>) -> vec3<f32> {
    return point + normal * (1.5 * texel) + towards * texel;
}

/// One of the four texels nearest to a place.
struct NearTexel {
    /// Column and row.
    texel: vec2<u32>,
    /// Share of the place, the four add up to 1.
    weight: f32,
}

/// The texel `tap`, 0 to 3, of the four nearest to a place of a map of `size`, 0..1.
fn near_texel(place: vec2<f32>, size: vec2<u32>, tap: u32) -> NearTexel {
    let last = vec2<f32>(size) - 1.0;
    let texel = clamp(place * vec2<f32>(size) - 0.5, vec2<f32>(0.0), last);
    let low = floor(texel);
    let part = texel - low;
    let step = vec2<f32>(f32(tap & 1u), f32(tap >> 1u));
    let weights = select(1.0 - part, part, step > vec2<f32>(0.5));
    return NearTexel(vec2<u32>(min(low + step, last)), weights.x * weights.y);
}

/// What arrives at a point, of the light that `reached` the first surface or what lies before it, linear RGB, and the share of it that no
/// surface blocks: of the four nearest texels those count whose surface does not lie in `range`, which ends at the point's
/// height. `heights`: r32float, of the first surface along light rays; `place`: of the point, 0..1 over both; beyond the edge it is that at the edge.
fn light_before_surfaces(
    reached: texture_2d<f32>, heights: texture_2d<f32>, place: vec2<f32>, range: vec2<f32>
) -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    for (var tap = 0u; tap < 4u; tap++) {
        let near = near_texel(place, textureDimensions(heights), tap);
        let surface = textureLoad(heights, near.texel, 0).x;
        let lit = surface < range.x || surface >= range.y;
        sum += select(0.0, near.weight, lit) * vec4<f32>(textureLoad(reached, near.texel, 0).rgb, 1.0);
    }
    return sum;
}

/// What arrives at a surface's point at `height`, of the light that `reached` the first surface along each light ray, linear RGB: over those
/// of the four nearest texels whose surface is no more than `reach` metres higher or lower. Rays that pass beside the surface have
/// gone on into the volume behind it and know nothing of the point; where no texel is near enough, the brightest counts.
fn light_on_surface(
    reached: texture_2d<f32>, heights: texture_2d<f32>, place: vec2<f32>, height: f32, reach: f32
) -> vec3<f32> {
    var sum = vec4<f32>(0.0);
    var brightest = vec3<f32>(0.0);
    for (var tap = 0u; tap < 4u; tap++) {
        let near = near_texel(place, textureDimensions(heights), tap);
        let light = textureLoad(reached, near.texel, 0).rgb;
        let own = abs(textureLoad(heights, near.texel, 0).x - height) <= reach;
        sum += select(0.0, near.weight, own) * vec4<f32>(light, 1.0);
        brightest = max(brightest, light);
    }
    return select(brightest, sum.rgb / max(sum.a, 1e-3), sum.a >= 1e-3);
}
