// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: An environment map at another size: means over the solid angle of what each texel covers.
// source: none; texels are constant, so that the means are exact. Halved again and again it makes a chain of levels.
// note: Any size into any other, smaller or larger, parts of texels included. A channel that is negative or not finite counts as 0, one
// note: above 1e30 as that; with HALF one above 65504, the greatest half float, becomes that.
// definition HALF: the result is rgba16float, which samplers filter, not rgba32float.
// binding environment: radiance, linear RGB, latitude-longitude as in ambient/environment; any float format.
// binding reduced: out, rgba32float, with HALF rgba16float: radiance, and 1.

#import airlight::ambient::environment::zone_height
#import airlight::core::finite::finite_or_rgb

@group(#{GROUP}) @binding(0) var environment: texture_2d<f32>;
#ifdef HALF
@group(#{GROUP}) @binding(1) var reduced: texture_storage_2d<rgba16float, write>;
#else
@group(#{GROUP}) @binding(1) var reduced: texture_storage_2d<rgba32float, write>;
#endif

const MOST_HALF: f32 = 65504.0;
const MOST: f32 = 1e30;

@compute @workgroup_size(16, 8)
fn reduce_environment(@builtin(global_invocation_id) id: vec3<u32>) {
    let to = textureDimensions(reduced);
    if any(id.xy >= to) {
        return;
    }
    let source = textureDimensions(environment);
    // Both maps are cut into source * to equal parts a side: texels begin and end at whole ones.
    let begin = id.xy * source;
    let end = begin + source;
    var sum = vec3<f32>(0.0);
    var weights = 0.0;
    for (var y = begin.y / to.y; y * to.y < end.y; y++) {
        let parts = f32(source.y * to.y);
        let top = f32(max(begin.y, y * to.y)) / parts;
        let bottom = f32(min(end.y, (y + 1u) * to.y)) / parts;
        let height = zone_height(top, bottom);
        for (var x = begin.x / to.x; x * to.x < end.x; x++) {
            let width = f32(min(end.x, (x + 1u) * to.x) - max(begin.x, x * to.x)) / f32(source.x);
            let texel = finite_or_rgb(textureLoad(environment, vec2<u32>(x, y), 0).rgb, 0.0);
            sum += height * width * clamp(texel, vec3<f32>(0.0), vec3<f32>(MOST));
            weights += height * width;
        }
    }
    var mean = sum / weights;
#ifdef HALF
    mean = min(mean, vec3<f32>(MOST_HALF));
#endif
    textureStore(reduced, id.xy, vec4<f32>(mean, 1.0));
}
