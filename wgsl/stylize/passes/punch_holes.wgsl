// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Random holes in the shadow map of an object, which is then put together with that of the rest of the scene.
// source: stylized scattering 4.1, Eq. 4 and 5; thesis 6.2.1.
// note: Several objects with holes of their own: the result for one is the rest for the next.
// note: Texels without a hole keep their bits.
// definition REST: puts the object together with the rest of the scene: the nearer to the light of both.
// binding holes: what holes look like.
// binding object: shadow map of the object alone, a depth format or r32float; non-finite values count as far.
// binding rest: with REST only: shadow map of the rest, of the same size, a depth format or r32float; non-finite values count as far.
// binding punched: out, r32float, of the same size: depth in the convention of the maps.

#import airlight::core::finite::finite_or
#ifdef REST
#import airlight::stylize::perlin_holes::{HoleParameters, punched_depth, nearer_depth}
#else
#import airlight::stylize::perlin_holes::{HoleParameters, punched_depth}
#endif

@group(#{GROUP}) @binding(0) var<uniform> holes: HoleParameters;
@group(#{GROUP}) @binding(1) var object: texture_2d<f32>;
#ifdef REST
@group(#{GROUP}) @binding(2) var rest: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(3) var punched: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn punch_holes(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(punched);
    if any(id.xy >= size) {
        return;
    }
    let uv = (vec2<f32>(id.xy) + 0.5) / vec2<f32>(size);
    let own = finite_or(textureLoad(object, id.xy, 0).x, holes.far_depth);
    var depth = own;
    // Noise is dear, and most of an object's map is empty.
    if own != holes.far_depth {
        depth = punched_depth(holes, uv, own);
    }
#ifdef REST
    let other = finite_or(textureLoad(rest, id.xy, 0).x, holes.far_depth);
    depth = nearer_depth(holes.far_depth, depth, other);
#endif
    textureStore(punched, id.xy, vec4<f32>(depth, 0.0, 0.0, 0.0));
}
