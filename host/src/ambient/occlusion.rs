// SPDX-License-Identifier: MIT OR Apache-2.0
//! Openness and bent normals of a picture.

use super::{AmbientError, BentBlur, OcclusionSettings};
use crate::core::Camera;
use crate::gpu::Gpu;
use crate::pass::{Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::TextureFormat::{R32Float, Rgba16Float};

/// How directions are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// A 2D pattern on a disc across the normal: Crytek 2D.
    Disc,
    /// A 3D pattern, marched: Crytek 3D.
    Hemisphere,
    /// Horizons of directions across the normal: HBAO.
    Horizon,
    /// A bit a sector of slices through the view direction.
    Bitmask,
}

/// What is blurred.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blurring {
    /// Nothing.
    Off,
    /// How bent normals differ from normals.
    Difference,
    /// Bent normals themselves.
    Plain,
}

/// How bent normals are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BentForm {
    /// How directions are looked at.
    pub sampling: Sampling,
    /// What is blurred.
    pub blurring: Blurring,
    /// Only openness, without bent normals.
    pub occlusion_only: bool,
    /// At half the resolution, then made whole; not with `occlusion_only`.
    pub halved: bool,
}

/// What is seen, as an engine has it.
#[derive(Clone, Copy)]
pub struct SurfaceImages<'a> {
    /// The camera; its viewport is the size of both pictures.
    pub camera: &'a Camera,
    /// Depth, a depth format or r32float.
    pub depth: &'a Texture,
    /// Unit normals in the world, any float format.
    pub normals: &'a Texture,
}

impl SurfaceImages<'_> {
    /// Records a pass over a picture of `size`, with what is seen and what else it wants.
    pub(crate) fn dispatch(
        self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        pass: &Pass,
        size: [u32; 2],
        more: &[(&str, Resource<'_>)],
    ) -> Result<(), AmbientError> {
        let camera = Buffer::uniform(gpu, self.camera);
        let mut resources: Vec<(&str, Resource<'_>)> = vec![
            ("camera", (&camera).into()),
            ("depth", self.depth.into()),
            ("normals", self.normals.into()),
        ];
        resources.extend_from_slice(more);
        let bound = pass.bind(gpu, &resources)?;
        pass.dispatch(encoder, &bound, [size[0], size[1], 1]);
        Ok(())
    }
}

/// Finds bent normals.
pub struct BentPasses {
    form: BentForm,
    occlude: Pass,
    blur: Pass,
    halve: Pass,
    upsample: Pass,
}

impl BentPasses {
    /// Composes the passes.
    ///
    /// # Errors
    /// [`AmbientError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, form: BentForm) -> Result<Self, AmbientError> {
        let pass = |name: &str, flags: &[(&str, bool)]| {
            Pass::compute_with(gpu, shaders, name, &Definitions::new().flags(flags))
        };
        let only = ("OCCLUSION_ONLY", form.occlusion_only);
        Ok(Self {
            form,
            occlude: pass(
                "ambient/occlude",
                &[
                    ("DISC", form.sampling == Sampling::Disc),
                    ("HORIZON", form.sampling == Sampling::Horizon),
                    ("BITMASK", form.sampling == Sampling::Bitmask),
                    only,
                ],
            )?,
            blur: pass("ambient/blur_bent", &[("PLAIN", form.blurring == Blurring::Plain), only])?,
            halve: pass("ambient/halve_geometry", &[])?,
            upsample: pass("ambient/upsample_bent", &[])?,
        })
    }

    /// Records what is found: rgba16float, the mean direction in the world, whose length is about 1/2 where all is open, and openness in
    /// alpha; with `occlusion_only` r32float, openness.
    ///
    /// # Errors
    /// [`AmbientError::Setting`], [`AmbientError::Pass`].
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        seen: SurfaceImages<'_>,
        settings: &OcclusionSettings,
    ) -> Result<Texture, AmbientError> {
        settings.check()?;
        if !self.form.halved || self.form.occlusion_only {
            return self.found(gpu, encoder, seen, settings);
        }
        let [width, height, _] = seen.depth.size();
        let size = [width.div_ceil(2), height.div_ceil(2)];
        let depth = Texture::storage(gpu, size, R32Float);
        let normals = Texture::storage(gpu, size, Rgba16Float);
        let resources = [("halved_depth", (&depth).into()), ("halved_normals", (&normals).into())];
        seen.dispatch(gpu, encoder, &self.halve, size, &resources)?;
        // Half of what is seen, also where a last column or row has no second one.
        let camera = Camera { viewport: 0.5 * seen.camera.viewport, ..*seen.camera };
        let halved = SurfaceImages { camera: &camera, depth: &depth, normals: &normals };
        let bent = self.found(gpu, encoder, halved, settings)?;
        let whole = Texture::storage(gpu, [width, height], Rgba16Float);
        let halved_camera = Buffer::uniform(gpu, &camera);
        let blur = Buffer::uniform(gpu, &BentBlur::over(settings, 0));
        let resources = [
            ("halved_camera", (&halved_camera).into()),
            ("blur", (&blur).into()),
            ("halved_depth", (&depth).into()),
            ("halved_normals", (&normals).into()),
            ("bent", (&bent).into()),
            ("whole", (&whole).into()),
        ];
        seen.dispatch(gpu, encoder, &self.upsample, [width, height], &resources)?;
        Ok(whole)
    }

    /// Occlusion and its blur at the size of what is seen.
    fn found(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        seen: SurfaceImages<'_>,
        settings: &OcclusionSettings,
    ) -> Result<Texture, AmbientError> {
        let [width, height, _] = seen.depth.size();
        let size = [width, height];
        let format = if self.form.occlusion_only { R32Float } else { Rgba16Float };
        let uniform = Buffer::uniform(gpu, settings);
        let mut bent = Texture::storage(gpu, size, format);
        let resources = [("settings", (&uniform).into()), ("bent", (&bent).into())];
        seen.dispatch(gpu, encoder, &self.occlude, size, &resources)?;
        let axes = if self.form.blurring == Blurring::Off { 0..0 } else { 0..2 };
        for axis in axes {
            let blur = Buffer::uniform(gpu, &BentBlur::over(settings, axis));
            let blurred = Texture::storage(gpu, size, format);
            let resources =
                [("blur", (&blur).into()), ("bent", (&bent).into()), ("blurred", (&blurred).into())];
            seen.dispatch(gpu, encoder, &self.blur, size, &resources)?;
            bent = blurred;
        }
        Ok(bent)
    }
}
