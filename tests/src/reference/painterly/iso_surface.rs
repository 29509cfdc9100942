// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where rays cross the surface of what is solid.

use crate::linear::{Mat4, Vec3};
use crate::reference::camera::Camera;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A value of a grid at a place in the box 0..1, voxel `i` lying at `(i + 0.5) / size`; beyond the outer voxels as there.
#[must_use]
pub fn trilinear(size: [usize; 3], values: &[f64], unit: [f64; 3]) -> f64 {
    let axis = |a: usize| {
        let at = (unit[a] * size[a] as f64 - 0.5).clamp(0.0, (size[a] - 1) as f64);
        let first = (at.floor() as usize).min(size[a].saturating_sub(2));
        (first, (first + 1).min(size[a] - 1), at - first as f64)
    };
    let [x, y, z] = [axis(0), axis(1), axis(2)];
    let voxel = |i: usize, j: usize, k: usize| values[(k * size[1] + j) * size[0] + i];
    let row = |j: usize, k: usize| voxel(x.0, j, k) * (1.0 - x.2) + voxel(x.1, j, k) * x.2;
    let slice = |k: usize| row(y.0, k) * (1.0 - y.2) + row(y.1, k) * y.2;
    slice(z.0) * (1.0 - z.2) + slice(z.1) * z.2
}

/// Colour and opacity of a value by an evenly spread table, straight between its entries.
#[must_use]
pub fn classify(table: &[[f64; 4]], value: f64) -> [f64; 4] {
    let at = value.clamp(0.0, 1.0) * (table.len() - 1) as f64;
    let first = (at.floor() as usize).min(table.len() - 2);
    let share = at - first as f64;
    std::array::from_fn(|channel| table[first][channel] * (1.0 - share) + table[first + 1][channel] * share)
}

/// What is solid of a volume.
pub struct Solid<'a> {
    /// World, metres, to the box 0..1.
    pub unit_from_world: Mat4,
    /// Value 0..1 at a place in the box.
    pub value: &'a (dyn Fn([f64; 3]) -> f64 + Sync),
    /// Linear RGB and opacity of values.
    pub table: &'a [[f64; 4]],
    /// Opacity from which on it is solid.
    pub iso_value: f64,
    /// What lies where normal and offset give less than 0 is cut away.
    pub clip_planes: &'a [[f64; 4]],
}

/// Where a ray comes into what is solid.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Metres along the ray.
    pub distance: f64,
    /// How far the ray then stays in it, metres, to the grain of the samples.
    pub lasts: f64,
    /// Whether it comes in by a face of the box, a clip plane or the ray's own beginning, not by the surface.
    pub entered: bool,
}

impl Solid<'_> {
    /// Place in the box of a point; none outside of it and where it is cut away.
    #[must_use]
    pub fn unit(&self, point: Vec3) -> Option<[f64; 3]> {
        let [x, y, z, _] = self.unit_from_world.apply_point(point);
        let cut = self.clip_planes.iter().any(|[a, b, c, d]| Vec3::new(*a, *b, *c).dot(point) + d < 0.0);
        (!cut && [x, y, z].iter().all(|u| (0.0..=1.0).contains(u))).then_some([x, y, z])
    }

    /// Whether a point is solid.
    #[must_use]
    pub fn holds(&self, point: Vec3) -> bool {
        self.unit(point).is_some_and(|unit| classify(self.table, (self.value)(unit))[3] >= self.iso_value)
    }

    /// All crossings of a ray from its origin to `end` metres, as samples `step` metres apart see them, each by 60 halvings.
    #[must_use]
    pub fn crossings(&self, origin: Vec3, direction: Vec3, end: f64, step: f64) -> Vec<Crossing> {
        let at = |distance: f64| origin + direction * distance;
        let samples = (end / step).ceil() as usize;
        let mut found: Vec<Crossing> = Vec::new();
        let mut before = false;
        for i in 0..=samples {
            let distance = (i as f64 * step).min(end);
            let here = self.holds(at(distance));
            if here && !before {
                let (mut outside, mut inside) = ((distance - step).max(0.0), distance);
                for _ in 0..60 {
                    let middle = 0.5 * (outside + inside);
                    *(if self.holds(at(middle)) { &mut inside } else { &mut outside }) = middle;
                }
                let entered = i == 0 || self.unit(at(outside)).is_none();
                found.push(Crossing { distance: inside, lasts: 0.0, entered });
            } else if here && let Some(last) = found.last_mut() {
                last.lasts = distance - last.distance;
            }
            before = here;
        }
        found
    }

    /// Change of the value a metre, by differences over `step` metres to both sides.
    #[must_use]
    pub fn gradient(&self, point: Vec3, step: f64) -> Vec3 {
        let value = |offset: [f64; 3]| {
            let [x, y, z, _] = self.unit_from_world.apply_point(point + Vec3::from(offset));
            (self.value)([x, y, z])
        };
        let axis = |a: usize| {
            let offset = |s: f64| std::array::from_fn(|i| if i == a { s } else { 0.0 });
            (value(offset(step)) - value(offset(-step))) / (2.0 * step)
        };
        Vec3::new(axis(0), axis(1), axis(2))
    }
}

/// Gradient of Marschner and Lobb's signal (modulation 0.25, 6 rings) at a place from -1 to 1, a unit of length.
#[must_use]
pub fn marschner_lobb_gradient(at: Vec3) -> Vec3 {
    let radius = at.x.hypot(at.y);
    // cos(TAU 6 cos(pi r / 2)), derived.
    let inner = TAU * 6.0;
    let ring = (inner * (FRAC_PI_2 * radius).cos()).sin() * inner * FRAC_PI_2 * (FRAC_PI_2 * radius).sin();
    let radial = if radius > 0.0 { 0.25 * ring / radius } else { 0.0 };
    Vec3::new(radial * at.x, radial * at.y, -FRAC_PI_2 * (FRAC_PI_2 * at.z).cos()) * 2.5_f64.recip()
}

/// Motion in pixels, x right and y down, of a place in the box from one camera and matrix to the next. `views`: camera and
/// matrix before, then now; none where it is behind an eye.
#[must_use]
pub fn motion(views: [(&Camera, &Mat4); 2], unit: [f64; 3], [width, height]: [f64; 2]) -> Option<[f64; 2]> {
    let pixel = |(camera, world_from_unit): (&Camera, &Mat4)| {
        let [x, y, z, _] = world_from_unit.apply_point(Vec3::from(unit));
        let [x, y, _] = camera.project(Vec3::new(x, y, z))?;
        Some([(x + 1.0) / 2.0 * width, (1.0 - y) / 2.0 * height])
    };
    let [before, now] = [pixel(views[0])?, pixel(views[1])?];
    Some([now[0] - before[0], now[1] - before[1]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slab_is_crossed_where_it_lies() {
        let value = |unit: [f64; 3]| if (0.4..0.6).contains(&unit[2]) { 1.0 } else { 0.0 };
        let table = [[0.0; 4], [1.0; 4]];
        let identity: [[f64; 4]; 4] =
            std::array::from_fn(|r| std::array::from_fn(|c| f64::from(u8::from(r == c))));
        let solid = Solid {
            unit_from_world: Mat4::from_rows(identity),
            value: &value,
            table: &table,
            iso_value: 0.5,
            clip_planes: &[],
        };
        let along = |solid: &Solid<'_>, z: f64| {
            solid.crossings(Vec3::new(0.5, 0.5, z), Vec3::new(0.0, 0.0, 1.0), 3.0, 0.01)
        };
        let found = along(&solid, -1.0);
        assert_eq!(found.len(), 1);
        assert!((found[0].distance - 1.4).abs() < 1e-12 && (found[0].lasts - 0.2).abs() < 0.011);
        assert!(!found[0].entered);
        let within = along(&solid, 0.5)[0];
        assert!(within.entered && within.distance == 0.0);
        let cut = Solid { clip_planes: &[[0.0, 0.0, 1.0, -0.45]], ..solid };
        let cut = along(&cut, -1.0)[0];
        assert!(cut.entered && (cut.distance - 1.45).abs() < 1e-12);
    }

    #[test]
    fn gradients_of_the_signal_are_its_differences() {
        let signal = |p: Vec3| {
            let rings = (TAU * 6.0 * (FRAC_PI_2 * p.x.hypot(p.y)).cos()).cos();
            (1.0 - (FRAC_PI_2 * p.z).sin() + 0.25 * (1.0 + rings)) / 2.5
        };
        for point in [Vec3::new(0.3, -0.2, 0.1), Vec3::new(-0.7, 0.5, -0.6), Vec3::new(0.0, 0.0, 0.4)] {
            let found = marschner_lobb_gradient(point).to_array();
            for (a, found) in found.into_iter().enumerate() {
                let offset =
                    Vec3::from(std::array::from_fn::<f64, 3, _>(|i| if i == a { 1e-6 } else { 0.0 }));
                let expected = (signal(point + offset) - signal(point - offset)) / 2e-6;
                assert!((found - expected).abs() < 1e-6, "{found} {expected}");
            }
        }
    }
}
