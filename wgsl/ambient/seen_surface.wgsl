// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::ambient::seen_surface
// summary: Surface points of a picture from its depth, and pixels from places.
// source: homogeneous unprojection.
// note: Any camera and depth convention; its viewport is the size of the depth buffer. A depth of the far plane, or none that is finite, is no surface.
// equation: place = P.xyz / P.w,  P = world_from_clip · (ndc(pixel + ½), depth, 1)
// error: places within 2e-4 m, pixels 1e-3; test ambient/places::places_are_where_rays_through_the_middles_of_pixels_meet_them.
// error: normals within 1e-5; test ambient/places::normals_are_made_unit_and_replaced_where_there_are_none.
// parameter pixel: column and row, from 0.
// parameter depth: of the depth buffer, 0..1; what is not finite is no surface.
// parameter place: metres in the world.
// parameter texel: a vector of any length; what is not finite is none.
// parameter otherwise: unit vector in the world.

#import airlight::core::camera::{Camera, ndc_from_pixel}
#import airlight::core::finite::{finite_or, finite_or_rgb}

/// What is seen at a pixel.
struct SeenSurface {
    /// Where it is in the world, metres.
    place: vec3<f32>,
    /// Whether there is anything.
    known: bool,
}

/// What is seen at a pixel with this depth.
fn seen_surface(camera: Camera, pixel: vec2<i32>, depth: f32) -> SeenSurface {
    let found = finite_or(depth, camera.far_depth);
    let point = camera.world_from_clip * vec4<f32>(ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5), found, 1.0);
    let known = found != camera.far_depth && abs(point.w) > 1e-20;
    return SeenSurface(point.xyz / select(1.0, point.w, known), known);
}

/// A place of the world in pixels.
struct SeenPlace {
    /// From the top left corner of the picture.
    pixel: vec2<f32>,
    /// Whether it is in the picture, and before the eye.
    inside: bool,
}

/// Where a place of the world, metres, is in the picture.
fn seen_place(camera: Camera, place: vec3<f32>) -> SeenPlace {
    let clip = camera.clip_from_world * vec4<f32>(place, 1.0);
    let before = clip.w > 1e-20;
    let ndc = clip.xy / select(1.0, clip.w, before);
    let inside = before && all(abs(ndc) < vec2<f32>(1.0));
    return SeenPlace(select(vec2<f32>(0.0), (ndc * vec2<f32>(0.5, -0.5) + 0.5) * camera.viewport, inside), inside);
}

/// The unit normal that a texel holds; `otherwise` where it holds none of any length, or what is not finite.
fn seen_normal(texel: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    // So that squares do not overflow.
    let bounded = clamp(finite_or_rgb(texel, 0.0), vec3<f32>(-1e6), vec3<f32>(1e6));
    let size = length(bounded);
    return select(otherwise, bounded / max(size, 1e-20), size > 1e-6);
}
