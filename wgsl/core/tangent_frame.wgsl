// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::tangent_frame
// summary: Directions at right angles to a normal.
// source: Duff et al., "Building an orthonormal basis, revisited" (2017).
// equation: s = sign(z), a = −1 / (s + z), b = x y a:  (1 + s x² a, s b, −s x), (b, s + y² a, −y), n
// error: lengths within 1e-6, right angles 2e-6; test core/directions::frames_are_orthonormal_and_right_handed.
// parameter normal: unit vector.

/// Columns: three unit vectors at right angles, the last of which is `normal`, unit.
fn tangent_frame(normal: vec3<f32>) -> mat3x3<f32> {
    let side = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (side + normal.z);
    let b = normal.x * normal.y * a;
    return mat3x3<f32>(
        vec3<f32>(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x),
        vec3<f32>(b, side + normal.y * normal.y * a, -normal.y),
        normal,
    );
}
