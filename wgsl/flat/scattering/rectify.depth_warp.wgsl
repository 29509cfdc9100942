// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/rectify, permutation depth_warp (DEPTH_WARP)
// summary: Resamples a standard shadow map into the rectified map, where view rays run along rows at constant depth.
// source: thesis 4.4.1.
// note: Nearest texel: a blend of two depths is the depth of nothing. Blockers outside the bounds of a slice are
// note: clamped into its guard band; light rays outside the shadow map, or without a blocker, store 1.
// note: Non-finite depths count as empty.
// note: The blocker on a light ray is the point of that ray at the stored depth, also where the texel is wide.
// definition DEPTH_WARP: stretch depths near the light, see warped_depth.
// binding light: the light, directional without LOCAL, and its shadow map's clip space.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding shadow_map: depth of the standard shadow map, a depth format or r32float; without SHADOW_ARRAY.
// binding rectified: out, depth 0..1, r32float; columns are radii, with LOCAL light angles, rows slices.

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

// ---- airlight::core::fourier_basis ----
// summary: Visibility as a Fourier series of the depth difference, four bases at a time.
// source: thesis 4.3.1, Eq. 4.7, after Annen et al., "Convolution shadow maps" (2007).

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

/// Depth in the guarded range. `unit`: depth over the bounds of the view rays, where rays lie in
/// 0..1 and blockers may lie outside; the result is clamped to 0..1.
fn guarded(unit: f32) -> f32 {
    return clamp(GUARD + (1.0 - 2.0 * GUARD) * unit, 0.0, 1.0);
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light and its standard shadow map. 192 bytes.
struct Light {
    /// World to the shadow map's clip space; affine for a directional light, unused with an array of shadow maps.
    clip_from_world: mat4x4<f32>,
    /// Its inverse.
    world_from_clip: mat4x4<f32>,
    /// Unit vector TOWARDS a directional light; of a spot, the reverse of the axis along which it shines.
    direction: vec3<f32>,
    /// Depth of an empty texel of the shadow map, farthest from the light: 1 forward, 0 reversed.
    far_depth: f32,
    /// Linear RGB: for a directional light the irradiance at normal incidence; for one at a point its radiant
    /// intensity, the irradiance at a distance of one metre.
    radiance: vec3<f32>,
    /// DIRECTIONAL, SPOT or POINT.
    kind: u32,
    /// Where a spot or point light is, metres.
    position: vec3<f32>,
    /// Radius of a spot or point light, metres, positive: nearer to it the fall-off with distance stops.
    radius: f32,
    /// Cosines of the half angles inside which a spot shines fully, and outside which not at all.
    spot_cosines: vec2<f32>,
    reserved_a: f32,
    reserved_b: f32,
}

/// Position in texels of a map, and depth, of a point in the clip space of that map; a point at or behind the light
/// (w <= 0) is carried outside the map. `size`: of the map in texels.
fn texels_from_clip(clip: vec4<f32>, size: vec2<f32>) -> vec3<f32> {
    let before = clip.w > 0.0;
    let ndc = clip.xyz / select(1.0, clip.w, before);
    return select(vec3<f32>(-size, 0.0), vec3<f32>((ndc.xy * vec2<f32>(0.5, -0.5) + 0.5) * size, ndc.z), before);
}

/// Position in texels of the shadow map, and depth, of a point in the world, metres; a point behind a spot is carried
/// outside the map. `size`: of the map in texels.
fn shadow_position(light: Light, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    return texels_from_clip(light.clip_from_world * vec4<f32>(point, 1.0), size);
}

// ---- airlight::scattering::rectify ----
// summary: Epipolar coordinates around a directional light: rows are slices, columns radii, depth the angle to the light.
// source: thesis 4.4.1, after Baran et al., "A hierarchical volumetric shadow algorithm" (2010); Eq. 4.12.

/// Slices are at least this wide in theta, radians.
const LEAST_WIDTH: f32 = 1e-3;

/// Axes around the light, the range of the slices, and the view rays in these axes. 128 bytes.
struct Frame {
    /// Unit vector TOWARDS the light.
    light: vec3<f32>,
    /// Azimuth of row 0, radians.
    azimuth_min: f32,
    /// Unit vector of azimuth 0.
    axis_a: vec3<f32>,
    /// Rows per radian of azimuth.
    rows_per_radian: f32,
    /// Unit vector of azimuth pi / 2.
    axis_b: vec3<f32>,
    /// Number of rows.
    rows: f32,
    /// Position of the eye, where all slices meet.
    eye: vec3<f32>,
    /// 1 where the rows go round the full circle and wrap, 0 elsewhere.
    wraps: f32,
    /// The view ray through ndc, times (x, y, 1): its part towards the light. Any length, the same for all four.
    ray_light: vec3<f32>,
    reserved_a: f32,
    /// Its part along axis_a.
    ray_a: vec3<f32>,
    reserved_b: f32,
    /// Its part along axis_b.
    ray_b: vec3<f32>,
    reserved_c: f32,
    /// Times (x, y, depth, 1): what its length is divided by for the distance of the surface at that depth.
    ray_scale: vec4<f32>,
}

/// Bounds of one slice.
struct Slice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Radius in metres at the right end of its row.
    radius_max: f32,
    /// k of the reference ray, the bisectrix: sine of its angle to the light.
    reference: f32,
}

/// Azimuth of the middle of `row`, radians.
fn row_azimuth(frame: Frame, row: f32) -> f32 {
    return frame.azimuth_min + row / max(frame.rows_per_radian, 1e-6);
}

/// Unit vector at right angles to the light in the half-plane of `azimuth`.
fn azimuth_direction(frame: Frame, azimuth: f32) -> vec3<f32> {
    return cos(azimuth) * frame.axis_a + sin(azimuth) * frame.axis_b;
}

/// What `slice_texel` did, undone.
fn slice_from_texel(texel: vec4<f32>) -> Slice {
    return Slice(texel.x, texel.y, texel.z, texel.w);
}

/// Depth 0..1 in the rectified map of an angle to the light: view rays of the slice lie in
/// GUARD .. 1 - GUARD, blockers beyond its bounds are clamped into the guard.
fn depth_from_angle(slice: Slice, angle: f32) -> f32 {
    return guarded((angle - slice.angle_min) / max(slice.angle_max - slice.angle_min, 0.1 * LEAST_WIDTH));
}

/// Depth 0..1 in the rectified map of a blocker `height` metres above the eye, towards the light, on
/// the light ray at `radius` metres.
fn depth_from_blocker(slice: Slice, radius: f32, height: f32) -> f32 {
    return depth_from_angle(slice, atan2(radius, height));
}

/// The depth warp of thesis 4.5: depths between the guards stretched by a square root, so that rays near the light (the
/// least angles of a slice) differ by more. Monotone: the same visibility, resolved otherwise.
fn warped_depth(depth: f32) -> f32 {
    let range = 1.0 - 2.0 * GUARD;
    let unit = clamp((depth - GUARD) / range, 0.0, 1.0);
    return select(depth, GUARD + range * sqrt(unit), depth > GUARD && depth < 1.0 - GUARD);
}

// ---- scattering/rectify ----

@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(1) var<uniform> frame: Frame;
@group(0) @binding(2) var slices: texture_2d<f32>;
@group(0) @binding(3) var shadow_map: texture_2d<f32>;
@group(0) @binding(4) var rectified: texture_storage_2d<r32float, write>;

/// Texels a thread takes, a quarter of the row apart, so that neighbours in a workgroup stay neighbours.
const PER_THREAD: u32 = 4u;

@compute @workgroup_size(16, 8)
fn rectify(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let columns = (size.x + PER_THREAD - 1u) / PER_THREAD;
    if id.x >= columns || id.y >= size.y {
        return;
    }
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(id.y, 0u), 0));
    let radial = azimuth_direction(frame, row_azimuth(frame, f32(id.y)));
    let map_size = vec2<f32>(textureDimensions(shadow_map));

    // All that is affine in the radius along this row: position in the shadow map, and depth.
    let start = shadow_position(light, map_size, frame.eye);
    let stride = (shadow_position(light, map_size, frame.eye + slice.radius_max * radial) - start) / f32(size.x);
    // Metres towards the light for one unit of depth, negative for forward depth.
    let metres = dot(light.world_from_clip[2].xyz, frame.light);
    for (var part = 0u; part < PER_THREAD; part++) {
        let column = id.x + part * columns;
        if column >= size.x {
            break;
        }
        let step = f32(column) + 0.5;
        let at = start + step * stride;
        let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < map_size);
        let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), map_size - 1.0));
        let stored = finite_or(textureLoad(shadow_map, texel, 0).x, light.far_depth);
        // The point looked at lies at the height of the eye, so this is the blocker's height above it.
        let height = (stored - at.z) * metres;
        let found = depth_from_blocker(slice, slice.radius_max * step / f32(size.x), height);
        let empty = !inside || stored == light.far_depth;
        var depth = select(found, 1.0, empty);
        depth = warped_depth(depth);
        textureStore(rectified, vec2<u32>(column, id.y), vec4<f32>(depth, 0.0, 0.0, 1.0));
    }
}
