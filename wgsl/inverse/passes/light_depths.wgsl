// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What a light passes on its way through a volume: an opacity shadow map.
// source: Kim and Neumann, "Opacity shadow maps" (2001); see inverse/light_layers.
// note: Dispatch over the texels of a light's view. A ray goes on behind the box with what is outermost, for points next to it.
// definition RGB: three channels, each by itself; else one.
// binding view: of the light; its slices are how many layers there are.
// binding layers: where they lie.
// binding extinction: of the medium, 1/m.
// binding means: out, mean extinction from the box's face to the sides of layers, 1/m: columns, rows, layers and one; r32float, rgba32float
// binding means: with RGB.

#import airlight::inverse::slice_steps::{SliceView, slice_ray}
#import airlight::inverse::light_layers::{LightLayers, layers_along, layers_begin}
#import airlight::inverse::channels::{channels_of, texel_of, all_channels}
#import airlight::inverse::basis::triangle_field

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var<uniform> layers: LightLayers;
@group(#{GROUP}) @binding(2) var extinction: texture_3d<f32>;
#ifdef RGB
@group(#{GROUP}) @binding(3) var means: texture_storage_3d<rgba32float, write>;
#else
@group(#{GROUP}) @binding(3) var means: texture_storage_3d<r32float, write>;
#endif

@compute @workgroup_size(16, 8)
fn light_depths(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
    let along = layers_along(layers, ray);
    let begins = layers_begin(view, ray, along);
    var depth = all_channels(0.0);
    let first = channels_of(triangle_field(extinction, ray.origin + ray.direction * begins));
    textureStore(means, vec3<u32>(id.xy, 0u), texel_of(first));
    for (var layer = 0u; layer < view.slices; layer++) {
        let sides = (vec2<f32>(f32(layer), f32(layer + 1u)) - along.x) / along.y;
        let from_side = max(sides.x, begins);
        let part = max(sides.y - from_side, 0.0);
        let value = channels_of(triangle_field(extinction, ray.origin + ray.direction * (from_side + 0.5 * part)));
        depth += value * part;
        // Before the ray enters it is what it meets first.
        let mean = depth / max(sides.y - begins, 1e-30);
        textureStore(means, vec3<u32>(id.xy, layer + 1u), texel_of(select(value, mean, sides.y > begins)));
    }
}
