// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/rectify_projective, permutation default
// summary: Resamples a standard shadow map into the projective map, for engines that do not draw it (pass project) and for orthographic cameras.
// source: thesis 4.4.2.
// note: Nearest texel: a blend of two depths is the depth of nothing. Blockers outside the view frustum are
// note: clamped into its guard band; light rays outside the shadow map, or without a blocker, store 1.
// note: Non-finite depths count as empty.
// binding light: the directional light and its shadow map's clip space.
// binding rows: the projective rows.
// binding shadow_map: depth of the standard shadow map, a depth format or r32float.
// binding rectified: out, depth 0..1, r32float; columns and rows of the projective map.

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

// ---- airlight::scattering::projective ----
// summary: Projective rows around a directional light: view rays run along rows at constant depth after one matrix.
// source: thesis 4.4.2; weights after 4.3.2, Eq. 4.8.

/// Perspective camera: rows and depth are slopes.
const PERSPECTIVE: u32 = 0u;

/// The rows of a camera and a light, made by the host. 96 bytes.
struct ProjectiveRows {
    /// The eye; of an orthographic camera the centre of its near plane. World, metres.
    origin: vec3<f32>,
    /// X at the left end of column 0, metres; positive in perspective.
    near: f32,
    /// Unit vector of X, at right angles to the light, along the middle of the view rays.
    along: vec3<f32>,
    /// Metres of Z that a view ray of an orthographic camera takes for one of X; 0 in perspective.
    tilt: f32,
    /// Unit vector of Y.
    across: vec3<f32>,
    /// Slope Y / X (orthographic: Y, metres) at the upper border of row 0.
    row_min: f32,
    /// Unit vector of Z, AWAY from the light.
    away: vec3<f32>,
    /// From there to the lower border of the last row, positive.
    row_span: f32,
    /// X at the right end of each split, metres, growing; the last one in use and all after it are the far end.
    bounds: vec4<f32>,
    /// Least slope Z / X (orthographic: Z - tilt X, metres) of view rays.
    depth_min: f32,
    /// Range of those, positive.
    depth_span: f32,
    /// Number of splits, 1..4.
    splits: u32,
    /// PERSPECTIVE, or 1 for orthographic.
    projection: u32,
}

/// What slopes are divided by: X in perspective, 1 for an orthographic camera. `x`: X in metres.
fn projective_divisor(rows: ProjectiveRows, x: f32) -> f32 {
    return select(1.0, max(x, 1e-6 * rows.bounds.w), rows.projection == PERSPECTIVE);
}

/// X at the left end of `split`, metres.
fn split_begin(rows: ProjectiveRows, split: u32) -> f32 {
    return select(rows.bounds[max(split, 1u) - 1u], rows.near, split == 0u);
}

/// X in metres of a fractional `column`, 0..`width`: what `column_from_x` did, undone.
fn x_from_column(rows: ProjectiveRows, width: f32, column: f32) -> f32 {
    let share = column * f32(rows.splits) / width;
    let split = min(u32(max(share, 0.0)), rows.splits - 1u);
    let unit = clamp(share - f32(split), 0.0, 1.0);
    let begin = split_begin(rows, split);
    let end = rows.bounds[split];
    let divided = begin * end / (end - unit * (end - begin));
    return select(begin + unit * (end - begin), divided, rows.projection == PERSPECTIVE);
}

/// Slope (orthographic: Y) in the middle of `row`, of `height` rows.
fn row_slope(rows: ProjectiveRows, height: f32, row: f32) -> f32 {
    return rows.row_min + rows.row_span * (row + 0.5) / height;
}

/// Depth over the bounds of the view rays, 0..1 for these, of the point at X and Z in metres.
fn depth_unit(rows: ProjectiveRows, x: f32, z: f32) -> f32 {
    return ((z - rows.tilt * x) / projective_divisor(rows, x) - rows.depth_min) / rows.depth_span;
}

/// Depth 0..1 in the map of a blocker at X and Z in metres: in front of all view rays or behind them it is clamped
/// into the guard.
fn depth_from_blocker(rows: ProjectiveRows, x: f32, z: f32) -> f32 {
    return guarded(depth_unit(rows, x, z));
}

/// The point on the light ray in the middle of a texel that lies at Z = 0, the height of the eye. `x`: X in metres.
fn light_ray_point(rows: ProjectiveRows, height: f32, row: f32, x: f32) -> vec3<f32> {
    let y = row_slope(rows, height, row) * projective_divisor(rows, x);
    return rows.origin + rows.along * x + rows.across * y;
}

// ---- scattering/rectify_projective ----

@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(5) var<uniform> rows: ProjectiveRows;
@group(0) @binding(3) var shadow_map: texture_2d<f32>;
@group(0) @binding(4) var rectified: texture_storage_2d<r32float, write>;

/// Texels a thread takes, a quarter of the row apart, so that neighbours in a workgroup stay neighbours.
const PER_THREAD: u32 = 4u;

@compute @workgroup_size(16, 8)
fn rectify_projective(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let columns = (size.x + PER_THREAD - 1u) / PER_THREAD;
    if id.x >= columns || id.y >= size.y {
        return;
    }
    let map_size = vec2<f32>(textureDimensions(shadow_map));
    // All that is affine along this row: position in the shadow map, and depth.
    let height = f32(size.y);
    let nearest = light_ray_point(rows, height, f32(id.y), rows.near);
    let farthest = light_ray_point(rows, height, f32(id.y), rows.bounds.w);
    let start = shadow_position(light, map_size, nearest);
    let stride = (shadow_position(light, map_size, farthest) - start) / (rows.bounds.w - rows.near);
    let metres = -dot(light.world_from_clip[2].xyz, rows.away);
    for (var part = 0u; part < PER_THREAD; part++) {
        let column = id.x + part * columns;
        if column >= size.x {
            break;
        }
        let step = f32(column) + 0.5;
        let x = x_from_column(rows, f32(size.x), step);
        let at = start + (x - rows.near) * stride;
        let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < map_size);
        let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), map_size - 1.0));
        let stored = finite_or(textureLoad(shadow_map, texel, 0).x, light.far_depth);
        // The point looked at lies at the height of the eye, so this is the blocker's height above it.
        let above = (stored - at.z) * metres;
        let depth = depth_from_blocker(rows, x, -above);
        let empty = !inside || stored == light.far_depth;
        textureStore(rectified, vec2<u32>(column, id.y), vec4<f32>(select(depth, 1.0, empty), 0.0, 0.0, 1.0));
    }
}
