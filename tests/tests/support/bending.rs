// SPDX-License-Identifier: MIT OR Apache-2.0
//! Curvatures that were written of surfaces, and where.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::matrix;
use crate::probing::hold;
use crate::surfaces::{PLAIN, SIZE, Setting};
use airlight::data::Volume;
use airlight::painterly::IsoForm;
use airlight_tests::linear::Vec3 as Point;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use glam::{Mat4, Vec3};

/// All targets.
pub const CURVED: IsoForm = IsoForm { curvature: true, ..PLAIN };

/// A volume of a function of places in the world.
pub fn field(size: [u32; 3], world_from_unit: Mat4, value: impl Fn(Point) -> f64) -> Volume {
    let space = matrix(world_from_unit);
    let [width, height, depth] = size;
    let mut values = Vec::new();
    for z in 0..depth {
        for y in 0..height {
            for x in 0..width {
                let unit = Point::new(
                    (f64::from(x) + 0.5) / f64::from(width),
                    (f64::from(y) + 0.5) / f64::from(height),
                    (f64::from(z) + 0.5) / f64::from(depth),
                );
                let [x, y, z, _] = space.apply_point(unit);
                values.push(value(Point::new(x, y, z)).clamp(0.0, 1.0) as f32);
            }
        }
    }
    Volume::new(size, values, world_from_unit).unwrap()
}

/// Boxes of 2 m and more about the origin, and their voxels: cubes, of three sides, turned as well, skewed and mirrored.
pub fn boxes() -> [(&'static str, [u32; 3], Mat4); 4] {
    let about = |m: Mat4| m * Mat4::from_translation(Vec3::splat(-0.5));
    let turn = Mat4::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 0.8);
    let sides = Mat4::from_scale(Vec3::new(2.0, 2.0, 2.2));
    let mut skew = Mat4::from_scale(Vec3::new(2.2, 2.3, -2.4));
    skew.y_axis.x = 0.5;
    skew.z_axis.y = -0.4;
    [
        ("cubes", [88; 3], about(Mat4::from_scale(Vec3::splat(2.0)))),
        ("three sides", [104, 72, 88], about(sides)),
        ("turned", [80, 112, 92], about(turn * sides)),
        ("skewed", [96, 100, 104], about(turn * skew)),
    ]
}

/// What was written at a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    /// The hit, world.
    pub point: Point,
    /// Direction of the view ray.
    pub view: Point,
    /// 1/m.
    pub curvatures: [f64; 2],
    /// (cos 2a, sin 2a).
    pub double: [f64; 2],
}

/// What was written of hits that have three voxels to all sides of the box.
pub fn bends(setting: &Setting, form: IsoForm) -> Vec<Bend> {
    let seen = setting.seen(form);
    seen.check();
    let camera = setting.camera();
    let back = matrix(setting.frame.world_from_unit).inverse().unwrap();
    let [width, height] = SIZE.map(|side| side as usize);
    let mut found = Vec::new();
    for (i, texel) in seen.curvature.chunks_exact(4).enumerate() {
        if seen.distance[i] < 0.0 {
            continue;
        }
        let ndc = ReferenceCamera::pixel_ndc(i % width, i / width, width, height);
        let view = camera.ray(ndc);
        let point = camera.origin(ndc) + view * f64::from(seen.distance[i]);
        let [x, y, z, _] = back.apply_point(point);
        let near_side = |(u, side): (f64, u32)| u.min(1.0 - u) * f64::from(side) < 3.0;
        if [x, y, z].into_iter().zip(setting.volume.size).any(near_side) {
            continue;
        }
        let texel: [f32; 4] = texel.try_into().unwrap();
        let [one, two, cosine, sine] = texel.map(f64::from);
        found.push(Bend { point, view, curvatures: [one, two], double: [cosine, sine] });
    }
    assert!(found.len() > 150, "{} hits", found.len());
    found
}

/// Both curvatures within 2 % of the greater.
pub fn hold_curvatures(what: &str, found: &[Bend], exact: impl Fn(Point) -> [f64; 2]) {
    let error = |bend: &Bend| {
        let [one, two] = exact(bend.point);
        let off = (bend.curvatures[0] - one).abs().max((bend.curvatures[1] - two).abs());
        off / one.abs().max(two.abs())
    };
    let errors: Vec<f64> = found.iter().map(error).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    println!("{what}: {} hits, mean error {mean:.1e}", errors.len());
    hold(&format!("{what}, curvature"), errors.into_iter().fold(0.0, f64::max), 0.02);
}

/// Directions in the picture within 2 degrees, of those that do not run along the view ray; and how many were told.
pub fn hold_directions(
    what: &str,
    setting: &Setting,
    found: &[Bend],
    exact: impl Fn(Point) -> Point,
) -> usize {
    let camera = setting.camera();
    let [width, height] = SIZE.map(f64::from);
    let (mut worst, mut shown) = (0.0_f64, 0);
    for bend in found {
        let along = exact(bend.point).normalised();
        let step = along * (1e-4 * setting.voxel());
        let [from, to] = [bend.point - step, bend.point + step].map(|p| camera.project(p).unwrap());
        // Rightwards and downwards.
        let angle = (-(to[1] - from[1]) * height).atan2((to[0] - from[0]) * width);
        if bend.double == [0.0; 2] {
            continue;
        }
        shown += 1;
        assert!((bend.double[0].hypot(bend.double[1]) - 1.0).abs() < 2e-3);
        // What runs nearly along the ray turns fast.
        if along.cross(bend.view).length() < 0.15 {
            continue;
        }
        let double = bend.double[1].atan2(bend.double[0]) - 2.0 * angle;
        worst = worst.max(0.5 * double.sin().atan2(double.cos()).abs().to_degrees());
    }
    hold(&format!("{what}, degrees"), worst, 2.0);
    shown
}
