// SPDX-License-Identifier: MIT OR Apache-2.0
//! Simple models of things, composed of closed bodies with smooth normals, in metres; each stands on y = 0 or is about the origin.

use super::lathe::{lathe, smooth_profile, tube};
use super::mesh::Mesh;
use super::shapes::{cuboid, sphere};
use glam::{Mat4, Quat, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Joins bodies that were placed and coloured.
fn joined(parts: impl IntoIterator<Item = (Mesh, Mat4, [f32; 3])>) -> Mesh {
    let mut mesh = Mesh::default();
    for (part, place, albedo) in parts {
        mesh.append(&part.transformed(place).with_albedo(Vec3::from(albedo)));
    }
    mesh
}

fn at(x: f32, y: f32, z: f32) -> Mat4 {
    Mat4::from_translation(Vec3::new(x, y, z))
}

/// An ellipsoid of such half axes.
fn ellipsoid(half: Vec3) -> Mesh {
    sphere(1.0, 48, 24).transformed(Mat4::from_scale(half))
}

fn profile(points: &[[f32; 2]], steps: u32) -> Vec<Vec2> {
    smooth_profile(&points.iter().map(|point| Vec2::from(*point)).collect::<Vec<_>>(), steps)
}

/// A mushroom of a height of 1 m: stem, cap and the hollow below it.
fn mushroom() -> Mesh {
    let stem = profile(
        &[[0.0, 0.0], [0.14, 0.0], [0.15, 0.06], [0.1, 0.25], [0.09, 0.5], [0.1, 0.78], [0.0, 0.8]],
        6,
    );
    let cap = profile(
        &[
            [0.0, 0.66],
            [0.12, 0.65],
            [0.3, 0.58],
            [0.43, 0.53],
            [0.46, 0.56],
            [0.41, 0.72],
            [0.27, 0.9],
            [0.1, 0.99],
            [0.0, 1.0],
        ],
        6,
    );
    let mut mesh = lathe(&stem, 40).with_albedo(Vec3::new(0.82, 0.76, 0.64));
    mesh.append(&lathe(&cap, 56).with_albedo(Vec3::new(0.62, 0.13, 0.07)));
    mesh
}

/// A group of five mushrooms, the highest of 1 m, on ground that is not part of it.
pub fn mushrooms() -> Mesh {
    let place = |x: f32, z: f32, height: f32, wide: f32, lean: f32, way: f32| {
        let lean = Quat::from_rotation_y(way) * Quat::from_rotation_z(lean);
        let scale = Vec3::new(height * wide, height, height * wide);
        at(x, -0.02 * height, z) * Mat4::from_quat(lean) * Mat4::from_scale(scale)
    };
    let mut mesh = Mesh::default();
    for place in [
        place(0.0, 0.0, 1.0, 1.0, 0.05, 0.3),
        place(0.62, 0.25, 0.66, 1.15, -0.14, 0.1),
        place(-0.55, 0.3, 0.52, 1.2, 0.16, 6.0),
        place(0.18, 0.6, 0.36, 1.25, 0.1, 4.2),
        place(-0.2, -0.55, 0.74, 0.95, 0.12, 1.7),
    ] {
        mesh.append(&mushroom().transformed(place));
    }
    mesh
}

/// A small aeroplane with a low wing, about the origin, its nose towards +z; 7 m long, 9 m wide.
pub fn aeroplane() -> Mesh {
    const BODY: [f32; 3] = [0.75, 0.76, 0.78];
    const WING: [f32; 3] = [0.68, 0.14, 0.1];
    let forward = Mat4::from_rotation_x(FRAC_PI_2);
    let body = profile(
        &[
            [0.0, -3.4],
            [0.1, -3.35],
            [0.22, -2.4],
            [0.45, -0.8],
            [0.56, 0.5],
            [0.54, 1.7],
            [0.42, 2.6],
            [0.2, 3.1],
            [0.0, 3.2],
        ],
        8,
    );
    let spinner = profile(&[[0.0, 3.0], [0.2, 3.0], [0.16, 3.3], [0.0, 3.5]], 6);
    // A wing tapers and is swept a little.
    let wing = |side: f32| {
        let mut wing = ellipsoid(Vec3::new(2.4, 0.09, 0.72));
        for position in &mut wing.positions {
            position.z -= 0.12 * (position.x + 2.4);
            position.y += 0.05 * (position.x + 2.4);
        }
        wing.compute_normals();
        let outwards = Mat4::from_scale(Vec3::new(side, 1.0, 1.0)) * at(2.1, -0.3, 0.55);
        (wing, outwards, WING)
    };
    let tail = |side: f32| {
        let place = Mat4::from_scale(Vec3::new(side, 1.0, 1.0)) * at(0.7, 0.1, -3.0);
        (ellipsoid(Vec3::new(0.95, 0.05, 0.34)), place, WING)
    };
    let mut fin = ellipsoid(Vec3::new(0.05, 0.75, 0.42));
    for position in &mut fin.positions {
        position.z -= 0.4 * (position.y + 0.75);
    }
    fin.compute_normals();
    let blade = ellipsoid(Vec3::new(0.09, 0.95, 0.025));
    joined([
        (lathe(&body, 48), forward, BODY),
        (lathe(&spinner, 32), forward, WING),
        wing(1.0),
        wing(-1.0),
        tail(1.0),
        tail(-1.0),
        (fin, at(0.0, 0.75, -2.7), WING),
        (ellipsoid(Vec3::new(0.4, 0.42, 0.95)), at(0.0, 0.45, 0.5), [0.12, 0.16, 0.2]),
        (blade, at(0.0, 0.0, 3.25) * Mat4::from_rotation_z(0.5), [0.1, 0.1, 0.1]),
    ])
}

/// A desk of 1.4 x 0.7 m with a lamp on it, and a chair before it, towards +z.
pub fn desk() -> Mesh {
    const WOOD: [f32; 3] = [0.5, 0.3, 0.16];
    const DARK: [f32; 3] = [0.3, 0.17, 0.09];
    const METAL: [f32; 3] = [0.35, 0.37, 0.4];
    let board = |size: [f32; 3], middle: [f32; 3], albedo| {
        (cuboid(Vec3::from(size)), Mat4::from_translation(Vec3::from(middle)), albedo)
    };
    let mut parts = vec![
        board([1.4, 0.04, 0.7], [0.0, 0.73, 0.0], WOOD),
        board([1.3, 0.1, 0.02], [0.0, 0.66, -0.3], WOOD),
        // Drawers.
        board([0.4, 0.5, 0.6], [0.45, 0.46, 0.0], WOOD),
    ];
    for drawer in 0..3_u8 {
        let y = 0.3 + 0.16 * f32::from(drawer);
        parts.push(board([0.34, 0.13, 0.02], [0.45, y, 0.305], DARK));
        parts.push((sphere(0.016, 24, 12), at(0.45, y, 0.33), METAL));
    }
    let leg = |height: f32, radius: f32| {
        lathe(&[Vec2::new(radius * 0.7, 0.0), Vec2::new(radius, height * 0.9), Vec2::new(radius, height)], 24)
    };
    for (x, z) in [(-0.64, -0.29), (-0.64, 0.29), (0.64, -0.29), (0.64, 0.29)] {
        parts.push((leg(0.72, 0.03), at(x, 0.0, z), DARK));
    }
    // The chair, turned a little away.
    let chair = at(-0.22, 0.0, 0.72) * Mat4::from_rotation_y(0.35);
    let mut chair_parts = vec![
        board([0.42, 0.04, 0.42], [0.0, 0.45, 0.0], WOOD),
        board([0.4, 0.1, 0.025], [0.0, 0.9, 0.2], WOOD),
        board([0.4, 0.07, 0.025], [0.0, 0.68, 0.2], WOOD),
    ];
    for (x, z, height) in [(-0.18, -0.18, 0.44), (0.18, -0.18, 0.44), (-0.18, 0.19, 0.97), (0.18, 0.19, 0.97)]
    {
        chair_parts.push((leg(height, 0.02), at(x, 0.0, z), DARK));
    }
    parts.extend(chair_parts.into_iter().map(|(part, place, albedo)| (part, chair * place, albedo)));
    // The lamp.
    let foot = profile(&[[0.0, 0.0], [0.1, 0.0], [0.1, 0.015], [0.03, 0.03], [0.0, 0.03]], 4);
    let neck: Vec<(Vec3, f32)> = (0..=24_u8)
        .map(|step| f32::from(step) / 24.0)
        .map(|t| (Vec3::new(0.24 * t * t, 0.4 * (t * FRAC_PI_2).sin(), 0.0), 0.009))
        .collect();
    let shade: Vec<Vec2> = profile(&[[0.02, 0.09], [0.045, 0.07], [0.09, 0.0]], 6);
    let shade: Vec<Vec2> = shade.into_iter().rev().collect();
    let lamp = at(-0.5, 0.75, -0.18) * Mat4::from_rotation_y(-0.5);
    parts.push((lathe(&foot, 40), lamp, METAL));
    parts.push((tube(&neck, 16), lamp * at(0.0, 0.02, 0.0), METAL));
    parts.push((lathe(&shade, 40), lamp * at(0.24, 0.35, 0.0), [0.1, 0.28, 0.17]));
    joined(parts)
}

/// A dart about the origin, its point towards +z; 1 m long.
pub fn dart() -> Mesh {
    let forward = Mat4::from_rotation_x(FRAC_PI_2);
    let point = profile(&[[0.0, 0.5], [0.006, 0.42], [0.009, 0.28], [0.012, 0.2], [0.0, 0.2]], 4);
    let point: Vec<Vec2> = point.into_iter().rev().collect();
    let barrel = profile(
        &[[0.0, -0.06], [0.02, -0.055], [0.034, 0.0], [0.04, 0.1], [0.03, 0.19], [0.012, 0.24], [0.0, 0.245]],
        6,
    );
    let shaft = [Vec2::new(0.012, -0.42), Vec2::new(0.014, -0.05)];
    let mut parts = vec![
        (lathe(&point, 32), forward, [0.55, 0.57, 0.6]),
        (lathe(&barrel, 40), forward, [0.62, 0.5, 0.2]),
        (lathe(&shaft, 24), forward, [0.08, 0.08, 0.09]),
    ];
    for blade in 0..4_u8 {
        let turn = Mat4::from_rotation_z(TAU / 4.0 * f32::from(blade) + TAU / 8.0);
        parts.push((
            ellipsoid(Vec3::new(0.075, 0.004, 0.13)),
            turn * at(0.075, 0.0, -0.37),
            [0.7, 0.1, 0.12],
        ));
    }
    joined(parts)
}

/// A teapot with lid, spout towards +x and handle; 0.6 m high.
pub fn teapot() -> Mesh {
    const GLAZE: [f32; 3] = [0.55, 0.62, 0.66];
    let body = profile(
        &[
            [0.0, 0.0],
            [0.2, 0.0],
            [0.24, 0.02],
            [0.36, 0.14],
            [0.4, 0.26],
            [0.34, 0.39],
            [0.23, 0.45],
            [0.0, 0.45],
        ],
        8,
    );
    let lid =
        profile(&[[0.0, 0.44], [0.24, 0.44], [0.23, 0.47], [0.14, 0.51], [0.05, 0.53], [0.0, 0.535]], 8);
    let curve = |points: &[[f32; 4]]| -> Vec<(Vec3, f32)> {
        let [places, radii] = [[0, 1], [3, 3]].map(|[a, b]| {
            smooth_profile(
                &points.iter().map(|point| Vec2::new(point[a] + 2.0, point[b])).collect::<Vec<_>>(),
                10,
            )
        });
        let path = places.iter().zip(&radii);
        path.map(|(place, radius)| (Vec3::new(place.x - 2.0, place.y, 0.0), radius.y)).collect()
    };
    let spout = curve(&[
        [0.2, 0.13, 0.0, 0.09],
        [0.42, 0.18, 0.0, 0.07],
        [0.53, 0.32, 0.0, 0.045],
        [0.64, 0.42, 0.0, 0.035],
    ]);
    let handle = curve(&[
        [-0.3, 0.38, 0.0, 0.03],
        [-0.48, 0.4, 0.0, 0.028],
        [-0.58, 0.31, 0.0, 0.028],
        [-0.53, 0.18, 0.0, 0.028],
        [-0.35, 0.12, 0.0, 0.03],
    ]);
    joined([
        (lathe(&body, 64), Mat4::IDENTITY, GLAZE),
        (lathe(&lid, 48), Mat4::IDENTITY, GLAZE),
        (sphere(0.045, 32, 16), at(0.0, 0.56, 0.0), GLAZE),
        (tube(&spout, 28), Mat4::IDENTITY, GLAZE),
        (tube(&handle, 24), Mat4::IDENTITY, GLAZE),
    ])
}

#[cfg(test)]
mod tests {
    use super::super::lathe::tests::closed;
    use super::*;

    #[test]
    fn models_are_closed_face_outwards_and_have_their_size() {
        for (name, mesh, size, base) in [
            ("mushrooms", mushrooms(), Vec3::new(1.9, 1.0, 1.6), true),
            ("aeroplane", aeroplane(), Vec3::new(9.0, 2.6, 7.3), false),
            ("desk", desk(), Vec3::new(1.4, 1.17, 1.36), true),
            ("dart", dart(), Vec3::new(0.22, 0.22, 1.0), false),
            ("teapot", teapot(), Vec3::new(1.27, 0.6, 0.8), true),
        ] {
            let volume = closed(&mesh);
            let bounds = mesh.bounds().expect("vertices");
            println!("{name}: {} triangles, {volume} m3, {bounds:?}", mesh.triangle_count());
            assert!(volume > 0.0, "{name}");
            let ratio = bounds.size() / size;
            assert!(ratio.min_element() > 0.85 && ratio.max_element() < 1.15, "{name}: {}", bounds.size());
            let low = bounds.min.y;
            assert!(if base { low.abs() < 0.08 } else { low < -0.05 }, "{name}: {low}");
            assert!((500..50_000).contains(&mesh.triangle_count()), "{name}");
        }
    }
}
