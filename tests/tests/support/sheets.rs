// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of volumes by sheets of splats.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{gpu, shaders};
use airlight::core::{Camera, DepthRange, OrthographicView, Transfer, TransferPoint};
use airlight::data::Volume;

use airlight::splatting::{SheetFrame, SheetInputs, SheetPicture, SheetSettings, Splats};
use glam::{Mat4, Vec3};

/// Opacity is the value; the colour goes straight from that of value 0 to that of value 1.
pub fn colored([none, full]: [Vec3; 2]) -> Transfer {
    let point = |value, color| TransferPoint { value, color, opacity: value };
    Transfer::of_points(gpu(), &[point(0.0, none), point(1.0, full)], 1024).unwrap()
}

/// A volume of voxels of a metre, its middle in the origin.
pub fn metres(size: [u32; 3], value: impl Fn(Vec3) -> f32) -> Volume {
    let sides = Vec3::from(size.map(|side| side as f32));
    let space = Mat4::from_translation(-0.5 * sides) * Mat4::from_scale(sides);
    let mut values = Vec::new();
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                values.push(value(Vec3::new(x as f32, y as f32, z as f32) + 0.5 - 0.5 * sides));
            }
        }
    }
    Volume::new(size, values, space).unwrap()
}

/// All splats of a volume, in one batch.
pub fn splats(volume: &Volume) -> Splats {
    Splats::new(gpu(), shaders(), volume, 0.0, None).unwrap()
}

/// What was drawn: four numbers a pixel, row after row.
#[derive(PartialEq)]
pub struct Shot {
    /// Radiance and transmittance.
    pub picture: Vec<f32>,
    /// What is left of the light.
    pub shadow: Vec<f32>,
}

impl Shot {
    /// The same bits.
    pub fn same(&self, other: &Self) -> bool {
        let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        bits(&self.picture) == bits(&other.picture) && bits(&self.shadow) == bits(&other.shadow)
    }

    /// Whether nothing is NaN, infinite or negative, nor the greatest number, which the last pass makes of a NaN.
    pub fn is_sound(&self) -> bool {
        self.picture.iter().chain(&self.shadow).all(|value| (0.0..65504.0).contains(value))
    }
}

/// A picture of the camera's size.
pub fn shoot(splats: &Splats, transfer: &Transfer, settings: SheetSettings, frame: &SheetFrame) -> Shot {
    shoot_all(SheetInputs::new(std::slice::from_ref(splats), transfer), settings, frame)
}

/// The same of several volumes, surfaces, through a light texture.
pub fn shoot_all(inputs: SheetInputs<'_, '_>, settings: SheetSettings, frame: &SheetFrame) -> Shot {
    let size = [frame.camera.viewport.x as u32, frame.camera.viewport.y as u32];
    let picture = SheetPicture::new(gpu(), shaders(), inputs, settings, size).unwrap();
    picture.set(gpu(), frame).unwrap();
    let mut encoder = gpu().encoder();
    picture.record(gpu(), &mut encoder).unwrap();
    gpu().submit(encoder).unwrap();
    Shot { picture: picture.picture.read(gpu()).unwrap(), shadow: picture.shadow().read(gpu()).unwrap() }
}

/// A camera with parallel rays along `direction`, through the origin; `height` metres high.
pub fn parallel(direction: Vec3, height: f32, side: u32) -> Camera {
    let view = OrthographicView {
        eye: -60.0 * direction,
        target: Vec3::ZERO,
        height,
        near: 0.0,
        far: 120.0,
        depth: DepthRange::Forward,
    };
    Camera::orthographic(&view, [side; 2]).unwrap()
}
