// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the prefiltered method can be told, and what is impossible.

use super::{LightForm, Visibility};
use crate::core::Camera;
use crate::gpu::Gpu;
use crate::pass::PassError;
use airlight_validate::Definitions;
use glam::Vec3;

/// What makes a medium or the settings impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// Number of bases.
    #[error("{0} bases are impossible: the number must be a multiple of 4 from 4 to 128")]
    Bases(u32),
    /// Bases a thread.
    #[error("{0} bases a thread are impossible: the number must be a multiple of 4 from 4 to 128")]
    BasesPerThread(u32),
    /// Bits of a depth in a rank structure.
    #[error("{0} bits a depth are impossible: the number must be from 8 to 12")]
    RankBits(u32),
    /// Bits of a depth in a wavelet matrix.
    #[error("{0} bits a depth are impossible in a wavelet matrix: the number must be 8, 10 or 12")]
    WaveletBits(u32),
    /// A wavelet matrix weighted by transmittance.
    #[error("the method `wavelet` counts texels alike: take the weighting `Average`, or the method `rank`")]
    WaveletWeighting,
    /// What a method of prefiltering cannot do.
    #[error("the method `{method}` needs {reason}; `fourier` does without")]
    Visibility {
        /// The method.
        method: &'static str,
        /// What it needs.
        reason: &'static str,
    },
    /// Regions of a row.
    #[error("{0} regions a row are impossible: the number must be from 1 to 8")]
    Regions(u32),
    /// An orthographic camera, whose rays begin inside their rows.
    #[error("an orthographic camera needs `Start::NearPlane` in the settings: its rays begin there")]
    OrthographicStart,
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
    /// What no pass is made for.
    #[error("this light is impossible: {0}")]
    LightForm(&'static str),
    /// The eye is at a spot or point light.
    #[error(
        "the eye is {distance} m from the light: at least {least} m are needed for rows around it; march instead"
    )]
    LightAtEye {
        /// Metres between them; not finite where one of them is nowhere.
        distance: f32,
        /// The least, metres.
        least: f32,
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

/// How the filtered bases are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filtering {
    /// Bilinear: smooth across rows and along them; free on a GPU.
    #[default]
    Linear,
    /// The nearest texel, as a march reads its map: half the cost of a read on a software adapter.
    Nearest,
}

/// How the reference ray of a slice is chosen, whose weights all rays of the slice share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reference {
    /// The bisectrix: errs less than half as much in thick air, since most rays of a slice are nearer to it.
    #[default]
    Bisectrix,
    /// The optimum of Eq. 4.12, clamped: the least greatest ratio over all rays.
    Optimum,
}

/// Where rays, and the medium, begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Start {
    /// At the eye.
    #[default]
    Eye,
    /// At the near plane: costs a second read of the bases, and amplifies what they are stored with.
    NearPlane,
}

/// What the prefiltered method can be told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How visibility is prefiltered; `bases`, `format`, `window`, `bases_per_thread`, `regions` and `direct_sines` are of
    /// Fourier bases alone.
    pub visibility: Visibility,
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
    /// The depth warp of thesis 4.5 instead of that march, to compare.
    pub depth_warp: bool,
    /// Bases that a thread of the filter takes.
    pub bases_per_thread: u32,
    /// Regions of a row that are filtered in parallel, 1 to 8; each before the last costs a read a pixel.
    pub regions: u32,
    /// How the bases are read.
    pub filtering: Filtering,
    /// The reference ray of a slice.
    pub reference: Reference,
    /// Where rays begin.
    pub start: Start,
    /// New sines for every basis instead of the recurrence, to compare.
    pub direct_sines: bool,
    /// The kind of light; all others than the default take one region and begin at the eye.
    pub light: LightForm,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            visibility: Visibility::default(),
            bases: 32,
            map: [1024, 1024],
            format: BasisFormat::default(),
            weighting: Weighting::default(),
            window: true,
            epipole_march: true,
            depth_warp: false,
            bases_per_thread: 8,
            regions: 1,
            filtering: Filtering::default(),
            reference: Reference::default(),
            start: Start::default(),
            direct_sines: false,
            light: LightForm::default(),
        }
    }
}

impl Settings {
    /// The defaults for an adapter: a software adapter has no idle lanes to fill, so that one thread takes
    /// all bases of a row and computes its sines once; a GPU wants more threads. A software adapter filters
    /// textures by arithmetic, so that it reads the nearest texel.
    pub fn tuned(gpu: &Gpu) -> Self {
        if gpu.adapter.device_type == wgpu::DeviceType::Cpu {
            Self { bases_per_thread: 32, filtering: Filtering::Nearest, ..Self::default() }
        } else {
            Self::default()
        }
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
        if !(1..=8).contains(&self.regions) {
            return Err(SettingsError::Regions(self.regions));
        }
        self.light.validate()?;
        let parts = self.regions > 1 || self.start == Start::NearPlane;
        if parts && (self.light.local() || self.light.texture) {
            return Err(SettingsError::LightForm(
                "rows of a spot, a point light or a light texture are filtered in one region, from the eye on",
            ));
        }
        self.validate_visibility()?;
        check_size(gpu, "a rectified map", self.map)
    }

    pub(super) fn slices_definitions(&self) -> Definitions {
        self.light.local_definitions(flags(&[("OPTIMUM", self.reference == Reference::Optimum)]))
    }

    pub(super) fn rectify_definitions(&self) -> Definitions {
        self.light.shadow_definitions(flags(&[("DEPTH_WARP", self.depth_warp)]))
    }

    pub(super) fn filter_definitions(&self) -> Definitions {
        let definitions = flags(&[
            ("AVERAGE", self.weighting == Weighting::Average),
            ("RGBA16FLOAT", self.format == BasisFormat::Rgba16Float),
            ("DIRECT", self.direct_sines),
        ])
        .set("BASES", self.bases as i32)
        .set("BASES_PER_THREAD", self.bases_per_thread.min(self.bases) as i32);
        self.with_regions(self.light.color_definitions(self.light.local_definitions(definitions)))
    }

    pub(super) fn evaluate_definitions(&self) -> Definitions {
        let definitions = flags(&[
            ("EPIPOLE_MARCH", self.epipole_march),
            ("DEPTH_WARP", self.depth_warp),
            ("AVERAGE", self.weighting == Weighting::Average),
            ("NEAREST", self.filtering == Filtering::Nearest),
            ("NEAR_PLANE", self.start == Start::NearPlane),
            ("PER_POINT", self.epipole_march && !self.light.plain()),
        ]);
        let definitions = self.prefiltered_definitions(definitions);
        self.with_regions(self.light.color_definitions(self.light.shadow_definitions(definitions)))
    }

    /// Of the pass `evaluate_projective`, which knows no epipole.
    pub(super) fn projective_definitions(&self) -> Definitions {
        let definitions = Self { epipole_march: false, depth_warp: false, ..*self }.evaluate_definitions();
        self.weight_definitions(definitions, self.weight_bits(true))
    }

    fn with_regions(&self, definitions: Definitions) -> Definitions {
        if self.regions > 1 { definitions.set("REGIONS", self.regions as i32) } else { definitions }
    }
}

/// The flags that are on.
fn flags(flags: &[(&str, bool)]) -> Definitions {
    flags.iter().filter(|(_, on)| *on).fold(Definitions::new(), |all, (name, _)| all.flag(*name))
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

/// True where the light or its antipode lies in the picture or within a tenth of a radian of it: where
/// [`Settings::epipole_march`] is worth its cost.
pub fn epipole_near_picture(camera: &Camera, towards_light: Vec3) -> bool {
    let rows = camera.clip_from_world.transpose();
    let (x, y, w) = (rows.x_axis.truncate(), rows.y_axis.truncate(), rows.w_axis.truncate());
    let sides = [w + x, w - x, w + y, w - y].map(|normal| normal.normalize_or_zero().dot(towards_light));
    let inside = |sign: f32| sides.iter().all(|side| sign * side > -0.1);
    inside(1.0) || inside(-1.0)
}
