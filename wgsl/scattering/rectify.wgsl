// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::rectify
// summary: Epipolar coordinates around a directional light: rows are slices, columns radii, depth the angle to the light.
// source: thesis 4.4.1, after Baran et al., "A hierarchical volumetric shadow algorithm" (2010); Eq. 4.12.
// note: The thesis measures "the angle between view ray and light direction"; with the direction of travel the
// note: visibility test would be reversed. The angle here is taken from the direction TOWARDS the light, so that
// note: it grows along light rays: lit if and only if theta_ray <= theta_stored.
// note: x is the radius, at right angles to the light. The distance along the reference ray of the thesis is
// note: the same up to a factor per slice: the texel is the same.
// note: The whole convention, with the range of rows, is docs/src/rectification.md.
// equation: θ: angle from the direction TOWARDS the light;  row = (azimuth − azimuth_min) rows / range;  column = t sin θ / radius_max width
// equation: depth = GUARD + (1 − 2 GUARD) (θ − θ_min) / (θ_max − θ_min);  lit ⇔ θ_ray ≤ θ_stored
// equation: reference: k = sin of the bisectrix of the fastest and slowest ray;  optimum (Eq. 4.12): k = √(k_min k_max)
// error: frames and slices within the budgets that the test derives; test scattering/frame::frame_and_slices_are_those_of_the_reference.
// error: maps within 1e-4; test scattering/rectified_map::rectified_maps_are_those_of_the_reference.
// error: greatest_sine within 2 %; test scattering/functions::greatest_sine_of_a_slice_is_within_two_percent.
// parameter point: homogeneous, world.
// parameter azimuth: radians.
// parameter row: of the map, row j at j.
// parameter far, limit, distance_limit: metres, above 0.
// parameter angle, angle_min, angle_max: to the light, radians, 0..pi.
// parameter texel: as `slice_texel` made it.
// parameter depth: 0..1; of `epipolar_ray` that of the depth buffer.
// parameter ndc: normalised device coordinates, -1..1.
// parameter radius, height: metres.

#import airlight::core::camera::{
    Camera, view_ray, side_normal, forward_direction, far_plane_distance, matrix_row
}
#import airlight::core::fourier_basis::{GUARD, guarded}

const PI: f32 = 3.141592653589793;

/// Closer than this to the border of the picture, the light (or its antipode) counts as inside.
const INSIDE_MARGIN: f32 = 1e-3;
/// Slices are at least this wide in theta, radians.
const LEAST_WIDTH: f32 = 1e-3;
/// Planes whose normal is this nearly at right angles to a slice bound none of its rays.
const SAME_PLANE: f32 = 1e-4;
/// The least cosine k of Eq. 4.10 that takes part in the choice of the reference ray.
const LEAST_REFERENCE: f32 = 0.1;

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

/// A view ray in epipolar coordinates.
struct EpipolarRay {
    /// Angle to the light, 0..pi, constant along the ray.
    angle: f32,
    /// Its sine: metres of radius per metre of distance.
    sine: f32,
    /// Its cosine.
    cosine: f32,
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// Length of the ray in metres, up to the surface or the limit.
    distance: f32,
}

/// The frame of a perspective camera for a light. `light`: unit vector towards the light; `rows`: height of the map, at least 1.
fn epipolar_frame(camera: Camera, light: vec3<f32>, rows: u32) -> Frame {
    let forward = forward_direction(camera);
    let right = view_ray(camera, vec2<f32>(1.0, 0.0)).direction - view_ray(camera, vec2<f32>(-1.0, 0.0)).direction;
    var axis = forward - light * dot(forward, light);
    if length(axis) < 1e-3 {
        let unit = normalize(right);
        axis = unit - light * dot(unit, light);
    }
    let axis_a = normalize(axis);
    let axis_b = cross(light, axis_a);

    var nearest = 1.0;
    var farthest = -1.0;
    for (var side = 0u; side < 4u; side++) {
        let towards = dot(side_normal(camera, side), light);
        nearest = min(nearest, towards);
        farthest = max(farthest, towards);
    }
    // The ray through ndc is the far point minus the eye, in homogeneous coordinates: affine in ndc.
    let column_x = eye_relative(camera, camera.world_from_clip[0]);
    let column_y = eye_relative(camera, camera.world_from_clip[1]);
    let constant = eye_relative(camera, camera.world_from_clip[2] * camera.far_depth + camera.world_from_clip[3]);
    var frame = Frame(
        light, -PI, axis_a, f32(rows) / (2.0 * PI), axis_b, f32(rows), camera.eye, 1.0,
        vec3<f32>(dot(column_x, light), dot(column_y, light), dot(constant, light)), 0.0,
        vec3<f32>(dot(column_x, axis_a), dot(column_y, axis_a), dot(constant, axis_a)), 0.0,
        vec3<f32>(dot(column_x, axis_b), dot(column_y, axis_b), dot(constant, axis_b)), 0.0,
        matrix_row(camera.world_from_clip, 3u)
    );
    if nearest > -INSIDE_MARGIN || farthest < INSIDE_MARGIN {
        return frame;
    }

    var azimuth_min = PI;
    var azimuth_max = -PI;
    for (var corner = 0u; corner < 4u; corner++) {
        let ndc = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
        let direction = view_ray(camera, ndc).direction;
        let azimuth = atan2(dot(direction, axis_b), dot(direction, axis_a));
        azimuth_min = min(azimuth_min, azimuth);
        azimuth_max = max(azimuth_max, azimuth);
    }
    frame.rows_per_radian = (f32(rows) - 1.0) / max(azimuth_max - azimuth_min, 1e-6);
    frame.azimuth_min = azimuth_min;
    frame.wraps = 0.0;
    return frame;
}

/// A homogeneous point as a vector from the eye, times its w.
fn eye_relative(camera: Camera, point: vec4<f32>) -> vec3<f32> {
    return point.xyz - camera.eye * point.w;
}

/// Azimuth of the middle of `row`, radians.
fn row_azimuth(frame: Frame, row: f32) -> f32 {
    return frame.azimuth_min + row / max(frame.rows_per_radian, 1e-6);
}

/// Unit vector at right angles to the light in the half-plane of `azimuth`.
fn azimuth_direction(frame: Frame, azimuth: f32) -> vec3<f32> {
    return cos(azimuth) * frame.axis_a + sin(azimuth) * frame.axis_b;
}

/// Distance at which the ray at `angle` in a half-plane leaves the far plane, at most `limit`.
/// `along_light`, `along_radius`: the camera's forward direction times the light and times the half-plane's direction.
fn far_radius(far: f32, limit: f32, along_light: f32, along_radius: f32, angle: f32) -> f32 {
    let sine = sin(angle);
    let towards = along_light * cos(angle) + along_radius * sine;
    if far * sine >= limit * towards {
        return limit;
    }
    return far * sine / towards;
}

/// Bounds of the slice at `azimuth`: view rays inside the frustum, no longer than `distance_limit` metres.
fn slice_bounds(camera: Camera, frame: Frame, azimuth: f32, distance_limit: f32) -> Slice {
    let radial = azimuth_direction(frame, azimuth);
    var angle_min = 0.0;
    var angle_max = PI;
    for (var side = 0u; side < 4u; side++) {
        let normal = side_normal(camera, side);
        let a = dot(normal, frame.light);
        let b = dot(normal, radial);
        // A plane that holds the light bounds no angle; what is left of it is rounding.
        if length(vec2<f32>(a, b)) < SAME_PLANE {
            continue;
        }
        if a > 0.0 {
            angle_max = min(angle_max, atan2(a, -b));
        } else if a < 0.0 {
            angle_min = max(angle_min, atan2(-a, b));
        }
    }
    if angle_max - angle_min < LEAST_WIDTH {
        let middle = clamp(0.5 * (angle_min + angle_max), 0.5 * LEAST_WIDTH, PI - 0.5 * LEAST_WIDTH);
        angle_min = middle - 0.5 * LEAST_WIDTH;
        angle_max = middle + 0.5 * LEAST_WIDTH;
    }

    let right_angle = 0.5 * PI;
    let widest = clamp(right_angle, angle_min, angle_max);
    let sine_max = max(sin(widest), 1e-4);
    let limit = distance_limit * sine_max;

    // On a half-plane the far plane's radius is monotone in the angle: its greatest value is at a bound.
    let forward = forward_direction(camera);
    let along_light = dot(forward, frame.light);
    let along_radius = dot(forward, radial);
    let far = far_plane_distance(camera, distance_limit);
    let radius = max(
        far_radius(far, limit, along_light, along_radius, angle_min),
        far_radius(far, limit, along_light, along_radius, angle_max)
    );
    let reference = reference_bisectrix(angle_min, angle_max);
    return Slice(angle_min, angle_max, clamp(radius, 1e-6 * distance_limit, limit), reference);
}

/// k of the reference ray by the optimum of Eq. 4.12: the geometric mean of the least and the greatest sine of
/// the slice, both clamped from below.
fn reference_optimum(angle_min: f32, angle_max: f32) -> f32 {
    let widest = sin(clamp(0.5 * PI, angle_min, angle_max));
    let narrowest = min(sin(angle_min), sin(angle_max));
    return sqrt(max(narrowest, LEAST_REFERENCE) * max(widest, LEAST_REFERENCE));
}

/// k of the reference ray by the bisectrix of the rays that cross a texel fastest and slowest.
fn reference_bisectrix(angle_min: f32, angle_max: f32) -> f32 {
    let widest = clamp(0.5 * PI, angle_min, angle_max);
    let narrowest = select(angle_max, angle_min, sin(angle_min) < sin(angle_max));
    return max(sin(0.5 * (widest + narrowest)), LEAST_REFERENCE);
}

/// Greatest sine of an angle to the light between the bounds of a slice, within 2 %.
fn greatest_sine(slice: Slice) -> f32 {
    let off = max(max(slice.angle_min - 0.5 * PI, 0.5 * PI - slice.angle_max), 0.0);
    let square = min(off * off, 0.25 * PI * PI);
    return 1.0 - square * (0.5 - square / 24.0);
}

/// A slice as one texel of an rgba32float texture.
fn slice_texel(slice: Slice) -> vec4<f32> {
    return vec4<f32>(slice.angle_min, slice.angle_max, slice.radius_max, slice.reference);
}

/// What `slice_texel` did, undone.
fn slice_from_texel(texel: vec4<f32>) -> Slice {
    return Slice(texel.x, texel.y, texel.z, texel.w);
}

/// The view ray through `ndc`, up to the surface with the depth-buffer value `depth` and at most `limit` metres long.
fn epipolar_ray(frame: Frame, ndc: vec2<f32>, depth: f32, limit: f32) -> EpipolarRay {
    let at = vec3<f32>(ndc, 1.0);
    let towards = dot(frame.ray_light, at);
    let a = dot(frame.ray_a, at);
    let b = dot(frame.ray_b, at);
    let radial = sqrt(a * a + b * b);
    let along = sqrt(radial * radial + towards * towards);
    let inverse = 1.0 / max(along, 1e-30);
    // At the light itself the azimuth is free; atan2(0, 0) is not.
    let azimuth = select(atan2(b, a), 0.0, radial < 1e-12 * along);
    let row = (azimuth - frame.azimuth_min) * frame.rows_per_radian;
    // A wrapping row may lie at `rows` itself: the sampler repeats.
    let last = select(frame.rows - 1.0, frame.rows, frame.wraps > 0.0);
    // along / scale, without dividing by a scale that is zero or has rounded below it.
    let scale = dot(frame.ray_scale, vec4<f32>(ndc, depth, 1.0));
    let beyond = along >= limit * scale;
    let distance = select(along / select(scale, 1.0, beyond), limit, beyond);
    return EpipolarRay(
        atan2(radial, towards), radial * inverse, towards * inverse, clamp(row, 0.0, last), distance
    );
}

/// The row nearest to a fractional `row`, always inside the map.
fn nearest_row(frame: Frame, row: f32) -> u32 {
    let rows = u32(frame.rows);
    let nearest = u32(max(row, 0.0) + 0.5);
    // Half a row beyond the last is the first, where rows wrap.
    return select(min(nearest, rows - 1u), 0u, nearest >= rows && frame.wraps > 0.0);
}

/// Depth 0..1 in the rectified map of an angle to the light: view rays of the slice lie in
/// GUARD .. 1 - GUARD, blockers beyond its bounds are clamped into the guard.
fn depth_from_angle(slice: Slice, angle: f32) -> f32 {
    return guarded((angle - slice.angle_min) / max(slice.angle_max - slice.angle_min, 0.1 * LEAST_WIDTH));
}

/// Depth in the rectified map of a view ray: kept out of the guard, into which a ray beside the
/// middle of its slice may fall.
fn depth_from_ray(slice: Slice, ray: EpipolarRay) -> f32 {
    return clamp(depth_from_angle(slice, ray.angle), GUARD, 1.0 - GUARD);
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
