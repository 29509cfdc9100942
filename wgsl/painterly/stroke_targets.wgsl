// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::stroke_targets
// summary: What the ray caster wrote, for passes that put strokes on surfaces: a callback that an engine may replace.
// source: Ramalhao (2010), 4.1, 4.2.1: the off-screen textures that strokes look up.
// note: All of one size. A texel with a distance, normal or gradient magnitude that is not finite counts as no surface; a
// note: colour that is not finite is black, and a curvature that is not finite is none.
// equation: none: it reads what the ray caster wrote.
// error: exact; what is not finite is no surface; test painterly/stroke_life::sources_that_are_not_finite_do_no_harm.
// parameter pixel: column and row of the sources, from 0.
// definition CURVATURE: strokes may follow the direction of greatest curvature.
// binding color: premultiplied linear RGB, alpha 1 where there is a surface; rgba16float.
// binding surface: unit normal in the world, 0 where there is no surface, and gradient magnitude; rgba16float.
// binding distances: metres along the view ray, negative where there is no surface; r32float.
// binding curvature: principal curvatures, and (cos 2a, sin 2a) of the picture's direction of the greater; with CURVATURE only.

#import airlight::core::finite::{finite_or, finite_or_rgb, is_finite}
#import airlight::painterly::stroke_update::SurfaceTexel

@group(#{GROUP}) @binding(0) var color: texture_2d<f32>;
@group(#{GROUP}) @binding(1) var surface: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var distances: texture_2d<f32>;
#ifdef CURVATURE
@group(#{GROUP}) @binding(3) var curvature: texture_2d<f32>;
#endif

/// Columns and rows of the sources.
fn source_size() -> vec2<u32> {
    return textureDimensions(distances);
}

/// Gradient magnitude at a pixel of the sources; negative where there is no surface.
fn magnitude_at(pixel: vec2<u32>) -> f32 {
    let at = textureLoad(surface, pixel, 0);
    let far = textureLoad(distances, pixel, 0).x;
    let finite = is_finite(far) && is_finite(at.x) && is_finite(at.y) && is_finite(at.z) && is_finite(at.w);
    let normal = select(vec3<f32>(0.0), at.xyz, finite);
    let there = finite && far >= 0.0 && at.w >= 0.0 && dot(normal, normal) > 0.25;
    return select(-1.0, at.w, there);
}

/// All that there is to know of a pixel of the sources.
fn surface_texel(pixel: vec2<u32>) -> SurfaceTexel {
    let magnitude = magnitude_at(pixel);
    let there = magnitude >= 0.0;
    let tint = clamp(finite_or_rgb(textureLoad(color, pixel, 0).rgb, 0.0), vec3<f32>(0.0), vec3<f32>(65504.0));
    let normal = textureLoad(surface, pixel, 0).xyz;
    let length_squared = select(1.0, dot(normal, normal), there);
    var direction = vec2<f32>(0.0);
#ifdef CURVATURE
    let twice = textureLoad(curvature, pixel, 0).zw;
    direction = vec2<f32>(finite_or(twice.x, 0.0), finite_or(twice.y, 0.0));
#endif
    return SurfaceTexel(
        tint,
        select(-1.0, textureLoad(distances, pixel, 0).x, there),
        select(vec3<f32>(0.0), normal * inverseSqrt(length_squared), there),
        magnitude,
        direction
    );
}
