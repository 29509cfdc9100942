// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes whose shafts are stylized: each has an object with a shadow worth changing.

use super::{BUNNY, Parts, SUZANNE, Scene, SceneError, placed, standing, view};
use crate::core::{Sky, direction_from_angles};
use crate::data::{
    Mesh, TerrainParameters, TreeParameters, mesh_from_bytes, plane, sphere, terrain, terrain_height, torus,
    tree,
};
use crate::scattering::Medium;
use crate::stage::Lighting;
use glam::{Mat4, Quat, Vec2, Vec3};

/// A lamp in the place of the sun, so that the air is dark but around `at`: it is `distance` metres away in a direction,
/// and lights everything within the lesser of two radii around `at`, metres, nothing beyond the other. Without the air
/// between, the irradiance there is `irradiance`.
fn beam(at: Vec3, direction: Vec3, distance: f32, radii: [f32; 2], irradiance: Vec3) -> Lighting {
    let degrees = |radius: f32| (radius / distance).atan().to_degrees();
    Lighting::Spot {
        position: at + direction * distance,
        target: at,
        outer_degrees: degrees(radii[1]),
        inner_degrees: degrees(radii[0]),
        intensity: irradiance * distance * distance,
        radius: 0.1,
    }
}

/// Below a great tree whose crown lets next to no light through.
pub fn canopy() -> Result<Parts, SceneError> {
    let parameters = TerrainParameters { seed: 11, size: 34.0, resolution: 140, height: 0.7 };
    let mut rest = terrain(&parameters).with_albedo(Vec3::new(0.055, 0.065, 0.028));
    let ground = |x, z| terrain_height(&parameters, x, z);
    let bunny = standing(mesh_from_bytes(BUNNY.0, BUNNY.1)?, 1.0).with_albedo(Vec3::new(0.72, 0.66, 0.60));
    let at = Vec2::new(1.9, 2.4);
    rest.append(&placed(bunny, Vec3::new(at.x, ground(at.x, at.y) - 0.02, at.y), -20.0));
    let crown = tree(&TreeParameters {
        seed: 4,
        height: 7.6,
        crown_radius: 4.6,
        leaves: 110000,
        leaf_length: 0.22,
        clumps: 150,
    });
    let object = placed(crown, Vec3::new(0.0, ground(0.0, 0.0) - 0.1, 0.0), 20.0);
    let scene = Scene {
        name: "canopy",
        title: "Below a great tree",
        mesh: Mesh::default(),
        view: view(Vec3::new(-1.5, 0.9, 10.5), Vec3::new(1.2, 2.4, 0.0), 46.0, 0.1, 40.0),
        light: beam(
            Vec3::new(0.8, 5.0, 0.0),
            direction_from_angles(222.0, 38.0),
            40.0,
            [3.7, 4.7],
            Vec3::new(75.0, 55.5, 31.5),
        ),
        light_texture: None,
        cascades: None,
        sky: Sky::new(
            Vec3::new(0.054, 0.09, 0.18),
            Vec3::new(0.126, 0.144, 0.18),
            Vec3::new(0.054, 0.054, 0.045),
        ),
        medium: Medium::new(0.05, Vec3::splat(0.96), 0.4, 40.0)?,
        exposure: 1.3,
    };
    Ok(Parts::new(scene, object, rest))
}

/// A ring in a cone of light from above.
pub fn ring() -> Result<Parts, SceneError> {
    let rest = plane(Vec2::splat(26.0), 8).with_albedo(Vec3::splat(0.03));
    let centre = Vec3::new(0.0, 3.5, 0.0);
    let object = torus(1.3, 0.7, 192, 72)
        .with_albedo(Vec3::new(0.72, 0.16, 0.07))
        .transformed(Mat4::from_rotation_translation(Quat::from_rotation_x(15.0_f32.to_radians()), centre));
    let scene = Scene {
        name: "ring",
        title: "A ring in a cone of light",
        mesh: Mesh::default(),
        view: view(Vec3::new(0.0, 1.0, 8.0), Vec3::new(0.0, 2.7, 0.0), 44.0, 0.1, 30.0),
        light: Lighting::Spot {
            position: Vec3::new(0.0, 22.0, -0.3),
            target: Vec3::new(0.0, 0.0, -0.3),
            outer_degrees: 9.5,
            inner_degrees: 6.2,
            intensity: Vec3::new(22000.0, 18920.0, 14520.0),
            radius: 0.1,
        },
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.012, 0.016, 0.03), Vec3::new(0.02, 0.026, 0.045), Vec3::splat(0.012)),
        medium: Medium::new(0.07, Vec3::splat(0.95), 0.1, 30.0)?,
        exposure: 0.8,
    };
    Ok(Parts::new(scene, object, rest))
}

/// A head before the sun.
pub fn halo() -> Result<Parts, SceneError> {
    let parameters = TerrainParameters { seed: 8, size: 30.0, resolution: 120, height: 0.8 };
    let rest = terrain(&parameters).with_albedo(Vec3::new(0.09, 0.08, 0.07));
    let head = standing(mesh_from_bytes(SUZANNE.0, SUZANNE.1)?, 2.2).with_albedo(Vec3::new(0.50, 0.30, 0.18));
    let object = placed(head, Vec3::new(0.0, terrain_height(&parameters, 0.0, 0.0) + 0.9, 0.0), 20.0);
    let scene = Scene {
        name: "halo",
        title: "A head before the sun",
        mesh: Mesh::default(),
        view: view(Vec3::new(0.3, 1.2, 5.0), Vec3::new(0.0, 1.9, 0.0), 48.0, 0.1, 30.0),
        light: beam(
            Vec3::new(0.0, 2.2, 0.0),
            direction_from_angles(183.0, 22.0),
            9.0,
            [1.8, 2.4],
            Vec3::new(20.0, 15.6, 9.2),
        ),
        light_texture: None,
        cascades: None,
        sky: Sky::new(
            Vec3::new(0.044, 0.066, 0.132),
            Vec3::new(0.132, 0.132, 0.154),
            Vec3::new(0.044, 0.044, 0.044),
        ),
        medium: Medium::new(0.05, Vec3::splat(0.96), 0.5, 40.0)?,
        exposure: 0.55,
    };
    Ok(Parts::new(scene, object, rest))
}

/// A leaping bunny, lit from ahead.
pub fn leap() -> Result<Parts, SceneError> {
    let parameters = TerrainParameters { seed: 8, size: 30.0, resolution: 120, height: 0.5 };
    let rest = terrain(&parameters).with_albedo(Vec3::new(0.10, 0.11, 0.06));
    let bunny = standing(mesh_from_bytes(BUNNY.0, BUNNY.1)?, 1.7).with_albedo(Vec3::new(0.70, 0.60, 0.52));
    let turn = Quat::from_rotation_z(18.0_f32.to_radians()) * Quat::from_rotation_y(75.0_f32.to_radians());
    let object = bunny.transformed(Mat4::from_rotation_translation(turn, Vec3::new(1.2, 1.7, 0.0)));
    let scene = Scene {
        name: "leap",
        title: "A leaping bunny",
        mesh: Mesh::default(),
        view: view(Vec3::new(-0.6, 1.6, 7.6), Vec3::new(-0.3, 2.1, 0.0), 33.0, 0.1, 30.0),
        light: beam(
            Vec3::new(1.1, 2.3, 0.0),
            direction_from_angles(104.0, 14.0),
            25.0,
            [1.08, 1.35],
            Vec3::new(55.0, 44.0, 28.6),
        ),
        light_texture: None,
        cascades: None,
        sky: Sky::new(
            Vec3::new(0.042, 0.07, 0.14),
            Vec3::new(0.084, 0.098, 0.126),
            Vec3::new(0.042, 0.042, 0.035),
        ),
        medium: Medium::new(0.06, Vec3::splat(0.96), 0.2, 40.0)?,
        exposure: 0.8,
    };
    Ok(Parts::new(scene, object, rest))
}

/// A bunny on a mound, the sun beside the picture.
pub fn hare() -> Result<Parts, SceneError> {
    let parameters = TerrainParameters { seed: 21, size: 26.0, resolution: 120, height: 0.8 };
    let rest = terrain(&parameters).with_albedo(Vec3::new(0.09, 0.10, 0.06));
    let ground = terrain_height(&parameters, 0.0, 0.0);
    let bunny = standing(mesh_from_bytes(BUNNY.0, BUNNY.1)?, 2.4).with_albedo(Vec3::new(0.62, 0.55, 0.48));
    let object = placed(bunny, Vec3::new(0.0, ground - 0.04, 0.0), 25.0);
    let scene = Scene {
        name: "hare",
        title: "A bunny against the light",
        mesh: Mesh::default(),
        view: view(Vec3::new(0.9, 1.0, 6.8), Vec3::new(0.6, 1.55, 0.0), 40.0, 0.1, 30.0),
        light: beam(
            Vec3::new(0.0, 1.3, 0.0),
            direction_from_angles(245.0, 36.0),
            14.0,
            [1.95, 2.6],
            Vec3::new(24.0, 18.24, 10.8),
        ),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.03, 0.05, 0.1), Vec3::new(0.07, 0.07, 0.08), Vec3::new(0.03, 0.03, 0.025)),
        medium: Medium::new(0.06, Vec3::splat(0.96), 0.35, 40.0)?,
        exposure: 0.8,
    };
    Ok(Parts::new(scene, object, rest))
}

/// A turtle in green water, its shadow below it.
pub fn turtle() -> Result<Parts, SceneError> {
    let parameters = TerrainParameters { seed: 3, size: 24.0, resolution: 120, height: 0.7 };
    let rest = terrain(&parameters)
        .with_albedo(Vec3::new(0.42, 0.40, 0.30))
        .transformed(Mat4::from_translation(Vec3::new(0.0, -3.2, 0.0)));
    let object = turtle_mesh().transformed(Mat4::from_rotation_translation(
        Quat::from_rotation_y(-25.0_f32.to_radians())
            * Quat::from_rotation_x(-18.0_f32.to_radians())
            * Quat::from_rotation_z(8.0_f32.to_radians()),
        Vec3::new(0.0, 0.3, 0.0),
    ));
    let scene = Scene {
        name: "turtle",
        title: "A turtle",
        mesh: Mesh::default(),
        view: view(Vec3::new(0.6, -1.3, 4.8), Vec3::new(-0.05, 0.08, 0.0), 43.0, 0.1, 26.0),
        light: beam(
            Vec3::new(0.0, 0.0, 0.0),
            direction_from_angles(-28.0, 45.0),
            12.0,
            [2.25, 3.0],
            Vec3::new(19.84, 32.0, 28.16),
        ),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.06, 0.16, 0.19), Vec3::new(0.03, 0.09, 0.12), Vec3::new(0.02, 0.05, 0.06)),
        medium: Medium::new(0.17, Vec3::new(0.62, 0.93, 0.95), 0.15, 26.0)?,
        exposure: 1.1,
    };
    Ok(Parts::new(scene, object, rest))
}

/// A turtle of ellipsoids around the origin, its head towards +z, 3 m long.
fn turtle_mesh() -> Mesh {
    let shell = Vec3::new(0.20, 0.15, 0.07);
    let skin = Vec3::new(0.30, 0.36, 0.16);
    let pale = Vec3::new(0.62, 0.58, 0.38);
    let mut mesh = Mesh::default();
    let mut part = |half: Vec3, at: Vec3, turn: Quat, albedo: Vec3| {
        let ball = sphere(1.0, 64, 40).with_albedo(albedo);
        mesh.append(&ball.transformed(Mat4::from_scale_rotation_translation(half, turn, at)));
    };
    let level = Quat::IDENTITY;
    part(Vec3::new(0.92, 0.42, 1.12), Vec3::new(0.0, 0.06, 0.0), level, shell);
    part(Vec3::new(0.98, 0.16, 1.18), Vec3::new(0.0, -0.02, 0.0), level, skin);
    part(Vec3::new(0.80, 0.24, 0.98), Vec3::new(0.0, -0.10, 0.0), level, pale);
    part(Vec3::new(0.20, 0.18, 0.45), Vec3::new(0.0, 0.02, 1.25), level, pale);
    part(Vec3::new(0.27, 0.24, 0.36), Vec3::new(0.0, 0.12, 1.66), Quat::from_rotation_x(0.15), skin);
    part(Vec3::new(0.07, 0.05, 0.22), Vec3::new(0.0, -0.05, -1.25), level, skin);
    for side in [-1.0, 1.0] {
        let eye = Vec3::new(0.215 * side, 0.18, 1.76);
        part(Vec3::splat(0.05), eye, level, Vec3::splat(0.02));
        // Front flippers sweep outwards and back, hind ones are paddles.
        let sweep = Quat::from_rotation_y(0.75 * side) * Quat::from_rotation_z(-0.28 * side);
        let reach = sweep * Vec3::new(side, 0.0, 0.0);
        part(Vec3::new(0.95, 0.055, 0.27), Vec3::new(0.62 * side, -0.03, 0.72) + 0.78 * reach, sweep, skin);
        let paddle = Quat::from_rotation_y(0.95 * side) * Quat::from_rotation_z(-0.12 * side);
        let reach = paddle * Vec3::new(side, 0.0, 0.0);
        part(Vec3::new(0.48, 0.05, 0.22), Vec3::new(0.52 * side, -0.06, -0.78) + 0.36 * reach, paddle, skin);
    }
    mesh
}
