// SPDX-License-Identifier: MIT OR Apache-2.0
//! Clouds (paper Fig. 1, 2 and 4), and an aeroplane above them (Fig. 13).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{Still, normalised};
use crate::Lighting;
use crate::command::CommandError;
use crate::data::{aeroplane as aeroplane_mesh, cloud, cloud_bank};
use crate::splatting::{LightTransport, ScatteringSettings, Shading, SheetLighting};
use glam::{EulerRot, Mat4, Quat, Vec3};

/// Light goes on within 80 degrees, and keeps its direction for 0.4 m.
fn scattering(back: bool) -> LightTransport {
    LightTransport::Scattering(ScatteringSettings { cone: 80.0, free_path: 0.4, back, sweeps: 2 })
}

/// One cloud whose light is only taken away, is scattered on, and back as well.
pub fn scattered(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let (volume, greatest) = normalised(cloud([120, 60, 100], 9));
    let still = Still {
        volumes: vec![volume],
        threshold: 0.002,
        transfer: "cloud",
        meshes: Vec::new(),
        light: Lighting::directional(Vec3::new(-0.55, 0.8, 0.1), Vec3::new(15.0, 13.6, 11.6)),
        slide: None,
        lighting: SheetLighting {
            ambient: Vec3::new(0.035, 0.06, 0.11),
            g: 0.1,
            ..SheetLighting::new(1.5 * greatest)
        },
        shading: Shading::Scattering,
        sheets: 128,
        light_size: 256,
        view: (Vec3::new(1.5, -1.0, 7.6), Vec3::new(0.0, 0.1, 0.0), 36.0),
        background: None,
        exposure: 1.0,
    };
    let about = "The same cloud, the same light. Forward scattering lets light get deep into it, back scattering brightens edges and depths.";
    let mut album =
        Album::new(&studio.out, folder, "Multiple scattering in a cloud".to_owned(), about.to_owned())?;
    still.hang(studio, &mut album, ["back.png", "Scattered on and back, two sweeps"], scattering(true))?;
    still.hang(studio, &mut album, ["forward.png", "Scattered on"], scattering(false))?;
    still.hang(studio, &mut album, ["none.png", "Only taken away"], LightTransport::Direct)?;
    Ok(album.finish())
}

/// An aeroplane above a bank of clouds, and its shadow on them.
pub fn aeroplane(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let (volume, greatest) = normalised(cloud_bank([192, 48, 192], 4));
    let turn = Quat::from_euler(EulerRot::YXZ, 0.9, -0.06, 0.22);
    let place = Mat4::from_scale_rotation_translation(Vec3::splat(0.42), turn, Vec3::new(-1.2, 3.6, 2.2));
    let still = Still {
        volumes: vec![volume],
        threshold: 0.002,
        transfer: "cloud",
        meshes: vec![aeroplane_mesh().transformed(place)],
        light: Lighting::directional(Vec3::new(0.5, 0.85, 0.25), Vec3::new(13.0, 11.6, 9.6)),
        slide: None,
        lighting: SheetLighting {
            ambient: Vec3::new(0.05, 0.085, 0.15),
            g: 0.1,
            specular: 0.15,
            ..SheetLighting::new(1.6 * greatest)
        },
        shading: Shading::Scattering,
        sheets: 128,
        light_size: 384,
        view: (Vec3::new(-2.2, 5.6, 8.8), Vec3::new(-0.7, 1.6, 0.0), 42.0),
        background: None,
        exposure: 1.0,
    };
    let about =
        "Clouds that scatter light on and back; a polygon model above them casts its shadow into them.";
    let mut album =
        Album::new(&studio.out, folder, "An aeroplane above clouds".to_owned(), about.to_owned())?;
    still.hang(studio, &mut album, ["aeroplane.png", "Light scattered on and back"], scattering(true))?;
    still.hang(studio, &mut album, ["none.png", "Light only taken away"], LightTransport::Direct)?;
    Ok(album.finish())
}
