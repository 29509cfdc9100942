// SPDX-License-Identifier: MIT OR Apache-2.0
//! Views of a volume whose rays go from slice to slice.

use super::InverseError;
use crate::core::Camera;
use crate::out_of_range::in_range;
use encase::ShaderType;
use glam::{DVec2, DVec3, DVec4, Mat4, UVec3, Vec3, Vec4};

/// Most slices.
const MOST_SLICES: u32 = 4096;
/// Most steps of a bent ray.
const MOST_STEPS: f64 = 65536.0;

/// The uniform `SliceView` of `inverse/slice_steps`. Positions are in unit space: the box 0..1 of the volume.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SliceView {
    /// Where the ray through the corner of the picture begins.
    pub origin: Vec3,
    /// How many slices.
    pub slices: u32,
    /// Direction of that ray, of any length.
    pub direction: Vec3,
    /// Padding.
    pub reserved_a: u32,
    /// What a pixel to the right adds to the origin.
    pub origin_right: Vec3,
    /// Of the picture, pixels.
    pub width: u32,
    /// What a pixel to the right adds to the direction.
    pub direction_right: Vec3,
    /// Of the picture, pixels.
    pub height: u32,
    /// What a pixel down adds to the origin.
    pub origin_down: Vec3,
    /// Padding.
    pub reserved_b: u32,
    /// What a pixel down adds to the direction.
    pub direction_down: Vec3,
    /// Padding.
    pub reserved_c: u32,
    /// Unit vector across slices: an axis of the box.
    pub axis: Vec3,
    /// How far from faces across the slices samples may lie of rays that do not cross their slice whole, of the box: anywhere from 1 on.
    pub margin: f32,
    /// Homogeneous column of a pixel of a point (x, y, z, 1).
    pub column_of: Vec4,
    /// Homogeneous row.
    pub row_of: Vec4,
    /// What both are divided by.
    pub divisor_of: Vec4,
    /// Edge of the box along x, in the world, metres.
    pub edge_x: Vec3,
    /// Padding.
    pub reserved_e: u32,
    /// Edge along y.
    pub edge_y: Vec3,
    /// Padding.
    pub reserved_f: u32,
    /// Edge along z.
    pub edge_z: Vec3,
    /// Padding.
    pub reserved_g: u32,
}

/// The uniform `PictureRows` of `inverse/slice_steps`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct PictureRows {
    /// From 0 at the top.
    pub first: u32,
    /// How many.
    pub count: u32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
}

/// The uniform `RaySteps` of `inverse/slice_steps`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct RaySteps {
    /// Length of a step of a bent ray, metres.
    pub metres: f32,
    /// Most steps of a bent ray.
    pub most: u32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
}

impl RaySteps {
    /// Of rays of a view, bent ones in steps of so many metres. A bent ray goes four times as far as from corner to corner at most: one
    /// that has not left the box by then goes round in it. And metres that no ray's way in the box is longer than.
    pub(super) fn of_view(view: &SliceView, refraction: Option<f32>) -> Result<(Self, f32), InverseError> {
        let edges = [view.edge_x, view.edge_y, view.edge_z].map(Vec3::as_dvec3);
        let Some(metres) = refraction else {
            // Not less than any of the diagonals.
            let longest = edges.iter().map(|edge| edge.length()).sum::<f64>() as f32;
            return Ok((Self { metres: f32::MAX, most: 0, reserved_a: 0, reserved_b: 0 }, longest));
        };
        let most = (4.0 * edges.iter().sum::<DVec3>().length() / f64::from(metres)).ceil();
        let range = "at most 65536, so give longer steps";
        in_range("number of steps of bent rays", most as f32, 0.0..=MOST_STEPS as f32, range)?;
        let longest = (most * f64::from(metres)) as f32;
        Ok((Self { metres, most: most as u32, reserved_a: 0, reserved_b: 0 }, longest))
    }
}

/// The uniform `VoxelGrid` of `inverse/slice_steps`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct VoxelGrid {
    /// Voxels along x, y and z.
    pub size: UVec3,
    /// Padding.
    pub reserved_a: u32,
}

impl SliceView {
    /// A camera's view of a volume with `voxels` along its axes, in `slices` across the axis along which the ray through the middle
    /// of the picture meets most of them.
    ///
    /// # Errors
    /// [`InverseError::Setting`] for a number of slices that is impossible; [`InverseError::Camera`] for matrices without an inverse.
    pub fn new(
        camera: &Camera,
        world_from_unit: Mat4,
        voxels: [u32; 3],
        slices: u32,
    ) -> Result<Self, InverseError> {
        in_range("number of slices", slices as f32, 1.0..=MOST_SLICES as f32, "from 1 to 4096")?;
        let placed = world_from_unit.as_dmat4();
        let unit_from_world = placed.inverse();
        // Not the camera's own inverse, which 32 bits have rounded: rays and projection have to agree.
        let unit_from_clip = unit_from_world * camera.clip_from_world.as_dmat4().inverse();
        let size = camera.viewport.as_dvec2();
        // Normalised device coordinates of the picture's corner, and what a pixel to the right and one down add.
        let corner = DVec4::new(-1.0, 1.0, 0.0, 1.0);
        let [right, down] =
            [DVec4::new(2.0 / size.x, 0.0, 0.0, 0.0), DVec4::new(0.0, -2.0 / size.y, 0.0, 0.0)];
        let at = |depth: f32| {
            let depth = DVec4::new(0.0, 0.0, f64::from(depth), 0.0);
            [unit_from_clip * (corner + depth), unit_from_clip * right, unit_from_clip * down]
        };
        let far = at(camera.far_depth);
        let (origins, directions) = if camera.projection == 1 {
            // Of parallel rays all w are 1.
            let near = at(camera.near_depth);
            let from = near.map(DVec4::truncate);
            (from, [0, 1, 2].map(|i| far[i].truncate() - from[i]))
        } else {
            let eye = unit_from_world.transform_point3(camera.eye.as_dvec3());
            // far / w - eye, times w: linear in the pixel, and right where the far plane is at infinity and w is 0.
            ([eye, DVec3::ZERO, DVec3::ZERO], far.map(|point| point.truncate() - eye * point.w))
        };
        let middle = directions[0] + directions[1] * (0.5 * size.x) + directions[2] * (0.5 * size.y);
        // About metres, so that 32 bits hold them.
        let scale = placed.transform_vector3(middle).length().recip();
        let [direction, direction_right, direction_down] = directions.map(|way| way * scale);
        let crossed = middle.abs() * UVec3::from(voxels).as_dvec3();
        let axis = [DVec3::X, DVec3::Y, DVec3::Z]
            .into_iter()
            .reduce(|best, axis| if crossed.dot(axis) > crossed.dot(best) { axis } else { best })
            .unwrap_or(DVec3::Z);
        let clip_from_unit = camera.clip_from_world.as_dmat4() * placed;
        let row = |row: usize| clip_from_unit.row(row);
        let edge = |axis: DVec3| placed.transform_vector3(axis).as_vec3();
        let view = Self {
            origin: origins[0].as_vec3(),
            slices,
            direction: direction.as_vec3(),
            reserved_a: 0,
            origin_right: origins[1].as_vec3(),
            width: size.x as u32,
            direction_right: direction_right.as_vec3(),
            height: size.y as u32,
            origin_down: origins[2].as_vec3(),
            reserved_b: 0,
            direction_down: direction_down.as_vec3(),
            reserved_c: 0,
            axis: axis.as_vec3(),
            margin: margin(origins, directions, axis, size, slices),
            column_of: ((row(0) + row(3)) * (0.5 * size.x)).as_vec4(),
            row_of: ((row(3) - row(1)) * (0.5 * size.y)).as_vec4(),
            divisor_of: row(3).as_vec4(),
            edge_x: edge(DVec3::X),
            reserved_e: 0,
            edge_y: edge(DVec3::Y),
            reserved_f: 0,
            edge_z: edge(DVec3::Z),
            reserved_g: 0,
        };
        let sound = view.direction.is_finite() && view.origin.is_finite() && clip_from_unit.is_finite();
        if sound { Ok(view) } else { Err(InverseError::Camera) }
    }
}

/// [`SliceView::margin`] of rays whose origins and directions are affine in the pixel, without surfaces. A ray that enters the box by a face
/// across the slices has less than a slice of its first one: its sample is beside the middle of that, half of what the ray strays within a
/// slice from the face at most.
fn margin(origins: [DVec3; 3], directions: [DVec3; 3], axis: DVec3, size: DVec2, slices: u32) -> f32 {
    const ANYWHERE: f32 = 2.0;
    let corners = [DVec2::ZERO, DVec2::new(size.x, 0.0), DVec2::new(0.0, size.y), size];
    let at = |[corner, right, down]: [DVec3; 3], pixel: DVec2| corner + right * pixel.x + down * pixel.y;
    let middle = at(directions, 0.5 * size).dot(axis);
    let mut farthest = 0.0_f64;
    for pixel in corners {
        let (origin, direction) = (at(origins, pixel), at(directions, pixel));
        let along = direction.dot(axis);
        // Rays that run along slices, to both sides, or from within them, where the eye is.
        let begins = origin.dot(axis);
        let before = if along > 0.0 { begins <= 0.0 } else { begins >= 1.0 };
        if along * middle <= 0.0 || !before {
            return ANYWHERE;
        }
        let strays = direction - axis * along;
        farthest = farthest.max(strays.abs().max_element() / (along.abs() * f64::from(slices)));
    }
    // Slopes are ratios of functions that are affine in the pixel: greatest in a corner. A little more, for rounding.
    (0.51 * farthest + 1e-5) as f32
}
