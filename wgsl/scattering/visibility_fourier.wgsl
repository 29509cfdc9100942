// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::visibility_fourier
// summary: Mean visibility of a view ray from filtered Fourier bases: one read a vector of bases, and a dot product.
// source: thesis 4.3.1 and 4.3.2, Eq. 4.6, 4.7 and 4.9; 4.3.3, Listing 4.4.
// note: `place` is where in the row the prefix mean is read, in texture coordinates, or in texels for the nearest one.
// note: `depth` is the ray's, 0..1; `layers` is M / 4; `windowed` takes the Lanczos window, for M of 8 and more.
// note: With colours each has layers of its own, one after the other, and the layer after all holds their mean fall-off:
// note: the constant 1/2 of the series is weighted by it as the bases are.
// equation: V̄ = ½ + Σ_k a_k · mean of B_k over the texels of the ray;  with fall-off: ½ F̄ + Σ_k a_k · mean of F B_k
// error: average visibility on foliage within 0.005 by 32 bases;
// error: test scattering/figures::average_visibility_on_foliage_falls_with_the_bases_to_its_figure.
// error: 8 bits add 0.002 at most; test scattering/figures::average_visibility_on_a_plane_under_an_overhead_light_reaches_its_figure.
// parameter depth: of the ray, 0..1.
// parameter layers: M / 4, from 1 up.
// parameter layer: 0 .. layers - 1.
// parameter windowed: whether with the Lanczos window.
// parameter bases: prefix means of bases, 0..1 stands for -1..1, four a layer.
// parameter bases_sampler: linear; clamp to edge in u, repeat in v.
// parameter place: texture coordinates, or of the nearest texel column and row.
// parameter colors: 1 or 3.

#import airlight::core::fourier_basis::{
    Series, series_first, series_next, coefficients, coefficients_lanczos, basis_from_stored
}

/// The series of a ray and of its window, stepped along together.
struct FourierRay {
    /// Of the ray's depth.
    series: Series,
    /// Of the window.
    window: Series,
}

/// The ray at its first four bases.
fn fourier_ray(depth: f32, layers: u32) -> FourierRay {
    return FourierRay(series_first(depth), series_first(1.0 / f32(4u * layers)));
}

/// What the bases of `layer` are multiplied with.
fn fourier_factors(ray: FourierRay, layer: u32, layers: u32, windowed: bool) -> vec4<f32> {
    if windowed {
        return coefficients_lanczos(ray.series, ray.window, layer, 4u * layers);
    }
    return coefficients(ray.series, layer);
}

/// The ray at the next four bases.
fn fourier_next(ray: FourierRay) -> FourierRay {
    return FourierRay(series_next(ray.series), series_next(ray.window));
}

/// Mean visibility by bilinear reads; not clamped: the series overshoots.
fn fourier_visibility(
    bases: texture_2d_array<f32>, bases_sampler: sampler, place: vec2<f32>, depth: f32, layers: u32, windowed: bool
) -> f32 {
    var ray = fourier_ray(depth, layers);
    var visibility = 0.5;
    for (var layer = 0u; layer < layers; layer++) {
        let stored = textureSampleLevel(bases, bases_sampler, place, layer, 0.0);
        visibility += dot(fourier_factors(ray, layer, layers, windowed), basis_from_stored(stored));
        ray = fourier_next(ray);
    }
    return visibility;
}

/// Mean visibility by reads of the nearest texel; not clamped.
fn fourier_visibility_nearest(
    bases: texture_2d_array<f32>, place: vec2<u32>, depth: f32, layers: u32, windowed: bool
) -> f32 {
    var ray = fourier_ray(depth, layers);
    var visibility = 0.5;
    for (var layer = 0u; layer < layers; layer++) {
        let stored = textureLoad(bases, place, layer, 0);
        visibility += dot(fourier_factors(ray, layer, layers, windowed), basis_from_stored(stored));
        ray = fourier_next(ray);
    }
    return visibility;
}

/// Mean of visibility times fall-off by bilinear reads, 0 up to the mean fall-off. `colors`: 1, the same fall-off for
/// all, or 3, red, green and blue.
fn fourier_colors(
    bases: texture_2d_array<f32>, bases_sampler: sampler, place: vec2<f32>, depth: f32, layers: u32, colors: u32,
    windowed: bool
) -> vec3<f32> {
    let falloff = textureSampleLevel(bases, bases_sampler, place, colors * layers, 0.0).rgb;
    var lit = 0.5 * falloff;
    var ray = fourier_ray(depth, layers);
    for (var layer = 0u; layer < layers; layer++) {
        let factors = fourier_factors(ray, layer, layers, windowed);
        let red = dot(factors, basis_from_stored(textureSampleLevel(bases, bases_sampler, place, layer, 0.0)));
        var both = vec2<f32>(red);
        if colors == 3u {
            let green = textureSampleLevel(bases, bases_sampler, place, layers + layer, 0.0);
            let blue = textureSampleLevel(bases, bases_sampler, place, 2u * layers + layer, 0.0);
            both = vec2<f32>(dot(factors, basis_from_stored(green)), dot(factors, basis_from_stored(blue)));
        }
        lit += vec3<f32>(red, both);
        ray = fourier_next(ray);
    }
    return clamp(lit, vec3<f32>(0.0), falloff);
}

/// Like `fourier_colors` by reads of the nearest texel.
fn fourier_colors_nearest(
    bases: texture_2d_array<f32>, place: vec2<u32>, depth: f32, layers: u32, colors: u32, windowed: bool
) -> vec3<f32> {
    let falloff = textureLoad(bases, place, colors * layers, 0).rgb;
    var lit = 0.5 * falloff;
    var ray = fourier_ray(depth, layers);
    for (var layer = 0u; layer < layers; layer++) {
        let factors = fourier_factors(ray, layer, layers, windowed);
        let red = dot(factors, basis_from_stored(textureLoad(bases, place, layer, 0)));
        var both = vec2<f32>(red);
        if colors == 3u {
            let green = textureLoad(bases, place, layers + layer, 0);
            let blue = textureLoad(bases, place, 2u * layers + layer, 0);
            both = vec2<f32>(dot(factors, basis_from_stored(green)), dot(factors, basis_from_stored(blue)));
        }
        lit += vec3<f32>(red, both);
        ray = fourier_next(ray);
    }
    return clamp(lit, vec3<f32>(0.0), falloff);
}
