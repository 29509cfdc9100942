// SPDX-License-Identifier: MIT OR Apache-2.0
//! What `airlight bench inverse` renders, projects back and solves for.

use crate::command::CommandError;
use crate::core::{Camera, DepthRange, PerspectiveView};
use crate::data::cloud;
use crate::inverse::{
    Basis, Channels, Collected, Fields, InverseError, Medium, Projector, ProjectorForm, Regulariser,
    SliceView, Solved, Solver, Target, Transpose, Unknown, ViewImages,
};
use crate::{Buffer, Gpu, Shaders, Texture};
use glam::{Mat4, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;
use wgpu::TextureFormat::R32Float;

/// What a scene is of.
#[derive(Clone, Copy)]
pub(super) struct Size {
    /// Voxels along each side of the cloud and of what is solved for.
    pub(super) voxels: u32,
    /// How many views.
    pub(super) views: u32,
    /// Columns and rows of each.
    pub(super) pixels: u32,
    /// Slices across the axis of a view.
    pub(super) slices: u32,
}

/// A cloud in a cube of 2 m, seen from all around; one channel.
pub(super) struct Scene {
    pub(super) size: Size,
    form: ProjectorForm,
    pub(super) projector: Projector,
    pub(super) views: Vec<ViewImages>,
    medium: Arc<Medium>,
    /// What is rendered: a ramp across the cube.
    field: Texture,
    picture: Texture,
    solved: Buffer,
    pub(super) collected: Buffer,
    touched: Vec<bool>,
}

fn volume(gpu: &Gpu, side: u32, values: &[f32]) -> Result<Texture, CommandError> {
    let texture = Texture::volume(gpu, [side; 3], R32Float);
    texture.write(gpu, values)?;
    Ok(texture)
}

/// Numbers from 0 to 1 that look random and are always the same.
fn scattered_numbers(count: usize) -> Vec<f32> {
    (0..count as u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0).collect()
}

impl Scene {
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        size: Size,
        (solved, transpose): (Solved, Transpose),
    ) -> Result<Self, CommandError> {
        let (channels, basis) = (Channels::One, Basis::Triangle);
        let form = ProjectorForm { solved, channels, basis, transpose, refraction: None };
        let projector = Projector::new(gpu, shaders, form).map_err(CommandError::failure)?;
        let Size { voxels, views, pixels, slices } = size;
        let cloud = cloud([voxels; 3], 5);
        let extinction: Vec<f32> = cloud.values.iter().map(|density| 6.0 * density).collect();
        let placed = Mat4::from_scale(Vec3::splat(2.0)) * Mat4::from_translation(Vec3::splat(-0.5));
        let images = (0..views).map(|view| {
            let camera = camera(view, views, pixels)?;
            let view = SliceView::new(&camera, placed, [voxels; 3], slices).map_err(CommandError::failure)?;
            projector.view(gpu, &view, None).map_err(CommandError::failure)
        });
        let views = images.collect::<Result<_, CommandError>>()?;
        let medium = Medium {
            extinction: volume(gpu, voxels, &extinction)?,
            scattered: volume(gpu, 1, &[1.0])?,
            index: None,
        };
        let count = extinction.len();
        let picture = Texture::storage(gpu, [pixels; 2], R32Float);
        picture.write(gpu, &scattered_numbers((pixels * pixels) as usize))?;
        Ok(Self {
            size,
            form,
            projector,
            views,
            medium: Arc::new(medium),
            field: volume(gpu, voxels, &scattered_numbers(count))?,
            picture,
            solved: Buffer::of_floats(gpu, &vec![1.0; count]),
            collected: Buffer::of_floats(gpu, &vec![0.0; count]),
            // What is rendered fills the cube; emission shows where there is a medium, extinction everywhere.
            touched: extinction.iter().map(|value| solved == Solved::Extinction || *value > 0.0).collect(),
        })
    }

    /// Records all views.
    pub(super) fn render(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), InverseError> {
        let fields = Fields { emission: &self.field, albedo: &self.field, extinction: &self.field };
        let render = |view| self.projector.render(gpu, encoder, view, &self.medium, fields);
        self.views.iter().try_for_each(render)
    }

    /// Records the back-projection of a picture from every view, into all voxels.
    pub(super) fn backproject(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), InverseError> {
        let size = [self.size.voxels; 3];
        let collected = [Collected { grid: size, wanted: &self.solved, sums: &self.collected }];
        let project =
            |view| self.projector.backproject(gpu, encoder, view, &self.medium, &self.picture, &collected);
        self.views.iter().try_for_each(project)
    }

    /// |<Wx, y> - <x, W'y>| of |Wx| |y|, for what is rendered and projected back.
    pub(super) fn mismatch(&self, gpu: &Gpu) -> Result<f64, CommandError> {
        let mut encoder = gpu.encoder();
        encoder.clear_buffer(&self.collected.raw, 0, None);
        self.render(gpu, &mut encoder).map_err(CommandError::failure)?;
        self.backproject(gpu, &mut encoder).map_err(CommandError::failure)?;
        gpu.submit(encoder)?;
        let product = |a: &[f32], b: &[f32]| -> f64 {
            a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
        };
        let sent = self.picture.read(gpu)?;
        let mut sums = [0.0; 2];
        for view in &self.views {
            let rendered = view.rendered.read(gpu)?;
            sums[0] += product(&rendered, &sent);
            sums[1] += product(&rendered, &rendered);
        }
        let back = product(&self.field.read(gpu)?, &self.collected.read_floats(gpu)?);
        let length = (sums[1] * product(&sent, &sent) * self.views.len() as f64).sqrt();
        Ok((sums[0] - back).abs() / length)
    }

    /// Conjugate gradients towards the pictures of what is rendered.
    pub(super) fn solver(self, gpu: &Gpu, shaders: &Shaders) -> Result<Solver, CommandError> {
        let mut encoder = gpu.encoder();
        self.render(gpu, &mut encoder).map_err(CommandError::failure)?;
        gpu.submit(encoder)?;
        let pixels = (self.size.pixels * self.size.pixels) as usize;
        let target = |view: ViewImages| -> Result<Target, CommandError> {
            let wanted = view.rendered.read(gpu)?;
            Ok(Target { view, medium: Arc::clone(&self.medium), wanted, weights: vec![1.0; pixels] })
        };
        let targets = self.views.into_iter().map(target).collect::<Result<_, _>>()?;
        let unknown = Unknown {
            size: [self.size.voxels; 3],
            start: vec![0.0; self.touched.len()],
            solved: self.touched,
            high: f32::MAX,
            regulariser: Regulariser { laplacian: 0.002, ..Regulariser::default() },
        };
        let projector = Projector::new(gpu, shaders, self.form).map_err(CommandError::failure)?;
        Solver::new(gpu, shaders, projector, targets, &[unknown]).map_err(CommandError::failure)
    }
}

/// One of several cameras around the cube, each a little higher than the one before.
fn camera(view: u32, views: u32, pixels: u32) -> Result<Camera, CommandError> {
    let turn = TAU * view as f32 / views as f32;
    let height = 2.4 * ((view as f32 + 0.5) / views as f32 - 0.5);
    let view = PerspectiveView {
        eye: Vec3::new(4.2 * turn.cos(), height, 4.2 * turn.sin()),
        target: Vec3::ZERO,
        field_of_view: 36.0,
        near: 0.1,
        far: 20.0,
        depth: DepthRange::Forward,
    };
    Camera::new(&view.into(), [pixels; 2]).map_err(CommandError::failure)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn what_is_measured_is_a_pair_that_solves() {
        let gpu = pollster::block_on(Gpu::new()).unwrap();
        let shaders = Shaders::builtin();
        let size = Size { voxels: 16, views: 3, pixels: 24, slices: 24 };
        for solved in [
            (Solved::Emission, Transpose::Collect),
            (Solved::Extinction, Transpose::Collect),
            (Solved::Emission, Transpose::FixedPoint),
            (Solved::Emission, Transpose::Swap),
        ] {
            let scene = Scene::new(&gpu, &shaders, size, solved).unwrap();
            let mismatch = scene.mismatch(&gpu).unwrap();
            assert!(mismatch < 1e-5, "{mismatch}");
            let mut solver = scene.solver(&gpu, &shaders).unwrap();
            for _ in 0..6 {
                solver.iterate(&gpu).unwrap();
            }
            let residuals = solver.residuals(&gpu).unwrap();
            assert!(residuals[5][0] < 0.05 * residuals[0][0], "{residuals:?}");
        }
    }
}
