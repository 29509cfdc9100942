// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flags of `airlight inverse`.

use crate::command::parse;
use crate::command::sequence::{FrameRange, frames, rate};
use crate::command::volumes::VolumeFlags;
use crate::inverse;
use clap::{Subcommand, ValueEnum};
use glam::Vec3;
use std::path::PathBuf;

mod light;

pub use light::{DiscFlags, LightFlags, StrategySpelling};

/// What is asked for.
#[derive(clap::Args)]
pub struct Options {
    #[command(subcommand)]
    pub task: Task,
}

/// There and back.
#[derive(Subcommand)]
pub enum Task {
    /// Pictures of a volume from the views of a file, to paint on: a .png and an .exr a view, and a views.toml that names them as what
    /// is wanted.
    Render(Box<RenderOptions>),
    /// The volume whose pictures are nearest to those that are wanted.
    Solve(Box<SolveOptions>),
}

/// The volume and its light, as both tasks know them.
#[derive(clap::Args, Clone)]
#[command(
    mut_arg("extinction_scale", |scale| scale.help(
        "Factor from the values of --volume to extinction in 1/m, 0 to 1e6 [default: 1 of volumes that are made; of files optical depth 32 along the longest side, were all of it as dense as its densest voxel]"
    )),
    mut_arg("threshold", |threshold| threshold.help(
        "Subtracted from the values of --volume; what is not greater is empty [default: 0]"
    )),
    mut_arg("voxels", |voxels| voxels.help(
        "Voxels along the longest side of a volume that is made, 4 to 512 [default: 64]"
    )),
)]
pub struct MediumFlags {
    /// Extinction: NIfTI (.nii, .nii.gz), a .npy array [z, y, x] or [z, y, x, 3], or a volume that is made: cloud, clouds, plume, smoke.
    #[arg(long, value_name = "FILE|cloud|clouds|plume|smoke")]
    pub volume: PathBuf,
    /// Views: a TOML file of cameras, and of the pictures that are wanted.
    #[arg(long, value_name = "FILE.toml")]
    pub views: PathBuf,
    /// Folder to write into; it is made where it is missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// How the volume is read or made.
    #[command(flatten)]
    pub of_volume: VolumeFlags,
    /// Emission: radiance of a medium so thick that nothing shines through, 0 to 1e4: a volume in the same box (.nii, .nii.gz, .npy), or
    /// one number or R,G,B for all of it. A solve for emission begins here.
    #[arg(long, value_name = "FILE|E|R,G,B", default_value = "0", value_parser = property, allow_hyphen_values = true)]
    pub emission: Property,
    /// Albedo, 0 to 1, likewise. A solve for albedo begins here.
    #[arg(long, value_name = "FILE|A|R,G,B", default_value = "0.8", value_parser = property, allow_hyphen_values = true)]
    pub albedo: Property,
    /// Where light comes from.
    #[command(flatten)]
    pub light: LightFlags,
    /// Index of refraction, which bends rays: one number a voxel, 0.01 to 100, in the same box (.nii, .nii.gz, .npy).
    #[arg(long, value_name = "FILE")]
    pub refraction: Option<PathBuf>,
    /// Length of a step of bent rays, metres [default: half the side of a voxel].
    #[arg(long, value_name = "M", value_parser = parse::positive, allow_hyphen_values = true)]
    pub refraction_step: Option<f32>,
    /// Steps of rays through the volume, 1 to 2048 [default: voxels along its longest side].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2048), allow_hyphen_values = true)]
    pub steps: Option<u32>,
}

/// Flags of `airlight inverse render`.
#[derive(clap::Args)]
pub struct RenderOptions {
    /// The volume.
    #[command(flatten)]
    pub medium: MediumFlags,
}

/// Flags of `airlight inverse solve`.
#[derive(clap::Args)]
pub struct SolveOptions {
    /// The volume.
    #[command(flatten)]
    pub medium: MediumFlags,
    /// What is solved for: emission, albedo, both (emission,albedo), extinction or light; given several times, one stage after another.
    #[arg(long = "for", value_name = "emission,albedo|emission|albedo|extinction|light", required = true, value_parser = wanted)]
    pub wanted: Vec<Wanted>,
    /// Iterations of each stage, 1 to 1024.
    #[arg(long, value_name = "N", default_value = "6", value_parser = clap::value_parser!(u32).range(1..=1024), allow_hyphen_values = true)]
    pub iterations: u32,
    /// Weight of the squared Laplacian, 0 to 1e6: how smooth the result is. These three weights are multiples of what the pictures say of
    /// a voxel in the mean.
    #[arg(long, value_name = "W", default_value = "0.002", value_parser = parse::number, allow_hyphen_values = true)]
    pub laplacian: f32,
    /// Weight of the squared values, 0 to 1e6: how small they are.
    #[arg(long, value_name = "W", default_value = "0", value_parser = parse::number, allow_hyphen_values = true)]
    pub smallness: f32,
    /// Weight of the squared differences from 1, 0 to 1e6.
    #[arg(long, value_name = "W", default_value = "0", value_parser = parse::number, allow_hyphen_values = true)]
    pub oneness: f32,
    /// Voxels along the longest side of what is solved for, 1 to 2048 [default: as many as --volume].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2048), allow_hyphen_values = true)]
    pub resolution: Option<u32>,
    /// The same of emission alone.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2048), allow_hyphen_values = true)]
    pub emission_resolution: Option<u32>,
    /// The same of albedo alone.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2048), allow_hyphen_values = true)]
    pub albedo_resolution: Option<u32>,
    /// Colours by channel, or one channel: the luminance of everything.
    #[arg(long, value_enum, default_value = "rgb")]
    pub channels: ChannelSpelling,
    /// What lies between the middles of voxels that are solved for: straight lines, or each voxel has one value.
    #[arg(long, value_enum, default_value = "triangle")]
    pub basis: BasisSpelling,
    /// Only voxels inside the masks of all views are solved for; the others are 0.
    #[arg(long)]
    pub hull: bool,
    /// Empty voxels are solved for too: the Laplacian goes on into them, for extinction that changes later.
    #[arg(long)]
    pub keep_empty: bool,
    /// With --for extinction: linear RGB radiance of the medium, one number or R,G,B, 0 to 1e4 [default: 0].
    #[arg(long, value_name = "A|R,G,B", value_parser = parse::grey_or_colour, allow_hyphen_values = true)]
    pub medium_radiance: Option<Vec3>,
    /// With --for extinction: greatest optical depth along a ray that a picture may ask for, 0.01 to 80 [default: 6].
    #[arg(long, value_name = "D", value_parser = parse::number, allow_hyphen_values = true)]
    pub most_depth: Option<f32>,
    /// Light that is solved for.
    #[command(flatten)]
    pub discs: DiscFlags,
    /// Frames A to B, both included, between key frames: views of each time are solved for by themselves, and what was found is blended.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true)]
    pub frames: Option<FrameRange>,
    /// With --frames: view from which frames are seen, in its light [default: the first].
    #[arg(long, value_name = "VIEW")]
    pub seen_from: Option<String>,
    /// With --frames: frames a second [default: 24].
    #[arg(long, value_name = "N", value_parser = rate, allow_hyphen_values = true)]
    pub rate: Option<f32>,
}

/// `--channels`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ChannelSpelling {
    /// Luminance.
    One,
    /// Red, green and blue.
    Rgb,
}

impl From<ChannelSpelling> for inverse::Channels {
    fn from(of: ChannelSpelling) -> Self {
        match of {
            ChannelSpelling::One => Self::One,
            ChannelSpelling::Rgb => Self::Rgb,
        }
    }
}

/// `--basis`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BasisSpelling {
    /// Straight between the middles.
    Triangle,
    /// One value a voxel.
    Box,
}

impl From<BasisSpelling> for inverse::Basis {
    fn from(of: BasisSpelling) -> Self {
        match of {
            BasisSpelling::Triangle => Self::Triangle,
            BasisSpelling::Box => Self::Box,
        }
    }
}

/// `--emission`, `--albedo`.
#[derive(Clone, Debug, PartialEq)]
pub enum Property {
    /// The same everywhere.
    Constant(Vec3),
    /// A volume.
    File(PathBuf),
}

fn property(text: &str) -> Result<Property, String> {
    if let Ok(colour) = parse::grey_or_colour(text) {
        return Ok(Property::Constant(colour));
    }
    let path = PathBuf::from(text);
    let name = text.to_lowercase();
    if [".nii", ".nii.gz", ".npy"].iter().any(|ending| name.ends_with(ending)) {
        return Ok(Property::File(path));
    }
    Err(format!(
        "`{text}` is neither a number, nor three R,G,B, nor a file that ends in .nii, .nii.gz or .npy"
    ))
}

/// `--for`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Emission.
    Emission,
    /// Albedo.
    Albedo,
    /// Both at once.
    Both,
    /// Extinction.
    Extinction,
    /// Light from all around.
    Light,
}

impl Wanted {
    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Emission => "emission",
            Self::Albedo => "albedo",
            Self::Both => "emission,albedo",
            Self::Extinction => "extinction",
            Self::Light => "light",
        }
    }

    /// Whether emission is solved for.
    pub fn emission(self) -> bool {
        matches!(self, Self::Emission | Self::Both)
    }

    /// Whether albedo is solved for.
    pub fn albedo(self) -> bool {
        matches!(self, Self::Albedo | Self::Both)
    }
}

fn wanted(text: &str) -> Result<Wanted, String> {
    match text {
        "emission" => Ok(Wanted::Emission),
        "albedo" => Ok(Wanted::Albedo),
        "emission,albedo" | "albedo,emission" => Ok(Wanted::Both),
        "extinction" => Ok(Wanted::Extinction),
        "light" => Ok(Wanted::Light),
        _ => Err(format!("`{text}` is unknown: give emission, albedo, emission,albedo, extinction or light")),
    }
}

impl SolveOptions {
    /// Whether any stage solves for it.
    pub fn any(&self, of: impl Fn(Wanted) -> bool) -> bool {
        self.wanted.iter().any(|wanted| of(*wanted))
    }
}
