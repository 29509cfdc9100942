// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flags of `airlight ambient`.

use crate::ambient::{BentForm, Blurring, Method, OcclusionSettings, Sampling};
use crate::command::camera::CameraFlags;
use crate::command::parse::{self, Placed};
use clap::ValueEnum;
use std::path::PathBuf;

/// `--method`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodSpelling {
    /// Ambient occlusion: light about the normal, times openness.
    Ao,
    /// Light about the bent normal.
    Normals,
    /// Light of the bent cone, its angle by Eq. 3.6.
    Cones,
    /// Light of the bent cone whose directions have the mean's length.
    ExactCones,
    /// Rays against the meshes themselves, on the CPU.
    Reference,
}

impl MethodSpelling {
    /// The method of the passes, where there is one.
    pub fn method(self) -> Option<Method> {
        Some(match self {
            Self::Ao => Method::Occlusion,
            Self::Normals => Method::Normals,
            Self::Cones => Method::Cones,
            Self::ExactCones => Method::ExactCones,
            Self::Reference => return None,
        })
    }
}

/// `--sampler`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplerSpelling {
    /// A 2D pattern on a disc across the normal: Crytek 2D.
    Disc,
    /// A 3D pattern, marched: Crytek 3D.
    Hemisphere,
    /// Horizons of directions across the normal.
    Horizon,
    /// A bit a sector of slices through the view direction.
    Bitmask,
}

/// `--show`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ShowSpelling {
    /// Surfaces in the light of the environment, and the environment behind them.
    Shaded,
    /// Share of the hemisphere that is open, 0 to 1.
    Openness,
    /// Unit bent normals in the world.
    BentNormals,
    /// Half angles of the bent cones, degrees.
    Angles,
}

/// Directions a pixel that are traced where no number is asked for.
const TRACED: u32 = 256;
/// Most directions a pixel that are traced.
pub const MOST_TRACED: u32 = 65_536;

/// Flags of the command. Every flag but --out has a default.
#[derive(clap::Args)]
pub struct Options {
    /// Mesh: OBJ or glTF, or one of the program's: bunny, suzanne, teapot, mushrooms, desk; may be given several times. What follows an
    /// `@` moves it by metres, scales it, and turns it by degrees: bunny@0,0,0,2,30.
    #[arg(long, value_name = "FILE|NAME[@X,Y,Z[,SCALE[,TURN]]]", default_value = "bunny", value_parser = parse::placed)]
    pub mesh: Vec<Placed>,
    /// Latitude-longitude map of radiance, twice as wide as high: .exr or .hdr (linear), .png (sRGB), or one of the program's: forest,
    /// sunset [default: forest].
    #[arg(long, value_name = "FILE|forest|sunset")]
    pub environment: Option<PathBuf>,
    /// Picture to write: .png (tone-mapped) or .exr (linear radiance).
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// How surfaces are lit.
    #[arg(long, value_enum, default_value = "cones")]
    pub method: MethodSpelling,
    /// How directions are looked at [default: hemisphere].
    #[arg(long, value_enum)]
    pub sampler: Option<SamplerSpelling>,
    /// Directions a pixel, 1 to 256; slices with --sampler horizon and bitmask; rays with --method reference, 1 to 65536 [default: 8,
    /// 256 rays].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub samples: Option<u32>,
    /// Steps along each direction, 1 to 256 [default: 3].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub steps: Option<u32>,
    /// Occluders count up to this distance, less the farther they are, metres, to 1e15 [default: a fifth of the diagonal of the box around
    /// the meshes; with --method reference any distance, and all of them fully].
    #[arg(long, value_name = "METRES", value_parser = parse::number, allow_hyphen_values = true)]
    pub radius: Option<f32>,
    /// How thick what is seen is taken to be, metres, to 1e15; with --sampler hemisphere and bitmask [default: the radius].
    #[arg(long, value_name = "METRES", value_parser = parse::number, allow_hyphen_values = true)]
    pub thickness: Option<f32>,
    /// Frame of a pattern that changes with time, for pictures to be averaged [default: 0, a static one].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub frame: Option<u32>,
    /// Side of the square of pixels that have different directions, and of the blur over it, 1 to 16 [default: 8].
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub interleave: Option<u32>,
    /// Occlusion at half the resolution, made whole along depth and normals.
    #[arg(long)]
    pub half: bool,
    /// No blur over the pattern.
    #[arg(long)]
    pub no_blur: bool,
    /// Blurs bent normals themselves rather than how they differ from normals.
    #[arg(long, conflicts_with = "no_blur")]
    pub plain_blur: bool,
    /// Brightness as the thesis prints it: darker where little is open.
    #[arg(long)]
    pub printed: bool,
    /// Reduces the environment to 32x16 texels first, which cones can follow.
    #[arg(long)]
    pub low_pass: bool,
    /// What the picture shows.
    #[arg(long, value_enum, default_value = "shaded")]
    pub show: ShowSpelling,
    /// The camera.
    #[command(flatten)]
    pub view: CameraFlags,
    /// Size of the picture.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    pub size: [u32; 2],
    /// Factor on the radiance before the tone curve of a .png [default: 1].
    #[arg(long, value_name = "F", value_parser = parse::number, allow_hyphen_values = true)]
    pub exposure: Option<f32>,
}

impl Options {
    /// How occlusion is looked for in screen space. `radius`: metres, where none was given.
    pub fn settings(&self, radius: f32) -> OcclusionSettings {
        let usual = OcclusionSettings::new(self.radius.unwrap_or(radius));
        OcclusionSettings {
            samples: self.samples.unwrap_or(usual.samples),
            steps: self.steps.unwrap_or(usual.steps),
            side: self.interleave.unwrap_or(usual.side),
            thickness: self.thickness.unwrap_or(usual.thickness),
            frame: self.frame.unwrap_or(usual.frame),
            ..usual
        }
    }

    /// How bent normals are found.
    pub fn form(&self) -> BentForm {
        let sampling = match self.sampler {
            Some(SamplerSpelling::Disc) => Sampling::Disc,
            None | Some(SamplerSpelling::Hemisphere) => Sampling::Hemisphere,
            Some(SamplerSpelling::Horizon) => Sampling::Horizon,
            Some(SamplerSpelling::Bitmask) => Sampling::Bitmask,
        };
        let blurring = match (self.no_blur, self.plain_blur) {
            (true, _) => Blurring::Off,
            (false, true) => Blurring::Plain,
            (false, false) => Blurring::Difference,
        };
        BentForm { sampling, blurring, occlusion_only: false, halved: self.half }
    }

    /// Rays a pixel.
    pub fn rays(&self) -> u32 {
        self.samples.unwrap_or(TRACED)
    }

    /// Where the picture is to be numbers rather than light.
    pub fn numbers(&self) -> bool {
        self.show != ShowSpelling::Shaded
    }

    /// Whether the picture is a .exr.
    pub fn linear(&self) -> bool {
        self.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
    }
}
