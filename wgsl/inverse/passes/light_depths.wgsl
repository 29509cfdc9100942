// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What a light passes on its way through a volume: an opacity shadow map.
// source: Kim and Neumann, "Opacity shadow maps" (2001); see inverse/light_layers.
// note: Dispatch over the texels of a light's view. Beyond the box there is what is outermost in it.
// definition RGB: three channels, each by itself; else one.
// binding view: of the light; its slices are how many layers there are.
// binding layers: where they lie.
// binding extinction: of the medium, 1/m.
// binding depths: out, optical depth from the first layer to the sides of layers: columns, rows, layers and one; r32float, rgba32float with RGB.

#import airlight::inverse::slice_steps::{SliceView, slice_ray}
#import airlight::inverse::light_layers::{LightLayers, layers_along}
#import airlight::inverse::channels::{channels_of, texel_of, all_channels}
#import airlight::inverse::basis::triangle_field

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var<uniform> layers: LightLayers;
@group(#{GROUP}) @binding(2) var extinction: texture_3d<f32>;
#ifdef RGB
@group(#{GROUP}) @binding(3) var depths: texture_storage_3d<rgba32float, write>;
#else
@group(#{GROUP}) @binding(3) var depths: texture_storage_3d<r32float, write>;
#endif

@compute @workgroup_size(16, 8)
fn light_depths(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
    let along = layers_along(layers, ray);
    var depth = all_channels(0.0);
    textureStore(depths, vec3<u32>(id.xy, 0u), texel_of(depth));
    let step = 1.0 / along.y;
    for (var layer = 0u; layer < min(view.slices, textureDimensions(depths).z); layer++) {
        let place = ray.origin + ray.direction * ((f32(layer) + 0.5 - along.x) * step);
        depth += channels_of(triangle_field(extinction, place)) * (step * ray.metres);
        textureStore(depths, vec3<u32>(id.xy, layer + 1u), texel_of(depth));
    }
}
