// SPDX-License-Identifier: MIT OR Apache-2.0
//! Openness and bent normals of a picture.

use super::{AmbientError, BentBlur, OcclusionSettings};
use crate::core::Camera;
use crate::gpu::Gpu;
use crate::pass::Pass;
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
        let flags = |names: &[(&str, bool)]| {
            let set = names.iter().filter(|(_, on)| *on);
            set.fold(Definitions::new(), |definitions, (name, _)| definitions.flag(*name))
        };
        let pass = |name: &str, names: &[(&str, bool)]| Pass::compute_with(gpu, shaders, name, &flags(names));
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
        let whole_camera = Buffer::uniform(gpu, seen.camera);
        let resources = [
            ("camera", (&whole_camera).into()),
            ("depth", seen.depth.into()),
            ("normals", seen.normals.into()),
            ("halved_depth", (&depth).into()),
            ("halved_normals", (&normals).into()),
        ];
        let bound = self.halve.bind(gpu, &resources)?;
        self.halve.dispatch(encoder, &bound, [size[0], size[1], 1]);
        // Half of what is seen, also where a last column or row has no second one.
        let camera = Camera { viewport: 0.5 * seen.camera.viewport, ..*seen.camera };
        let halved = SurfaceImages { camera: &camera, depth: &depth, normals: &normals };
        let bent = self.found(gpu, encoder, halved, settings)?;
        let whole = Texture::storage(gpu, [width, height], Rgba16Float);
        let halved_camera = Buffer::uniform(gpu, &camera);
        let blur = Buffer::uniform(gpu, &BentBlur::over(settings, 0));
        let resources = [
            ("camera", (&whole_camera).into()),
            ("halved_camera", (&halved_camera).into()),
            ("blur", (&blur).into()),
            ("depth", seen.depth.into()),
            ("normals", seen.normals.into()),
            ("halved_depth", (&depth).into()),
            ("halved_normals", (&normals).into()),
            ("bent", (&bent).into()),
            ("whole", (&whole).into()),
        ];
        let bound = self.upsample.bind(gpu, &resources)?;
        self.upsample.dispatch(encoder, &bound, [width, height, 1]);
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
        let format = if self.form.occlusion_only { R32Float } else { Rgba16Float };
        let image = || Texture::storage(gpu, [width, height], format);
        let camera = Buffer::uniform(gpu, seen.camera);
        let uniform = Buffer::uniform(gpu, settings);
        let mut bent = image();
        let resources = [
            ("camera", (&camera).into()),
            ("settings", (&uniform).into()),
            ("depth", seen.depth.into()),
            ("normals", seen.normals.into()),
            ("bent", (&bent).into()),
        ];
        let bound = self.occlude.bind(gpu, &resources)?;
        self.occlude.dispatch(encoder, &bound, [width, height, 1]);
        if self.form.blurring == Blurring::Off {
            return Ok(bent);
        }
        for axis in 0..2 {
            let blur = Buffer::uniform(gpu, &BentBlur::over(settings, axis));
            let blurred = image();
            let resources = [
                ("camera", (&camera).into()),
                ("blur", (&blur).into()),
                ("depth", seen.depth.into()),
                ("normals", seen.normals.into()),
                ("bent", (&bent).into()),
                ("blurred", (&blurred).into()),
            ];
            let bound = self.blur.bind(gpu, &resources)?;
            self.blur.dispatch(encoder, &bound, [width, height, 1]);
            bent = blurred;
        }
        Ok(bent)
    }
}
