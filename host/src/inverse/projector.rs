// SPDX-License-Identifier: MIT OR Apache-2.0
//! Renders what is solved for, and projects pictures back.

mod collect;
mod forms;
mod scatter;

pub use forms::{Basis, Channels, Collected, Fields, Medium, ProjectorForm, Solved, Transpose};

use super::{InverseError, RaySteps, SliceView};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use collect::Collector;
use scatter::Scatterer;
use wgpu::TextureFormat::{self, R32Float, Rg32Float};

/// Pictures of one view.
pub struct ViewImages {
    view: Buffer,
    size: [u32; 2],
    slices: u32,
    steps: Buffer,
    /// No ray's way in the box is longer, metres.
    longest: f32,
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
    back: Back,
}

/// The transpose.
enum Back {
    Collect(Box<Collector>),
    Scatter(Scatterer),
}

/// Threads of a group along the axes of a picture.
pub(super) const TILE: [u32; 2] = [16, 8];
/// Threads of a group along the axes of a volume.
pub(super) const BRICK: [u32; 3] = [8, 4, 4];

fn compute(gpu: &Gpu, shaders: &Shaders, name: &str, flags: &[(&str, bool)]) -> Result<Pass, InverseError> {
    let definitions = Definitions::new().flags(flags);
    Ok(Pass::compute_with(gpu, shaders, name, &definitions)?)
}

/// Groups of a dispatch over the voxels of a volume.
pub(super) fn bricks(size: [u32; 3]) -> [u32; 3] {
    [0, 1, 2].map(|axis| size[axis].div_ceil(BRICK[axis]))
}

/// Groups of a dispatch over the pixels of a picture.
pub(super) fn tiles([width, height]: [u32; 2]) -> [u32; 3] {
    [width.div_ceil(TILE[0]), height.div_ceil(TILE[1]), 1]
}

impl Projector {
    /// Builds all passes.
    ///
    /// # Errors
    /// [`InverseError::Setting`] for a step of bent rays that is not above 0, [`InverseError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, form: ProjectorForm) -> Result<Self, InverseError> {
        if let Some(step) = form.refraction {
            in_range("step of bent rays", step, f32::MIN_POSITIVE..=f32::MAX, "above 0 metres and finite")?;
        }
        let [emission, albedo] = form.radiance();
        let flags = [
            ("PATHS", form.solved == Solved::Extinction),
            ("EMISSION", emission),
            ("ALBEDO", albedo),
            ("RGB", form.channels == Channels::Rgb),
            ("BOX", form.basis == Basis::Box),
            ("BENT", form.refraction.is_some()),
        ];
        let back = match form.transpose {
            Transpose::Collect if form.refraction.is_none() => {
                Back::Collect(Box::new(Collector::new(gpu, shaders, form)?))
            }
            _ => Back::Scatter(Scatterer::new(gpu, shaders, form)?),
        };
        Ok(Self {
            form,
            spans: compute(gpu, shaders, "inverse/ray_spans", &flags[5..])?,
            render: compute(gpu, shaders, "inverse/render_slices", &flags)?,
            back,
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
    /// surfaces. Of bent rays metres count along the bend.
    ///
    /// # Errors
    /// [`InverseError::Setting`] for steps of bent rays so short that rays may need more than 65536, [`InverseError`].
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
        let (steps, longest) = RaySteps::of_view(view, self.form.refraction)?;
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
            steps: Buffer::uniform(gpu, &steps),
            longest,
            spans,
            rendered: image(),
            through: image(),
        })
    }

    /// Records `W a` of a view; of extinction alone nothing of the medium counts but, with bent rays, its index.
    ///
    /// # Errors
    /// [`InverseError::Index`], [`InverseError::Pass`].
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
        let mut resources: Vec<(&str, Resource<'_>)> = vec![
            ("view", (&view.view).into()),
            ("spans", (&view.spans).into()),
            ("steps", (&view.steps).into()),
            ("rendered", (&view.rendered).into()),
            ("through", (&view.through).into()),
            ("extinction", extinction.into()),
            ("emission", fields.emission.into()),
            ("albedo", fields.albedo.into()),
            ("scattered", (&medium.scattered).into()),
        ];
        if self.form.refraction.is_some() {
            resources.push(("refraction", medium.index.as_ref().ok_or(InverseError::Index)?.into()));
        }
        let bound = self.render.bind_known(gpu, &resources)?;
        Ok(self.render.dispatch_groups(encoder, &bound, "render_slices", tiles(view.size))?)
    }

    /// Records what a picture sends back into the volumes that are solved for, added to what is there: emission, albedo, both in
    /// this order, or extinction. `picture`: of the view's size and the projector's channels.
    ///
    /// # Errors
    /// [`InverseError::Memory`] where rays scatter and sums need too much, [`InverseError::Index`], [`InverseError::Pass`].
    pub fn backproject(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewImages,
        medium: &Medium,
        picture: &Texture,
        collected: &[Collected<'_>],
    ) -> Result<(), InverseError> {
        match &self.back {
            Back::Collect(collector) => {
                collector.backproject(gpu, encoder, (view, medium, picture), collected)
            }
            Back::Scatter(scatterer) => {
                scatterer.backproject(gpu, encoder, (view, medium, picture), collected)
            }
        }
    }
}
