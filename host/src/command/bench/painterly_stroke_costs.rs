// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the upkeep of strokes costs over drawing them, and what drawing them costs over plain textured quads.

use super::baselines::with_baselines;
use super::painterly::SYSTEM;
use super::painterly_strokes::{Head, SIZE};
use super::{Quality, Row, Work, figure, interleaved, ratio, time};
use crate::command::CommandError;
use crate::painterly::{
    Brushes, IsoBound, PainterlyStyle, Stroke, StrokeSettings, StrokeStep, StrokeTargets, Strokes,
};
use crate::pass::{Bound, Pass, Render, RenderStages};
use crate::{Buffer, Gpu, Shaders, Texture};
use airlight_tests::error::mean_absolute;
use glam::Vec2;
use std::cell::{Cell, RefCell};

/// Poses of a pendulum, a frame's turn apart: what turns on would need rays in every frame.
const POSES: u32 = 5;
/// Frames in which strokes settle.
const SETTLING: u32 = 40;
/// Samples of each piece of work.
const SAMPLES: usize = 7;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Strokes on a head that swings.
struct Swing<'a> {
    head: &'a Head,
    poses: Vec<IsoBound>,
    strokes: RefCell<Strokes>,
    frame: Cell<u32>,
}

impl<'a> Swing<'a> {
    fn new(gpu: &Gpu, shaders: &Shaders, head: &'a Head) -> Result<Self, CommandError> {
        let brushes = Brushes::procedural(gpu).map_err(CommandError::failure)?;
        let settings = StrokeSettings::new(SIZE, SIZE);
        let strokes = Strokes::new(gpu, shaders, head.style(gpu, shaders)?, brushes, settings);
        let poses: Result<_, _> = (0..POSES).map(|pose| head.cast(gpu, shaders, pose)).collect();
        let swing = Self {
            head,
            poses: poses?,
            strokes: RefCell::new(strokes.map_err(CommandError::failure)?),
            frame: Cell::new(0),
        };
        for _ in 0..SETTLING {
            let mut encoder = gpu.encoder();
            swing.keep_up(gpu, &mut encoder)?;
            gpu.submit(encoder)?;
        }
        Ok(swing)
    }

    /// Records all that a frame does with strokes before they are drawn.
    fn keep_up(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), CommandError> {
        let frame = self.frame.replace(self.frame.get() + 1);
        let period = 2 * (POSES - 1);
        let pose = (frame % period).min(period - frame % period);
        let targets = &self.poses[pose as usize].targets;
        let targets = StrokeTargets {
            color: &targets.color,
            surface: &targets.surface,
            distance: &targets.distance,
            curvature: None,
        };
        let step = StrokeStep {
            camera: self.head.camera,
            world_from_unit: self.head.posed(pose),
            seconds: if frame == 1 { 1.0 } else { 1.0 / 60.0 },
            generation: true,
            deletion: true,
        };
        let mut strokes = self.strokes.borrow_mut();
        strokes.record(gpu, encoder, &targets, &step).map_err(CommandError::failure)
    }
}

/// Every named ratio.
pub(super) fn rows(gpu: &Gpu, shaders: &Shaders, head: &Head) -> Result<Vec<Row>, CommandError> {
    let swing = Swing::new(gpu, shaders, head)?;
    let painted = Texture::target(gpu, SIZE, FORMAT);
    let draw: Work<'_> = &|encoder| {
        clear(encoder, &painted);
        // The only errors are of bindings, which settling would have met.
        let _ = swing.strokes.borrow().draw(gpu, encoder, &painted);
    };
    let quads = Quads::of(gpu, shaders, &swing.strokes.borrow())?;
    let plain = Texture::target(gpu, SIZE, FORMAT);
    let drawn = interleaved(gpu, &[draw, &|encoder| quads.draw(encoder, &plain)], SAMPLES)?;
    let difference = mean_absolute(&painted.read(gpu)?, &plain.read(gpu)?);
    let quality =
        Quality { metric: "mean difference of the two pictures", error: difference, baseline_error: 0.0 };
    let over = ratio(SYSTEM, "draw_over_plain_quads", &drawn[0], &drawn[1], "lower", Some(quality));

    let upkeep: Work<'_> = &|encoder| {
        let _ = swing.keep_up(gpu, encoder);
    };
    let kept = interleaved(gpu, &[upkeep, draw], SAMPLES)?;
    let alive = swing.strokes.borrow().read_counts(gpu).map_err(CommandError::failure)?.instances;
    Ok(vec![
        ratio(SYSTEM, "stroke_upkeep_over_draw", &kept[0], &kept[1], "lower", None),
        over,
        figure(SYSTEM, "strokes_drawn", f64::from(alive), "strokes"),
        time(SYSTEM, "stroke_upkeep", kept[0].clone()),
        time(SYSTEM, "draw_strokes", drawn[0].clone()),
        time(SYSTEM, "plain_quads", drawn[1].clone()),
    ])
}

/// Strokes as plain quads.
struct Quads {
    pass: Pass,
    bound: Bound,
    vertices: Buffer,
    indices: Buffer,
    count: u32,
}

impl Quads {
    fn of(gpu: &Gpu, shaders: &Shaders, strokes: &Strokes) -> Result<Self, CommandError> {
        let composed = with_baselines(shaders)
            .compose_with("baselines/plain_quads", &airlight_validate::Definitions::new())
            .map_err(CommandError::failure)?;
        let attributes =
            wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Float32x4, 3 => Uint32];
        let stages = RenderStages {
            vertex: "vertex_quad",
            fragment: Some("fragment_quad"),
            vertices: Some(wgpu::VertexBufferLayout {
                array_stride: 36,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            }),
            target: Some(FORMAT),
            depth: None,
            samples: 1,
        };
        let over = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;
        let pass = Pass::blended(gpu, &composed, &stages, over, 1)?;
        let brushes = strokes.brushes();
        let bound = pass.bind(
            gpu,
            &[("brushes", (&brushes.texture).into()), ("brush_sampler", (&brushes.sampler).into())],
        )?;
        let list = strokes.read(gpu).map_err(CommandError::failure)?;
        let order = strokes.read_order(gpu).map_err(CommandError::failure)?;
        let (mut vertices, mut indices) = (Vec::<u8>::new(), Vec::<u8>::new());
        for (quad, number) in order.iter().enumerate() {
            for corner in 0..4 {
                vertices.extend(corner_bytes(&list[*number as usize], corner, strokes));
            }
            let corners = [0, 1, 2, 2, 1, 3].map(|corner: u32| 4 * quad as u32 + corner);
            indices.extend(corners.iter().flat_map(|index| index.to_le_bytes()));
        }
        Ok(Self {
            pass,
            bound,
            vertices: Buffer::with_bytes(gpu, &vertices, wgpu::BufferUsages::VERTEX),
            indices: Buffer::with_bytes(gpu, &indices, wgpu::BufferUsages::INDEX),
            count: 6 * order.len() as u32,
        })
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, target: &Texture) {
        clear(encoder, target);
        let mut render = Render::onto(encoder, target, wgpu::LoadOp::Load);
        render.set(&self.pass, &self.bound);
        render.set_mesh(&self.vertices, &self.indices);
        render.draw_indexed(0..self.count, 0..1);
    }
}

/// Place, texture coordinates, tint and brush of a corner of a stroke, as `painterly/draw_strokes` finds them.
fn corner_bytes(stroke: &Stroke, corner: u32, strokes: &Strokes) -> Vec<u8> {
    let style: &PainterlyStyle = strokes.style();
    let side = Vec2::new((corner & 1) as f32, (corner >> 1) as f32) - 0.5;
    let along = Vec2::from_angle(stroke.orientation);
    let offset = stroke.size * (side.x * along + stroke.aspect * side.y * along.perp());
    let picture = Vec2::from(SIZE.map(|side| side as f32));
    let place = (stroke.position + offset / picture) * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
    let mirrored = corner ^ (stroke.hash >> 30);
    let coordinates = Vec2::new((mirrored & 1) as f32, ((mirrored >> 1) & 1) as f32);
    let tint = stroke.color * (1.0 + style.color_variation * own_variation(stroke.hash)) * stroke.opacity;
    let count = strokes.brushes().count();
    let brush = style.layers()[stroke.layer as usize].brush.unwrap_or((stroke.hash & 0xffff) % count);
    let numbers = [place.x, place.y, coordinates.x, coordinates.y, tint.x, tint.y, tint.z, stroke.opacity];
    numbers.iter().flat_map(|number| number.to_le_bytes()).chain(brush.to_le_bytes()).collect()
}

/// The number that varies a stroke's tint, -1..1: PCG3D of its hash.
fn own_variation(hash: u32) -> f32 {
    let step = |value: u32| value.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let [mut x, mut y, mut z] = [hash, 1, 0].map(step);
    for round in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        if round == 0 {
            [x, y, z] = [x, y, z].map(|value| value ^ (value >> 16));
        }
    }
    2.0 * ((x >> 8) as f32 / 16_777_216.0) - 1.0
}

fn clear(encoder: &mut wgpu::CommandEncoder, target: &Texture) {
    drop(Render::onto(encoder, target, wgpu::LoadOp::Clear(wgpu::Color::WHITE)));
}
