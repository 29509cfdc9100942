// SPDX-License-Identifier: MIT OR Apache-2.0
//! Visual hulls: the voxels of a volume that may be seen inside of all masks.

use super::InverseError;
use crate::core::Camera;
use glam::{DMat4, DVec4, Mat4, UVec3};

/// Where a view may see the medium.
#[derive(Clone, Copy)]
pub struct Silhouette<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Whether the medium may be seen in a pixel, row after row from the top.
    pub mask: &'a [bool],
}

/// Whether each voxel of a volume, x fastest, belongs to the hull: whether every view that sees all of its box has a pixel of its mask in
/// the rectangle about that box. Voxels that a view sees in part or not at all, or that reach behind its eye, are inside for it: it says
/// nothing of them. So the hull never loses a point, and reaches beyond by less than the rectangle about a voxel.
///
/// # Errors
/// [`InverseError::Count`] for a mask of another size than its camera's picture.
pub fn visual_hull(
    size: [u32; 3],
    world_from_unit: Mat4,
    silhouettes: &[Silhouette<'_>],
) -> Result<Vec<bool>, InverseError> {
    let voxels: usize = size.iter().map(|side| *side as usize).product();
    let mut inside = vec![true; voxels];
    for silhouette in silhouettes {
        let shadow = Shadow::new(silhouette)?;
        let voxel_scale = DMat4::from_scale(UVec3::from(size).as_dvec3().recip());
        let clip_from_voxel =
            silhouette.camera.clip_from_world.as_dmat4() * world_from_unit.as_dmat4() * voxel_scale;
        for (index, inside) in inside.iter_mut().enumerate().filter(|(_, inside)| **inside) {
            *inside = shadow.may_hold(clip_from_voxel, voxel(size, index));
        }
    }
    Ok(inside)
}

/// The least corner of a voxel, voxels.
fn voxel(size: [u32; 3], index: usize) -> [f64; 3] {
    let [width, height] = [size[0] as usize, size[1] as usize];
    [index % width, index / width % height, index / width / height].map(|at| at as f64)
}

/// A mask whose pixels in any rectangle are counted with four numbers.
struct Shadow {
    size: [usize; 2],
    /// Pixels of the mask above and left of each corner of pixels.
    counts: Vec<u64>,
}

impl Shadow {
    fn new(of: &Silhouette<'_>) -> Result<Self, InverseError> {
        let size = of.camera.viewport.to_array().map(|side| side as usize);
        let needed = size[0] * size[1];
        if of.mask.len() != needed {
            return Err(InverseError::Count { name: "pixels of a mask", needed, given: of.mask.len() });
        }
        let width = size[0] + 1;
        let mut counts = vec![0; width * (size[1] + 1)];
        for row in 0..size[1] {
            let mut sum = 0;
            for column in 0..size[0] {
                sum += u64::from(of.mask[row * size[0] + column]);
                counts[(row + 1) * width + column + 1] = counts[row * width + column + 1] + sum;
            }
        }
        Ok(Self { size, counts })
    }

    /// Whether the mask says nothing against the voxel whose least corner is given.
    fn may_hold(&self, clip_from_voxel: DMat4, least: [f64; 3]) -> bool {
        let [width, height] = self.size.map(|side| side as f64);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in 0..8_u8 {
            let at = [0, 1, 2].map(|axis| least[axis] + f64::from(corner >> axis & 1));
            let clip = clip_from_voxel * DVec4::new(at[0], at[1], at[2], 1.0);
            if clip.w <= 1e-12 {
                return true;
            }
            let pixel = [(0.5 + 0.5 * clip.x / clip.w) * width, (0.5 - 0.5 * clip.y / clip.w) * height];
            for axis in 0..2 {
                low[axis] = low[axis].min(pixel[axis]);
                high[axis] = high[axis].max(pixel[axis]);
            }
        }
        if low[0] < 0.0 || low[1] < 0.0 || high[0] > width || high[1] > height {
            return true;
        }
        let first = low.map(|at| at as usize);
        let past = [0, 1].map(|axis| (high[axis] as usize + 1).min(self.size[axis]));
        let count = |column: usize, row: usize| self.counts[row * (self.size[0] + 1) + column];
        count(past[0], past[1]) + count(first[0], first[1])
            > count(first[0], past[1]) + count(past[0], first[1])
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::{DepthRange, OrthographicView, PerspectiveView, View};
    use crate::data::Random;
    use glam::Vec3;

    const SIZE: [u32; 3] = [14, 11, 12];

    fn placed() -> Mat4 {
        Mat4::from_rotation_y(0.3)
            * Mat4::from_scale(Vec3::new(2.4, 2.2, 2.0))
            * Mat4::from_translation(Vec3::splat(-0.5))
    }

    fn cameras() -> Vec<Camera> {
        let depth = DepthRange::Forward;
        let perspective = |eye: Vec3| {
            View::from(PerspectiveView {
                eye,
                target: Vec3::ZERO,
                field_of_view: 40.0,
                near: 0.1,
                far: 20.0,
                depth,
            })
        };
        let parallel = OrthographicView {
            eye: Vec3::new(-1.0, 4.0, 0.5),
            target: Vec3::ZERO,
            height: 3.0,
            near: 0.0,
            far: 20.0,
            depth,
        };
        let views =
            [perspective(Vec3::new(0.4, 0.3, 5.0)), perspective(Vec3::new(5.0, 0.8, 1.0)), parallel.into()];
        views.iter().map(|view| Camera::new(view, [60, 48]).unwrap()).collect()
    }

    /// Masks of a ball, each pixel that a point of it falls into.
    fn masks(radius: f32, random: &mut Random) -> (Vec<Vec<bool>>, Vec<Vec3>) {
        let points: Vec<Vec3> = (0..60_000)
            .map(|i| random.direction() * radius * if i % 2 == 0 { 1.0 } else { random.unit().cbrt() })
            .collect();
        let mask = |camera: &Camera| {
            let mut mask = vec![false; 60 * 48];
            for point in &points {
                let at = camera.clip_from_world.project_point3(*point);
                let [column, row] = [(0.5 + 0.5 * at.x) * 60.0, (0.5 - 0.5 * at.y) * 48.0];
                mask[60 * row as usize + column as usize] = true;
            }
            mask
        };
        (cameras().iter().map(mask).collect(), points)
    }

    #[test]
    fn hulls_hold_what_is_seen_and_little_more() {
        let mut random = Random::new(4);
        let (masks, points) = masks(0.6, &mut random);
        let cameras = cameras();
        let silhouettes: Vec<_> =
            cameras.iter().zip(&masks).map(|(camera, mask)| Silhouette { camera, mask }).collect();
        let hull = visual_hull(SIZE, placed(), &silhouettes).unwrap();
        let unit_from_world = placed().inverse();
        for point in points {
            let at = unit_from_world.transform_point3(point) * UVec3::from(SIZE).as_vec3();
            let [x, y, z] = at.to_array().map(|at| at as usize);
            assert!(hull[(z * 11 + y) * 14 + x], "{point}");
        }
        // A voxel farther from the ball than its diagonal and a pixel is outside of some mask, but for those where cones cross.
        let far = (0..hull.len()).filter(|index| {
            let [x, y, z] = voxel(SIZE, *index).map(|at| at as f32 + 0.5);
            let unit = Vec3::new(x, y, z) / UVec3::from(SIZE).as_vec3();
            placed().transform_point3(unit).length() > 1.2
        });
        let (beyond, kept) =
            far.fold((0, 0), |(all, kept), index| (all + 1, kept + usize::from(hull[index])));
        assert!(beyond > 500 && kept == 0, "{kept} of {beyond}");
        let count = hull.iter().filter(|inside| **inside).count();
        assert!((150..500).contains(&count), "{count}");
        // More views never add.
        let fewer = visual_hull(SIZE, placed(), &silhouettes[..1]).unwrap();
        assert!(hull.iter().zip(&fewer).all(|(all, one)| *one || !*all));
    }

    #[test]
    fn views_say_nothing_of_what_they_do_not_see() {
        let cameras = cameras();
        assert_eq!(visual_hull(SIZE, placed(), &[]).unwrap(), vec![true; 14 * 11 * 12]);
        let none = vec![false; 60 * 48];
        let seen = visual_hull(SIZE, placed(), &[Silhouette { camera: &cameras[0], mask: &none }]).unwrap();
        assert!(!seen.contains(&true));
        // All of it lies beside or behind.
        for offset in [Vec3::new(50.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 30.0)] {
            let moved = Mat4::from_translation(offset) * placed();
            let hull = visual_hull(SIZE, moved, &[Silhouette { camera: &cameras[0], mask: &none }]).unwrap();
            assert!(!hull.contains(&false), "{offset}");
        }
        let short = Silhouette { camera: &cameras[0], mask: &none[1..] };
        assert!(matches!(visual_hull(SIZE, placed(), &[short]), Err(InverseError::Count { .. })));
    }
}
