// SPDX-License-Identifier: MIT OR Apache-2.0
//! One sentence to the person at the keyboard, and the exit code that goes with it.

use crate::ambient::{AmbientError, ConeLightError};
use crate::core::{CameraError, LightError, TransferError, TransferFileError, VolumeTextureError};
use crate::data::MediumFileError;
use crate::painterly::{PainterlyError, PaintingError, StrokeError};
use crate::scattering::ScatteringError;
use crate::scenes::SceneError;
use crate::splatting::SplattingError;
use crate::stylize::StylizeError;
use crate::transmittance::TransmittanceError;
use crate::{GpuError, OutOfRange, PassError, StageError};
use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;

/// How a command ended badly.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// What was typed cannot be meant: a flag, a name, a number. Exit code 2.
    #[error("{0}")]
    Misuse(String),
    /// A file, a folder or the machine did not do. Exit code 1.
    #[error("{0}")]
    Failure(String),
}

impl CommandError {
    /// Misuse of `flag`.
    pub fn misuse(flag: &str, problem: impl Display) -> Self {
        Self::Misuse(format!("{flag}: {problem}"))
    }

    /// A failure, described.
    pub fn failure(problem: impl Display) -> Self {
        Self::Failure(problem.to_string())
    }

    /// 2 for misuse, 1 for failure.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Misuse(_) => 2,
            Self::Failure(_) => 1,
        })
    }
}

/// What an error says, on one line.
pub(super) fn one_line(error: impl Display) -> String {
    let text = error.to_string();
    let words: Vec<_> = text.split_whitespace().collect();
    words.join(" ")
}

/// A problem with the path that it is about, unless it names that itself.
pub(super) fn named(path: &Path, problem: String) -> String {
    let path = path.display().to_string();
    if problem.contains(&path) { problem } else { format!("{path}: {problem}") }
}

/// Misuse where a name is unknown, a failure where a shader is broken.
pub(super) fn shader_error(error: airlight_validate::Error) -> CommandError {
    use airlight_validate::Error;
    match error {
        Error::UnknownPass { .. }
        | Error::UnknownModule { .. }
        | Error::UnknownPermutation { .. }
        | Error::Definition { .. } => CommandError::Misuse(one_line(error)),
        other => CommandError::failure(one_line(other)),
    }
}

/// Misuse where the name of a file of a medium is unknown, a failure where the file is broken. `known`: what may be given.
pub(super) fn medium_error(flag: &str, error: MediumFileError, known: &str) -> CommandError {
    match error {
        MediumFileError::UnknownExtension { path, .. } => {
            CommandError::misuse(flag, format!("`{}` is unknown: give {known}", path.display()))
        }
        error => CommandError::Failure(format!("{flag}: {error}")),
    }
}

impl From<GpuError> for CommandError {
    fn from(error: GpuError) -> Self {
        Self::failure(error)
    }
}

impl From<PassError> for CommandError {
    fn from(error: PassError) -> Self {
        Self::failure(error)
    }
}

impl From<SceneError> for CommandError {
    fn from(error: SceneError) -> Self {
        Self::failure(error)
    }
}

impl From<ScatteringError> for CommandError {
    fn from(error: ScatteringError) -> Self {
        match error {
            ScatteringError::Settings(error) => Self::from(error),
            ScatteringError::Pass(error) => Self::failure(error),
        }
    }
}

impl From<crate::scattering::SettingsError> for CommandError {
    fn from(error: crate::scattering::SettingsError) -> Self {
        use crate::scattering::SettingsError as E;
        let flag = match &error {
            E::Bases(_) | E::BasesPerThread(_) => "--bases",
            E::RankBits(_) | E::WaveletBits(_) => "--bits",
            E::Visibility { .. } | E::WaveletWeighting => "--method",
            E::Regions(_) => "--regions",
            E::OrthographicStart => "--start",
            E::LightForm(_) | E::LightAtEye { .. } => "--light",
            E::Size { what, .. } => match *what {
                "a picture" => "--size",
                "a shadow map" => "--shadow-map",
                "a light texture" => "--light-texture",
                _ => "--map",
            },
            E::Medium { name, .. } => match *name {
                "extinction" => "--extinction",
                "albedo" => "--albedo",
                "g" => "--g",
                _ => "--far",
            },
        };
        Self::misuse(flag, error)
    }
}

impl From<StylizeError> for CommandError {
    fn from(error: StylizeError) -> Self {
        match error {
            StylizeError::Holes(_) => Self::misuse("--holes", error),
            StylizeError::Size { .. } => Self::misuse("--shadow-map", error),
            StylizeError::Epipole(_) => Self::misuse("--close-epipolar, --extrude", error),
            _ => Self::failure(error),
        }
    }
}

impl From<VolumeTextureError> for CommandError {
    fn from(error: VolumeTextureError) -> Self {
        Self::failure(format!("--volume: {error}"))
    }
}

impl From<TransmittanceError> for CommandError {
    fn from(error: TransmittanceError) -> Self {
        use TransmittanceError as E;
        let flag = match &error {
            E::Coefficients { .. } => "--coefficients",
            E::HalfMoments(_) | E::Blend(_) => "--format",
            E::Size { what: "a transmittance map", .. } | E::Sums { .. } => "--map-size",
            E::Splat(..) => "--map",
            E::Lighting { name: "albedo", .. } => "--albedo",
            E::Lighting { name: "g", .. } => "--g",
            E::Volume(_) => return Self::failure(format!("--volume: {error}")),
            E::Size { .. }
            | E::Lighting { .. }
            | E::Range(_)
            | E::Leaning
            | E::OtherMap { .. }
            | E::Reference(_)
            | E::Pass(_) => {
                return Self::failure(error);
            }
        };
        Self::misuse(flag, error)
    }
}

impl From<TransferFileError> for CommandError {
    fn from(error: TransferFileError) -> Self {
        Self::failure(format!("--transfer: {error}"))
    }
}

impl From<TransferError> for CommandError {
    fn from(error: TransferError) -> Self {
        Self::failure(format!("--transfer: {error}"))
    }
}

impl From<SplattingError> for CommandError {
    fn from(error: SplattingError) -> Self {
        use SplattingError as E;
        let flag = match &error {
            E::Setting(OutOfRange { name: "number of sheets", .. }) => "--sheets",
            E::Setting(OutOfRange { name: "side of a picture", .. }) => "--size, --light-size",
            E::Setting(OutOfRange { name: "extinction", .. }) => "--extinction-scale",
            E::Setting(OutOfRange { name: "ambient radiance", .. }) => "--ambient",
            E::Setting(OutOfRange { name: "mean cosine", .. }) => "--g",
            E::Setting(OutOfRange { name: "cone of scattered light", .. }) => "--cone",
            E::Setting(OutOfRange { name: "free path", .. }) => "--free-path",
            E::Setting(OutOfRange { name: "number of sweeps", .. }) => "--sweeps",
            E::Setting(OutOfRange { name: "size of the light", .. }) => "--light",
            E::Setting(OutOfRange { name: "texels of a soft shadow buffer", .. }) | E::LightBuffer { .. } => {
                "--light-size"
            }
            E::LightInside(_) | E::LightTooNear(_) | E::LightBehind { .. } => "--light",
            E::NoPolygons => "--mesh",
            E::Light(error) => return StageError::Light(error.clone()).into(),
            E::Volume(_) | E::Voxels(_) => return Self::failure(format!("--volume: {error}")),
            E::Setting(_) | E::Viewport { .. } | E::Pass(_) => return Self::failure(error),
        };
        Self::misuse(flag, error)
    }
}

impl From<PaintingError> for CommandError {
    fn from(error: PaintingError) -> Self {
        match error {
            PaintingError::Rays(error) => error.into(),
            PaintingError::Strokes(error) => error.into(),
        }
    }
}

impl From<PainterlyError> for CommandError {
    fn from(error: PainterlyError) -> Self {
        use PainterlyError as E;
        let flag = match &error {
            E::Setting(OutOfRange { name: "iso-value", .. }) => "--iso",
            E::Setting(OutOfRange { name: "steps per voxel", .. }) => "--steps",
            E::Setting(OutOfRange { name: "radiance of the light" | "ambient radiance", .. }) => "--exposure",
            E::Setting(OutOfRange { name: "underpainting", .. }) => "--underpainting",
            E::ClipPlanes(_)
            | E::Setting(OutOfRange {
                name: "length of a clip plane's normal" | "offset of a clip plane",
                ..
            }) => "--clip",
            E::Size { .. } => "--size",
            E::Volume(_) | E::Space => return Self::failure(format!("--volume: {error}")),
            E::Function(_) | E::Entry { .. } | E::Range(..) => {
                return Self::failure(format!("--transfer: {error}"));
            }
            E::Setting(_) | E::Table { .. } | E::NoCurvature | E::Pass(_) => return Self::failure(error),
        };
        Self::misuse(flag, error)
    }
}

impl From<StrokeError> for CommandError {
    fn from(error: StrokeError) -> Self {
        use StrokeError as E;
        let flag = match &error {
            E::Capacity { .. } => "--capacity",
            E::Size { .. } => "--size",
            E::Style { .. } | E::File(_) | E::MissingBrush { .. } => {
                return Self::failure(format!("--style: {error}"));
            }
            E::Brush { .. } | E::NoBrush => return Self::failure(format!("--brush: {error}")),
            E::OtherSize { .. } | E::Curvature | E::Transform | E::Pass(_) => return Self::failure(error),
        };
        Self::misuse(flag, error)
    }
}

impl From<AmbientError> for CommandError {
    fn from(error: AmbientError) -> Self {
        use AmbientError as E;
        let flag = match &error {
            E::Setting(OutOfRange { name: "radius of occlusion", .. }) => "--radius",
            E::Setting(OutOfRange { name: "thickness of occluders", .. }) => "--thickness",
            E::Setting(OutOfRange { name: "number of directions", .. }) => "--samples",
            E::Setting(OutOfRange { name: "number of steps", .. }) => "--steps",
            E::Setting(OutOfRange { name: "side of the sampling pattern", .. }) => "--interleave",
            E::Setting(_) | E::Pass(_) | E::Gpu(_) => return Self::failure(error),
        };
        Self::misuse(flag, error)
    }
}

impl From<ConeLightError> for CommandError {
    fn from(error: ConeLightError) -> Self {
        use ConeLightError as E;
        match error {
            E::Shape { .. } | E::TooLarge { .. } => Self::failure(format!("--environment: {error}")),
            E::Side(_) | E::Pass(_) | E::Gpu(_) => Self::failure(error),
        }
    }
}

impl From<StageError> for CommandError {
    fn from(error: StageError) -> Self {
        match error {
            StageError::Camera(error) => {
                let flag = match error {
                    CameraError::Direction { .. } | CameraError::Up { .. } => "--eye, --target",
                    CameraError::FieldOfView { .. } => "--fov",
                    CameraError::Planes { .. } => "--near, --far",
                    CameraError::OrthographicPlanes { .. } => "--near, --far",
                    CameraError::Height(_) => "--height",
                    CameraError::Viewport { .. } => "--size",
                };
                Self::misuse(flag, error)
            }
            StageError::Light(error) => match error {
                LightError::Scene { .. } | LightError::Points | LightError::Range { .. } => {
                    Self::failure(error)
                }
                LightError::Cascades(_)
                | LightError::CascadesOfLocal
                | LightError::Split(_)
                | LightError::Camera => Self::misuse("--cascades", error),
                LightError::TextureOfPoint => Self::misuse("--light-texture", error),
                LightError::Direction(_)
                | LightError::Position(_)
                | LightError::Aim { .. }
                | LightError::Cone { .. }
                | LightError::Radius(_) => Self::misuse("--light", error),
            },
            StageError::Samples(_) => Self::misuse("--samples", error),
            StageError::Size(error) => error.into(),
            StageError::Pass(error) => error.into(),
        }
    }
}
