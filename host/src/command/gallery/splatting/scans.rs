// SPDX-License-Identifier: MIT OR Apache-2.0
//! Meshes over and inside volumes of surfaces (paper Fig. 8, 9, 11, 16).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::Still;
use crate::Lighting;
use crate::command::CommandError;
use crate::command::scans;
use crate::data::{Volume, dart, mushrooms as mushroom_meshes, solid_plate, teapot as teapot_mesh};
use crate::splatting::{LightTransport, Shading, SheetLighting, SoftShadows};
use glam::{EulerRot, Mat4, Quat, Vec3};

/// The abdomen, upright, its longest side 4 m, values of its transfer function's range 0..32 as 0..1.
fn abdomen() -> Result<Volume, CommandError> {
    let mut volume = scans::stent()?;
    volume.values.iter_mut().for_each(|value| *value = (*value / 32.0).clamp(0.0, 1.0));
    let bounds = volume.bounds();
    let scale = 4.0 / bounds.size().max_element();
    let stand = Mat4::from_rotation_x(-std::f32::consts::FRAC_PI_2) * Mat4::from_scale(Vec3::splat(scale));
    volume.world_from_unit = stand * Mat4::from_translation(-bounds.center()) * volume.world_from_unit;
    Ok(volume)
}

/// A dart that has hit an aorta.
pub fn stent(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let turn = Quat::from_euler(EulerRot::YXZ, -2.3, 0.45, 0.0);
    let place = Mat4::from_scale_rotation_translation(Vec3::splat(1.6), turn, Vec3::new(0.75, 0.35, 0.75));
    let still = Still {
        volumes: vec![abdomen()?],
        threshold: 1.6 / 32.0,
        transfer: "vessels",
        meshes: vec![dart().transformed(place)],
        light: Lighting::directional(Vec3::new(0.55, 0.65, 0.75), Vec3::new(10.5, 9.8, 8.8)),
        slide: None,
        lighting: SheetLighting { ambient: Vec3::splat(0.28), specular: 0.35, ..SheetLighting::new(40.0) },
        shading: Shading::Phong,
        sheets: 160,
        light_size: 512,
        view: (Vec3::new(0.9, 0.6, 5.2), Vec3::new(0.1, 0.05, 0.0), 34.0),
        background: Some(Vec3::new(0.012, 0.014, 0.018)),
        exposure: 1.0,
    };
    let about = "Computed tomography in sheets with Phong's reflection. The mesh is in the same picture: it is behind, before and inside what is translucent, and casts shadows on it.";
    let mut album = Album::new(&studio.out, folder, "A dart in an abdomen".to_owned(), about.to_owned())?;
    still.hang(studio, &mut album, ["stent.png", "Vessels, stent, and a dart"], LightTransport::Direct)?;
    Ok(album.finish())
}

/// A teapot in a translucent block.
pub fn teapot(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let block = solid_plate(72, Vec3::new(2.2, 1.3, 1.6), Mat4::IDENTITY);
    let place = Mat4::from_scale_rotation_translation(
        Vec3::splat(1.5),
        Quat::from_rotation_y(-0.5),
        Vec3::new(0.0, -0.42, 0.0),
    );
    let still = Still {
        volumes: vec![block],
        threshold: 0.01,
        transfer: "cloud",
        meshes: vec![teapot_mesh().transformed(place).with_albedo(Vec3::new(0.75, 0.32, 0.16))],
        light: Lighting::directional(Vec3::new(-0.8, 0.75, 0.35), Vec3::new(15.0, 13.8, 12.0)),
        slide: None,
        lighting: SheetLighting {
            ambient: Vec3::new(0.05, 0.06, 0.075),
            specular: 0.5,
            shininess: 40.0,
            ..SheetLighting::new(0.55)
        },
        shading: Shading::Scattering,
        sheets: 128,
        light_size: 512,
        view: (Vec3::new(0.9, 1.4, 4.3), Vec3::new(0.0, -0.05, 0.0), 36.0),
        background: Some(Vec3::new(0.02, 0.024, 0.03)),
        exposure: 1.0,
    };
    let about =
        "Polygons inside a translucent medium: their shadows go through it, onto themselves, and out of it.";
    let mut album = Album::new(&studio.out, folder, "A teapot in a block".to_owned(), about.to_owned())?;
    still.hang(studio, &mut album, ["teapot.png", "Shadows through the medium"], LightTransport::Direct)?;
    Ok(album.finish())
}

/// Mushrooms, which are polygons, on a plate, which is a volume, in hard and in soft shadows.
pub fn mushrooms(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let plate =
        solid_plate(192, Vec3::new(4.2, 0.12, 4.0), Mat4::from_translation(Vec3::new(0.0, -0.06, 0.4)));
    let still = Still {
        volumes: vec![plate],
        threshold: 0.01,
        transfer: "cloud",
        meshes: vec![mushroom_meshes()],
        light: Lighting::directional(Vec3::new(-0.75, 0.95, 0.25), Vec3::new(9.0, 8.4, 7.4)),
        slide: None,
        lighting: SheetLighting {
            ambient: Vec3::new(0.22, 0.25, 0.3),
            specular: 0.15,
            ..SheetLighting::new(120.0)
        },
        shading: Shading::Phong,
        sheets: 128,
        light_size: 640,
        view: (Vec3::new(0.5, 1.7, 3.4), Vec3::new(0.05, 0.32, 0.0), 36.0),
        background: Some(Vec3::new(0.09, 0.1, 0.12)),
        exposure: 1.0,
    };
    let about = "The same light as a point in the sky and as a square of 12 degrees: penumbras widen with the distance from what casts them.";
    let mut album = Album::new(&studio.out, folder, "Mushrooms on a plate".to_owned(), about.to_owned())?;
    let soft = LightTransport::Soft(SoftShadows { filling: 0.2, ..SoftShadows::new(12.0) });
    still.hang(studio, &mut album, ["soft.png", "Soft shadows"], soft)?;
    still.hang(studio, &mut album, ["hard.png", "Hard shadows"], LightTransport::Direct)?;
    Ok(album.finish())
}
