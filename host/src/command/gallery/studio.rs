// SPDX-License-Identifier: MIT OR Apache-2.0
//! What all sections share: the device, and a scene's way to its scattered light.

use crate::command::CommandError;
use crate::command::bench::{Work, milliseconds};
use crate::core::{DIRECTIONAL, Raster, Tonemap, View};
use crate::scattering::{
    BasisFormat, Choice, Composite, Filtering, LightForm, March, Prefilter, Prefiltered, ProjectiveMap,
    ProjectivePrefiltered, Settings, Start, Visibility, Weighting, choose, epipole_near_picture,
};
use crate::scenes::{self, Scene};
use crate::{Gpu, Shaders, Stage, Texture};
use std::path::{Path, PathBuf};

/// Size of the standard shadow map.
const SHADOW_MAP: [u32; 2] = [2048, 2048];
/// Steps a ray of the marched reference.
pub const STEPS: u32 = 1024;
/// What differences are multiplied by before they are shown.
pub const AMPLIFIED: f32 = 8.0;

/// The device, the passes that every picture needs, and where pictures go.
pub struct Studio {
    /// The device.
    pub gpu: Gpu,
    /// The shipped shaders.
    pub shaders: Shaders,
    /// Size of the pictures.
    pub size: [u32; 2],
    /// Folder of the gallery.
    pub out: PathBuf,
    /// Draws scenes.
    pub raster: Raster,
    tonemap: Tonemap,
    composite: Composite,
}

/// The light that was scattered in a scene.
pub struct Shot {
    /// Radiance, and visibility in alpha.
    pub scattered: Texture,
    /// The rectified map.
    pub rectified: Texture,
    /// What the filter stored.
    pub prefilter: Prefilter,
    /// What the rows of the map are, and their number and that of the bases.
    pub rows: String,
    /// Step, and milliseconds.
    pub times: Vec<(&'static str, f64)>,
}

impl Studio {
    /// Builds the passes.
    pub fn new(gpu: Gpu, size: [u32; 2], out: &Path) -> Result<Self, CommandError> {
        let shaders = Shaders::builtin();
        let raster = Raster::new(&gpu, &shaders)?;
        let tonemap = Tonemap::new(&gpu, &shaders)?;
        let composite = Composite::new(&gpu, &shaders)?;
        Ok(Self { gpu, shaders, size, out: out.to_owned(), raster, tonemap, composite })
    }

    /// A scene by name, and the same on the device.
    pub fn scene(&self, name: &str) -> Result<(Scene, Stage), CommandError> {
        let scene =
            scenes::scene(name)?.ok_or_else(|| CommandError::failure(format!("no scene `{name}`")))?;
        let stage = Stage::new(&self.gpu, &self.raster, &scene.setting(), self.size, SHADOW_MAP)?;
        Ok((scene, stage))
    }

    /// The settings of pictures that are looked at: bilinear reads of the bases.
    pub fn settings(&self) -> Settings {
        Settings { filtering: Filtering::Linear, ..Settings::tuned(&self.gpu) }
    }

    /// The light that a stage scatters, prefiltered in the way that fits its light and its camera.
    pub fn shoot(&self, stage: &Stage) -> Result<Shot, CommandError> {
        if stage.camera.projection == 0 {
            return self.epipolar(stage, self.settings_of(stage));
        }
        let light = LightForm::of(&stage.light, &stage.inputs());
        self.projective(stage, Settings { light, ..self.settings() })
    }

    /// The settings that fit the light of a stage and its camera, which is a perspective one.
    pub fn settings_of(&self, stage: &Stage) -> Settings {
        let light = LightForm::of(&stage.light, &stage.inputs());
        let epipole_march =
            stage.light.kind != DIRECTIONAL || epipole_near_picture(&stage.camera, stage.light.direction);
        // Around a local light blockers are often closer to it in angle than the series resolves.
        let depth_warp = light.local();
        let settings = self.settings();
        let visibility = Visibility::automatic(settings.map[0]);
        Settings { light, epipole_march, depth_warp, visibility, ..settings }
    }

    fn epipolar(&self, stage: &Stage, settings: Settings) -> Result<Shot, CommandError> {
        let prefiltered = Prefiltered::new(&self.gpu, &self.shaders, settings, self.size)?;
        let bound = prefiltered.bind(&self.gpu, &stage.inputs())?;
        let times = vec![
            ("rectification", self.time(&|encoder| prefiltered.record_rectification(encoder, &bound))?),
            ("filter", self.time(&|encoder| prefiltered.record_filter(encoder, &bound))?),
            ("evaluation", self.time(&|encoder| prefiltered.record_evaluation(encoder, &bound))?),
        ];
        let Prefiltered { rectification, prefilter, scattered, .. } = prefiltered;
        let rows = rows("epipolar rows", settings, prefilter.stored());
        Ok(Shot { scattered, rectified: rectification.rectified, prefilter, rows, times })
    }

    fn projective(&self, stage: &Stage, settings: Settings) -> Result<Shot, CommandError> {
        // Short stretches behind the near plane magnify the steps of 8 bits.
        let settings = Settings { start: Start::NearPlane, format: BasisFormat::Rgba16Float, ..settings };
        let limit = stage.medium.distance_limit;
        let projective = match choose(&stage.camera, stage.light.direction, limit, 1) {
            Choice::Projective(projective) => projective,
            Choice::Epipolar { reason } | Choice::March { reason } => {
                return Err(CommandError::failure(reason));
            }
        };
        let map = ProjectiveMap::resampled(&self.gpu, &self.shaders, settings.map)?;
        let prefiltered = ProjectivePrefiltered::new(&self.gpu, &self.shaders, map, settings, self.size)?;
        prefiltered.write(&self.gpu, &projective).map_err(CommandError::failure)?;
        let bound = prefiltered.bind(&self.gpu, &stage.inputs())?;
        let resample = prefiltered.map.bind(&self.gpu, &stage.inputs())?;
        let times = vec![
            ("rectification", self.time(&|encoder| prefiltered.map.record(encoder, resample.as_ref()))?),
            ("filter", self.time(&|encoder| prefiltered.record_filter(encoder, &bound))?),
            ("evaluation", self.time(&|encoder| prefiltered.record_evaluation(encoder, &bound))?),
        ];
        let ProjectivePrefiltered { map, prefilter, scattered, .. } = prefiltered;
        let rows = rows("projective rows", settings, prefilter.stored());
        Ok(Shot { scattered, rectified: map.rectified, prefilter, rows, times })
    }

    /// The same light step by step through the shadow maps, and milliseconds.
    pub fn march(&self, stage: &Stage) -> Result<(Texture, f64), CommandError> {
        let form = LightForm::of(&stage.light, &stage.inputs());
        let along = crate::scattering::Along::ShadowMap { steps: STEPS };
        let march =
            March::of_light(&self.gpu, &self.shaders, form, STEPS, Weighting::Transmittance, self.size)?;
        let bound = march.bind(&self.gpu, &stage.inputs(), &along)?;
        let time = self.time(&|encoder| march.record(encoder, &bound))?;
        Ok((march.scattered, time))
    }

    /// Surfaces seen through the air, and the light that it scatters.
    pub fn compose(&self, stage: &Stage, scattered: &Texture) -> Result<Texture, CommandError> {
        Ok(self.composite.run(&self.gpu, &stage.inputs(), &stage.pictures.surface, scattered)?)
    }

    /// Pixels of radiance, 4 bytes each.
    pub fn pixels(&self, radiance: &Texture, exposure: f32) -> Result<Vec<u8>, CommandError> {
        Ok(self.tonemap.run(&self.gpu, radiance, exposure)?)
    }

    /// Least milliseconds of five runs after the first one, which compiles; long work runs twice in all.
    pub fn time(&self, work: Work<'_>) -> Result<f64, CommandError> {
        let runs = if milliseconds(&self.gpu, work)? > 500.0 { 1 } else { 5 };
        let mut least = f64::INFINITY;
        for _ in 0..runs {
            least = least.min(milliseconds(&self.gpu, work)?);
        }
        Ok(least)
    }
}

fn rows(kind: &str, settings: Settings, bases: &Texture) -> String {
    let ([columns, rows], [.., layers]) = (settings.map, bases.size());
    let stored = match settings.visibility {
        Visibility::Fourier => format!("{} bases in {layers} layers", settings.bases),
        Visibility::Moments => "6 moments".to_owned(),
        Visibility::Rank { bits } => format!("rank queries of {bits} bits"),
        Visibility::Wavelet { bits } => format!("a wavelet matrix of {bits} bits"),
    };
    format!("{kind}, {columns}x{rows}, {stored}")
}

/// What made the picture of a scene.
pub fn parameters(scene: &Scene) -> String {
    let medium = &scene.medium;
    format!(
        "{} triangles, extinction {} /m, albedo {}, g {}, {}, {}",
        scene.mesh.triangle_count(),
        medium.extinction,
        medium.albedo.x,
        medium.g,
        match &scene.view {
            View::Perspective(view) => {
                format!(
                    "eye {:.2}, target {:.2}, field of view {}°",
                    view.eye, view.target, view.field_of_view
                )
            }
            View::Orthographic(view) => {
                format!(
                    "eye {:.2}, target {:.2}, height {} m, orthographic",
                    view.eye, view.target, view.height
                )
            }
        },
        scene.light,
    )
}
