// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Transmittance from the light to each of a list of points in the world, by any form of map.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 3.
// note: What a renderer does for each particle or sample; here for curves along a light ray, and for tests.
// note: Points that are not finite have transmittance 1.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition FUNCTION: transmittance function map; without this and the next four an extinction map of cosines.
// definition PERIODIC: the series of the full period instead of cosines: a Fourier opacity map, or with FUNCTION.
// definition POWER: six power moments.
// definition TRIGONOMETRIC: two trigonometric moments.
// definition BOUNDED: an extinction map over the occupied interval of each texel.
// definition MONOTONE: with the Fejer window, extinction maps only.
// definition FILTERED: bilinear means are read through a sampler: for maps of rgba16float, not BOUNDED.
// definition NEAREST: the nearest texel instead of a bilinear read.
// binding coefficients: the layers of the map, rgba32float or rgba16float.
// binding map_sampler: linear, clamped to the edge; with FILTERED only.
// binding intervals: least and greatest occupied depth, 0..1, rg32float; with BOUNDED only.
// binding light: the directional light of the map.
// binding points: points in the world, metres; the fourth number is not used.
// binding transmittances: out, 0..1, one a point.

#import airlight::core::finite::is_finite
#import airlight::core::light::Light
#import airlight::transmittance::light_space::map_position
#import airlight::transmittance::transmittance_map::{transmittance, transmittance_map_size}

@group(#{GROUP}) @binding(2) var<uniform> light: Light;
@group(#{GROUP}) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(#{GROUP}) @binding(4) var<storage, read_write> transmittances: array<f32>;

@compute @workgroup_size(64)
fn query(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= min(arrayLength(&points), arrayLength(&transmittances)) {
        return;
    }
    let given = points[index].xyz;
    let known = is_finite(given.x) && is_finite(given.y) && is_finite(given.z);
    let point = select(vec3<f32>(0.0), given, known);
    let at = map_position(light, vec2<f32>(transmittance_map_size()), point);
    transmittances[index] = select(1.0, transmittance(at.xy, at.z), known);
}
