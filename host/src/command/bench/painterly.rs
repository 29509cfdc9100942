// SPDX-License-Identifier: MIT OR Apache-2.0
//! The named figures of the system `painterly`: ray casting of iso-surfaces; strokes on them lie in files of their own.

use super::painterly_strokes::Head;
use super::{
    Quality, Row, Work, figure, interleaved, painterly_stroke_costs, painterly_strokes, ratio, time,
};
use crate::command::{CommandError, progress, scans};
use crate::core::{Camera, DepthRange, Jitter, PerspectiveView, Transfer};
use crate::data::{Volume, marschner_lobb};
use crate::painterly::{
    BrickRanges, IsoBound, IsoForm, IsoFrame, IsoRaycast, IsoSettings, IsoVolume, SolidBricks,
    SurfaceLighting,
};
use crate::{Gpu, Shaders};
use airlight_tests::linear;
use airlight_tests::parallel;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::painterly::{Solid, trilinear};
use airlight_tests::statistics::mean;
use glam::Vec3;

/// Name of the system in its rows.
pub(super) const SYSTEM: &str = "painterly";
/// The picture of the costs.
const SIZE: [u32; 2] = [1280, 800];
/// Every how many of its pixels hits are sought in f64.
const STRIDE: usize = 40;
/// Samples of each piece of work.
const SAMPLES: usize = 5;
/// What errors are: of rays that hit in both, of less than a voxel, so that a grazing ray that slips by counts for little.
const ERROR: &str = "mean distance of hits from f64, voxels, at most 1";
/// All targets, without skipping.
const PLAIN: IsoForm = IsoForm {
    jitter: Jitter::None,
    skipping: false,
    deferred: false,
    distance_only: false,
    curvature: false,
};
const SKIPPING: IsoForm = IsoForm { skipping: true, ..PLAIN };

/// A volume before a camera.
struct Scene {
    volume: Volume,
    uploaded: IsoVolume,
    table: Vec<[f32; 4]>,
    transfer: Transfer,
    ranges: BrickRanges,
    view: PerspectiveView,
}

/// A pass of a scene, ready to run.
struct Cast {
    pass: IsoRaycast,
    bound: IsoBound,
}

impl Cast {
    fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.pass.record(encoder, &self.bound);
    }
}

impl Scene {
    /// `towards`: from the middle of the volume to the eye, in diagonals of its box.
    fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        volume: Volume,
        table: Vec<[f32; 4]>,
        towards: Vec3,
    ) -> Result<Self, CommandError> {
        let bounds = volume.bounds();
        let (target, diagonal) = (0.5 * (bounds.min + bounds.max), (bounds.max - bounds.min).length());
        let view = PerspectiveView {
            eye: target + diagonal * towards,
            target,
            field_of_view: 36.0,
            near: 0.01 * diagonal,
            far: 10.0 * diagonal,
            depth: DepthRange::Forward,
        };
        let uploaded = IsoVolume::new(gpu, &volume, None).map_err(CommandError::failure)?;
        let transfer = Transfer::new(gpu, &table).map_err(CommandError::failure)?;
        let solid = SolidBricks::new(gpu, shaders).map_err(CommandError::failure)?;
        let mut encoder = gpu.encoder();
        let ranges = solid.ranges(gpu, &mut encoder, &uploaded).map_err(CommandError::failure)?;
        gpu.submit(encoder)?;
        Ok(Self { volume, uploaded, table, transfer, ranges, view })
    }

    fn cast(
        &self,
        gpu: &Gpu,
        shaders: &Shaders,
        form: IsoForm,
        size: [u32; 2],
    ) -> Result<Cast, CommandError> {
        let pass = IsoRaycast::new(gpu, shaders, form).map_err(CommandError::failure)?;
        let bound = pass.bind(gpu, &self.uploaded, &self.transfer, size).map_err(CommandError::failure)?;
        let camera = Camera::perspective(&self.view, size).map_err(CommandError::failure)?;
        let frame = IsoFrame::still(camera, self.volume.world_from_unit);
        let lighting = SurfaceLighting::towards(Vec3::new(0.4, 0.8, 0.5)).map_err(CommandError::failure)?;
        pass.set(gpu, &bound, &self.uploaded, &frame, &IsoSettings::default(), &lighting)
            .map_err(CommandError::failure)?;
        if form.skipping {
            let mut encoder = gpu.encoder();
            let solid = SolidBricks::new(gpu, shaders).map_err(CommandError::failure)?;
            solid
                .record(gpu, &mut encoder, &self.ranges, &self.transfer, &bound)
                .map_err(CommandError::failure)?;
            gpu.submit(encoder)?;
        }
        Ok(Cast { pass, bound })
    }

    /// First hits of every [`STRIDE`]-th ray both ways in f64, metres; none where there is none.
    fn exact(&self, gpu: &Gpu) -> Result<Vec<Option<f64>>, CommandError> {
        let no_inverse = || CommandError::failure("a matrix has no inverse");
        let matrix = |m: glam::Mat4| linear::Mat4::from(m.to_cols_array());
        let camera = Camera::perspective(&self.view, SIZE).map_err(CommandError::failure)?;
        let camera =
            ReferenceCamera::from_matrix(matrix(camera.clip_from_world), 1.0).ok_or_else(no_inverse)?;
        let texels = self.uploaded.texture.read(gpu)?;
        let (scale, offset) = (f64::from(self.uploaded.scale), f64::from(self.uploaded.offset));
        let values: Vec<f64> = texels.iter().map(|texel| f64::from(*texel) * scale + offset).collect();
        let size = self.volume.size.map(|side| side as usize);
        let table: Vec<_> = self.table.iter().map(|entry| entry.map(f64::from)).collect();
        let solid = Solid {
            unit_from_world: matrix(self.volume.world_from_unit).inverse().ok_or_else(no_inverse)?,
            value: &|unit| trilinear(size, &values, unit).clamp(0.0, 1.0),
            table: &table,
            iso_value: 0.5,
            clip_planes: &[],
        };
        let bounds = self.volume.bounds();
        let reach = (self.view.eye - self.view.target).length() + (bounds.max - bounds.min).length();
        let [width, height] = SIZE.map(|side| side as usize);
        let step = f64::from(self.volume.voxel()) / 8.0;
        let rows = parallel::rows(height / STRIDE, |row| {
            let ray = |column: usize| {
                let ndc = ReferenceCamera::pixel_ndc(column * STRIDE, row * STRIDE, width, height);
                let crossings = solid.crossings(camera.origin(ndc), camera.ray(ndc), f64::from(reach), step);
                crossings.first().map(|crossing| crossing.distance)
            };
            (0..width / STRIDE).map(ray).collect::<Vec<_>>()
        });
        Ok(rows.into_iter().flatten().collect())
    }

    /// Mean error of hits, [`ERROR`].
    fn error(&self, gpu: &Gpu, cast: &Cast, exact: &[Option<f64>]) -> Result<f64, CommandError> {
        let distance = cast.bound.targets.distance.read(gpu)?;
        let [width, height] = SIZE.map(|side| side as usize);
        let places = (0..height / STRIDE)
            .flat_map(|y| (0..width / STRIDE).map(move |x| y * STRIDE * width + x * STRIDE));
        let errors: Vec<f64> = places
            .zip(exact)
            .filter_map(|(place, exact)| {
                let found = f64::from(distance[place]);
                let exact = exact.filter(|_| found >= 0.0)?;
                Some(((found - exact).abs() / f64::from(self.volume.voxel())).min(1.0))
            })
            .collect();
        Ok(if errors.is_empty() { f64::NAN } else { mean(&errors) })
    }
}

/// A table that rises from nothing at `from` to opacity 1 at `to`, in 64ths of the range.
pub(super) fn rising(from: usize, to: usize) -> Vec<[f32; 4]> {
    let opacity = |i: usize| ((i as f32 - from as f32) / (to - from) as f32).clamp(0.0, 1.0);
    (0..65).map(|i| [0.9, 0.8, 0.7, opacity(i)]).collect()
}

fn head(gpu: &Gpu, shaders: &Shaders) -> Result<Scene, CommandError> {
    Scene::new(gpu, shaders, scans::head()?, rising(8, 24), Vec3::new(0.45, 0.2, 0.85))
}

fn stent(gpu: &Gpu, shaders: &Shaders) -> Result<Scene, CommandError> {
    Scene::new(gpu, shaders, scans::stent()?, rising(12, 20), Vec3::new(0.5, 0.4, 0.7))
}

/// The test signal from near, so that it fills most of the picture; opacity is the value.
fn signal(gpu: &Gpu, shaders: &Shaders, side: u32) -> Result<Scene, CommandError> {
    Scene::new(gpu, shaders, marschner_lobb([side; 3]), rising(0, 64), Vec3::new(0.2, 0.35, 0.6))
}

/// Every named figure.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(6, quiet);
    let mut rows = Vec::new();
    for (name, scene) in [
        ("stent", stent(gpu, shaders)?),
        ("mri", head(gpu, shaders)?),
        ("marschner_lobb", signal(gpu, shaders, 256)?),
    ] {
        bar.set_message(format!("skipping, {name}"));
        rows.extend(skipping(gpu, shaders, name, &scene)?);
        bar.inc(1);
    }
    bar.set_message("targets and sizes");
    rows.extend(targets(gpu, shaders)?);
    bar.inc(1);
    let head = Head::new(gpu)?;
    bar.set_message("strokes, a turn");
    rows.extend(painterly_strokes::rows(gpu, shaders, &head)?);
    bar.inc(1);
    bar.set_message("strokes, costs");
    rows.extend(painterly_stroke_costs::rows(gpu, shaders, &head)?);
    bar.finish_and_clear();
    Ok(rows)
}

/// With bricks against the same pass without them, of the same volume, step and targets.
fn skipping(gpu: &Gpu, shaders: &Shaders, name: &str, scene: &Scene) -> Result<Vec<Row>, CommandError> {
    let [plain, skips] = [PLAIN, SKIPPING].map(|form| scene.cast(gpu, shaders, form, SIZE));
    let (plain, skips) = (plain?, skips?);
    let works: [Work<'_>; 2] = [&|encoder| plain.record(encoder), &|encoder| skips.record(encoder)];
    let samples = interleaved(gpu, &works, SAMPLES)?;
    let exact = scene.exact(gpu)?;
    let quality = Quality {
        metric: ERROR,
        error: scene.error(gpu, &skips, &exact)?,
        baseline_error: scene.error(gpu, &plain, &exact)?,
    };
    let speedup = format!("skipping_speedup_{name}");
    let mut rows = vec![ratio(SYSTEM, speedup, &samples[0], &samples[1], "higher", Some(quality))];
    let [mut differ, mut hits] = [0.0; 2];
    let (one, other) = (&plain.bound.targets, &skips.bound.targets);
    for (one, other) in [
        (&one.color, &other.color),
        (&one.surface, &other.surface),
        (&one.flow, &other.flow),
        (&one.distance, &other.distance),
    ] {
        let (one, other) = (one.read(gpu)?, other.read(gpu)?);
        let unlike = one.iter().zip(&other).filter(|(a, b)| a.to_bits() != b.to_bits());
        differ += unlike.count() as f64;
    }
    hits += other.distance.read(gpu)?.iter().filter(|distance| **distance >= 0.0).count() as f64;
    let pixels = f64::from(SIZE[0] * SIZE[1]);
    rows.push(figure(SYSTEM, format!("skipping_differs_{name}"), differ / pixels, "fraction"));
    rows.push(figure(SYSTEM, format!("pixels_hit_{name}"), hits / pixels, "fraction"));
    for (form, list) in ["plain", "skipping"].iter().zip(samples) {
        rows.push(time(SYSTEM, format!("raycast_{name}_{form}"), list));
    }
    Ok(rows)
}

/// What the other targets cost over distances alone, half the size over the whole, and the upkeep of bricks.
fn targets(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let scene = head(gpu, shaders)?;
    let all = scene.cast(gpu, shaders, SKIPPING, SIZE)?;
    let alone = scene.cast(gpu, shaders, IsoForm { distance_only: true, ..SKIPPING }, SIZE)?;
    let half = scene.cast(gpu, shaders, SKIPPING, SIZE.map(|side| side / 2))?;
    let solid = SolidBricks::new(gpu, shaders).map_err(CommandError::failure)?;
    let samples = interleaved(
        gpu,
        &[
            &|encoder| all.record(encoder),
            &|encoder| alone.record(encoder),
            &|encoder| half.record(encoder),
            &|encoder| {
                // The only errors are of bindings, which `cast` would have met.
                let _ = solid.ranges(gpu, encoder, &scene.uploaded);
            },
            &|encoder| {
                let _ = solid.record(gpu, encoder, &scene.ranges, &scene.transfer, &all.bound);
            },
        ],
        SAMPLES,
    )?;
    let mut rows = vec![
        ratio(SYSTEM, "targets_over_depth_only", &samples[0], &samples[1], "lower", None),
        ratio(SYSTEM, "half_source_speedup", &samples[0], &samples[2], "higher", None),
    ];
    let names = ["targets_all", "targets_depth_only", "half_source", "brick_ranges", "solid_bricks"];
    for (name, list) in names.iter().zip(samples) {
        rows.push(time(SYSTEM, *name, list));
    }
    Ok(rows)
}

/// The signal from 64^3 to 512^3 voxels.
pub fn tables(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let sides = [64, 128, 256, 512];
    let bar = progress::bar(sides.len() as u64, quiet);
    let mut rows = Vec::new();
    let mut medians = Vec::new();
    for side in sides {
        bar.set_message(format!("{side}^3"));
        let scene = signal(gpu, shaders, side)?;
        let [plain, skips] = [PLAIN, SKIPPING].map(|form| scene.cast(gpu, shaders, form, SIZE));
        let (plain, skips) = (plain?, skips?);
        let works: [Work<'_>; 2] = [&|encoder| plain.record(encoder), &|encoder| skips.record(encoder)];
        let samples = interleaved(gpu, &works, 3)?;
        medians.push(super::median(&samples[1]));
        for (form, list) in ["plain", "skipping"].iter().zip(samples) {
            rows.push(time(SYSTEM, format!("raycast_{side}_{form}"), list));
        }
        bar.inc(1);
    }
    // 1 where the cost grows as the side does.
    let growth = medians[medians.len() - 1] / medians[0] / f64::from(sides[sides.len() - 1] / sides[0]);
    rows.push(figure(SYSTEM, "raycast_growth_over_side", growth, "ratio"));
    bar.finish_and_clear();
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_rise_from_nothing_to_one() {
        let table = rising(8, 24);
        let opacities: Vec<f32> = table.iter().map(|entry| entry[3]).collect();
        assert_eq!((table.len(), opacities[8], opacities[16], opacities[24]), (65, 0.0, 0.5, 1.0));
    }
}
