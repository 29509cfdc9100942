// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering of a directional light in a homogeneous medium: the host's side of `wgsl/scattering`.
//!
//! The order of [`Prefiltered::record`] is that of the thesis, 4.3: bounds of the slices, rectified
//! shadow map, filtered bases, one dot product a pixel.

use crate::core::Camera;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use encase::ShaderType;
use glam::Vec3;
use wgpu::TextureFormat;

/// What makes a medium or the settings impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// Number of bases.
    #[error("{0} bases are impossible: the number must be a multiple of 4 from 4 to 128")]
    Bases(u32),
    /// Bases a thread.
    #[error("{0} bases a thread are impossible: the number must be a multiple of 4 from 4 to 128")]
    BasesPerThread(u32),
    /// Size of the rectified map or the picture.
    #[error("{what} of {width}x{height} is impossible: both must lie between 1 and {limit} on this device")]
    Size {
        /// What has the size.
        what: &'static str,
        /// Width.
        width: u32,
        /// Height.
        height: u32,
        /// The device's limit.
        limit: u32,
    },
    /// A property of the medium.
    #[error("{name} {value} is impossible: it must be {range}")]
    Medium {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f32,
        /// What it may be.
        range: &'static str,
    },
}

/// Why the system could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum ScatteringError {
    /// Impossible settings.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A pass failed.
    #[error(transparent)]
    Pass(#[from] PassError),
}

/// The uniform `Medium` of `scattering/single_scatter`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Medium {
    /// Single-scattering albedo, 0..1.
    pub albedo: Vec3,
    /// Extinction, 1/m.
    pub extinction: f32,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// Rays end here, metres.
    pub distance_limit: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
}

impl Medium {
    /// A checked medium.
    ///
    /// # Errors
    /// [`SettingsError::Medium`] for a value out of range or not finite.
    pub fn new(extinction: f32, albedo: Vec3, g: f32, distance_limit: f32) -> Result<Self, SettingsError> {
        let check = |name, value: f32, fits: bool, range| {
            if fits { Ok(()) } else { Err(SettingsError::Medium { name, value, range }) }
        };
        check("extinction", extinction, (0.0..=1e6).contains(&extinction), "from 0 to 1e6 per metre")?;
        for value in albedo.to_array() {
            check("albedo", value, (0.0..=1.0).contains(&value), "from 0 to 1")?;
        }
        check("g", g, (-0.999..=0.999).contains(&g), "from -0.999 to 0.999")?;
        let fits = distance_limit > 0.0 && distance_limit <= 1e7;
        check("distance limit", distance_limit, fits, "positive and at most 1e7 metres")?;
        Ok(Self { albedo, extinction, g, distance_limit, reserved_a: 0.0, reserved_b: 0.0 })
    }
}

/// The uniform `Frame` of `scattering/rectify`, which the pass `slices` writes.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Frame {
    /// Unit vector TOWARDS the light.
    pub light: Vec3,
    /// Azimuth of row 0, radians.
    pub azimuth_min: f32,
    /// Unit vector of azimuth 0.
    pub axis_a: Vec3,
    /// Rows per radian.
    pub rows_per_radian: f32,
    /// Unit vector of azimuth pi / 2.
    pub axis_b: Vec3,
    /// Number of rows.
    pub rows: f32,
    /// Position of the eye.
    pub eye: Vec3,
    /// 1 where rows wrap.
    pub wraps: f32,
}

/// The uniform `MarchParameters` of the pass `march`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct MarchParameters {
    /// Steps a ray.
    pub steps: u32,
    /// Where in each step the sample lies.
    pub offset: f32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
}

/// Texture format of the filtered bases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BasisFormat {
    /// 8 bits a basis.
    #[default]
    Rgba8Unorm,
    /// 16 bits a basis.
    Rgba16Float,
}

/// How the visibility along a ray is averaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weighting {
    /// By transmittance (thesis Eq. 4.8).
    #[default]
    Transmittance,
    /// All alike (Eq. 4.2).
    Average,
}

/// What the prefiltered method can be told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Number M of bases, a multiple of 4 from 4 to 128.
    pub bases: u32,
    /// Columns and rows of the rectified map.
    pub map: [u32; 2],
    /// Format of the filtered bases.
    pub format: BasisFormat,
    /// How visibility is averaged.
    pub weighting: Weighting,
    /// Lanczos window against ringing.
    pub window: bool,
    /// March around the light's place in the picture.
    pub epipole_march: bool,
    /// Bases that a thread of the filter takes.
    pub bases_per_thread: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            bases: 32,
            map: [1024, 1024],
            format: BasisFormat::default(),
            weighting: Weighting::default(),
            window: true,
            epipole_march: true,
            bases_per_thread: 8,
        }
    }
}

impl Settings {
    /// The defaults for an adapter: a software adapter has no idle lanes to fill, so that one thread takes
    /// all bases of a row and computes its sines once; a GPU wants more threads.
    pub fn tuned(gpu: &Gpu) -> Self {
        let software = gpu.adapter.device_type == wgpu::DeviceType::Cpu;
        Self { bases_per_thread: if software { 32 } else { 8 }, ..Self::default() }
    }

    /// Checks the settings for a device.
    ///
    /// # Errors
    /// [`SettingsError`].
    pub fn validate(&self, gpu: &Gpu) -> Result<(), SettingsError> {
        if self.bases == 0 || !self.bases.is_multiple_of(4) || self.bases > 128 {
            return Err(SettingsError::Bases(self.bases));
        }
        let per_thread = self.bases_per_thread;
        if per_thread == 0 || !per_thread.is_multiple_of(4) || per_thread > 128 {
            return Err(SettingsError::BasesPerThread(per_thread));
        }
        check_size(gpu, "a rectified map", self.map)
    }

    fn filter_definitions(&self) -> Definitions {
        let mut definitions = Definitions::new()
            .set("BASES", self.bases as i32)
            .set("BASES_PER_THREAD", self.bases_per_thread.min(self.bases) as i32);
        if self.weighting == Weighting::Average {
            definitions = definitions.flag("AVERAGE");
        }
        if self.format == BasisFormat::Rgba16Float {
            definitions = definitions.flag("RGBA16FLOAT");
        }
        definitions
    }

    fn evaluate_definitions(&self) -> Definitions {
        let mut definitions = Definitions::new().set("BASES", self.bases as i32);
        // Below 8 bases the window widens the edge by more than the ringing that it takes away.
        if self.window && self.bases >= 8 {
            definitions = definitions.flag("LANCZOS");
        }
        if self.epipole_march {
            definitions = definitions.flag("EPIPOLE_MARCH");
        }
        if self.weighting == Weighting::Average {
            definitions = definitions.flag("AVERAGE");
        }
        definitions
    }
}

/// Checks the size of a map or a picture against the device's limit.
///
/// # Errors
/// [`SettingsError::Size`].
pub fn check_size(gpu: &Gpu, what: &'static str, size: [u32; 2]) -> Result<(), SettingsError> {
    let limit = gpu.limits.max_texture_dimension_2d;
    let [width, height] = size;
    if size.iter().any(|side| *side == 0 || *side > limit) {
        return Err(SettingsError::Size { what, width, height, limit });
    }
    Ok(())
}

/// The fragment form of a pass: a fifth faster than its compute form on a software adapter, and as good elsewhere.
fn picture_pass(
    gpu: &Gpu,
    shaders: &Shaders,
    pass: &str,
    definitions: &Definitions,
    fragment: &str,
) -> Result<Pass, PassError> {
    Pass::picture(gpu, shaders, pass, definitions, fragment, TextureFormat::Rgba16Float)
}

/// True where the light or its antipode lies in the picture or within a tenth of a radian of it: where
/// [`Settings::epipole_march`] is worth its cost.
pub fn epipole_near_picture(camera: &Camera, towards_light: Vec3) -> bool {
    let rows = camera.clip_from_world.transpose();
    let (x, y, w) = (rows.x_axis.truncate(), rows.y_axis.truncate(), rows.w_axis.truncate());
    let sides = [w + x, w - x, w + y, w - y].map(|normal| normal.normalize_or_zero().dot(towards_light));
    let inside = |sign: f32| sides.iter().all(|side| sign * side > -0.1);
    inside(1.0) || inside(-1.0)
}

/// What an engine brings: uniforms and two depth textures.
#[derive(Clone, Copy)]
pub struct Inputs<'a> {
    /// Uniform `Camera`.
    pub camera: &'a Buffer,
    /// Uniform `Light`.
    pub light: &'a Buffer,
    /// Uniform `Medium`.
    pub medium: &'a Buffer,
    /// Depth buffer of the picture.
    pub depth: &'a Texture,
    /// Standard shadow map.
    pub shadow_map: &'a Texture,
}

/// The rectified shadow map: slices, their frame, and the map itself.
pub struct Rectification {
    slices_pass: Pass,
    rectify_pass: Pass,
    /// Uniform `Frame`, written by the pass `slices`.
    pub frame: Buffer,
    /// Bounds of the slices, one texel each.
    pub slices: Texture,
    /// The rectified map.
    pub rectified: Texture,
}

impl Rectification {
    /// Builds the passes and the textures for a map of `map` columns and rows.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, map: [u32; 2]) -> Result<Self, ScatteringError> {
        check_size(gpu, "a rectified map", map)?;
        Ok(Self {
            slices_pass: Pass::compute(gpu, shaders, "scattering/slices", "default")?,
            rectify_pass: Pass::compute(gpu, shaders, "scattering/rectify", "default")?,
            frame: Buffer::storage(gpu, u64::from(Frame::min_size())),
            slices: Texture::storage(gpu, [map[1], 1], TextureFormat::Rgba32Float),
            rectified: Texture::storage(gpu, map, TextureFormat::R32Float),
        })
    }

    /// Binds the inputs.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>) -> Result<[Bound; 2], PassError> {
        let resources = [
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("frame", (&self.frame).into()),
            ("slices", (&self.slices).into()),
            ("shadow_map", inputs.shadow_map.into()),
            ("rectified", (&self.rectified).into()),
        ];
        Ok([self.slices_pass.bind_known(gpu, &resources)?, self.rectify_pass.bind_known(gpu, &resources)?])
    }

    /// Records both passes.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, [slices, rectify]: &[Bound; 2]) {
        let [width, height, _] = self.rectified.size();
        self.slices_pass.dispatch(encoder, slices, [height, 1, 1]);
        // A thread takes four texels of a row.
        self.rectify_pass.dispatch(encoder, rectify, [width.div_ceil(4), height, 1]);
    }
}

/// Light shafts by prefiltered bases.
pub struct Prefiltered {
    settings: Settings,
    /// The map that is filtered.
    pub rectification: Rectification,
    filter_pass: Pass,
    evaluate_pass: Pass,
    sampler: Sampler,
    /// Filtered bases, M/4 layers.
    pub bases: Texture,
    /// Radiance, and visibility in alpha.
    pub scattered: Texture,
}

/// Inputs bound to every pass of [`Prefiltered`].
pub struct PrefilteredBound {
    rectification: [Bound; 2],
    filter: Bound,
    evaluate: Bound,
}

impl Prefiltered {
    /// Builds all passes and textures for pictures of `viewport` pixels.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: Settings,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        settings.validate(gpu)?;
        check_size(gpu, "a picture", viewport)?;
        let format = match settings.format {
            BasisFormat::Rgba8Unorm => TextureFormat::Rgba8Unorm,
            BasisFormat::Rgba16Float => TextureFormat::Rgba16Float,
        };
        let [width, height] = settings.map;
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        let filter = settings.filter_definitions();
        let evaluate = settings.evaluate_definitions();
        Ok(Self {
            settings,
            rectification: Rectification::new(gpu, shaders, settings.map)?,
            filter_pass: Pass::compute_with(gpu, shaders, "scattering/filter", &filter)?,
            evaluate_pass: picture_pass(gpu, shaders, "scattering/evaluate", &evaluate, "fragment_evaluate")?,
            sampler: Sampler::rows(gpu),
            bases: Texture::array(gpu, [width, height, settings.bases / 4], format, usage),
            scattered: Texture::target(gpu, viewport, TextureFormat::Rgba16Float),
        })
    }

    /// Binds the inputs.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>) -> Result<PrefilteredBound, PassError> {
        let resources = [
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("frame", (&self.rectification.frame).into()),
            ("slices", (&self.rectification.slices).into()),
            ("depth", inputs.depth.into()),
            ("shadow_map", inputs.shadow_map.into()),
            ("rectified", (&self.rectification.rectified).into()),
            ("bases", (&self.bases).into()),
            ("bases_sampler", (&self.sampler).into()),
        ];
        Ok(PrefilteredBound {
            rectification: self.rectification.bind(gpu, inputs)?,
            filter: self.filter_pass.bind_known(gpu, &resources)?,
            evaluate: self.evaluate_pass.bind_known(gpu, &resources)?,
        })
    }

    /// Records everything from shadow map and depth buffer to radiance.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &PrefilteredBound) {
        self.record_rectification(encoder, bound);
        self.record_filter(encoder, bound);
        self.record_evaluation(encoder, bound);
    }

    /// Records the bounds of the slices and the rectified map (thesis 4.4.1).
    pub fn record_rectification(&self, encoder: &mut wgpu::CommandEncoder, bound: &PrefilteredBound) {
        self.rectification.record(encoder, &bound.rectification);
    }

    /// Records the filter of the bases (thesis 4.3.3, Listings 4.1 to 4.3).
    pub fn record_filter(&self, encoder: &mut wgpu::CommandEncoder, bound: &PrefilteredBound) {
        let Settings { bases, bases_per_thread, map, .. } = self.settings;
        let chunks = bases.div_ceil(bases_per_thread.min(bases));
        self.filter_pass.dispatch(encoder, &bound.filter, [map[1], chunks, 1]);
    }

    /// Records the evaluation of every pixel (thesis 4.3.3, Listing 4.4).
    pub fn record_evaluation(&self, encoder: &mut wgpu::CommandEncoder, bound: &PrefilteredBound) {
        self.evaluate_pass.fill(encoder, &bound.evaluate, &self.scattered);
    }

    /// Bytes of the textures between shadow map and picture.
    pub fn memory(&self) -> u64 {
        self.bases.memory() + self.rectification.rectified.memory() + self.rectification.slices.memory()
    }
}

/// What a march goes along.
pub enum Along<'a> {
    /// Rows of a rectified map, one step a texel.
    Rows(&'a Rectification),
    /// Rows of a rectified map by equal steps, average visibility: the fastest march there is.
    RowSteps {
        /// The map.
        map: &'a Rectification,
        /// Steps a ray, at least 1.
        steps: u32,
    },
    /// The standard shadow map, by equal steps.
    ShadowMap {
        /// Steps a ray, at least 1.
        steps: u32,
    },
}

/// Light shafts by marching: the baseline.
pub struct March {
    pass: Pass,
    parameters: Buffer,
    /// Radiance, and visibility in alpha.
    pub scattered: Texture,
}

impl March {
    /// Builds the pass for pictures of `viewport` pixels.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        along: &Along<'_>,
        weighting: Weighting,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        check_size(gpu, "a picture", viewport)?;
        let mut definitions = Definitions::new();
        let mut steps = 0;
        match along {
            Along::Rows(_) => {}
            Along::RowSteps { steps: asked, .. } => {
                definitions = definitions.flag("STEPS");
                steps = *asked;
            }
            Along::ShadowMap { steps: asked } => {
                definitions = definitions.flag("SHADOW_MAP");
                steps = *asked;
            }
        }
        if weighting == Weighting::Average {
            definitions = definitions.flag("AVERAGE");
        }
        let parameters = MarchParameters { steps, offset: 0.5, reserved_a: 0, reserved_b: 0 };
        Ok(Self {
            pass: picture_pass(gpu, shaders, "scattering/march", &definitions, "fragment_march")?,
            parameters: Buffer::uniform(gpu, &parameters),
            scattered: Texture::target(gpu, viewport, TextureFormat::Rgba16Float),
        })
    }

    /// Binds the inputs.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>, along: &Along<'_>) -> Result<Bound, PassError> {
        let mut resources = vec![
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("depth", inputs.depth.into()),
            ("shadow_map", inputs.shadow_map.into()),
            ("parameters", (&self.parameters).into()),
        ];
        if let Along::Rows(map) | Along::RowSteps { map, .. } = along {
            resources.extend([
                ("frame", (&map.frame).into()),
                ("slices", (&map.slices).into()),
                ("rectified", (&map.rectified).into()),
            ]);
        }
        self.pass.bind_known(gpu, &resources)
    }

    /// Records the march of every pixel.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        self.pass.fill(encoder, bound, &self.scattered);
    }
}

/// Puts a picture and the light scattered before it together.
pub struct Composite {
    pass: Pass,
}

impl Composite {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "scattering/composite", "default")? })
    }

    /// `surface` seen through the medium, plus `scattered`, as linear RGB radiance.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn run(
        &self,
        gpu: &Gpu,
        inputs: &Inputs<'_>,
        surface: &Texture,
        scattered: &Texture,
    ) -> Result<Texture, PassError> {
        let [width, height, _] = scattered.size();
        let composed = Texture::storage(gpu, [width, height], TextureFormat::Rgba16Float);
        let bound = self.pass.bind(
            gpu,
            &[
                ("camera", inputs.camera.into()),
                ("medium", inputs.medium.into()),
                ("depth", inputs.depth.into()),
                ("surface", surface.into()),
                ("scattered", scattered.into()),
                ("composed", (&composed).into()),
            ],
        )?;
        let mut encoder = gpu.encoder();
        self.pass.dispatch(&mut encoder, &bound, [width, height, 1]);
        gpu.submit(encoder)?;
        Ok(composed)
    }
}
