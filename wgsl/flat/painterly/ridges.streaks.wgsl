// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/ridges, permutation streaks (STREAKS)
// summary: Colours a surface by a table over both principal curvatures: ridges, valleys, saddles; and by streaks.
// source: Hadwiger et al., "Real-time ray-casting and advanced shading of discrete isosurfaces" (2005); dissertation on painterly volume rendering, 6.1.3.
// note: What is read and written has the form of target 0 of `iso_raycast`; with DEFERRED there, `shade` lights it afterwards.
// definition STREAKS: streaks of `advect` lighten and darken what is coloured.
// binding parameters: range of the table and strength of streaks.
// binding color: linear RGB, and 1 where the surface is seen.
// binding curvature: of `iso_raycast` with CURVATURE.
// binding table: columns for the greater curvature, rows for the lesser: linear RGB and how much of it, 0..1; rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.
// binding streaks: 0..1; with STREAKS only.
// binding tinted: out, rgba16float: linear RGB, and 1 where the surface is seen.

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

// ---- airlight::painterly::curvature ----
// summary: Principal curvatures of iso-surfaces and their directions, in the world and in the picture.
// source: Kindlmann, Whitaker, Tasdizen and Moller, "Curvature-based transfer functions for direct volume rendering" (2003); dissertation on painterly volume rendering, 6.1.3.

/// What a table over both curvatures holds: columns for the greater one and rows for the lesser, the first for -range and the
/// last for range, 1/m. `table`: linear RGB and how much of it, filtered; what is not finite counts as 0.
fn curvature_color(table: texture_2d<f32>, linear_sampler: sampler, curvatures: vec2<f32>, range: f32) -> vec4<f32> {
    let size = vec2<f32>(textureDimensions(table));
    let held = vec2<f32>(finite_or(curvatures.x, 0.0), finite_or(curvatures.y, 0.0));
    let share = clamp(held / max(range, 1e-20), vec2<f32>(-1.0), vec2<f32>(1.0)) * 0.5 + 0.5;
    let texel = textureSampleLevel(table, linear_sampler, (share * (size - 1.0) + 0.5) / size, 0.0);
    return vec4<f32>(finite_or_rgb(texel.rgb, 0.0), finite_or(texel.a, 0.0));
}

// ---- painterly/ridges ----

/// What curvatures and streaks do to colours. 16 bytes.
struct RidgeParameters {
    /// Curvature of the table's last column and row, 1/m, positive.
    range: f32,
    /// 0 for no streaks, 1 for colours from none to twice as bright.
    streak_strength: f32,
    reserved_a: f32,
    reserved_b: f32,
}

@group(0) @binding(0) var<uniform> parameters: RidgeParameters;
@group(0) @binding(1) var color: texture_2d<f32>;
@group(0) @binding(2) var curvature: texture_2d<f32>;
@group(0) @binding(3) var table: texture_2d<f32>;
@group(0) @binding(4) var linear_sampler: sampler;
@group(0) @binding(5) var streaks: texture_2d<f32>;
@group(0) @binding(6) var tinted: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn ridges(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(tinted)) {
        return;
    }
    let seen = textureLoad(color, id.xy, 0);
    let own = max(finite_or_rgb(seen.xyz, 0.0), vec3<f32>(0.0));
    let given = curvature_color(table, linear_sampler, textureLoad(curvature, id.xy, 0).xy, parameters.range);
    var light = mix(own, max(given.xyz, vec3<f32>(0.0)), clamp(given.w, 0.0, 1.0));
    let streak = clamp(finite_or(textureLoad(streaks, id.xy, 0).x, 0.5), 0.0, 1.0);
    light *= mix(1.0, 2.0 * streak, clamp(parameters.streak_strength, 0.0, 1.0));
    let written = vec4<f32>(min(light, vec3<f32>(65504.0)), 1.0);
    textureStore(tinted, id.xy, select(vec4<f32>(0.0), written, seen.w > 0.5));
}
