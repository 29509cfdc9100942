// SPDX-License-Identifier: MIT OR Apache-2.0
//! Smoke in a room with light from behind (paper Fig. 12), and through a slide.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{Still, normalised};
use crate::Lighting;
use crate::command::CommandError;
use crate::data::{LightImage, Mesh, cuboid, desk, smoke as smoke_volume};
use crate::splatting::{LightTransport, Shading, SheetLighting};
use glam::{Mat4, Quat, Vec2, Vec3};

/// A slab between two corners.
fn slab(min: Vec3, max: Vec3, albedo: Vec3) -> Mesh {
    let placed = Mat4::from_translation(0.5 * (min + max));
    cuboid(max - min).transformed(placed).with_albedo(albedo)
}

/// A room of 4 x 3 x 4 m without its front, a window in the wall behind.
fn room() -> Vec<Mesh> {
    let (plaster, boards) = (Vec3::new(0.55, 0.5, 0.44), Vec3::new(0.34, 0.22, 0.14));
    let wall =
        |x: [f32; 2], y: [f32; 2]| slab(Vec3::new(x[0], y[0], -2.1), Vec3::new(x[1], y[1], -2.0), plaster);
    vec![
        slab(Vec3::new(-2.4, -0.1, -2.1), Vec3::new(2.4, 0.0, 6.5), boards),
        slab(Vec3::new(-2.4, 3.0, -2.1), Vec3::new(2.4, 3.1, 6.5), plaster),
        slab(Vec3::new(-2.5, -0.1, -2.1), Vec3::new(-2.4, 3.1, 6.5), plaster),
        slab(Vec3::new(2.4, -0.1, -2.1), Vec3::new(2.5, 3.1, 6.5), plaster),
        wall([-2.4, 0.2], [0.0, 3.0]),
        wall([1.5, 2.4], [0.0, 3.0]),
        wall([0.2, 1.5], [0.0, 0.9]),
        wall([0.2, 1.5], [2.4, 3.0]),
        wall([0.82, 0.88], [0.9, 2.4]),
        wall([0.2, 1.5], [1.62, 1.68]),
    ]
}

/// A desk in a smoky room, lit through the window behind it.
pub fn smoke(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let (volume, greatest) = normalised(smoke_volume([80, 60, 80], 3));
    let mut meshes = room();
    meshes.push(desk().transformed(Mat4::from_rotation_translation(
        Quat::from_rotation_y(0.35),
        Vec3::new(-0.35, 0.0, -0.3),
    )));
    let still = Still {
        volumes: vec![volume],
        threshold: 0.002,
        transfer: "smoke",
        meshes,
        light: Lighting::directional(Vec3::new(0.5, 0.62, -1.0), Vec3::new(46.0, 38.0, 27.0)),
        slide: None,
        lighting: SheetLighting {
            ambient: Vec3::new(0.03, 0.035, 0.045),
            g: 0.45,
            ..SheetLighting::new(0.35 * greatest)
        },
        shading: Shading::Scattering,
        sheets: 128,
        light_size: 1280,
        view: (Vec3::new(-1.2, 1.5, 4.6), Vec3::new(0.0, 1.3, -0.8), 38.0),
        background: Some(Vec3::new(0.8, 1.0, 1.25)),
        exposure: 1.0,
    };
    let about = "Light comes through a window towards the eye, so that sheets are put together from back to front. Desk, chair and bars cast shadows through the smoke.";
    let mut album = Album::new(&studio.out, folder, "A smoky room".to_owned(), about.to_owned())?;
    still.hang(studio, &mut album, ["smoke.png", "Light from behind"], LightTransport::Direct)?;
    Ok(album.finish())
}

/// A slide of coloured rings and rays.
fn rose() -> LightImage {
    let colors = [
        Vec3::new(0.95, 0.16, 0.1),
        Vec3::new(0.1, 0.3, 0.95),
        Vec3::new(0.98, 0.72, 0.12),
        Vec3::new(0.1, 0.7, 0.35),
    ];
    LightImage::from_function([256; 2], |at| {
        let place = 2.0 * at - Vec2::ONE;
        let (radius, turn) = (place.length(), place.y.atan2(place.x) / std::f32::consts::TAU + 0.5);
        let (ring, petal) = ((radius * 4.2).floor(), (turn * 12.0).floor());
        let lead = (radius * 4.2).fract().min(1.0 - (radius * 4.2).fract()) < 0.09
            || radius > 0.25 && (turn * 12.0).fract() < 0.08;
        let color = colors[((ring + petal * (ring.min(1.0))) as usize) % 4];
        if lead || radius > 0.94 { Vec3::splat(0.0) } else { color }
    })
}

/// A projector's slide in smoke, on a wall.
pub fn slide(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let (volume, greatest) = normalised(smoke_volume([80, 60, 80], 8));
    let white = Vec3::splat(0.7);
    let still = Still {
        volumes: vec![volume],
        threshold: 0.002,
        transfer: "cloud",
        meshes: vec![
            slab(Vec3::new(-2.6, -0.1, -2.1), Vec3::new(2.6, 0.0, 2.2), Vec3::splat(0.3)),
            slab(Vec3::new(-2.6, 0.0, -2.2), Vec3::new(2.6, 3.2, -2.0), white),
        ],
        light: Lighting::Spot {
            position: Vec3::new(2.6, 2.5, 4.6),
            target: Vec3::new(-0.5, 1.35, -2.0),
            outer_degrees: 14.0,
            inner_degrees: 13.0,
            intensity: Vec3::splat(900.0),
            radius: 0.05,
        },
        slide: Some(rose()),
        lighting: SheetLighting {
            ambient: Vec3::new(0.012, 0.014, 0.02),
            g: 0.2,
            specular: 0.0,
            ..SheetLighting::new(0.3 * greatest)
        },
        shading: Shading::Scattering,
        sheets: 128,
        light_size: 512,
        view: (Vec3::new(-2.2, 1.7, 5.6), Vec3::new(0.1, 1.3, -1.0), 38.0),
        background: Some(Vec3::splat(0.004)),
        exposure: 1.0,
    };
    let about = "A projective light texture: the beam is coloured in the smoke as on the wall, and the smoke dims it on the way.";
    let mut album = Album::new(&studio.out, folder, "A slide in smoke".to_owned(), about.to_owned())?;
    still.hang(studio, &mut album, ["slide.png", "A spot through a slide"], LightTransport::Direct)?;
    Ok(album.finish())
}
