// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Copies a shadow map texel by texel: the least that any pass over it costs.
// source: none; the floor that morphology is measured against.
// binding values: the map, a depth format or r32float.
// binding copied: out, r32float.

@group(#{GROUP}) @binding(0) var values: texture_2d<f32>;
@group(#{GROUP}) @binding(1) var copied: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn copy(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(copied)) {
        textureStore(copied, id.xy, vec4<f32>(textureLoad(values, id.xy, 0).x, 0.0, 0.0, 0.0));
    }
}
