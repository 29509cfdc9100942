// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the prefiltered method can be told, and what is impossible.

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

/// Texture format of the filtered bases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BasisFormat {
    /// 8 bits a basis.
    #[default]
    Rgba8Unorm,
    /// 16 bits a basis.
    Rgba16Float,
}

impl BasisFormat {
    pub(super) fn texture_format(self) -> wgpu::TextureFormat {
        match self {
            Self::Rgba8Unorm => wgpu::TextureFormat::Rgba8Unorm,
            Self::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
        }
    }
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

    pub(super) fn filter_definitions(&self) -> Definitions {
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

    pub(super) fn evaluate_definitions(&self) -> Definitions {
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

/// True where the light or its antipode lies in the picture or within a tenth of a radian of it: where
/// [`Settings::epipole_march`] is worth its cost.
pub fn epipole_near_picture(camera: &Camera, towards_light: Vec3) -> bool {
    let rows = camera.clip_from_world.transpose();
    let (x, y, w) = (rows.x_axis.truncate(), rows.y_axis.truncate(), rows.w_axis.truncate());
    let sides = [w + x, w - x, w + y, w - y].map(|normal| normal.normalize_or_zero().dot(towards_light));
    let inside = |sign: f32| sides.iter().all(|side| sign * side > -0.1);
    inside(1.0) || inside(-1.0)
}
