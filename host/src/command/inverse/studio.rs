// SPDX-License-Identifier: MIT OR Apache-2.0
//! Views, and pictures of a volume as they see it.

use super::discs::LitDiscs;
use super::error::SolveError;
use super::field::{Field, colours, reduced};
use super::light::{Illumination, Lights, as_channels};
use super::refraction::Refraction;
use super::views::{LoadedView, ViewDescription, load_view};
use super::volumes::Matter;
use crate::command::CommandError;
use crate::core::Camera;
use crate::inverse::{
    Basis, Channels, Fields, InverseError, LightMaps, LightPasses, Medium, Projector, ProjectorForm,
    SliceView, Solved, meets_volume,
};
use crate::{Gpu, Shaders, Texture};
use glam::{Mat4, Vec3};
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

/// Most voxels of scattered light along the longest side where none are asked for.
const LIGHT_VOXELS: u32 = 128;
/// The same of discs, whose light is soft.
const DISC_VOXELS: u32 = 32;

/// Most lights of which each shadow is seen.
const FEW: usize = 8;

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
    /// Which of the lights it is seen in.
    pub light: usize,
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
        light: usize,
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
        Ok(Self { slices, background, target, weights, light, loaded })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.loaded.description.name
    }

    /// As it is rendered.
    pub fn shot(&self) -> Shot<'_> {
        Shot { slices: &self.slices, depths: self.loaded.depth.as_deref(), light: self.light }
    }
}

/// Rays, and where they end.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    /// The rays.
    pub slices: &'a SliceView,
    /// Metres along each; none where there are no surfaces.
    pub depths: Option<&'a [f32]>,
    /// Which of the lights.
    pub light: usize,
}

/// What is rendered.
#[derive(Clone)]
pub struct Look {
    /// 1/m.
    pub extinction: Arc<Field>,
    /// Radiance.
    pub emission: Field,
    /// 0..1.
    pub albedo: Field,
    /// Where light comes from, which views have a number of.
    pub lights: Vec<Arc<Illumination>>,
}

impl Look {
    /// A volume as it was read, in all lights.
    pub fn of(matter: &Matter, lights: &Lights) -> Self {
        Self {
            extinction: Arc::new(matter.extinction.clone()),
            emission: matter.emission.clone(),
            albedo: matter.albedo.clone(),
            lights: lights.all.clone(),
        }
    }

    /// Straight between this and another, `part` of it, 0 to 1, in the light of this one.
    pub fn blended(&self, other: &Self, part: f32) -> Self {
        Self {
            extinction: Arc::new(self.extinction.blended(&other.extinction, part)),
            emission: self.emission.blended(&other.emission, part),
            albedo: self.albedo.blended(&other.albedo, part),
            lights: self.lights.clone(),
        }
    }

    /// Light that was solved for.
    pub fn found(&self) -> Option<&LitDiscs> {
        match self.lights.first().map(Arc::as_ref) {
            Some(Illumination::Discs(discs)) => Some(discs),
            _ => None,
        }
    }
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

/// What rays there are, and how finely light is scattered.
pub struct Setting<'a> {
    /// From the box 0..1 to the world, metres.
    pub place: Mat4,
    /// Across the volume.
    pub steps: u32,
    /// What bends rays.
    pub refraction: Option<&'a Refraction>,
    /// Voxels of scattered light along the longest side, where it is said.
    pub light_resolution: Option<u32>,
}

/// Where pictures are made.
pub struct Studio<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The shaders.
    pub shaders: &'a Shaders,
    /// Of pictures and volumes.
    pub channels: Channels,
    /// From the box 0..1 to the world, metres.
    pub place: Mat4,
    /// Index of refraction, where rays are bent.
    pub index: Option<Texture>,
    steps: u32,
    light_resolution: Option<u32>,
    form: ProjectorForm,
    lighting: LightPasses,
    soft: OnceCell<LightPasses>,
    renderer: Projector,
    kept: RefCell<Vec<Kept>>,
}

/// What was made of a volume in a light: lights are many, and the same ones are asked for again.
struct Kept {
    extinction: Arc<Field>,
    light: Arc<Illumination>,
    medium: Arc<Medium>,
}

impl<'a> Studio<'a> {
    /// A studio.
    ///
    /// # Errors
    /// [`InverseError`]: a step of bent rays that is impossible, passes that cannot be made.
    pub fn new(
        (gpu, shaders): (&'a Gpu, &'a Shaders),
        (channels, basis): (Channels, Basis),
        setting: &Setting<'_>,
    ) -> Result<Self, InverseError> {
        let &Setting { place, steps, refraction, light_resolution } = setting;
        let form = ProjectorForm {
            basis,
            refraction: refraction.map(|refraction| refraction.step),
            ..ProjectorForm::new(Solved::Both, channels)
        };
        let index = refraction.map(|refraction| refraction.index.texture(gpu, Channels::One)).transpose()?;
        let renderer = Projector::new(gpu, shaders, form)?;
        let lighting = LightPasses::new(gpu, shaders, channels)?;
        let (soft, kept) = (OnceCell::new(), RefCell::new(Vec::new()));
        Ok(Self {
            gpu,
            shaders,
            channels,
            place,
            index,
            steps,
            light_resolution,
            form,
            lighting,
            soft,
            renderer,
            kept,
        })
    }

    /// What is known of a volume in one of its lights, for passes.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn medium(&self, look: &Look, light: usize) -> Result<Arc<Medium>, InverseError> {
        let light = look.lights.get(light).cloned().unwrap_or_else(Illumination::dark);
        let mut kept = self.kept.borrow_mut();
        kept.retain(|own| Arc::ptr_eq(&own.extinction, &look.extinction));
        if let Some(own) = kept.iter().find(|own| Arc::ptr_eq(&own.light, &light)) {
            return Ok(Arc::clone(&own.medium));
        }
        let extinction = match kept.first() {
            Some(own) => own.medium.extinction.clone(),
            None => look.extinction.texture(self.gpu, self.channels)?,
        };
        let scattered = self.scattered(&light, &extinction)?;
        let medium = Arc::new(Medium { extinction, scattered, index: self.index.clone() });
        if kept.len() > look.lights.len() + 1 {
            kept.remove(0);
        }
        let extinction = Arc::clone(&look.extinction);
        kept.push(Kept { extinction, light, medium: Arc::clone(&medium) });
        Ok(medium)
    }

    /// The radiance that an albedo of 1 scatters towards the eye; the phase function is isotropic. `extinction`: 1/m.
    fn scattered(&self, light: &Illumination, extinction: &Texture) -> Result<Texture, InverseError> {
        let Self { gpu, channels, place, .. } = *self;
        let (passes, lights, most) = match light {
            Illumination::Ambient(radiance) => {
                return Ok(Field::constant(reduced(*radiance, channels)).texture(gpu, channels)?);
            }
            Illumination::Lights(lights) => {
                let passes = if lights.len() > FEW { self.soft_passes()? } else { &self.lighting };
                (passes, as_channels(lights, channels), LIGHT_VOXELS)
            }
            Illumination::Discs(discs) => {
                (self.soft_passes()?, as_channels(&discs.lights(), channels), DISC_VOXELS)
            }
        };
        let size = coarser(extinction.size(), self.light_resolution.unwrap_or(most));
        passes.scattered(gpu, extinction, place, size, &lights, None)
    }

    /// The same of each disc, for a radiance of 1.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn disc_volumes(&self, discs: &LitDiscs, extinction: &Texture) -> Result<Vec<Texture>, InverseError> {
        let size = coarser(extinction.size(), self.light_resolution.unwrap_or(DISC_VOXELS));
        self.soft_passes()?.scattered_each(self.gpu, extinction, self.place, size, &discs.groups(), None)
    }

    /// The shadows of many lights are soft, which needs no fine maps: two texels and layers a voxel of light.
    fn soft_passes(&self) -> Result<&LightPasses, InverseError> {
        if let Some(passes) = self.soft.get() {
            return Ok(passes);
        }
        let texels = (2 * self.light_resolution.unwrap_or(DISC_VOXELS)).clamp(32, 192);
        let maps = LightMaps { texels, layers: texels, shadow_texels: 4 };
        let passes = LightPasses::new(self.gpu, self.shaders, self.channels)?.with_maps(maps)?;
        Ok(self.soft.get_or_init(|| passes))
    }

    /// What does what.
    ///
    /// # Errors
    /// [`InverseError::Pass`].
    pub fn projector(&self, solved: Solved, channels: Channels) -> Result<Projector, InverseError> {
        Projector::new(self.gpu, self.shaders, ProjectorForm { solved, channels, ..self.form })
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
        let [emission, albedo] = [&look.emission, &look.albedo].map(|field| field.texture(gpu, channels));
        let (emission, albedo) = (emission?, albedo?);
        let picture = |shot: &Shot<'_>| {
            let medium = self.medium(look, shot.light)?;
            let fields = Fields { emission: &emission, albedo: &albedo, extinction: &medium.extinction };
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

/// Voxels of a volume with at most so many along its longest side.
fn coarser(size: [u32; 3], most: u32) -> [u32; 3] {
    let longest = size.into_iter().max().unwrap_or(1);
    if longest <= most { size } else { size.map(|side| (side * most).div_ceil(longest)) }
}
