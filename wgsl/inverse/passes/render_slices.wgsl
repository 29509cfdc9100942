// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: A picture of a volume, linear in what is solved for: the product with W.
// source: thesis 7.3.2, Eq. 7.4, 7.6, 7.8 and 7.13, Listing 7.1.
// note: Dispatch over the picture of a view.
// note: A step of length d through extinction s behind a transmittance T weighs T (1 - exp(-s d)) for emission, and that times scattered light
// note: for albedo. For extinction it weighs d: the picture is the optical depth, the thesis's o with the other sign.
// definition PATHS: extinction is solved for.
// definition EMISSION: emission is solved for; with ALBEDO both are. Without PATHS.
// definition ALBEDO: albedo is solved for. Without PATHS.
// definition RGB: three channels, each by itself; else one.
// definition BOX: what is solved for is constant in each voxel; else straight between them.
// definition BENT: rays are bent by an index of refraction, and their steps are of one length.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float; of inverse/ray_spans, with BENT if this has it.
// binding rendered: out, radiance of the volume, with PATHS its optical depth; r32float, rgba32float with RGB.
// binding extinction: of the medium, 1/m; with PATHS what is solved for.
// binding emission: radiance of a medium so thick that nothing shines through; with EMISSION.
// binding albedo: of the medium, 0..1; with ALBEDO.
// binding scattered: radiance that an albedo of 1 scatters towards the eye; with ALBEDO.
// binding steps: of the view's rays; with BENT.
// binding refraction: index of refraction; with BENT.
// binding through: out, transmittance to what lies behind, like `rendered`; without PATHS.

#import airlight::inverse::slice_steps::{SliceView, slice_ray}
#ifdef BENT
#import airlight::inverse::slice_steps::{RaySteps, MOST_RAY_STEPS}
#import airlight::inverse::bent_rays::{bent_ray, next_part, box_slopes}
#else
#import airlight::inverse::slice_steps::{slice_walk, slice_of_step, slice_part}
#endif
#import airlight::inverse::channels::{channels_of, texel_of, all_channels}
#ifndef PATHS
#import airlight::inverse::channels::step_weight
#endif
#import airlight::inverse::basis::{box_field, triangle_field}

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var spans: texture_2d<f32>;
#ifdef RGB
@group(#{GROUP}) @binding(2) var rendered: texture_storage_2d<rgba32float, write>;
#else
@group(#{GROUP}) @binding(2) var rendered: texture_storage_2d<r32float, write>;
#endif
@group(#{GROUP}) @binding(3) var extinction: texture_3d<f32>;
#ifdef EMISSION
@group(#{GROUP}) @binding(4) var emission: texture_3d<f32>;
#endif
#ifdef ALBEDO
@group(#{GROUP}) @binding(5) var albedo: texture_3d<f32>;
@group(#{GROUP}) @binding(6) var scattered: texture_3d<f32>;
#endif
#ifndef PATHS
#ifdef RGB
@group(#{GROUP}) @binding(7) var through: texture_storage_2d<rgba32float, write>;
#else
@group(#{GROUP}) @binding(7) var through: texture_storage_2d<r32float, write>;
#endif
#endif
#ifdef BENT
@group(#{GROUP}) @binding(8) var<uniform> steps: RaySteps;
@group(#{GROUP}) @binding(9) var refraction: texture_3d<f32>;
#endif

/// What is solved for, at a place.
fn solved(field: texture_3d<f32>, place: vec3<f32>) -> vec4<f32> {
#ifdef BOX
    return box_field(field, place);
#else
    return triangle_field(field, place);
#endif
}

@compute @workgroup_size(16, 8)
fn render_slices(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
    let span = textureLoad(spans, min(id.xy, textureDimensions(spans) - 1u), 0).xy;
#ifdef BENT
    let slopes = box_slopes(view);
    var bent = bent_ray(refraction, view, ray, span);
    let first = 0u;
    let end = min(steps.most, MOST_RAY_STEPS);
#else
    let walk = slice_walk(view, ray, span);
    let first = walk.first;
    let end = walk.end;
#endif
    var sum = all_channels(0.0);
#ifndef PATHS
    var depth = all_channels(0.0);
#endif
    for (var step = first; step < end; step++) {
#ifdef BENT
        let part = next_part(refraction, slopes, &bent, steps.metres);
        if part.metres <= 0.0 {
            break;
        }
#else
        let part = slice_part(view, ray, span, slice_of_step(walk, step));
#endif
#ifdef PATHS
        sum += channels_of(solved(extinction, part.place)) * part.metres;
#else
        let weight = step_weight(&depth, channels_of(triangle_field(extinction, part.place)), part.metres);
        var radiance = all_channels(0.0);
#ifdef EMISSION
        radiance += channels_of(solved(emission, part.place));
#endif
#ifdef ALBEDO
        radiance += channels_of(solved(albedo, part.place)) * channels_of(triangle_field(scattered, part.place));
#endif
        sum += weight * radiance;
#endif
    }
    textureStore(rendered, id.xy, texel_of(sum));
#ifndef PATHS
    textureStore(through, id.xy, texel_of(exp(-depth)));
#endif
}
