// SPDX-License-Identifier: MIT OR Apache-2.0
//! Renders what is solved for, and projects pictures back.

use super::{InverseError, PictureRows, SliceView, VoxelGrid};
use crate::gpu::Gpu;
use crate::pass::{Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use glam::UVec3;
use std::sync::{Mutex, PoisonError};
use wgpu::TextureFormat::{self, R32Float, Rg32Float, Rgba32Float};

/// What is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solved {
    /// Emission: radiance of a medium so thick that nothing shines through.
    Emission,
    /// Albedo, 0..1.
    Albedo,
    /// Emission and albedo.
    Both,
    /// Extinction, 1/m, from optical depths.
    Extinction,
}

/// How many channels pictures and volumes have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channels {
    /// One.
    One,
    /// Linear RGB, each by itself; texels have a fourth that is not used.
    Rgb,
}

impl Channels {
    /// Numbers a voxel or a pixel in textures and buffers.
    pub fn numbers(self) -> usize {
        match self {
            Self::One => 1,
            Self::Rgb => 4,
        }
    }

    /// Numbers of them that mean something.
    pub(super) fn used(self) -> usize {
        match self {
            Self::One => 1,
            Self::Rgb => 3,
        }
    }

    /// Of textures.
    pub(super) fn format(self) -> TextureFormat {
        match self {
            Self::One => R32Float,
            Self::Rgb => Rgba32Float,
        }
    }
}

/// Basis functions of what is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// Straight between the middles of voxels.
    Triangle,
    /// Constant in each voxel.
    Box,
}

/// What a projector does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProjectorForm {
    /// What is solved for.
    pub solved: Solved,
    /// Of pictures and volumes.
    pub channels: Channels,
    /// Of what is solved for.
    pub basis: Basis,
}

/// What is known of the medium, as one view sees it.
pub struct Medium {
    /// 1/m; 3D, of the projector's channels.
    pub extinction: Texture,
    /// Radiance that an albedo of 1 scatters towards the eye, likewise; black where light does not matter.
    pub scattered: Texture,
}

/// Volumes that are rendered; those that are not solved for may be any.
#[derive(Clone, Copy)]
pub struct Fields<'a> {
    /// Radiance.
    pub emission: &'a Texture,
    /// 0..1.
    pub albedo: &'a Texture,
    /// 1/m.
    pub extinction: &'a Texture,
}

/// What is collected from pictures, of one volume that is solved for.
#[derive(Clone, Copy)]
pub struct Collected<'a> {
    /// Voxels along x, y and z.
    pub grid: [u32; 3],
    /// A number a voxel, 0 where it is not solved for, x fastest.
    pub wanted: &'a Buffer,
    /// Numbers of the projector's channels a voxel, to which is added.
    pub sums: &'a Buffer,
}

/// Pictures of one view.
pub struct ViewImages {
    view: Buffer,
    size: [u32; 2],
    slices: u32,
    spans: Texture,
    /// `W a`: radiance, or optical depth.
    pub rendered: Texture,
    /// Transmittance to what lies behind; of extinction alone it stays as it is.
    pub through: Texture,
}

impl ViewImages {
    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }
}

/// Renders and projects back.
pub struct Projector {
    form: ProjectorForm,
    spans: Pass,
    render: Pass,
    /// Of emission, of albedo, of both in this order, or of extinction.
    weigh: Vec<Pass>,
    collect: Pass,
    steps: Mutex<Option<Texture>>,
    /// Bytes of weighed steps in one piece at most.
    piece: u64,
}

/// Threads of a group along the axes of a picture.
pub(super) const TILE: [u32; 2] = [16, 8];
/// Threads of a group along the axes of a volume.
pub(super) const BRICK: [u32; 3] = [8, 4, 4];

pub(super) fn tiles([width, height]: [u32; 2]) -> [u32; 3] {
    [width.div_ceil(TILE[0]), height.div_ceil(TILE[1]), 1]
}

impl Projector {
    /// Builds all passes.
    ///
    /// # Errors
    /// [`InverseError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, form: ProjectorForm) -> Result<Self, InverseError> {
        let ProjectorForm { solved, channels, basis } = form;
        let pass = |name: &str, flags: &[(&str, bool)]| {
            let flags = flags.iter().filter(|(_, set)| *set);
            let definitions = flags.fold(Definitions::new(), |all, (flag, _)| all.flag(*flag));
            Pass::compute_with(gpu, shaders, name, &definitions)
        };
        let [emission, albedo] =
            [Solved::Emission, Solved::Albedo].map(|own| solved == own || solved == Solved::Both);
        let paths = solved == Solved::Extinction;
        let rgb = ("RGB", channels == Channels::Rgb);
        let boxes = ("BOX", basis == Basis::Box);
        let weigh = [("EMISSION", emission), ("ALBEDO", albedo), ("PATHS", paths)];
        let weigh = weigh.iter().filter(|(_, wanted)| *wanted);
        let weigh = weigh.map(|(name, _)| pass("inverse/weigh_slices", &[rgb, (name, *name != "EMISSION")]));
        Ok(Self {
            form,
            spans: pass("inverse/ray_spans", &[])?,
            render: pass(
                "inverse/render_slices",
                &[("PATHS", paths), ("EMISSION", emission), ("ALBEDO", albedo), rgb, boxes],
            )?,
            weigh: weigh.collect::<Result<_, _>>()?,
            collect: pass("inverse/cg_backproject", &[("PATHS", paths), rgb, boxes])?,
            steps: Mutex::new(None),
            piece: gpu.limits.max_storage_buffer_binding_size,
        })
    }

    /// What it solves for.
    pub fn solved(&self) -> Solved {
        self.form.solved
    }

    /// Of pictures and volumes.
    pub fn channels(&self) -> Channels {
        self.form.channels
    }

    /// Of textures of pictures and volumes.
    pub(super) fn format(&self) -> TextureFormat {
        self.form.channels.format()
    }

    /// Of passes that have as many channels.
    pub(super) fn definitions(&self) -> Definitions {
        match self.form.channels {
            Channels::One => Definitions::new(),
            Channels::Rgb => Definitions::new().flag("RGB"),
        }
    }

    /// Pictures of a view. `depths`: metres along each view ray to the first surface, row after row; none where there are no
    /// surfaces.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn view(
        &self,
        gpu: &Gpu,
        view: &SliceView,
        depths: Option<&[f32]>,
    ) -> Result<ViewImages, InverseError> {
        let size = [view.width, view.height];
        let needed = size[0] as usize * size[1] as usize;
        let surfaces = match depths {
            Some(depths) if depths.len() != needed => {
                return Err(InverseError::Count { name: "depths of a view", needed, given: depths.len() });
            }
            Some(depths) => {
                let texture = Texture::storage(gpu, size, R32Float);
                texture.write(gpu, depths)?;
                texture
            }
            None => {
                let texture = Texture::storage(gpu, [1, 1], R32Float);
                texture.write(gpu, &[f32::MAX])?;
                texture
            }
        };
        // Rays that end at surfaces do so anywhere.
        let margin = if depths.is_some() { f32::MAX } else { view.margin };
        let uniform = Buffer::uniform(gpu, &SliceView { margin, ..*view });
        let spans = Texture::storage(gpu, size, Rg32Float);
        let bound = self.spans.bind(
            gpu,
            &[("view", (&uniform).into()), ("depths", (&surfaces).into()), ("spans", (&spans).into())],
        )?;
        let mut encoder = gpu.encoder();
        self.spans.dispatch_groups(&mut encoder, &bound, "ray_spans", tiles(size))?;
        gpu.submit(encoder)?;
        let image = || Texture::storage(gpu, size, self.form.channels.format());
        Ok(ViewImages {
            view: uniform,
            size,
            slices: view.slices,
            spans,
            rendered: image(),
            through: image(),
        })
    }

    /// Records `W a` of a view; of extinction alone nothing of the medium counts.
    ///
    /// # Errors
    /// [`InverseError::Pass`].
    pub fn render(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewImages,
        medium: &Medium,
        fields: Fields<'_>,
    ) -> Result<(), InverseError> {
        let extinction =
            if self.form.solved == Solved::Extinction { fields.extinction } else { &medium.extinction };
        let resources: [(&str, Resource<'_>); 8] = [
            ("view", (&view.view).into()),
            ("spans", (&view.spans).into()),
            ("rendered", (&view.rendered).into()),
            ("through", (&view.through).into()),
            ("extinction", extinction.into()),
            ("emission", fields.emission.into()),
            ("albedo", fields.albedo.into()),
            ("scattered", (&medium.scattered).into()),
        ];
        let bound = self.render.bind_known(gpu, &resources)?;
        Ok(self.render.dispatch_groups(encoder, &bound, "render_slices", tiles(view.size))?)
    }

    /// Where the weighed steps of a view go: the same for all views of a size, so that many of them need no more memory than one.
    fn steps(&self, gpu: &Gpu, size: [u32; 3]) -> Texture {
        let mut kept = self.steps.lock().unwrap_or_else(PoisonError::into_inner);
        match &*kept {
            Some(steps) if steps.size() == size => steps.clone(),
            _ => {
                let steps = Texture::storage_volume(gpu, size, self.form.channels.format());
                kept.insert(steps).clone()
            }
        }
    }

    /// Records what a picture sends back into the volumes that are solved for, added to what is there: emission, albedo, both in
    /// this order, or extinction. `picture`: of the view's size and the projector's channels.
    ///
    /// # Errors
    /// [`InverseError::Pass`].
    pub fn backproject(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewImages,
        medium: &Medium,
        picture: &Texture,
        collected: &[Collected<'_>],
    ) -> Result<(), InverseError> {
        let paths = self.form.solved == Solved::Extinction;
        // Of paths one slice stands for all.
        let slices = if paths { 1 } else { view.slices };
        let [width, height] = view.size;
        let row = u64::from(width) * u64::from(slices) * 4 * self.form.channels.numbers() as u64;
        let together = (self.piece / row.max(1)).clamp(1, u64::from(height)) as u32;
        let weighed = self.steps(gpu, [width, together, slices]);
        for (weigh, part) in self.weigh.iter().zip(collected) {
            let size = part.grid;
            let grid = Buffer::uniform(gpu, &VoxelGrid { size: UVec3::from(size), reserved_a: 0 });
            let groups = [0, 1, 2].map(|axis| size[axis].div_ceil(BRICK[axis]));
            for first in (0..height).step_by(together as usize) {
                let count = together.min(height - first);
                let rows = Buffer::uniform(gpu, &PictureRows { first, count, reserved_a: 0, reserved_b: 0 });
                let resources: [(&str, Resource<'_>); 10] = [
                    ("view", (&view.view).into()),
                    ("spans", (&view.spans).into()),
                    ("rows", (&rows).into()),
                    ("grid", (&grid).into()),
                    ("picture", picture.into()),
                    ("extinction", (&medium.extinction).into()),
                    ("scattered", (&medium.scattered).into()),
                    ("weighed", (&weighed).into()),
                    ("solved", part.wanted.into()),
                    ("collected", part.sums.into()),
                ];
                let bound = weigh.bind_known(gpu, &resources)?;
                weigh.dispatch_groups(encoder, &bound, "weigh_slices", tiles([width, count]))?;
                let bound = self.collect.bind_known(gpu, &resources)?;
                self.collect.dispatch_groups(encoder, &bound, "cg_backproject", groups)?;
            }
        }
        Ok(())
    }
}
