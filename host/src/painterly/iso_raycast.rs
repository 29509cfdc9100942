// SPDX-License-Identifier: MIT OR Apache-2.0
//! Casts view rays at a surface.

use super::{IsoFrame, IsoSettings, IsoSurface, IsoVolume, PainterlyError, SurfaceLighting};
use crate::core::{Camera, Jitter, Transfer, VolumeSpace, blue_noise_texture, brick_count};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use encase::ShaderType;
use wgpu::TextureFormat;

/// What the pass writes and how it marches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct IsoForm {
    /// How starts of steps are spread.
    pub jitter: Jitter,
    /// Bricks in which nothing is solid are passed over, as [`super::SolidBricks`] has last found them.
    pub skipping: bool,
    /// Colours are left unlit, for [`super::Shade`].
    pub deferred: bool,
    /// Nothing but distances.
    pub distance_only: bool,
    /// Principal curvatures as well; without effect with `distance_only`.
    pub curvature: bool,
}

impl IsoForm {
    fn has_curvature(self) -> bool {
        self.curvature && !self.distance_only
    }

    fn definitions(self) -> Definitions {
        let flags = [
            self.jitter.definition(),
            self.skipping.then_some("SKIPPING"),
            self.deferred.then_some("DEFERRED"),
            self.distance_only.then_some("DISTANCE_ONLY"),
            self.has_curvature().then_some("CURVATURE"),
        ];
        flags.into_iter().flatten().fold(Definitions::new(), Definitions::flag)
    }
}

/// What is written of the surface, one texel a ray.
pub struct IsoTargets {
    /// Linear RGB radiance, premultiplied, and 1 where the surface is seen, else 0; rgba16float.
    pub color: Texture,
    /// Unit normal in the world towards the eye's side, and change of the value a voxel; rgba16float, 0 where nothing is seen.
    pub surface: Texture,
    /// Motion of the surface point since the previous frame, pixels, x right, y down; rg16float.
    pub flow: Texture,
    /// Metres along the view ray, negative where nothing is seen; r32float.
    pub distance: Texture,
    /// With [`IsoForm::curvature`] only: principal curvatures, the greater first, 1/m, positive where the surface is convex towards
    /// the eye's side; (cos 2a, sin 2a) of the direction of the greater absolute one, x right, y down, 0 where there is none;
    /// rgba16float.
    pub curvature: Option<Texture>,
}

impl IsoTargets {
    fn new(gpu: &Gpu, size: [u32; 2], curvature: bool) -> Self {
        let target = |format| Texture::target(gpu, size, format);
        Self {
            color: target(TextureFormat::Rgba16Float),
            surface: target(TextureFormat::Rgba16Float),
            flow: target(TextureFormat::Rg16Float),
            distance: target(TextureFormat::R32Float),
            curvature: curvature.then(|| target(TextureFormat::Rgba16Float)),
        }
    }
}

/// Casts view rays at the surface of a volume.
pub struct IsoRaycast {
    pass: Pass,
    form: IsoForm,
    sampler: Sampler,
    blue_noise: Option<Texture>,
}

/// A volume, its transfer function and pictures of it, bound.
pub struct IsoBound {
    bound: Bound,
    camera: Buffer,
    previous_camera: Buffer,
    volume: Buffer,
    surface: Buffer,
    lighting: Buffer,
    brick_distances: Texture,
    /// What is written; of [`IsoForm::distance_only`] the distance alone.
    pub targets: IsoTargets,
}

impl IsoBound {
    /// Uniform of the camera, [`Camera`].
    pub fn camera(&self) -> &Buffer {
        &self.camera
    }

    /// Uniform of [`VolumeSpace`], where the volume lies.
    pub fn volume(&self) -> &Buffer {
        &self.volume
    }

    /// Uniform of [`IsoSurface`].
    pub fn surface(&self) -> &Buffer {
        &self.surface
    }

    /// Of each brick to the nearest in which anything is solid, in bricks, r32uint; what [`super::SolidBricks`] has last found.
    pub fn brick_distances(&self) -> &Texture {
        &self.brick_distances
    }

    /// Uniform of [`SurfaceLighting`].
    pub fn lighting(&self) -> &Buffer {
        &self.lighting
    }
}

impl IsoRaycast {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, form: IsoForm) -> Result<Self, PainterlyError> {
        use TextureFormat as F;
        let all = [F::Rgba16Float, F::Rgba16Float, F::Rg16Float, F::R32Float, F::Rgba16Float];
        let formats: &[F] = match (form.distance_only, form.curvature) {
            (true, _) => &all[3..4],
            (false, true) => &all,
            (false, false) => &all[..4],
        };
        let (name, entry) = ("painterly/iso_raycast", "fragment_iso_raycast");
        let pass = Pass::pictures(gpu, shaders, name, &form.definitions(), entry, formats)?;
        let blue_noise = match form.jitter {
            Jitter::BlueNoise => Some(blue_noise_texture(gpu)?),
            Jitter::None | Jitter::Gradient => None,
        };
        Ok(Self { pass, form, sampler: Sampler::linear(gpu), blue_noise })
    }

    /// Binds a volume, its transfer function and targets of `size`. [`IsoRaycast::set`] tells the rest.
    ///
    /// # Errors
    /// [`PainterlyError`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        volume: &IsoVolume,
        transfer: &Transfer,
        size: [u32; 2],
    ) -> Result<IsoBound, PainterlyError> {
        let limit = gpu.limits.max_texture_dimension_2d;
        if size.iter().any(|side| *side == 0 || *side > limit) {
            return Err(PainterlyError::Size { size, limit });
        }
        let uniform = |bytes: u64| Buffer::storage(gpu, bytes);
        let [camera, previous_camera] = [0; 2].map(|_| uniform(Camera::min_size().get()));
        let space = uniform(VolumeSpace::min_size().get());
        let surface = uniform(IsoSurface::min_size().get());
        let lighting = uniform(SurfaceLighting::min_size().get());
        // A new texture holds zeros, and so passes over nothing.
        let brick_distances = Texture::storage_volume(gpu, brick_count(volume.size), TextureFormat::R32Uint);
        let targets = IsoTargets::new(gpu, size, self.form.has_curvature());
        let mut resources: Vec<(&str, Resource<'_>)> = vec![
            ("camera", (&camera).into()),
            ("previous_camera", (&previous_camera).into()),
            ("volume", (&space).into()),
            ("surface", (&surface).into()),
            ("lighting", (&lighting).into()),
            ("values", (&volume.texture).into()),
            ("transfer", (&transfer.texture).into()),
            ("linear_sampler", (&self.sampler).into()),
            ("brick_distances", (&brick_distances).into()),
        ];
        resources.extend(self.blue_noise.as_ref().map(|tile| ("blue_noise", tile.into())));
        let bound = self.pass.bind_known(gpu, &resources)?;
        let volume = space;
        Ok(IsoBound { bound, camera, previous_camera, volume, surface, lighting, brick_distances, targets })
    }

    /// Says what the next recorded frame shows of `volume`, which was bound.
    ///
    /// # Errors
    /// [`PainterlyError`] for numbers out of range, and for a camera of pictures of another size.
    pub fn set(
        &self,
        gpu: &Gpu,
        bound: &IsoBound,
        volume: &IsoVolume,
        frame: &IsoFrame,
        settings: &IsoSettings,
        lighting: &SurfaceLighting,
    ) -> Result<(), PainterlyError> {
        lighting.check()?;
        let (space, surface) = frame.uniforms(volume, settings)?;
        bound.camera.write(gpu, &frame.camera);
        bound.previous_camera.write(gpu, &frame.previous_camera);
        bound.volume.write(gpu, &space);
        bound.surface.write(gpu, &surface);
        bound.lighting.write(gpu, lighting);
        Ok(())
    }

    /// Records the rays of all texels.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &IsoBound) {
        let targets = &bound.targets;
        let mut all = vec![&targets.color, &targets.surface, &targets.flow, &targets.distance];
        all.extend(&targets.curvature);
        let written = if self.form.distance_only { &all[3..] } else { &all[..] };
        self.pass.fill_all(encoder, &bound.bound, written);
    }
}
