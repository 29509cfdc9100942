// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::local_light
// summary: Epipolar rows around a light at a point, spot or point light, and the light that air scatters along a view ray.
// source: thesis 4.3.2 ("other light sources") and 4.4.1; W. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009); C. Kulla and M. Fajardo (2012) for equal angles.
// note: `theta` is the angle at the eye, from the direction to the light; the light angle `alpha` is the angle at the
// note: light, from the direction to the eye. On a view ray theta is constant and alpha grows; on a light ray alpha is
// note: constant and theta grows away from the light: lit if and only if theta_ray <= theta_stored.
// note: Columns are linear in alpha. Since dt / d^2 = d alpha / (D sin theta), plain means over columns are weighted by
// note: the inverse square of the distance to the light, alike for every ray: the fall-off that the thesis (4.6.1)
// note: leaves open costs nothing here.
// note: The thesis splits a point light into six spots; here six faces of shadow maps fill one rectified map, whose
// note: light angles go from 0 to pi.
// note: Both ways are attenuated: view ray of length t, and light ray of length d.
// equation: tan α = t sin θ / (D − t cos θ);  t(α) = D sin α / sin(θ + α);  dt / d² = dα / (D sin θ)
// equation: airlight = ∫ p(cos) exp(−σ (t + d)) / (d² + r²) dt, by 8 Gauss-Legendre points a side in asinh of the angle
// error: airlight within 1e-3, nearer than twice the radius 5e-2; test scattering/functions::airlight_is_the_integral.
// error: angles and distances within the budgets that the test derives; test scattering/functions::angles_and_distances_belong_together.
// parameter position: of the light in the world, metres.
// parameter eye, fallback: of the world, metres, and a unit vector.
// parameter texel: as `local_slice_texel` made it.
// parameter angle: radians.
// parameter at_light: light angle, radians, 0..pi.
// parameter along: metres along the ray, from 0 up.
// parameter x: from 0 up.
// parameter extinction: 1/m, from 0 up.
// parameter g: mean cosine, -0.999..0.999.
// parameter limit: metres, above 0.
// parameter azimuth: radians.
// parameter integral: 1/(m sr), from `airlight`.

#import airlight::core::camera::{Camera, forward_direction, far_plane_distance}
#import airlight::core::phase::henyey_greenstein
#import airlight::scattering::rectify::{Frame, Slice, azimuth_direction, slice_bounds}
#import airlight::scattering::single_scatter::Medium

const PI: f32 = 3.141592653589793;

/// An eye nearer to the light than this, metres, has no direction to it.
const LEAST_DISTANCE: f32 = 1e-4;
/// Slices span at least this much at the light, radians.
const LEAST_SPAN: f32 = 1e-4;
/// Optical depth after which the airlight integral stops.
const DEEPEST: f32 = 10.0;
/// Nodes and weights of the Gauss-Legendre rule of 8 points, the positive half.
const NODES: vec4<f32> = vec4<f32>(0.1834346424956498, 0.525532409916329, 0.7966664774136267, 0.9602898564975363);
const WEIGHTS: vec4<f32> = vec4<f32>(0.362683783378362, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763);

/// Bounds of one slice around a light at a point.
struct LocalSlice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Light angle at the left end of its row, radians.
    light_angle_min: f32,
    /// Light angle at the right end of its row, radians.
    light_angle_max: f32,
}

/// The line of a view ray, as the light sees it.
struct LocalRay {
    /// Where along the ray it passes closest to the light, metres from the eye; negative where that lies behind.
    closest: f32,
    /// How close, metres.
    passing: f32,
    /// How close, softened by the radius of the light, metres, positive.
    softened: f32,
}

/// Unit vector from `eye` TOWARDS `position`, the light, metres in the world, and the distance in metres, at least
/// LEAST_DISTANCE; nearer than that the direction is `fallback`, a unit vector.
fn place_of_light(position: vec3<f32>, eye: vec3<f32>, fallback: vec3<f32>) -> vec4<f32> {
    let between = position - eye;
    let distance = length(between);
    let apart = distance >= LEAST_DISTANCE;
    return vec4<f32>(select(fallback, between / max(distance, LEAST_DISTANCE), apart), max(distance, LEAST_DISTANCE));
}

/// Distance in metres of a light at `position` from the eye of `frame`, which looks towards it.
fn distance_to_light(frame: Frame, position: vec3<f32>) -> f32 {
    return max(dot(position - frame.eye, frame.light), LEAST_DISTANCE);
}

/// Light angle, 0..pi, of the point `along` metres along a view ray. `away`: of the light from the eye, metres;
/// `cosine`, `sine`: of the ray's angle to the light.
fn light_angle(away: f32, cosine: f32, sine: f32, along: f32) -> f32 {
    // At the light itself the angle is free; atan2(0, 0) is not.
    return atan2(max(along * sine, 1e-30), away - along * cosine);
}

/// Distance in metres along the view ray at `angle` to the light, of the point with the light angle `at_light`, both in
/// 0..pi; at most `limit`, which also stands for light rays that never meet it. `away`: of the light, metres.
fn distance_from_light_angle(away: f32, angle: f32, at_light: f32, limit: f32) -> f32 {
    let between = sin(angle + at_light);
    let along = away * sin(at_light);
    if angle + at_light >= PI || along > limit * between {
        return limit;
    }
    return along / max(between, 1e-30);
}

/// Angle at the eye, 0..pi, from the direction to the light, of the point `along` metres along a light ray. `away`: of
/// the light from the eye, metres; `at_light`: its light angle.
fn angle_from_light_ray(away: f32, at_light: f32, along: f32) -> f32 {
    return atan2(max(along * sin(at_light), 1e-30), away - along * cos(at_light));
}

/// Unit vector along a light ray, away from the light. `radial`: unit vector of its half-plane, at right angles to the
/// direction to the light; `at_light`: its light angle.
fn light_ray_direction(frame: Frame, radial: vec3<f32>, at_light: f32) -> vec3<f32> {
    return sin(at_light) * radial - cos(at_light) * frame.light;
}

/// Least and greatest light angle, within 0..pi, of the light rays of a half-plane inside a cone; the first is the
/// greater one where there are none. `along_light`, `along_radius`: the cone's axis, the way it shines, times the
/// direction to the light and times the half-plane's; `cosine`: of its half angle.
fn cone_interval(along_light: f32, along_radius: f32, cosine: f32) -> vec2<f32> {
    // On light rays the cosine to the axis is extent cos(alpha - middle).
    let extent = length(vec2<f32>(along_light, along_radius));
    if cosine <= -extent {
        return vec2<f32>(0.0, PI);
    }
    if cosine >= extent {
        return vec2<f32>(PI, 0.0);
    }
    let middle = atan2(along_radius, -along_light);
    // Not acos, which WGSL allows an error of 7e-5.
    let half = atan2(sqrt(max(extent * extent - cosine * cosine, 0.0)), cosine);
    // The interval itself, and a full turn on, for cones wider than a half-space: together they are taken as one.
    var least = select(PI, max(middle - half, 0.0), middle + half >= 0.0);
    var greatest = select(0.0, min(middle + half, PI), middle + half >= 0.0);
    if middle - half < -PI {
        least = min(least, max(middle - half + 2.0 * PI, 0.0));
        greatest = PI;
    }
    return vec2<f32>(least, greatest);
}

/// Greatest light angle that the rays of a slice reach, radians, or a little more. `far`: distance of the far plane along the
/// camera's forward direction, metres; `along_light`, `along_radius`: that direction times the direction to the light
/// and times the half-plane's; `limit`: of the distance along rays, metres; `away`: of the light, metres.
fn light_angle_reach(
    slice: Slice, away: f32, far: f32, limit: f32, along_light: f32, along_radius: f32
) -> f32 {
    // On the circle at the limit: beyond the light it falls with theta; nearer it is greatest on the tangent.
    var angle = slice.angle_min;
    if limit < away {
        let tangent = atan2(sqrt((away - limit) * (away + limit)), limit);
        angle = clamp(tangent, slice.angle_min, slice.angle_max);
    }
    let circle = light_angle(away, cos(angle), sin(angle), limit);
    // On the far plane, a line here, it is monotone in theta: its greatest value is at a bound.
    var plane = 0.0;
    for (var bound = 0u; bound < 2u; bound++) {
        let theta = select(slice.angle_min, slice.angle_max, bound == 1u);
        let towards = along_light * cos(theta) + along_radius * sin(theta);
        let met = atan2(max(far * sin(theta), 1e-30), away * towards - far * cos(theta));
        plane = max(plane, select(PI - theta, met, towards > 0.0));
    }
    return min(circle, plane);
}

/// Bounds of the slice at `azimuth` around a light at a point: view rays inside the frustum, no longer than `limit` metres,
/// and the light angles that they reach inside a cone. `away`: of the light, metres; `axis`: of the cone, unit vector,
/// the way it shines; `cosine`: of its half angle, -1 for a light that shines everywhere. A slice that the cone misses
/// takes a span of LEAST_SPAN.
fn local_slice_bounds(
    camera: Camera, frame: Frame, azimuth: f32, limit: f32, away: f32, axis: vec3<f32>, cosine: f32
) -> LocalSlice {
    let slice = slice_bounds(camera, frame, azimuth, limit);
    let radial = azimuth_direction(frame, azimuth);
    let forward = forward_direction(camera);
    let far = far_plane_distance(camera, limit);
    let reach = light_angle_reach(slice, away, far, limit, dot(forward, frame.light), dot(forward, radial));
    let cone = cone_interval(dot(axis, frame.light), dot(axis, radial), cosine);
    let least = clamp(cone.x, 0.0, PI - LEAST_SPAN);
    let greatest = clamp(min(cone.y, reach), least + LEAST_SPAN, PI);
    return LocalSlice(slice.angle_min, slice.angle_max, least, greatest);
}

/// A slice as one texel of an rgba32float texture.
fn local_slice_texel(slice: LocalSlice) -> vec4<f32> {
    return vec4<f32>(slice.angle_min, slice.angle_max, slice.light_angle_min, slice.light_angle_max);
}

/// What `local_slice_texel` did, undone.
fn local_slice_from_texel(texel: vec4<f32>) -> LocalSlice {
    return LocalSlice(texel.x, texel.y, texel.z, texel.w);
}

/// The bounds of the view rays alone, for `depth_from_angle` and `depth_from_ray`.
fn ray_bounds(slice: LocalSlice) -> Slice {
    return Slice(slice.angle_min, slice.angle_max, 1.0, 1.0);
}

/// Light angle of a position along a row, radians. `unit`: 0..1 over the columns.
fn light_angle_of_column(slice: LocalSlice, unit: f32) -> f32 {
    return mix(slice.light_angle_min, slice.light_angle_max, unit);
}

/// Weight in the means of a row of the column with the light angle `at_light`, positive, 1 at the light angle 0: phase function
/// times transmittance on a ray between those of the slice that meet this light ray, nearer to the brighter ones: at the
/// geometric mean of their angles, cf. Eq. 4.12. `away`: of the light, metres.
fn column_weight(slice: LocalSlice, away: f32, at_light: f32, medium: Medium) -> f32 {
    let farthest = max(min(slice.angle_max, PI - at_light), slice.angle_min);
    let angle = sqrt(max(slice.angle_min, 0.1 * farthest) * farthest);
    // (sin alpha + sin theta) / sin(alpha + theta): what the light passes through, over the distance to the light.
    let path = cos(0.5 * (at_light - angle)) / max(cos(0.5 * (at_light + angle)), 1e-6);
    let air = exp(-min(medium.extinction * away * max(path - 1.0, 0.0), 12.0));
    let phase = henyey_greenstein(cos(angle + at_light), medium.g) / henyey_greenstein(cos(angle), medium.g);
    return air * phase;
}

/// Part of the row, 0..1, that a view ray covers which ends at the light angle `at_light`.
fn columns_covered(slice: LocalSlice, at_light: f32) -> f32 {
    let span = max(slice.light_angle_max - slice.light_angle_min, 0.1 * LEAST_SPAN);
    return clamp((at_light - slice.light_angle_min) / span, 0.0, 1.0);
}

/// The line of a view ray as the light sees it. `away`: of the light from the eye, metres; `cosine`, `sine`: of the ray's
/// angle to the light; `radius`: of the light, metres.
fn local_ray(away: f32, cosine: f32, sine: f32, radius: f32) -> LocalRay {
    let passing = away * sine;
    // Somewhat above zero, for a ray through a light without radius.
    return LocalRay(away * cosine, passing, max(length(vec2<f32>(passing, radius)), 1e-6 * away));
}

/// Angle, -pi/2..pi/2, that grows along a view ray so that equal steps of it receive alike from the light in clear air.
/// `along`: metres along the ray.
fn equal_angle(ray: LocalRay, along: f32) -> f32 {
    return atan2(along - ray.closest, ray.softened);
}

/// Metres along the ray, not negative, of an `equal_angle`.
fn along_from_equal_angle(ray: LocalRay, angle: f32) -> f32 {
    return clamp(ray.closest + ray.softened * tan(angle), 0.0, 1e15);
}

/// Metres of air that light passes from the light to the point `along` metres along the ray, and from there to the eye.
fn path_through_air(ray: LocalRay, along: f32) -> f32 {
    return along + length(vec2<f32>(ray.passing, along - ray.closest));
}

/// Cosine of the scattering angle at the point `along` metres along the ray: the view direction times the direction
/// from there TOWARDS the light.
fn cosine_to_light(ray: LocalRay, along: f32) -> f32 {
    let left = ray.closest - along;
    return left / max(length(vec2<f32>(ray.passing, left)), 1e-12);
}

/// asinh of x >= 0, with a small relative error for small x, which the built-in function lacks.
fn area_sine(x: f32) -> f32 {
    let square = x * x;
    let series = x * (1.0 - square * (0.16666667 - square * (0.075 - square * 0.04464286)));
    return select(log(x + sqrt(square + 1.0)), series, x < 0.3);
}

/// What `area_sine` did, undone.
fn sine_of_area(x: f32) -> f32 {
    let square = x * x;
    let series = x * (1.0 + square * (0.16666667 + square * (0.008333333 + square * 0.00019841270)));
    return select(0.5 * (exp(x) - exp(-x)), series, x < 0.7);
}

/// The airlight integral on one side of the closest point. `side`: -1 before it, 1 beyond; `from_along`, `to_along`: metres from
/// the closest point, not negative, the first not greater than the second; `stretch`: the scale within which the integrand changes fast near zero.
fn airlight_side(
    ray: LocalRay, side: f32, from_along: f32, to_along: f32, stretch: f32, extinction: f32, g: f32
) -> f32 {
    let h = ray.softened;
    // What `equal_angle` lacks to pi/2 on that side; the span by itself, for a difference would lose its figures.
    let a = atan2(h, to_along) / stretch;
    let b = atan2(h, from_along) / stretch;
    let span = atan2(h * (to_along - from_along), h * h + from_along * to_along) / stretch;
    let first = area_sine(a);
    let half = 0.5 * area_sine(span * (a + b) / (b * sqrt(1.0 + a * a) + a * sqrt(1.0 + b * b)));
    let middle = first + half;
    var sum = 0.0;
    for (var pair = 0u; pair < 8u; pair++) {
        // An index into a constant vector would be a table in memory.
        let picked = select(vec4<f32>(0.0), vec4<f32>(1.0), vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(pair >> 1u));
        let node = dot(NODES, picked);
        let at = middle + half * select(node, -node, (pair & 1u) == 0u);
        let growth = exp(at);
        let angle = max(stretch * sine_of_area(at), 1e-12);
        let along = clamp(ray.closest + side * h * cos(angle) / sin(angle), 0.0, 1e15);
        let phase = henyey_greenstein(cosine_to_light(ray, along), g);
        let air = exp(-min(extinction * path_through_air(ray, along), 200.0));
        sum += dot(WEIGHTS, picked) * phase * air * 0.5 * (growth + 1.0 / growth);
    }
    return sum * half * stretch;
}

/// The airlight integral: int p(cos) exp(-extinction (t + d)) / (d^2 + radius^2) dt from `from_along` to `to_along`
/// metres along a view ray, in 1/(m sr), with d the distance to the light. `extinction` in 1/m, not negative; `g`: mean cosine.
/// A fixed rule of 16 points: within 1e-3 for g from -0.75 to 0.9 on rays that pass the light at twice its radius or farther;
/// nearer, where the softening is a matter of taste, within 5e-2. Stretches below a thousandth of the distance to the
/// light lose figures in proportion.
fn airlight(ray: LocalRay, extinction: f32, g: f32, from_along: f32, to_along: f32) -> f32 {
    let start = from_along - ray.closest;
    let start_away = length(vec2<f32>(ray.passing, start));
    // Path at the start less that at the eye; the second form does not cancel before the closest point.
    let before = ray.passing * ray.passing / max(start_away - start, 1e-30);
    let path = select(before, start + start_away, start > 0.0) + DEEPEST / max(extinction, 1e-20);
    let deepest = 0.5 * (path - ray.passing * ray.passing / path);
    let end = max(min(to_along - ray.closest, deepest), start);

    let peak = clamp((1.0 - abs(g)) / sqrt(max(abs(g), 0.01)), 1e-3, 10.0);
    // Both sides always, an empty one for nothing: a branch here, or a loop of varying length, ends lavapipe of Mesa 22.3.
    let before_light = airlight_side(
        ray, -1.0, max(-end, 0.0), max(-start, 0.0), select(10.0, peak, g > 0.0), extinction, g
    );
    // Beyond the light the air dims over angles of about the optical depth of the closest distance.
    let stretch = min(max(extinction * ray.softened, 0.01), select(10.0, peak, g < 0.0));
    let beyond_light = airlight_side(ray, 1.0, max(start, 0.0), max(end, 0.0), stretch, extinction, g);
    return (before_light + beyond_light) / ray.softened;
}

/// Radiance scattered into a view ray. `intensity`: linear RGB radiant intensity of the light; `lit`: mean of visibility times
/// fall-off over the light angles of the stretch that `integral` was taken over, for each colour, 0..1.
fn local_in_scattered(medium: Medium, intensity: vec3<f32>, integral: f32, lit: vec3<f32>) -> vec3<f32> {
    return medium.albedo * intensity * lit * (medium.extinction * integral);
}
