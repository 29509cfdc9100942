// SPDX-License-Identifier: MIT OR Apache-2.0
//! Strokes on a head that turns: how many there are, how densely they lie, whether they keep to their points, and how many
//! outlive a turn. From this near the head covers a quarter of the picture.

use super::painterly::{SYSTEM, rising};
use super::{Row, figure};
use crate::command::{CommandError, scans};
use crate::core::{Camera, DepthRange, Jitter, PerspectiveView, Transfer};
use crate::data::Volume;
use crate::painterly::{
    Brushes, Canvas, IsoBound, IsoForm, IsoFrame, IsoRaycast, IsoSettings, IsoTargets, IsoVolume,
    PainterlyStyle, Painting, PaintingFrame, PaintingSettings, STYLES, SolidBricks, Stroke, StrokeSettings,
    StrokeState, SurfaceLighting, parse_style,
};
use crate::{Gpu, Shaders};
use airlight_tests::linear;
use airlight_tests::parallel;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::painterly::{Solid, trilinear};
use glam::{Mat4, Vec3};
use std::collections::HashMap;

/// The picture, and the rays that it is cast by.
pub(super) const SIZE: [u32; 2] = [1280, 800];
/// Voxels along each axis.
const SIDE: u32 = 256;
/// Frames that the head turns for.
const FRAMES: u32 = 60;
/// Frames that it then goes on turning, while strokes are neither born nor thinned out.
const ALONE: u32 = 10;
/// A turn in a frame, degrees.
const TURN: f32 = 1.0;
/// Pixels along the side of a tile that density is judged in.
const TILE: usize = 32;

/// The head of 256^3 voxels, before a camera.
pub(super) struct Head {
    volume: Volume,
    pub(super) uploaded: IsoVolume,
    table: Vec<[f32; 4]>,
    pub(super) transfer: Transfer,
    pub(super) camera: Camera,
    pub(super) settings: IsoSettings,
    pub(super) lighting: SurfaceLighting,
    middle: Vec3,
}

impl Head {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, CommandError> {
        let volume = resampled(&scans::head()?, SIDE);
        let bounds = volume.bounds();
        let (middle, diagonal) = (0.5 * (bounds.min + bounds.max), (bounds.max - bounds.min).length());
        let view = PerspectiveView {
            eye: middle + diagonal * Vec3::new(0.45, 0.2, 0.85),
            target: middle,
            field_of_view: 38.0,
            near: 0.01 * diagonal,
            far: 10.0 * diagonal,
            depth: DepthRange::Forward,
        };
        let table = rising(8, 24);
        Ok(Self {
            uploaded: IsoVolume::new(gpu, &volume, None).map_err(CommandError::failure)?,
            transfer: Transfer::new(gpu, &table).map_err(CommandError::failure)?,
            camera: Camera::perspective(&view, SIZE).map_err(CommandError::failure)?,
            settings: IsoSettings::default(),
            lighting: SurfaceLighting::towards(Vec3::new(0.4, 0.8, 0.5)).map_err(CommandError::failure)?,
            volume,
            table,
            middle,
        })
    }

    /// Where the head is in a frame.
    pub(super) fn posed(&self, frame: u32) -> Mat4 {
        let turn = Mat4::from_rotation_y((TURN * frame as f32).to_radians());
        Mat4::from_translation(self.middle)
            * turn
            * Mat4::from_translation(-self.middle)
            * self.volume.world_from_unit
    }

    /// The style `dense`, with thresholds that give each layer a third of what is seen of the head: gradients of skin lie closer
    /// together than those of the style.
    pub(super) fn style(&self, gpu: &Gpu, shaders: &Shaders) -> Result<PainterlyStyle, CommandError> {
        let (name, text) = STYLES
            .iter()
            .find(|(name, _)| *name == "dense")
            .ok_or_else(|| CommandError::failure("there is no style `dense`"))?;
        let mut style = parse_style(name, text).map_err(CommandError::failure)?;
        let targets = self.cast(gpu, shaders, 0)?.targets;
        let (surface, distance) = (targets.surface.read(gpu)?, targets.distance.read(gpu)?);
        let seen = surface.chunks_exact(4).zip(&distance).filter(|(_, distance)| **distance >= 0.0);
        let mut magnitudes: Vec<f32> = seen.map(|(texel, _)| texel[3]).collect();
        magnitudes.sort_unstable_by(f32::total_cmp);
        let third = |of: usize| magnitudes.get(of * magnitudes.len() / 3).copied();
        let (Some(first), Some(second)) = (third(1), third(2)) else {
            return Err(CommandError::failure("the head is not seen"));
        };
        (style.coarse.threshold, style.medium.threshold) = (first, second);
        Ok(style)
    }

    /// What rays see in a frame.
    pub(super) fn cast(&self, gpu: &Gpu, shaders: &Shaders, frame: u32) -> Result<IsoBound, CommandError> {
        let form = IsoForm { skipping: true, ..IsoForm::default() };
        let pass = IsoRaycast::new(gpu, shaders, form).map_err(CommandError::failure)?;
        let solid = SolidBricks::new(gpu, shaders).map_err(CommandError::failure)?;
        let bound = pass.bind(gpu, &self.uploaded, &self.transfer, SIZE).map_err(CommandError::failure)?;
        let still = IsoFrame::still(self.camera, self.posed(frame));
        pass.set(gpu, &bound, &self.uploaded, &still, &self.settings, &self.lighting)
            .map_err(CommandError::failure)?;
        let mut encoder = gpu.encoder();
        let ranges = solid.ranges(gpu, &mut encoder, &self.uploaded).map_err(CommandError::failure)?;
        solid.record(gpu, &mut encoder, &ranges, &self.transfer, &bound).map_err(CommandError::failure)?;
        pass.record(&mut encoder, &bound);
        gpu.submit(encoder)?;
        Ok(bound)
    }
}

/// A volume of `side` voxels along each axis in the same box, straight between those that there are.
fn resampled(volume: &Volume, side: u32) -> Volume {
    let size = volume.size.map(|side| side as usize);
    let values: Vec<f64> = volume.values.iter().map(|value| f64::from(*value)).collect();
    let count = side as usize;
    let unit = |i: usize| (i as f64 + 0.5) / f64::from(side);
    let slices = parallel::rows(count, |z| {
        let voxel = |i: usize| trilinear(size, &values, [unit(i % count), unit(i / count), unit(z)]) as f32;
        (0..count * count).map(voxel).collect::<Vec<_>>()
    });
    let values = slices.into_iter().flatten().collect();
    Volume { size: [side; 3], values, world_from_unit: volume.world_from_unit }
}

/// Every named figure.
pub(super) fn rows(gpu: &Gpu, shaders: &Shaders, head: &Head) -> Result<Vec<Row>, CommandError> {
    let style = head.style(gpu, shaders)?;
    let brushes = Brushes::procedural(gpu).map_err(CommandError::failure)?;
    let shown = Brushes::procedural(gpu).map_err(CommandError::failure)?;
    let settings = PaintingSettings {
        strokes: StrokeSettings::new(SIZE, SIZE),
        style,
        jitter: Jitter::None,
        canvas: Canvas::new(Vec3::ONE, 0.0),
    };
    let mut painting = Painting::new(gpu, shaders, &head.uploaded, &head.transfer, shown, settings)
        .map_err(CommandError::failure)?;
    let mut rows = Vec::new();
    let mut greatest = 0;
    let mut least = u32::MAX;
    for frame in 0..=FRAMES {
        advance(gpu, &mut painting, head, frame, true)?;
        let counts = painting.strokes().read_counts(gpu).map_err(CommandError::failure)?;
        if frame == 0 {
            let areas = areas(gpu, painting.targets(), &style)?;
            for (k, (layer, of)) in PainterlyStyle::LAYERS.into_iter().zip(style.layers()).enumerate() {
                let [first, _] = style.expected_strokes(k, 1.0, &brushes);
                let density = f64::from(style.within_bounds(of)[0] / of.density.min);
                let p = (f64::from(first) * density).min(f64::from(of.probability));
                let (expected, sigma) = (p * areas[k], (p * (1.0 - p) * areas[k]).sqrt());
                let off = (f64::from(counts.layers()[k]) - expected).abs() / sigma;
                rows.push(figure(SYSTEM, format!("strokes_{layer}_sigmas"), off, "sigmas"));
                let share = areas[k] / f64::from(SIZE[0] * SIZE[1]);
                rows.push(figure(SYSTEM, format!("pixels_of_layer_{layer}"), share, "fraction"));
            }
        }
        if frame >= FRAMES / 2 {
            (least, greatest) = (least.min(counts.instances), greatest.max(counts.instances));
        }
    }
    rows.push(figure(SYSTEM, "strokes_alive_least", f64::from(least), "strokes"));
    rows.push(figure(SYSTEM, "strokes_alive_most", f64::from(greatest), "strokes"));
    rows.extend(densities(gpu, &painting, &style)?);
    rows.extend(persistence(gpu, &mut painting, head)?);
    Ok(rows)
}

/// Does a frame.
fn advance(
    gpu: &Gpu,
    painting: &mut Painting<'_>,
    head: &Head,
    frame: u32,
    population: bool,
) -> Result<(), CommandError> {
    let mut encoder = gpu.encoder();
    let step = PaintingFrame {
        camera: head.camera,
        world_from_unit: head.posed(frame),
        surface: &head.settings,
        lighting: &head.lighting,
        seconds: 1.0 / 60.0,
        generation: population,
        deletion: population,
    };
    painting.record(gpu, &mut encoder, &step).map_err(CommandError::failure)?;
    gpu.submit(encoder)?;
    Ok(())
}

/// The layer of each pixel of the sources, by the bounds of the style.
fn layers(
    gpu: &Gpu,
    targets: &IsoTargets,
    style: &PainterlyStyle,
) -> Result<Vec<Option<usize>>, CommandError> {
    let surface = targets.surface.read(gpu)?;
    let distance = targets.distance.read(gpu)?;
    let of = |(texel, distance): (&[f32], &f32)| {
        let magnitude = texel[3] * style.gradient_scale;
        let layer = style.layers().iter().position(|layer| magnitude < layer.threshold);
        layer.filter(|_| *distance >= 0.0)
    };
    Ok(surface.chunks_exact(4).zip(&distance).map(of).collect())
}

/// Pixels of each layer.
fn areas(gpu: &Gpu, targets: &IsoTargets, style: &PainterlyStyle) -> Result<[f64; 3], CommandError> {
    let mut areas = [0.0; 3];
    for layer in layers(gpu, targets, style)?.into_iter().flatten() {
        areas[layer] += 1.0;
    }
    Ok(areas)
}

/// Of each layer the mean of its density as a share of the way from one bound to the other, and how many of the tiles that it
/// covers a quarter of lie between them.
fn densities(gpu: &Gpu, painting: &Painting<'_>, style: &PainterlyStyle) -> Result<Vec<Row>, CommandError> {
    let density = &painting.strokes().density;
    let found = density.read(gpu)?;
    let [width, height, _] = density.size().map(|side| side as usize);
    let layers = layers(gpu, painting.targets(), style)?;
    let step = SIZE[0] as usize / width;
    let side = TILE / step;
    let columns = width.div_ceil(side);
    let mut rows = Vec::new();
    for (k, (name, of)) in PainterlyStyle::LAYERS.into_iter().zip(style.layers()).enumerate() {
        let mut tiles = vec![(0.0, 0.0); columns * height.div_ceil(side)];
        for (index, texel) in found.chunks_exact(4).enumerate() {
            let (x, y) = (index % width, index / width);
            let pixel = (y * step + step / 2) * SIZE[0] as usize + x * step + step / 2;
            if layers.get(pixel) == Some(&Some(k)) {
                let tile = &mut tiles[y / side * columns + x / side];
                *tile = (tile.0 + f64::from(texel[k]), tile.1 + 1.0);
            }
        }
        let [least, most] = [of.density.min, of.density.max].map(f64::from);
        let (sum, count) = tiles.iter().fold((0.0, 0.0), |all, tile| (all.0 + tile.0, all.1 + tile.1));
        let judged: Vec<f64> = tiles
            .iter()
            .filter(|tile| tile.1 >= (side * side) as f64 / 4.0)
            .map(|tile| tile.0 / tile.1)
            .collect();
        let inside = judged.iter().filter(|mean| (least..=most).contains(*mean)).count();
        let place = (sum / count - least) / (most - least);
        let share = inside as f64 / judged.len() as f64;
        rows.push(figure(SYSTEM, format!("density_between_bounds_{name}"), place, "fraction"));
        rows.push(figure(SYSTEM, format!("density_tiles_{name}"), judged.len() as f64, "tiles"));
        let inside = figure(SYSTEM, format!("density_tiles_inside_{name}"), share, "fraction");
        rows.push(Row { better: "higher", ..inside });
    }
    Ok(rows)
}

/// How far strokes are from where their points are seen, and how many of those whose points are still seen stay.
fn persistence(gpu: &Gpu, painting: &mut Painting<'_>, head: &Head) -> Result<Vec<Row>, CommandError> {
    let read = |painting: &Painting<'_>| painting.strokes().read(gpu).map_err(CommandError::failure);
    let before: Vec<Stroke> =
        read(painting)?.into_iter().filter(|stroke| stroke.state == StrokeState::Stays).collect();
    let points: HashMap<u32, Vec3> = before.iter().map(|stroke| (stroke.hash, stroke.point)).collect();
    let exact = |matrix: Mat4| linear::Mat4::from(matrix.to_cols_array());
    let no_inverse = || CommandError::failure("a matrix has no inverse");
    let camera =
        ReferenceCamera::from_matrix(exact(head.camera.clip_from_world), 1.0).ok_or_else(no_inverse)?;
    let mut drift = 0.0_f64;
    let mut after = HashMap::new();
    for frame in FRAMES + 1..=FRAMES + ALONE {
        advance(gpu, painting, head, frame, false)?;
        after = read(painting)?.into_iter().map(|stroke| (stroke.hash, stroke)).collect();
        let world_from_unit = exact(head.posed(frame));
        for stroke in after.values().filter(|stroke| stroke.state == StrokeState::Stays) {
            let Some(point) = points.get(&stroke.hash) else { continue };
            let [x, y, z, _] = world_from_unit.apply_point(linear::Vec3::from(point.to_array()));
            let Some([x, y, _]) = camera.project(linear::Vec3::new(x, y, z)) else { continue };
            let place = [0.5 + 0.5 * x, 0.5 - 0.5 * y];
            let found = stroke.position.to_array().map(f64::from);
            let off = [0, 1].map(|axis| (found[axis] - place[axis]) * f64::from(SIZE[axis]));
            drift = drift.max(off[0].hypot(off[1]));
        }
    }
    let seen = visible(gpu, head, &camera, FRAMES + ALONE, &before)?;
    let stay = |stroke: &Stroke| after.get(&stroke.hash).is_some_and(|now| now.state == StrokeState::Stays);
    let all = seen.iter().filter(|seen| **seen).count();
    let survive = before.iter().zip(&seen).filter(|(stroke, seen)| **seen && stay(stroke)).count();
    let survivors = figure(SYSTEM, "survivors", survive as f64 / all as f64, "fraction");
    Ok(vec![
        figure(SYSTEM, "drift", drift, "pixels"),
        Row { better: "higher", ..survivors },
        figure(SYSTEM, "survivors_of", all as f64 / before.len() as f64, "fraction"),
    ])
}

/// Whether nothing solid lies before the points of strokes in a frame, in f64.
fn visible(
    gpu: &Gpu,
    head: &Head,
    camera: &ReferenceCamera,
    frame: u32,
    strokes: &[Stroke],
) -> Result<Vec<bool>, CommandError> {
    let world_from_unit = linear::Mat4::from(head.posed(frame).to_cols_array());
    let texels = head.uploaded.texture.read(gpu)?;
    let (scale, offset) = (f64::from(head.uploaded.scale), f64::from(head.uploaded.offset));
    let values: Vec<f64> = texels.iter().map(|texel| f64::from(*texel) * scale + offset).collect();
    let table: Vec<_> = head.table.iter().map(|entry| entry.map(f64::from)).collect();
    let solid = Solid {
        unit_from_world: world_from_unit.inverse().ok_or_else(|| CommandError::failure("no inverse"))?,
        value: &|unit| trilinear([SIDE as usize; 3], &values, unit).clamp(0.0, 1.0),
        table: &table,
        iso_value: f64::from(head.settings.iso_value),
        clip_planes: &[],
    };
    let voxel = f64::from(head.volume.voxel());
    let reach = f64::from(head.volume.bounds().size().length());
    let list = |chunk: &[Stroke]| -> Vec<bool> {
        let seen = |stroke: &Stroke| {
            let [x, y, z, _] = world_from_unit.apply_point(linear::Vec3::from(stroke.point.to_array()));
            let point = linear::Vec3::new(x, y, z);
            let Some([x, y, _]) = camera.project(point) else { return false };
            let direction = camera.ray([x, y]);
            let distance = (point - camera.origin([x, y])).dot(direction);
            // From two voxels before the point to the other side of the box.
            let steps = (reach.min(distance) / voxel * 2.0) as usize;
            let inside = x.abs() < 1.0 && y.abs() < 1.0;
            inside && (4..steps).all(|i| !solid.holds(point - direction * (i as f64 * 0.5 * voxel)))
        };
        chunk.iter().map(seen).collect()
    };
    let chunks: Vec<&[Stroke]> = strokes.chunks(256).collect();
    Ok(parallel::rows(chunks.len(), |k| list(chunks[k])).into_iter().flatten().collect())
}
