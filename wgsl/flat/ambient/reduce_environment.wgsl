// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: ambient/reduce_environment, permutation default
// summary: An environment map at another size: means over the solid angle of what each texel covers.
// source: none; texels are constant, so that the means are exact. Halved again and again it makes a chain of levels.
// note: Any size into any other, smaller or larger, parts of texels included. A channel that is negative or not finite counts as 0, one
// note: above 1e30 as that; with HALF one above 65504, the greatest half float, becomes that.
// binding environment: radiance, linear RGB, latitude-longitude as in ambient/environment; any float format.
// binding reduced: out, rgba32float, with HALF rgba16float: radiance, and 1.

// ---- airlight::ambient::environment ----
// summary: Environment maps: directions and solid angles of the texels of a latitude-longitude picture.
// source: the unit sphere; a zone between two elevations has 2 pi times the difference of their sines (Archimedes).

/// Half a turn, radians.
const HALF_TURN: f32 = 3.14159265;

/// Difference of the sines of elevation between two heights of the map, 0..1 from the top, `begin` above `end`: over
/// a column of width w (0..1) the solid angle is 2 pi w times this.
fn zone_height(begin: f32, end: f32) -> f32 {
    // The difference of two cosines, without its cancellation.
    return 2.0 * sin(0.5 * HALF_TURN * (begin + end)) * sin(0.5 * HALF_TURN * (end - begin));
}

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- ambient/reduce_environment ----

@group(0) @binding(0) var environment: texture_2d<f32>;
@group(0) @binding(1) var reduced: texture_storage_2d<rgba32float, write>;

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
    textureStore(reduced, id.xy, vec4<f32>(mean, 1.0));
}
