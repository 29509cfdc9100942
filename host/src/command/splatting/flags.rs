// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flags of `airlight splatting`.

use super::transport::TransportFlags;
use crate::command::camera::CameraFlags;
use crate::command::parse::{self, LightSpelling, Placed};
use crate::command::sequence::{FrameRange, frames, rate};
use crate::command::volumes::VolumeFlags;
use crate::splatting::{Shading, SheetSettings};
use clap::ValueEnum;
use glam::Vec3;
use std::path::PathBuf;

/// `--shading`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ShadingSpelling {
    /// The medium scatters, like droplets.
    Scattering,
    /// It reflects across its gradient, like surfaces.
    Phong,
}

/// Flags of the command. Every flag but --volume and --out has a default.
#[derive(clap::Args)]
#[command(
    mut_arg("extinction_scale", |scale| scale.help(
        "Extinction where the transfer function's opacity is 1, 1/m, 0 to 1e6 [default: of volumes that are made what they have; with files optical depth 100 along the longest side]"
    )),
    mut_arg("threshold", |threshold| threshold.help(
        "Voxels of no greater value are left out [default: those that the transfer function makes transparent]"
    )),
    mut_arg("voxels", |voxels| voxels.help(
        "Voxels along the longest side of volumes that are made, 4 to 512 [default: 128]"
    )),
)]
pub struct Options {
    /// Volume: NIfTI (.nii, .nii.gz), a .npy array [z, y, x], or one that is made: cloud, clouds, plume or smoke; may be given several
    /// times. What follows an `@` moves it by metres, scales it, and turns it by degrees: clouds@0,-4,0,2,30.
    #[arg(long, value_name = "FILE|cloud|clouds|plume|smoke[@X,Y,Z[,SCALE[,TURN]]]", required = true, value_parser = parse::placed)]
    pub volume: Vec<Placed>,
    /// Mesh file, OBJ or glTF, placed as --volume is; may be given several times.
    #[arg(long, value_name = "FILE[@X,Y,Z[,SCALE[,TURN]]]", value_parser = parse::placed)]
    pub mesh: Vec<Placed>,
    /// Picture to write: .png (tone-mapped) or .exr (linear radiance); with --frames a .png.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Colours and opacities of values: cloud, smoke, head, stent, vessels, or a TOML file.
    #[arg(long, value_name = "FILE.toml|NAME", default_value = "cloud")]
    pub transfer: PathBuf,
    /// How volumes are read or made.
    #[command(flatten)]
    pub of_volume: VolumeFlags,
    /// What the medium does with light.
    #[arg(long, value_enum, default_value = "scattering")]
    pub shading: ShadingSpelling,
    /// Factor on the transfer function's colours, one number or R,G,B, 0 to 1.
    #[arg(long, value_name = "A|R,G,B", default_value = "1", value_parser = parse::grey_or_colour, allow_hyphen_values = true)]
    pub albedo: Vec3,
    /// Mean cosine of the phase function, -0.99 to 0.99; --shading scattering [default: 0.2].
    #[arg(long, value_name = "G", value_parser = parse::number, allow_hyphen_values = true)]
    pub g: Option<f32>,
    /// Linear RGB radiance from all around, one number or R,G,B, 0 to 1e4.
    #[arg(long, value_name = "A|R,G,B", default_value = "0.06,0.08,0.12", value_parser = parse::grey_or_colour, allow_hyphen_values = true)]
    pub ambient: Vec3,
    /// Sheets, 1 to 4096.
    #[arg(long, value_name = "N", default_value = "128", value_parser = clap::value_parser!(u32).range(1..=4096), allow_hyphen_values = true)]
    pub sheets: u32,
    /// Columns and rows of the shadow buffer, 1 to 8192.
    #[arg(long, value_name = "N", default_value = "512", value_parser = clap::value_parser!(u32).range(1..=8192), allow_hyphen_values = true)]
    pub light_size: u32,
    /// Light: directional:AZ,EL (degrees, TOWARDS the light), spot:X,Y,Z,TX,TY,TZ,ANGLE[,INNER], point:X,Y,Z,
    /// area:AZ,EL,DEGREES (across) or area:X,Y,Z,SIDE (metres); area lights with --soft.
    #[arg(long, value_name = "LIGHT", default_value = "directional:70,40", value_parser = parse::light)]
    pub light: LightSpelling,
    /// Linear RGB irradiance of a surface that faces the light, at one metre from a light at a point, 0 to 60000 [default:
    /// 16,14.2,11.7, of surfaces (--shading phong) half of it; of a light at a point as much in the middle of the volumes].
    #[arg(long, value_name = "R,G,B", value_parser = parse::vector, allow_hyphen_values = true)]
    pub radiance: Option<Vec3>,
    /// Picture that colours the light, .png or .exr, over the whole shadow buffer.
    #[arg(long, value_name = "FILE")]
    pub light_texture: Option<PathBuf>,
    /// How light goes from sheet to sheet.
    #[command(flatten)]
    pub transport: TransportFlags,
    /// The camera.
    #[command(flatten)]
    pub view: CameraFlags,
    /// Linear RGB radiance behind everything, one number or R,G,B [default: a sky].
    #[arg(long, value_name = "A|R,G,B", value_parser = parse::grey_or_colour, allow_hyphen_values = true)]
    pub background: Option<Vec3>,
    /// Frames A to B, both included: pictures NAME.0000.png beside --out, which is an animated PNG of them.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true)]
    pub frames: Option<FrameRange>,
    /// Degrees that the eye goes round the target from frame to frame [default: 3].
    #[arg(long, value_name = "DEG/FRAME", value_parser = parse::number, allow_hyphen_values = true)]
    pub turn: Option<f32>,
    /// Frames a second [default: 24].
    #[arg(long, value_name = "N", value_parser = rate, allow_hyphen_values = true)]
    pub rate: Option<f32>,
    /// Size of the picture.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    pub size: [u32; 2],
    /// Factor on the radiance before the tone curve of a .png.
    #[arg(long, value_name = "F", default_value = "1", value_parser = parse::number, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Folder for the medium, what is left of the light, and what lies behind, of the last frame, as .npy.
    #[arg(long, value_name = "DIR")]
    pub buffers: Option<PathBuf>,
}

/// Degrees from frame to frame where none are asked for.
const TURN: f32 = 3.0;
/// Voxels along the longest side of what is made.
const VOXELS: u32 = 128;

impl Options {
    /// The frames that are written.
    pub fn shown(&self) -> FrameRange {
        self.frames.unwrap_or(FrameRange { first: 0, count: 1 })
    }

    /// Where the eye is in a frame, degrees.
    pub fn turned(&self, frame: u32) -> f64 {
        if self.frames.is_none() { 0.0 } else { f64::from(frame) * f64::from(self.turn.unwrap_or(TURN)) }
    }

    /// Voxels along the longest side of what is made.
    pub fn voxels(&self) -> u32 {
        self.of_volume.voxels.unwrap_or(VOXELS)
    }

    /// How sheets are drawn, but for the way of the light.
    pub fn settings(&self) -> SheetSettings {
        SheetSettings {
            count: self.sheets,
            light_size: [self.light_size; 2],
            shading: match self.shading {
                ShadingSpelling::Scattering => Shading::Scattering,
                ShadingSpelling::Phong => Shading::Phong,
            },
            ..SheetSettings::default()
        }
    }
}
