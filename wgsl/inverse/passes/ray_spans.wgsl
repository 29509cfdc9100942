// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Which part of each view ray lies in the volume before the first surface.
// source: thesis Listing 7.1.
// note: Dispatch over the picture, once for a view. What is not finite in `depths` counts as no surface.
// definition BENT: rays are bent in the volume: they end at the surface at the latest, and where they leave the volume is not asked.
// binding view: the view.
// binding depths: of the first surface along each view ray, metres from where the ray begins, r32float; great where there is none.
// binding spans: out, from and to in lengths of the ray's direction, rg32float; to is not greater than from where a ray misses.

#import airlight::core::finite::finite_or
#import airlight::inverse::slice_steps::{SliceView, slice_ray, ray_span}

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var depths: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var spans: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(16, 8)
fn ray_spans(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let limit = finite_or(textureLoad(depths, min(id.xy, textureDimensions(depths) - 1u), 0).x, 3e38);
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
#ifdef BENT
    let straight = ray_span(ray, limit);
    let reach = min(max(limit, 0.0), 1e30) / max(ray.metres, 1e-6);
    let span = vec2<f32>(straight.x, select(straight.y, reach, straight.y > straight.x));
#else
    let span = ray_span(ray, limit);
#endif
    textureStore(spans, id.xy, vec4<f32>(span, 0.0, 0.0));
}
