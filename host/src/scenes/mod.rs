// SPDX-License-Identifier: MIT OR Apache-2.0
//! The scenes of the gallery and the benchmarks: real meshes among generated trees and terrain.

mod ambient;
mod lights;
mod parts;
mod stylized;
mod windows;

pub use ambient::{AmbientScene, ambient_scenes};

use crate::core::{Cascades, DepthRange, PerspectiveView, Sky, View, direction_from_angles};
use crate::data::{
    Bounds, LightImage, Mesh, MeshError, TerrainParameters, TreeParameters, mesh_from_bytes, plane, terrain,
    terrain_height, torus, tree,
};
use crate::scattering::{Medium, SettingsError};
use crate::stage::{Lighting, Setting};
use glam::{Mat4, Quat, Vec2, Vec3};

/// Meshes that are part of the program, from `host/assets`.
pub const BUNNY: (&str, &[u8]) = ("bunny.obj", include_bytes!("../../assets/bunny.obj"));
/// See [`BUNNY`].
pub const SUZANNE: (&str, &[u8]) = ("suzanne.obj", include_bytes!("../../assets/suzanne.obj"));

/// All that a picture needs.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name, as in `--only scattering/NAME`.
    pub name: &'static str,
    /// One line about it.
    pub title: &'static str,
    /// What is drawn.
    pub mesh: Mesh,
    /// The camera.
    pub view: View,
    /// The light.
    pub light: Lighting,
    /// What colours the light.
    pub light_texture: Option<LightImage>,
    /// Shadow maps fitted to parts of the view.
    pub cascades: Option<Cascades>,
    /// Radiance of the sky and the ground.
    pub sky: Sky,
    /// Air.
    pub medium: Medium,
    /// Factor on the radiance before the tone curve.
    pub exposure: f32,
}

impl Scene {
    /// The scene as [`crate::Stage::new`] takes it.
    pub fn setting(&self) -> Setting<'_> {
        Setting {
            mesh: &self.mesh,
            view: self.view,
            light: self.light,
            light_texture: self.light_texture.as_ref(),
            cascades: self.cascades,
            sky: self.sky,
            medium: self.medium,
            samples: 1,
        }
    }
}

/// A scene, and an object in it by itself.
#[derive(Clone, Debug)]
pub struct Parts {
    /// The whole.
    pub scene: Scene,
    /// The object: holes are made in its shadow alone.
    pub object: Mesh,
    /// Everything else.
    pub rest: Mesh,
}

impl Parts {
    /// `scene` with both meshes in the place of its own.
    fn new(scene: Scene, object: Mesh, rest: Mesh) -> Self {
        let mut mesh = rest.clone();
        mesh.append(&object);
        Self { scene: Scene { mesh, ..scene }, object, rest }
    }
}

/// Why a scene could not be built.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The medium.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

/// The names that [`scene`] knows.
pub const SCENES: [&str; 17] = [
    "foliage",
    "terrain",
    "torus",
    "plane",
    "sun",
    "spot",
    "slide",
    "lamp",
    "glass",
    "orthographic",
    "cascades",
    "canopy",
    "ring",
    "halo",
    "leap",
    "hare",
    "turtle",
];

/// A scene by name; none if there is no such scene.
///
/// # Errors
/// [`SceneError`].
pub fn scene(name: &str) -> Result<Option<Scene>, SceneError> {
    Ok(Some(match name {
        "terrain" => suzanne_on_terrain()?,
        "torus" => torus_scene()?,
        "plane" => plane_scene()?,
        "sun" => sun()?,
        "spot" => windows::spot()?,
        "slide" => windows::slide()?,
        "glass" => windows::glass()?,
        "orthographic" => lights::orthographic()?,
        "cascades" => lights::cascades()?,
        _ => return Ok(parts(name)?.map(|parts| parts.scene)),
    }))
}

/// A scene by name whose object is known apart from the rest; none if there is no such scene.
///
/// # Errors
/// [`SceneError`].
pub fn parts(name: &str) -> Result<Option<Parts>, SceneError> {
    Ok(Some(match name {
        "foliage" => foliage()?,
        "lamp" => lights::lamp()?,
        "canopy" => stylized::canopy()?,
        "ring" => stylized::ring()?,
        "halo" => stylized::halo()?,
        "leap" => stylized::leap()?,
        "hare" => stylized::hare()?,
        "turtle" => stylized::turtle()?,
        _ => return Ok(None),
    }))
}

fn view(eye: Vec3, target: Vec3, field_of_view: f32, near: f32, far: f32) -> View {
    perspective(eye, target, field_of_view, near, far).into()
}

fn perspective(eye: Vec3, target: Vec3, field_of_view: f32, near: f32, far: f32) -> PerspectiveView {
    PerspectiveView { eye, target, field_of_view, near, far, depth: DepthRange::Forward }
}

/// `mesh` scaled to `height` with its lowest point at the origin.
fn standing(mesh: Mesh, height: f32) -> Mesh {
    let bounds = mesh.bounds().unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ONE });
    let foot = Vec3::new(bounds.center().x, bounds.min.y, bounds.center().z);
    let scale = height / bounds.size().y.max(1e-6);
    mesh.transformed(Mat4::from_scale(Vec3::splat(scale)) * Mat4::from_translation(-foot))
}

fn placed(mesh: Mesh, at: Vec3, turn: f32) -> Mesh {
    mesh.transformed(Mat4::from_rotation_translation(Quat::from_rotation_y(turn.to_radians()), at))
}

/// A bunny under a leafy tree, late light through the crown.
fn foliage() -> Result<Parts, SceneError> {
    let parameters = TerrainParameters { seed: 11, size: 44.0, resolution: 160, height: 0.6 };
    let mut mesh = terrain(&parameters).with_albedo(Vec3::new(0.11, 0.13, 0.05));
    let ground = |x, z| terrain_height(&parameters, x, z);
    let crown = tree(&TreeParameters { seed: 4, leaves: 14000, clumps: 30, ..TreeParameters::default() });
    let object = placed(crown, Vec3::new(0.4, ground(0.4, -0.6) - 0.05, -0.6), 20.0);
    let bunny = standing(mesh_from_bytes(BUNNY.0, BUNNY.1)?, 0.9).with_albedo(Vec3::new(0.72, 0.66, 0.60));
    mesh.append(&placed(bunny, Vec3::new(-1.35, ground(-1.35, 1.9) - 0.02, 1.9), 25.0));
    let scene = Scene {
        name: "foliage",
        title: "Bunny under a tree",
        mesh: Mesh::default(),
        view: view(Vec3::new(-2.3, 1.0, 8.6), Vec3::new(-0.35, 2.85, 0.0), 40.0, 0.1, 30.0),
        light: Lighting::directional(direction_from_angles(184.0, 39.0), Vec3::new(8.4, 6.0, 3.5)),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.05, 0.10, 0.20), Vec3::new(0.17, 0.19, 0.22), Vec3::new(0.03, 0.03, 0.025)),
        medium: Medium::new(0.034, Vec3::splat(0.96), 0.6, 40.0)?,
        exposure: 0.62,
    };
    Ok(Parts::new(scene, object, mesh))
}

/// The same from below the crown, with the sun behind it.
fn sun() -> Result<Scene, SceneError> {
    Ok(Scene {
        name: "sun",
        title: "The sun behind a tree",
        view: view(Vec3::new(0.9, 0.8, 6.6), Vec3::new(0.0, 2.75, -0.6), 50.0, 0.1, 30.0),
        light: Lighting::directional(direction_from_angles(184.0, 25.0), Vec3::new(8.4, 6.0, 3.5)),
        medium: Medium::new(0.02, Vec3::splat(0.96), 0.75, 40.0)?,
        exposure: 0.3,
        ..foliage()?.scene
    })
}

/// Suzanne on a ridge, low sun.
fn suzanne_on_terrain() -> Result<Scene, SceneError> {
    let parameters = TerrainParameters::default();
    let mut mesh = terrain(&parameters);
    let at = Vec2::new(-2.0, 3.0);
    let ground = terrain_height(&parameters, at.x, at.y);
    let head = standing(mesh_from_bytes(SUZANNE.0, SUZANNE.1)?, 3.6).with_albedo(Vec3::new(0.62, 0.33, 0.18));
    mesh.append(&placed(head, Vec3::new(at.x, ground - 0.3, at.y), 30.0));
    Ok(Scene {
        name: "terrain",
        title: "Suzanne on a terrain",
        mesh,
        view: view(
            Vec3::new(at.x + 5.2, ground + 2.4, at.y + 8.5),
            Vec3::new(at.x + 0.6, ground + 2.0, at.y),
            46.0,
            0.2,
            60.0,
        ),
        light: Lighting::directional(direction_from_angles(258.0, 20.0), Vec3::new(9.0, 5.4, 2.7)),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.04, 0.07, 0.15), Vec3::new(0.22, 0.16, 0.13), Vec3::new(0.03, 0.03, 0.03)),
        medium: Medium::new(0.016, Vec3::splat(0.95), 0.4, 80.0)?,
        exposure: 0.9,
    })
}

/// A torus against the light: its shadow, and the beam through its hole, hang in the mist.
fn torus_scene() -> Result<Scene, SceneError> {
    let mut mesh = plane(Vec2::splat(60.0), 8).with_albedo(Vec3::new(0.13, 0.13, 0.14));
    let light = direction_from_angles(160.0, 34.0);
    let ring = torus(1.7, 0.75, 160, 64).with_albedo(Vec3::new(0.66, 0.17, 0.09));
    // Its axis points to the light, all but ten degrees.
    let stand = Quat::from_rotation_arc(Vec3::Y, (light + Vec3::new(0.15, 0.05, 0.0)).normalize());
    mesh.append(&ring.transformed(Mat4::from_rotation_translation(stand, Vec3::new(0.0, 2.75, 0.0))));
    Ok(Scene {
        name: "torus",
        title: "A torus",
        mesh,
        view: view(Vec3::new(-4.6, 1.3, 6.4), Vec3::new(-0.1, 2.15, 0.6), 46.0, 0.1, 24.0),
        light: Lighting::directional(light, Vec3::new(8.5, 7.0, 5.4)),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.02, 0.03, 0.06), Vec3::new(0.05, 0.06, 0.08), Vec3::new(0.03, 0.03, 0.03)),
        medium: Medium::new(0.045, Vec3::splat(0.95), 0.35, 30.0)?,
        exposure: 0.8,
    })
}

/// A level plate under an overhead light: one depth in every texel, the worst case for ringing.
fn plane_scene() -> Result<Scene, SceneError> {
    let mut mesh = plane(Vec2::splat(16.0), 4).with_albedo(Vec3::splat(0.4));
    let plate = plane(Vec2::splat(4.0), 1)
        .transformed(Mat4::from_translation(Vec3::new(0.0, 2.5, 0.0)))
        .with_albedo(Vec3::splat(0.6));
    mesh.append(&plate);
    Ok(Scene {
        name: "plane",
        title: "A plate under an overhead light",
        mesh,
        view: view(Vec3::new(0.0, 1.5, 7.0), Vec3::new(0.0, 1.6, 0.0), 50.0, 0.1, 20.0),
        light: Lighting::directional(Vec3::Y, Vec3::splat(12.0)),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::splat(0.05), Vec3::splat(0.1), Vec3::splat(0.03)),
        medium: Medium::new(0.08, Vec3::splat(0.95), 0.0, 20.0)?,
        exposure: 0.4,
    })
}

/// A view that frames a mesh, and the far plane that goes with it.
pub fn framing(bounds: &Bounds, field_of_view: f32) -> PerspectiveView {
    let radius = bounds.radius().max(1e-4);
    let distance = 1.25 * radius / (0.5 * field_of_view.to_radians()).sin();
    let eye = bounds.center() + Vec3::new(-0.45, 0.28, 1.0).normalize() * distance;
    perspective(
        eye,
        bounds.center(),
        field_of_view,
        (distance - radius).max(0.02 * radius) * 0.2,
        distance + 2.0 * radius,
    )
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::Camera;

    #[test]
    fn every_scene_can_be_drawn() {
        for name in SCENES {
            let scene = scene(name).unwrap().unwrap();
            assert_eq!(scene.name, name);
            assert_eq!(scene.mesh.validate(), Ok(()), "{name}");
            assert!(Camera::new(&scene.view, [160, 90]).is_ok(), "{name}");
            assert!(scene.light.fitted(&scene.mesh.bounds().unwrap()).is_ok(), "{name}");
        }
        assert!(scene("nope").unwrap().is_none());
    }
}
