// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/epipolar_direct, permutation default
// summary: Dilation or erosion of a shadow map along view rays, texel by texel: as many reads as the kernel has texels.
// source: stylized scattering, Eq. 3; thesis Eq. 6.1.
// note: Nearest texel: a sample lies exactly on the line and takes the depth of the texel that it falls into. What it is extruded
// note: to lies on the view ray through the sample, and so behind it.
// note: For a closing, dispatch a dilation into an intermediate map, then the erosion with the reflected kernel.
// binding epipole: the eye in the map.
// binding kernel: width, direction and extremum.
// binding shadow_map: the original map, a depth format or r32float.
// binding source: what is morphed: the same, or an intermediate map, r32float: facing depths, unclamped.
// binding morphed: out, r32float: the map, or the intermediate one.

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

// ---- airlight::stylize::epipolar_dilate ----
// summary: Extrusion of blockers along view rays inside a shadow map, and its counterpart: depths carried along epipolar lines.
// source: stylized scattering, Eq. 3; thesis Eq. 6.1.

/// The eye in a shadow map: a homogeneous point in texels and depth. 16 bytes.
struct Epipole {
    /// Position in the map, texels, times the weight; the first texel's centre is at (0.5, 0.5).
    position: vec2<f32>,
    /// Depth in the map's own convention, times the weight.
    depth: f32,
    /// 1 for an eye that the map can see, 0 for one at infinity (position and depth are then a direction), below 0 for one
    /// behind the light.
    weight: f32,
}

/// A step of morphology along epipolar lines. 32 bytes.
struct EpipolarKernel {
    /// Texels of the kernel besides the own one.
    reach: u32,
    /// 0 for the texels towards the epipole, 1 for the reflected kernel away from it.
    away: u32,
    /// 1 for minima, -1 for maxima.
    sign: f32,
    /// Depth of an empty texel: 1 forward, 0 reversed.
    far_depth: f32,
    /// 1 where the source is a shadow map, 0 where it is an intermediate map of facing depths.
    first: u32,
    /// 1 where the result is a shadow map again.
    finish: u32,
    /// With `finish`: 1 keeps the nearer of result and original to the light, -1 the farther.
    keep: f32,
    reserved: u32,
}

/// The line from a texel towards the epipole.
struct EpipolarLine {
    /// One step towards the epipole, texels: 1 along the longer axis.
    step: vec2<f32>,
    /// Distance of the epipole along that axis in texels, times the absolute weight.
    distance: f32,
}

/// Facing depth of a texel without a blocker.
const EMPTY: f32 = 1e30;
/// Samples nearer to the epipole, in texels, cannot be told from it.
const LEAST_DISTANCE: f32 = 1e-3;

/// 1 where stored depth grows away from the light, else -1.
fn depth_facing(far_depth: f32) -> f32 {
    return select(-1.0, 1.0, far_depth > 0.5);
}

/// Facing depth of the far plane: facing depth grows away from the light, over an interval of length 1.
fn facing_far(far_depth: f32) -> f32 {
    return select(0.0, 1.0, far_depth > 0.5);
}

/// Facing depth of what a shadow map stores, EMPTY where that is no blocker.
fn blocker_from_stored(stored: f32, far_depth: f32) -> f32 {
    let depth = depth_facing(far_depth) * finite_or(stored, far_depth);
    let far = facing_far(far_depth);
    return select(max(depth, far - 1.0), EMPTY, depth >= far);
}

/// What a shadow map stores of a facing depth: beyond the far plane nothing, before the near plane the near plane.
fn stored_from_blocker(depth: f32, far_depth: f32) -> f32 {
    let far = facing_far(far_depth);
    return select(depth_facing(far_depth) * max(depth, far - 1.0), far_depth, depth >= far);
}

/// The line through `at`, in texels.
fn line_towards(epipole: Epipole, at: vec2<f32>) -> EpipolarLine {
    let towards = epipole.position - at * epipole.weight;
    let distance = max(abs(towards.x), abs(towards.y));
    return EpipolarLine(towards / max(distance, 1e-30), distance);
}

/// The least `distance` at which a sample is still told from the epipole.
fn least_distance(epipole: Epipole) -> f32 {
    return max(LEAST_DISTANCE * abs(epipole.weight), 1e-20);
}

/// `distance` after a number of steps towards the epipole.
fn distance_after(epipole: Epipole, distance: f32, steps: f32) -> f32 {
    return distance - epipole.weight * steps;
}

/// Facing depth of a blocker, carried along its view ray by a number of steps away from the epipole, negative towards it.
/// `distance`: of the blocker. EMPTY stays EMPTY.
fn carried_depth(epipole: Epipole, far_depth: f32, depth: f32, distance: f32, steps: f32) -> f32 {
    let above = depth * epipole.weight - depth_facing(far_depth) * epipole.depth;
    let carried = depth + above * (steps / max(distance, least_distance(epipole)));
    return select(clamp(carried, -1e29, 1e29), EMPTY, depth >= EMPTY);
}

/// Result of morphology at a texel whose blocker was at the facing depth `original`.
fn kept_depth(kernel: EpipolarKernel, original: f32, result: f32) -> f32 {
    return select(max(original, result), min(original, result), kernel.keep > 0.0);
}

// ---- stylize/epipolar_direct ----

@group(0) @binding(0) var<uniform> epipole: Epipole;
@group(0) @binding(1) var<uniform> kernel: EpipolarKernel;
@group(0) @binding(2) var shadow_map: texture_2d<f32>;
@group(0) @binding(3) var source: texture_2d<f32>;
@group(0) @binding(4) var morphed: texture_storage_2d<r32float, write>;

/// Facing depth of a texel of the source.
fn blocker_at(texel: vec2<u32>) -> f32 {
    let value = textureLoad(source, texel, 0).x;
    return select(value, blocker_from_stored(value, kernel.far_depth), kernel.first == 1u);
}

@compute @workgroup_size(16, 8)
fn epipolar_direct(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(shadow_map);
    if any(id.xy >= size) {
        return;
    }
    let extent = vec2<f32>(size);
    let at = vec2<f32>(id.xy) + 0.5;
    let line = line_towards(epipole, at);
    let least = least_distance(epipole);
    let direction = select(1.0, -1.0, kernel.away == 1u);
    var extremum = kernel.sign * blocker_at(id.xy);
    // A texel at the epipole has no line.
    let reach = select(0u, min(kernel.reach, max(size.x, size.y)), line.distance > least);
    for (var step = 1u; step <= reach; step++) {
        let along = direction * f32(step);
        let sample = at + along * line.step;
        let distance = distance_after(epipole, line.distance, along);
        if any(sample < vec2<f32>(0.0)) || any(sample >= extent) || distance <= least {
            break;
        }
        let depth = carried_depth(epipole, kernel.far_depth, blocker_at(vec2<u32>(sample)), distance, along);
        extremum = min(extremum, kernel.sign * depth);
    }
    var result = kernel.sign * extremum;
    if kernel.finish == 1u {
        let original = blocker_from_stored(textureLoad(shadow_map, id.xy, 0).x, kernel.far_depth);
        result = stored_from_blocker(kept_depth(kernel, original, result), kernel.far_depth);
    }
    textureStore(morphed, id.xy, vec4<f32>(result, 0.0, 0.0, 0.0));
}
