// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is painted: a scan, how it lies before the camera, and its light.

use crate::command::{CommandError, scans};
use crate::data::Volume;
use glam::{Mat4, Vec3, Vec4};

/// A scan before a camera. Its box is scaled to a diagonal of 1 m about the origin, and then turned.
pub struct Motif {
    /// Its name in sentences.
    pub name: &'static str,
    /// Which of the transfer functions that come with Airlight.
    pub transfer: &'static str,
    read: fn() -> Result<Volume, CommandError>,
    /// Degrees about x, y and z; z comes first, y last.
    turned: [f32; 3],
    /// Planes that cut the scan before it is turned: normal and offset, metres.
    planes: &'static [[f32; 4]],
    /// Metres.
    pub eye: Vec3,
    /// Metres.
    pub target: Vec3,
    /// Linear RGB of the canvas.
    pub canvas: Vec3,
    /// Towards the light, of any length.
    pub towards_light: Vec3,
    /// Curvature at the ends of colour scales, 1/m.
    pub curvature: f32,
}

/// A brain from its left side.
pub const BRAIN: Motif = Motif {
    name: "A brain",
    transfer: "head",
    read: scans::head,
    turned: [0.0, -50.0, 0.0],
    planes: &[],
    eye: Vec3::new(-0.02, 0.10, 0.97),
    target: Vec3::new(-0.02, 0.0, 0.0),
    canvas: Vec3::new(0.40, 0.29, 0.17),
    towards_light: Vec3::new(-0.6, 0.62, 0.5),
    curvature: 120.0,
};

/// The same, cut across: what is within has a colour of its own, and a small gradient.
pub const CUT: Motif = Motif {
    name: "A brain, cut",
    turned: [0.0, -38.0, 0.0],
    planes: &[[0.0, 0.0, -1.0, 0.06]],
    eye: Vec3::new(0.03, 0.10, 0.96),
    target: Vec3::new(0.035, 0.0, 0.0),
    canvas: Vec3::new(0.14, 0.095, 0.06),
    ..BRAIN
};

/// An aorta with the wires of a stent, lying on its side; what is around it is cut away.
pub const STENT: Motif = Motif {
    name: "A stent in an aorta",
    transfer: "stent",
    read: scans::stent,
    turned: [20.0, 180.0, -165.0],
    planes: &[[0.0, 1.0, 0.0, 0.065], [0.0, -1.0, 0.0, 0.10], [0.0, 0.0, 1.0, 0.13], [0.0, 0.0, -1.0, 0.075]],
    eye: Vec3::new(0.03, 0.015, 0.64),
    target: Vec3::new(0.03, 0.01, 0.0),
    canvas: BRAIN.canvas,
    towards_light: Vec3::new(-0.5, 0.75, 0.5),
    curvature: 400.0,
};

impl Motif {
    /// The scan.
    pub fn volume(&self) -> Result<Volume, CommandError> {
        (self.read)()
    }

    fn turn(&self, degrees: f32) -> Mat4 {
        let [x, y, z] = self.turned.map(f32::to_radians);
        Mat4::from_rotation_y(y + degrees.to_radians()) * Mat4::from_rotation_x(x) * Mat4::from_rotation_z(z)
    }

    /// Where the box of the scan lies when it is turned about the vertical by some more degrees.
    pub fn world_from_unit(&self, volume: &Volume, degrees: f32) -> Mat4 {
        let bounds = volume.bounds();
        let diagonal = (bounds.max - bounds.min).length();
        self.turn(degrees)
            * Mat4::from_scale(Vec3::splat(1.0 / diagonal))
            * Mat4::from_translation(-bounds.center())
            * volume.world_from_unit
    }

    /// The planes in the world.
    pub fn clip_planes(&self, degrees: f32) -> Vec<Vec4> {
        let turn = self.turn(degrees);
        let plane =
            |[x, y, z, offset]: &[f32; 4]| turn.transform_vector3(Vec3::new(*x, *y, *z)).extend(*offset);
        self.planes.iter().map(plane).collect()
    }
}
