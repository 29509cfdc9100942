// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::curvature
// summary: Principal curvatures of iso-surfaces and their directions, in the world and in the picture.
// source: Kindlmann, Whitaker, Tasdizen and Moller, "Curvature-based transfer functions for direct volume rendering" (2003); dissertation on painterly volume rendering, 6.1.3.
// note: There k = (T +- sqrt(2 F^2 - T^2)) / 2 with trace T and Frobenius norm F of -P H P / |g|, P = I - n n^T. Here the same
// note: tensor is taken in a basis of the tangent plane, as a symmetric form of two rows a, b and b, c: then T = a + c and
// note: 2 F^2 - T^2 = (a - c)^2 + 4 b^2, a sum of squares in which nothing cancels, and which gives the directions as well.
// note: A voxel has three sides and may be skewed: with B, which takes metres to voxels, gradients become B^T g and second
// note: derivatives B^T H B. Both are scaled by the greatest entry of B, so that voxels of any size neither overflow nor vanish.
// note: Where both curvatures are alike there is no direction, and where the value hardly changes there is no curvature.
// equation: (a b; b c) = side Pᵀ H P / |g| in a basis P of the tangent plane;  κ = ½ (a + c) ± √(¼ (a − c)² + b²)
// equation: direction of κ₁: half the angle of (½ (a − c), b);  in metres: gradient Bᵀ g, second derivatives Bᵀ H B
// error: eigenvalues within 1e-4, directions 0.05 degrees; test painterly/curvature_functions::curvatures_are_eigenvalues_in_any_space.
// error: spheres in any box within 2 % of their radius; test painterly/curvature::spheres_bend_by_their_radius_in_any_box.
// parameter double: unit vector (cos 2a, sin 2a).
// parameter unit_from_world: world, metres, to unit space; affine.
// parameter size: voxels along each axis.
// parameter along: any length.
// parameter point: metres in the world.
// parameter linear_sampler: linear, clamped to the edge.
// parameter curvatures: of the picture's texel, the greater and the lesser, 1/m.
// parameter range: 1/m, positive.

#import airlight::core::camera::Camera
#import airlight::core::finite::{finite_or, finite_or_rgb, is_finite}
#import airlight::core::tangent_frame::tangent_frame
#import airlight::painterly::iso_surface::direction_in_picture
#import airlight::painterly::spline::SplineJet

/// Change of the value a voxel below which a gradient is rounding.
const LEAST_SLOPE: f32 = 1e-5;
/// Curvatures that differ by less than this share of the greater one count as alike.
const ALIKE: f32 = 0.02;
/// A surface is flat where its radii are longer than this, in voxels.
const FLAT_RADIUS: f32 = 1e3;
/// Greatest curvature that is told, 1/m: the greatest half float.
const MOST_CURVATURE: f32 = 65504.0;
/// Sine of the angle between view ray and a direction below which the picture shows none.
const LEAST_SINE: f32 = 1e-3;

/// How a surface bends.
struct PrincipalCurvatures {
    /// The greater curvature, signed, positive where the surface is convex on the side of its normal.
    one: f32,
    /// The lesser.
    two: f32,
    /// Unit direction of the greater, either way; 0 where both are alike.
    along_one: vec3<f32>,
    /// Unit direction of the lesser.
    along_two: vec3<f32>,
}

/// Half the angle of a unit vector, as a unit vector.
fn half_angle(double: vec2<f32>) -> vec2<f32> {
    // Of two forms the one in which nothing cancels.
    return normalize(select(vec2<f32>(abs(double.y), 1.0 - double.x), vec2<f32>(1.0 + double.x, abs(double.y)), double.x >= 0.0))
        * vec2<f32>(1.0, select(-1.0, 1.0, double.y >= 0.0));
}

/// Principal curvatures of the level set of a function. `gradient`, `hessian`: of it, in any unit of length, which is that of
/// the curvatures; `side`: 1 where the normal points along the gradient, -1 where against it; `least`: length of the
/// gradient from which on there is a surface, positive.
fn principal_curvatures(gradient: vec3<f32>, hessian: mat3x3<f32>, side: f32, least: f32) -> PrincipalCurvatures {
    let size = length(gradient);
    let known = size >= least;
    let frame = tangent_frame(select(vec3<f32>(0.0, 0.0, 1.0), gradient / select(1.0, size, known), known));
    let bent_one = hessian * frame[0];
    let bent_two = hessian * frame[1];
    let factor = select(0.0, side / select(1.0, size, known), known);
    let a = factor * dot(frame[0], bent_one);
    let b = factor * dot(frame[0], bent_two);
    let c = factor * dot(frame[1], bent_two);
    let mean = 0.5 * (a + c);
    let apart = vec2<f32>(0.5 * (a - c), b);
    let half = length(apart);
    let one = mean + half;
    let two = mean - half;
    let directed = 2.0 * half > max(ALIKE * max(abs(one), abs(two)), 1.0 / FLAT_RADIUS);
    let angle = half_angle(select(vec2<f32>(1.0, 0.0), apart / select(1.0, half, directed), directed));
    let shown = select(0.0, 1.0, directed);
    return PrincipalCurvatures(
        one, two,
        shown * (angle.x * frame[0] + angle.y * frame[1]),
        shown * (angle.x * frame[1] - angle.y * frame[0]),
    );
}

/// Principal curvatures in 1/m, and their directions in the world, of the level set of a volume. `jet`: of the volume, in voxels
/// of `size` along each axis; `side`: 1 where the normal points to greater values, -1 where to lesser ones.
fn world_curvatures(jet: SplineJet, size: vec3<f32>, unit_from_world: mat4x4<f32>, side: f32) -> PrincipalCurvatures {
    let rows = transpose(mat3x3<f32>(size * unit_from_world[0].xyz, size * unit_from_world[1].xyz, size * unit_from_world[2].xyz));
    let greatest = max(max(abs(rows[0]), abs(rows[1])), abs(rows[2]));
    let scale = clamp(max(max(greatest.x, greatest.y), greatest.z), 1e-30, 1e30);
    // From world to voxels, its columns those of the world's axes.
    let scaled = transpose(mat3x3<f32>(rows[0] / scale, rows[1] / scale, rows[2] / scale));
    let gradient = transpose(scaled) * jet.gradient;
    let hessian = transpose(scaled) * jet.hessian * scaled;
    let found = principal_curvatures(gradient, hessian, side, LEAST_SLOPE);
    let limit = MOST_CURVATURE / scale;
    return PrincipalCurvatures(
        clamp(found.one, -limit, limit) * scale, clamp(found.two, -limit, limit) * scale, found.along_one, found.along_two
    );
}

/// The direction of greatest bending, either way; 0 where there is none.
fn greatest_direction(curvatures: PrincipalCurvatures) -> vec3<f32> {
    return select(curvatures.along_two, curvatures.along_one, abs(curvatures.one) >= abs(curvatures.two));
}

/// (cos 2a, sin 2a) of a vector's angle a; 0 of a vector of no length.
fn double_angle(along: vec2<f32>) -> vec2<f32> {
    let greatest = max(abs(along.x), abs(along.y));
    let known = greatest > 0.0;
    let held = along / select(1.0, greatest, known);
    let square = select(1.0, dot(held, held), known);
    return vec2<f32>(held.x * held.x - held.y * held.y, 2.0 * held.x * held.y) / square;
}

/// A direction at a point as the picture shows it: (cos 2a, sin 2a) of its angle from x, rightwards, to y, downwards; 0 where it
/// runs along the view ray, or is 0. `direction`: unit, either way; `view`: unit, of the view ray; world all.
fn picture_direction(camera: Camera, point: vec3<f32>, direction: vec3<f32>, view: vec3<f32>) -> vec2<f32> {
    let across = direction - view * dot(view, direction);
    let moved = direction_in_picture(camera, point, across, camera.viewport);
    let shown = length(across) > LEAST_SINE && is_finite(moved.x) && is_finite(moved.y);
    return select(vec2<f32>(0.0), double_angle(select(vec2<f32>(1.0), moved, shown)), shown);
}

/// What the texel `curvature` of a picture holds. `curvatures`: of the surface at `point`; `view`: unit, of the view ray; world.
fn curvature_texel(curvatures: PrincipalCurvatures, camera: Camera, point: vec3<f32>, view: vec3<f32>) -> vec4<f32> {
    let shown = picture_direction(camera, point, greatest_direction(curvatures), view);
    return vec4<f32>(curvatures.one, curvatures.two, shown);
}

/// What a table over both curvatures holds: columns for the greater one and rows for the lesser, the first for -range and the
/// last for range, 1/m. `table`: linear RGB and how much of it, filtered; what is not finite counts as 0.
fn curvature_color(table: texture_2d<f32>, linear_sampler: sampler, curvatures: vec2<f32>, range: f32) -> vec4<f32> {
    let size = vec2<f32>(textureDimensions(table));
    let held = vec2<f32>(finite_or(curvatures.x, 0.0), finite_or(curvatures.y, 0.0));
    let share = clamp(held / max(range, 1e-20), vec2<f32>(-1.0), vec2<f32>(1.0)) * 0.5 + 0.5;
    let texel = textureSampleLevel(table, linear_sampler, (share * (size - 1.0) + 0.5) / size, 0.0);
    return vec4<f32>(finite_or_rgb(texel.rgb, 0.0), finite_or(texel.a, 0.0));
}
