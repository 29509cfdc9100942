// SPDX-License-Identifier: MIT OR Apache-2.0
//! Views, and pictures of a volume as they see it.

use super::error::SolveError;
use super::field::{Field, colours, reduced};
use super::light::Illumination;
use super::views::{LoadedView, ViewDescription, load_view};
use super::volumes::Matter;
use crate::command::CommandError;
use crate::core::Camera;
use crate::inverse::{
    Basis, Channels, Fields, InverseError, LightPasses, Medium, Projector, ProjectorForm, SliceView, Solved,
    meets_volume,
};
use crate::{Gpu, Shaders};
use glam::{Mat4, Vec3};

/// A view, ready to be rendered.
pub struct Seen {
    /// What was read.
    pub loaded: LoadedView,
    /// Its rays.
    pub slices: SliceView,
    /// Radiance behind, as the channels have it.
    pub background: Vec<Vec3>,
    /// What is wanted, as the channels have it; nothing where there is no target.
    pub target: Vec<Vec3>,
    /// How much each pixel counts.
    pub weights: Vec<f32>,
}

impl Seen {
    /// Reads the pictures of a view.
    ///
    /// # Errors
    /// A failure: a file, or a view that misses the volume.
    pub fn new(
        description: &ViewDescription,
        matter: &Matter,
        steps: u32,
        channels: Channels,
    ) -> Result<Self, CommandError> {
        let loaded = load_view(description)?;
        let slices = SliceView::new(&loaded.camera, matter.place, matter.extinction.size, steps)?;
        if !meets_volume(&slices, loaded.depth.as_deref()) {
            let (view, bounds) = (description.name.clone(), matter.bounds());
            return Err(SolveError::Misses { view, low: bounds.min, high: bounds.max }.into());
        }
        let all = |colours: &[Vec3]| colours.iter().map(|colour| reduced(*colour, channels)).collect();
        let background: Vec<Vec3> = all(&loaded.background);
        let target = all(loaded.target.as_deref().unwrap_or_default());
        let weights = loaded.weights.clone().unwrap_or_else(|| vec![1.0; background.len()]);
        Ok(Self { slices, background, target, weights, loaded })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.loaded.description.name
    }

    /// As it is rendered.
    pub fn shot(&self) -> Shot<'_> {
        Shot { slices: &self.slices, depths: self.loaded.depth.as_deref() }
    }
}

/// Rays, and where they end.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    /// The rays.
    pub slices: &'a SliceView,
    /// Metres along each; none where there are no surfaces.
    pub depths: Option<&'a [f32]>,
}

/// What is rendered.
#[derive(Clone)]
pub struct Look {
    /// 1/m.
    pub extinction: Field,
    /// Radiance.
    pub emission: Field,
    /// 0..1.
    pub albedo: Field,
}

/// What a view shows of the volume.
pub struct Picture {
    /// Radiance of the volume.
    pub radiance: Vec<Vec3>,
    /// Transmittance to what lies behind.
    pub through: Vec<Vec3>,
}

impl Picture {
    /// With what lies behind.
    pub fn over(&self, background: &[Vec3]) -> Vec<Vec3> {
        let pixels = self.radiance.iter().zip(&self.through).zip(background);
        pixels.map(|((radiance, through), behind)| radiance + through * behind).collect()
    }
}

/// Where pictures are made.
pub struct Studio<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The shaders.
    pub shaders: &'a Shaders,
    /// Of pictures and volumes.
    pub channels: Channels,
    /// Of emission and albedo.
    pub basis: Basis,
    /// From the box 0..1 to the world, metres.
    pub place: Mat4,
    /// Across the volume.
    pub steps: u32,
    /// What is scattered.
    pub illumination: Illumination,
    /// Lights the volume.
    pub lighting: LightPasses,
    /// Renders all there is.
    pub renderer: Projector,
}

impl<'a> Studio<'a> {
    /// A studio.
    ///
    /// # Errors
    /// [`InverseError::Pass`].
    pub fn new(
        (gpu, shaders): (&'a Gpu, &'a Shaders),
        (channels, basis): (Channels, Basis),
        place: Mat4,
        steps: u32,
        illumination: Illumination,
    ) -> Result<Self, InverseError> {
        let form = ProjectorForm { basis, ..ProjectorForm::new(Solved::Both, channels) };
        let renderer = Projector::new(gpu, shaders, form)?;
        let lighting = LightPasses::new(gpu, shaders, channels)?;
        Ok(Self { gpu, shaders, channels, basis, place, steps, illumination, lighting, renderer })
    }

    /// What is known of a volume, for passes.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn medium(&self, look: &Look) -> Result<Medium, InverseError> {
        let extinction = look.extinction.texture(self.gpu, self.channels)?;
        let passes = (&self.lighting, self.channels);
        let scattered = self.illumination.scattered(self.gpu, passes, (&extinction, self.place))?;
        Ok(Medium { extinction, scattered, index: None })
    }

    /// What does what.
    ///
    /// # Errors
    /// [`InverseError::Pass`].
    pub fn projector(&self, solved: Solved, channels: Channels) -> Result<Projector, InverseError> {
        Projector::new(
            self.gpu,
            self.shaders,
            ProjectorForm { basis: self.basis, ..ProjectorForm::new(solved, channels) },
        )
    }

    /// The rays of a camera.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn rays(&self, camera: &Camera, look: &Look) -> Result<SliceView, InverseError> {
        SliceView::new(camera, self.place, look.extinction.size, self.steps)
    }

    /// Renders.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn pictures(&self, look: &Look, shots: &[Shot<'_>]) -> Result<Vec<Picture>, InverseError> {
        let (gpu, channels) = (self.gpu, self.channels);
        let projector = &self.renderer;
        let medium = self.medium(look)?;
        let [emission, albedo] = [&look.emission, &look.albedo].map(|field| field.texture(gpu, channels));
        let (emission, albedo) = (emission?, albedo?);
        let fields = Fields { emission: &emission, albedo: &albedo, extinction: &medium.extinction };
        let picture = |shot: &Shot<'_>| {
            let view = projector.view(gpu, shot.slices, shot.depths)?;
            let mut encoder = gpu.encoder();
            projector.render(gpu, &mut encoder, &view, &medium, fields)?;
            gpu.submit(encoder)?;
            let [radiance, through] = [&view.rendered, &view.through].map(|image| image.read(gpu));
            Ok(Picture { radiance: colours(&radiance?, channels), through: colours(&through?, channels) })
        };
        shots.iter().map(picture).collect()
    }
}
