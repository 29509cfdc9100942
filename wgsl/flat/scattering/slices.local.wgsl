// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/slices, permutation local (LOCAL)
// summary: The frame of the epipolar slices and the bounds of each, one thread a slice.
// source: thesis 4.4.1 (bounds), 4.3.2 Eq. 4.12 (reference ray).
// definition LOCAL: a spot or point light; its slices are bounded by light angles.
// binding camera: the camera, perspective.
// binding light: the light, directional without LOCAL.
// binding medium: the medium; its distance limit bounds the slices.
// binding frame: out, the frame that later passes read as a uniform.
// binding slices: out, one texel a slice (width rows, height 1): angle_min, angle_max, radius_max, reference; with LOCAL angle_min, angle_max, light_angle_min, light_angle_max.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Orthographic projection: view rays are parallel and leave the near plane.
const ORTHOGRAPHIC: u32 = 1u;

/// A camera, as an engine hands it over. 160 bytes.
struct Camera {
    /// View-projection matrix, world to clip.
    clip_from_world: mat4x4<f32>,
    /// Its inverse, clip to world.
    world_from_clip: mat4x4<f32>,
    /// Position of the eye in the world, metres; unused by an orthographic camera.
    eye: vec3<f32>,
    /// Clip depth of the near plane: 0 forward, 1 reversed.
    near_depth: f32,
    /// Width and height of the picture in pixels.
    viewport: vec2<f32>,
    /// Clip depth of the far plane: 1 forward, 0 reversed.
    far_depth: f32,
    /// PERSPECTIVE or ORTHOGRAPHIC.
    projection: u32,
}

/// A view ray: world-space origin in metres, unit direction.
struct Ray {
    /// Where it starts in the world, metres.
    origin: vec3<f32>,
    /// Unit vector, away from the eye.
    direction: vec3<f32>,
}

/// The view ray through `ndc`, of any camera.
fn view_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    // Values, not branches: some drivers compile a shader anew for every value of a uniform that a branch depends on.
    let parallel = camera.projection == ORTHOGRAPHIC;
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let near = camera.world_from_clip * vec4<f32>(ndc, camera.near_depth, 1.0);
    let origin = select(camera.eye, near.xyz / select(1.0, near.w, parallel), parallel);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(origin, normalize(far.xyz - select(camera.eye * far.w, near.xyz, parallel)));
}

/// Row `index` of a matrix, as a vector.
fn matrix_row(matrix: mat4x4<f32>, index: u32) -> vec4<f32> {
    return vec4<f32>(matrix[0][index], matrix[1][index], matrix[2][index], matrix[3][index]);
}

/// Unit inward normal of a side plane of a perspective frustum: 0 left, 1 right, 2 bottom, 3 top.
fn side_normal(camera: Camera, side: u32) -> vec3<f32> {
    let axis = matrix_row(camera.clip_from_world, side >> 1u).xyz;
    let w = matrix_row(camera.clip_from_world, 3u).xyz;
    return normalize(w + select(axis, -axis, (side & 1u) == 1u));
}

/// Unit direction in which a perspective camera looks, at right angles to the picture plane.
fn forward_direction(camera: Camera) -> vec3<f32> {
    return normalize(matrix_row(camera.clip_from_world, 3u).xyz);
}

/// Distance of the far plane along `forward_direction` in metres, at most `limit`.
fn far_plane_distance(camera: Camera, limit: f32) -> f32 {
    let forward = forward_direction(camera);
    let point = camera.world_from_clip * vec4<f32>(0.0, 0.0, camera.far_depth, 1.0);
    let along = dot(point.xyz - camera.eye * point.w, forward);
    let beyond = along >= limit * point.w;
    return select(max(along / select(point.w, 1.0, beyond), 0.0), limit, beyond);
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light at a point that shines into a cone.
const SPOT: u32 = 1u;

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

// ---- airlight::scattering::rectify ----
// summary: Epipolar coordinates around a directional light: rows are slices, columns radii, depth the angle to the light.
// source: thesis 4.4.1, after Baran et al., "A hierarchical volumetric shadow algorithm" (2010); Eq. 4.12.

const rectify_PI: f32 = 3.141592653589793;

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
        light, -rectify_PI, axis_a, f32(rows) / (2.0 * rectify_PI), axis_b, f32(rows), camera.eye, 1.0,
        vec3<f32>(dot(column_x, light), dot(column_y, light), dot(constant, light)), 0.0,
        vec3<f32>(dot(column_x, axis_a), dot(column_y, axis_a), dot(constant, axis_a)), 0.0,
        vec3<f32>(dot(column_x, axis_b), dot(column_y, axis_b), dot(constant, axis_b)), 0.0,
        matrix_row(camera.world_from_clip, 3u)
    );
    if nearest > -INSIDE_MARGIN || farthest < INSIDE_MARGIN {
        return frame;
    }

    var azimuth_min = rectify_PI;
    var azimuth_max = -rectify_PI;
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
    var angle_max = rectify_PI;
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
        let middle = clamp(0.5 * (angle_min + angle_max), 0.5 * LEAST_WIDTH, rectify_PI - 0.5 * LEAST_WIDTH);
        angle_min = middle - 0.5 * LEAST_WIDTH;
        angle_max = middle + 0.5 * LEAST_WIDTH;
    }

    let right_angle = 0.5 * rectify_PI;
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

/// k of the reference ray by the bisectrix of the rays that cross a texel fastest and slowest.
fn reference_bisectrix(angle_min: f32, angle_max: f32) -> f32 {
    let widest = clamp(0.5 * rectify_PI, angle_min, angle_max);
    let narrowest = select(angle_max, angle_min, sin(angle_min) < sin(angle_max));
    return max(sin(0.5 * (widest + narrowest)), LEAST_REFERENCE);
}

// ---- airlight::scattering::single_scatter ----
// summary: Single scattering of a directional light in a homogeneous medium, given the visibility along a ray.
// source: thesis 4.2.1, Eq. 4.1 and 4.2; 4.3.2, Eq. 4.8 and 4.9; Listing 4.4.

/// A homogeneous medium. 32 bytes.
struct Medium {
    /// Single-scattering albedo, 0..1 for each colour.
    albedo: vec3<f32>,
    /// Extinction coefficient in 1/m, not negative; zero is a clear picture.
    extinction: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
    /// Rays end here if they meet nothing nearer, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

// ---- airlight::scattering::local_light ----
// summary: Epipolar rows around a light at a point, spot or point light, and the light that air scatters along a view ray.
// source: thesis 4.3.2 ("other light sources") and 4.4.1; W. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009); C. Kulla and M. Fajardo (2012) for equal angles.

const local_light_PI: f32 = 3.141592653589793;

/// An eye nearer to the light than this, metres, has no direction to it.
const LEAST_DISTANCE: f32 = 1e-4;
/// Slices span at least this much at the light, radians.
const LEAST_SPAN: f32 = 1e-4;

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

/// Least and greatest light angle, within 0..pi, of the light rays of a half-plane inside a cone; the first is the
/// greater one where there are none. `along_light`, `along_radius`: the cone's axis, the way it shines, times the
/// direction to the light and times the half-plane's; `cosine`: of its half angle.
fn cone_interval(along_light: f32, along_radius: f32, cosine: f32) -> vec2<f32> {
    // On light rays the cosine to the axis is extent cos(alpha - middle).
    let extent = length(vec2<f32>(along_light, along_radius));
    if cosine <= -extent {
        return vec2<f32>(0.0, local_light_PI);
    }
    if cosine >= extent {
        return vec2<f32>(local_light_PI, 0.0);
    }
    let middle = atan2(along_radius, -along_light);
    // Not acos, which WGSL allows an error of 7e-5.
    let half = atan2(sqrt(max(extent * extent - cosine * cosine, 0.0)), cosine);
    // The interval itself, and a full turn on, for cones wider than a half-space: together they are taken as one.
    var least = select(local_light_PI, max(middle - half, 0.0), middle + half >= 0.0);
    var greatest = select(0.0, min(middle + half, local_light_PI), middle + half >= 0.0);
    if middle - half < -local_light_PI {
        least = min(least, max(middle - half + 2.0 * local_light_PI, 0.0));
        greatest = local_light_PI;
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
        plane = max(plane, select(local_light_PI - theta, met, towards > 0.0));
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
    let least = clamp(cone.x, 0.0, local_light_PI - LEAST_SPAN);
    let greatest = clamp(min(cone.y, reach), least + LEAST_SPAN, local_light_PI);
    return LocalSlice(slice.angle_min, slice.angle_max, least, greatest);
}

/// A slice as one texel of an rgba32float texture.
fn local_slice_texel(slice: LocalSlice) -> vec4<f32> {
    return vec4<f32>(slice.angle_min, slice.angle_max, slice.light_angle_min, slice.light_angle_max);
}

// ---- scattering/slices ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> medium: Medium;
@group(0) @binding(3) var<storage, read_write> frame: Frame;
@group(0) @binding(4) var slices: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64)
fn slices_main(@builtin(global_invocation_id) id: vec3<u32>) {
    let rows = textureDimensions(slices).x;
    if id.x >= rows {
        return;
    }
    let place = place_of_light(light.position, camera.eye, forward_direction(camera));
    let around = epipolar_frame(camera, place.xyz, rows);
    // Everything is within an angle whose cosine is -1.
    let cosine = select(-1.0, light.spot_cosines.y, light.kind == SPOT);
    let away = distance_to_light(around, light.position);
    let bounds = local_slice_bounds(
        camera, around, row_azimuth(around, f32(id.x)), medium.distance_limit, away, -light.direction, cosine
    );
    textureStore(slices, vec2<u32>(id.x, 0u), local_slice_texel(bounds));
    if id.x == 0u {
        frame = around;
    }
}
