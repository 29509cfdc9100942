// SPDX-License-Identifier: MIT OR Apache-2.0
//! A shadow buffer parallel to the sheets.

use super::soft_schedule::{SOFT_SPREAD, SoftSchedule};
use super::{SheetFrame, Sheets, SoftShadows, SplattingError};
use crate::core::{Camera, DIRECTIONAL, Light};
use encase::ShaderType;
use glam::{DMat4, DVec2, DVec3, DVec4, UVec2, Vec2, Vec3};

/// The uniform `SoftLight` of `splatting/soft_shadow`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SoftLight {
    /// Texels of the shadow buffer.
    pub size: UVec2,
    /// Side of a texel: metres of a directional light, metres per metre of distance of a light at a point.
    pub texel: Vec2,
    /// Height of a light at a point along the sheets' normal, metres.
    pub height: f32,
    /// 1 of a light at a point, 0 of a directional one.
    pub local: u32,
    /// Depth of solids where their surface rises by a metre a metre, metres.
    pub filling: f32,
    /// Greatest depth of solids, metres.
    pub deepest: f32,
}

/// A shadow buffer whose texels lie in planes of constant height, and what sheets do with its layers.
#[derive(Debug, Clone, PartialEq)]
pub struct SoftPlane {
    /// The light's middle as a camera; clip depth is 0 where the first sheet begins or before it.
    pub camera: Camera,
    /// Geometry of the buffer.
    pub light: SoftLight,
    /// Of the sheets' middles and of one more, from which widths of penumbras are reckoned: heights in metres above the first sheet, or
    /// -1/d, d the distance from a light at a point along the normal, metres.
    pub places: Vec<f64>,
    /// Width of a penumbra a place behind its occluder along columns and rows, in what `texel` of the light is in.
    pub widths: [f64; 2],
    /// What sheets do with layers.
    pub schedule: SoftSchedule,
}

/// Directions in the buffer, in the world.
struct Axes {
    /// Across the tilt of the light against the sheets.
    across: DVec3,
    /// Along it.
    along: DVec3,
    normal: DVec3,
    /// Between the normal and the way of the light.
    cosine: f64,
}

impl Axes {
    fn new(normal: DVec3, way: DVec3) -> Self {
        let cosine = normal.dot(way).clamp(0.0, 1.0);
        let tilt = way - normal * normal.dot(way);
        let any = normal.any_orthonormal_vector();
        let along = if tilt.length() > 1e-6 { tilt.normalize() } else { any };
        Self { across: normal.cross(along), along, normal, cosine }
    }
}

impl SoftPlane {
    /// Of a buffer of `size` texels around `points`, metres, in front of all of which the light has to be.
    ///
    /// The light's square faces the scene; it is put into the plane parallel to the sheets as that looks from there. So it is
    /// longer along the tilt of the light against the sheets by 1/cos, and heights are passed at a slant, by 1/cos both ways: the
    /// penumbra on a surface across the light stays as wide as it is without sheets.
    ///
    /// # Errors
    /// [`SplattingError`].
    pub fn new(
        settings: &SoftShadows,
        frame: &SheetFrame,
        sheets: &Sheets,
        points: &[Vec3],
        size: [u32; 2],
    ) -> Result<Self, SplattingError> {
        settings.check(frame.light.kind == DIRECTIONAL)?;
        if frame.light.kind == DIRECTIONAL {
            Self::parallel(settings, &frame.light, sheets, points, size)
        } else {
            Self::local(settings, &frame.light, sheets, points, size)
        }
    }

    fn parallel(
        settings: &SoftShadows,
        light: &Light,
        sheets: &Sheets,
        points: &[Vec3],
        size: [u32; 2],
    ) -> Result<Self, SplattingError> {
        let normal = sheets.normal.as_dvec3();
        let way = (-light.direction.as_dvec3()).normalize_or(normal);
        let axes = Axes::new(normal, way);
        if axes.cosine < 0.05 {
            return Err(SplattingError::LightBehind { nearest: axes.cosine as f32, farthest: 1.0 });
        }
        let first = f64::from(sheets.first);
        // Along a ray of light the offset is that in the plane where the first sheet begins.
        let slope = axes.along.dot(way) / axes.cosine;
        let skewed = axes.along - axes.normal * slope;
        let seen = |point: DVec3| DVec2::new(axes.across.dot(point), skewed.dot(point) + slope * first);
        let angle = (f64::from(settings.size).to_radians() / 2.0).tan() * 2.0;
        let widths = [angle / axes.cosine, angle / axes.cosine.powi(2)];
        let thickness = f64::from(sheets.thickness);
        let places: Vec<f64> = (0..=sheets.count).map(|sheet| (f64::from(sheet) + 0.5) * thickness).collect();
        let deep = places.last().copied().unwrap_or(0.0);
        let fit = Fit::new(
            points.iter().map(|point| seen(point.as_dvec3())),
            widths.map(|w| w * deep),
            1e-3 * thickness,
        );
        let depth = (f64::from(sheets.count) * thickness).max(1e-9);
        let [x, y] = fit.scales();
        let rows = [
            (axes.across * x).extend(fit.shift(0)),
            (skewed * y).extend(fit.shift(1) + y * slope * first),
            (normal / depth).extend(-first / depth),
            DVec4::W,
        ];
        let camera = camera(rows, Vec3::ZERO, size, 1);
        Ok(Self::over(settings, camera, &fit, size, (0.0, false), places, widths))
    }

    fn local(
        settings: &SoftShadows,
        light: &Light,
        sheets: &Sheets,
        points: &[Vec3],
        size: [u32; 2],
    ) -> Result<Self, SplattingError> {
        let normal = sheets.normal.as_dvec3();
        let place = light.position.as_dvec3();
        let height = normal.dot(place);
        let thickness = f64::from(sheets.thickness);
        let first = f64::from(sheets.first) - height;
        let last = first + f64::from(sheets.count + 1) * thickness;
        let distances = points.iter().map(|point| normal.dot(point.as_dvec3()) - height);
        let (near, far) = distances.fold((first, last), |(a, b), d| (a.min(d), b.max(d)));
        // Written so that a NaN is refused as well; farther ones leave no digits.
        if !(near > 1e-3 * far && far < 1e12) {
            return Err(SplattingError::LightBehind { nearest: near as f32, farthest: far as f32 });
        }
        let middle = points.iter().map(|point| point.as_dvec3()).sum::<DVec3>() / points.len().max(1) as f64;
        let way = (middle - place).normalize_or(normal);
        let axes = Axes::new(normal, way);
        let seen = |point: DVec3| {
            let offset = point - place;
            DVec2::new(axes.across.dot(offset), axes.along.dot(offset)) / normal.dot(offset)
        };
        let side = f64::from(settings.size);
        let widths = [side, side / axes.cosine.max(0.05)];
        let of_sheet = |sheet: u32| -1.0 / (first + (f64::from(sheet) + 0.5) * thickness);
        let places: Vec<f64> = (0..=sheets.count).map(of_sheet).collect();
        let deep = of_sheet(sheets.count) - of_sheet(0);
        let fit = Fit::new(points.iter().map(|point| seen(point.as_dvec3())), widths.map(|w| w * deep), 1e-6);
        let [x, y] = fit.scales();
        let from_light = |row: DVec3, shift: f64| {
            let row = row + normal * shift;
            row.extend(-row.dot(place))
        };
        // Depth rises from 0 at `near` to 1 at `far`.
        let deepening = far / (far - near);
        let w = normal.extend(-height);
        let rows = [
            from_light(axes.across * x, fit.shift(0)),
            from_light(axes.along * y, fit.shift(1)),
            w * deepening - DVec4::W * (deepening * near),
            w,
        ];
        let camera = camera(rows, light.position, size, 0);
        Ok(Self::over(settings, camera, &fit, size, (height as f32, true), places, widths))
    }

    fn over(
        settings: &SoftShadows,
        camera: Camera,
        fit: &Fit,
        size: [u32; 2],
        (height, local): (f32, bool),
        places: Vec<f64>,
        widths: [f64; 2],
    ) -> Self {
        let texel = [0, 1].map(|axis| fit.extent()[axis] / f64::from(size[axis].max(1)));
        let spread = [0, 1].map(|axis| SOFT_SPREAD * widths[axis] / texel[axis]);
        let light = SoftLight {
            size: UVec2::from(size),
            texel: Vec2::from(texel.map(|side| side as f32)),
            height,
            local: u32::from(local),
            filling: settings.filling,
            deepest: settings.deepest,
        };
        let schedule = SoftSchedule::new(&places, spread);
        Self { camera, light, places, widths, schedule }
    }
}

/// What the buffer holds, in its own coordinates.
struct Fit {
    low: DVec2,
    high: DVec2,
}

impl Fit {
    /// All of `seen`, with room for what penumbras of `widths` spill, so that it is there when they spill back.
    fn new(seen: impl Iterator<Item = DVec2>, widths: [f64; 2], least: f64) -> Self {
        let ends = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = seen.fold(ends, |(low, high), at| (low.min(at), high.max(at)));
        let (low, high) = if low.cmple(high).all() { (low, high) } else { (DVec2::ZERO, DVec2::ZERO) };
        let extent = (high - low).max(DVec2::splat(least));
        let spilled = DVec2::from(widths) * (2.0 * SOFT_SPREAD);
        let room = spilled.min(extent * 0.5) + extent * 5e-3;
        Self { low: low - room, high: high + room }
    }

    fn extent(&self) -> DVec2 {
        self.high - self.low
    }

    /// To clip coordinates.
    fn scales(&self) -> [f64; 2] {
        (DVec2::splat(2.0) / self.extent()).to_array()
    }

    fn shift(&self, axis: usize) -> f64 {
        -(self.low[axis] + self.high[axis]) / self.extent()[axis]
    }
}

/// From the rows of its matrix.
fn camera([x, y, z, w]: [DVec4; 4], eye: Vec3, size: [u32; 2], projection: u32) -> Camera {
    let clip_from_world = DMat4::from_cols(x, y, z, w).transpose();
    Camera {
        clip_from_world: clip_from_world.as_mat4(),
        world_from_clip: clip_from_world.inverse().as_mat4(),
        eye,
        near_depth: 0.0,
        viewport: UVec2::from(size).as_vec2(),
        far_depth: 1.0,
        projection,
    }
}
