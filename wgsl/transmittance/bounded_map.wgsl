// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::bounded_map
// summary: An extinction map whose series covers only the occupied interval of each texel's light ray.
// source: extends Gautron et al., "Extinction transmittance maps" (2011): the same series, another domain.
// note: No coefficient is spent on the empty space before and behind the medium: T is exactly 1 before the interval and
// note: exact behind it. Coefficients of texels whose intervals differ must not be interpolated. A bilinear read
// note: is therefore the mean of four transmittances.
// equation: x' = (x − x₀) / (x₁ − x₀) within the occupied interval x₀..x₁ of a texel;  T = Σ corners share exp(−Σ_j c_j B_j(x'))
// error: within 1e-5 of its reference, and of a fifth of the plain map's error;
// error: test transmittance/forms::intervals_are_not_mixed_but_transmittances_are.
// parameter depth: 0..1 over the range of the map.
// parameter interval: least and greatest occupied depth, 0..1.
// parameter extent: half a length, 0..1 over the range of the map.
// parameter map: layers of four coefficients.
// parameter layers: of the map, four coefficients each.
// parameter monotone: 1 for the Fejer window, 0 for the plain series.
// parameter place: texels of the read, of `footprint`.

#import airlight::transmittance::extinction_map::{extinction_optical_depth, transmittance_of}
#import airlight::transmittance::map_texels::{Footprint, footprint_alone, footprint_texel, footprint_weight}

/// Shortest interval that is told from a point, over the range of the map.
const LEAST_INTERVAL: f32 = 1e-6;

/// A depth of the map, 0..1, as one of `interval`, its least and greatest occupied depth: 0..1, clamped.
fn depth_in_interval(interval: vec2<f32>, depth: f32) -> f32 {
    return clamp((depth - interval.x) / max(interval.y - interval.x, LEAST_INTERVAL), 0.0, 1.0);
}

/// A length over the range of the map as one over the interval.
fn length_in_interval(interval: vec2<f32>, extent: f32) -> f32 {
    return min(extent / max(interval.y - interval.x, LEAST_INTERVAL), 0.5);
}

/// Transmittance 0..1 from the near side to `depth` 0..1: the mean over the footprint. `intervals`: least and greatest
/// occupied depth of each texel; the other parameters as of `extinction_optical_depth`.
fn bounded_transmittance(
    map: texture_2d_array<f32>, intervals: texture_2d<f32>, place: Footprint, depth: f32, layers: u32, monotone: f32
) -> f32 {
    let alone = all(place.share == vec2<f32>(0.0));
    var sum = 0.0;
    for (var corner = 0u; corner < select(4u, 1u, alone); corner++) {
        let texel = footprint_texel(place, corner);
        let own = depth_in_interval(textureLoad(intervals, texel, 0).xy, depth);
        let single = footprint_alone(textureDimensions(map), texel);
        let optical_depth = extinction_optical_depth(map, single, own, layers, monotone);
        sum += footprint_weight(place, corner) * transmittance_of(optical_depth);
    }
    return clamp(sum, 0.0, 1.0);
}
