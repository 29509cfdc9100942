// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flags of `airlight transmittance`.

use crate::command::camera::CameraFlags;
use crate::command::parse::{self, LightSpelling};
use crate::command::volumes::{Made, VolumeFlags};
use crate::core::Reading;
use crate::transmittance::{Form, MapSettings, Precision};
use clap::ValueEnum;
use glam::Vec3;
use std::path::{Path, PathBuf};

/// `--map`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MapSpelling {
    /// Extinction transmittance map: cosines of extinction over the whole range.
    Etm,
    /// The same over the occupied interval of each texel: the most exact.
    Bounded,
    /// Fourier opacity map: the full period instead of cosines.
    Fom,
    /// Transmittance function map of cosines; volumes only.
    Tfm,
    /// Transmittance function map of the full period; volumes only.
    TfmFourier,
    /// Six power moments.
    Moments,
    /// Two trigonometric moments.
    Trigonometric,
    /// No map: a march to the light from every step of a view ray, or for each particle the sum over all of them.
    Reference,
}

impl MapSpelling {
    /// The form of the map, where there is one.
    pub fn form(self) -> Option<Form> {
        Some(match self {
            Self::Etm => Form::Extinction,
            Self::Bounded => Form::Bounded,
            Self::Fom => Form::Opacity,
            Self::Tfm => Form::Function,
            Self::TfmFourier => Form::FunctionPeriodic,
            Self::Moments => Form::PowerMoments,
            Self::Trigonometric => Form::TrigonometricMoments,
            Self::Reference => return None,
        })
    }
}

/// `--format`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormatSpelling {
    /// 32 bits a coefficient.
    Float32,
    /// 16 bits a coefficient.
    Float16,
}

/// `--splat`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SplatSpelling {
    /// Added in fixed point: any order gives the same map.
    Fixed,
    /// Blended additively in 16 bits, --map etm and fom only.
    Blend,
}

/// `--reading`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReadingSpelling {
    /// Between voxels, trilinear.
    Linear,
    /// The nearest voxel.
    Nearest,
}

/// Numbers a texel where none are asked for.
const COEFFICIENTS: u32 = 8;
/// Side of the map where none is asked for.
const MAP_SIZE: u32 = 512;

/// Flags of the command. Every flag but the medium and --out has a default.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("medium").required(true).args(["volume", "particles"]))]
#[command(
    mut_arg("extinction_scale", |scale| scale.help(
        "From values of a file of a volume to extinction in 1/m; of all else a factor on its extinction, 0 to 1e6 [default: 1; of files optical depth 32 at the greatest value along the longest side]"
    )),
    mut_arg("threshold", |threshold| threshold.help(
        "Value that is empty in a file of a volume: what exceeds it is extinction [default: 0]"
    )),
    mut_arg("voxels", |voxels| voxels.help(
        "Voxels along the longest side of cloud and plume, 4 to 512 [default: 160]"
    )),
    mut_arg("seed", |seed| seed.help("Another cloud, plume or burst for another number [default: 1]")),
)]
pub struct Options {
    /// Volume: NIfTI (.nii, .nii.gz), a .npy array [z, y, x], or one that is made: cloud or plume.
    #[arg(long, value_name = "FILE|cloud|plume")]
    pub volume: Option<PathBuf>,
    /// Particles: a .npy array [n, 5] of x, y, z, radius (m) and extinction (1/m), or some that are made: burst.
    #[arg(long, value_name = "FILE.npy|burst")]
    pub particles: Option<PathBuf>,
    /// Picture to write: .png (tone-mapped) or .exr (linear radiance).
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// How the light inside the medium is found.
    #[arg(long, value_enum, default_value = "bounded")]
    pub map: MapSpelling,
    /// Numbers a texel: 4, 8 or 16; moments have 8 [default: 8].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub coefficients: Option<u32>,
    /// Columns and rows of the map, 1 to 8192 [default: 512].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8192), allow_hyphen_values = true)]
    pub map_size: Option<u32>,
    /// Format of the layers of the map [default: float32; float16 with --splat blend].
    #[arg(long, value_enum)]
    pub format: Option<FormatSpelling>,
    /// Transmittance never rises along a light ray, at a greater error; --map etm and bounded.
    #[arg(long)]
    pub monotone: bool,
    /// How particles are added up in the map [default: fixed].
    #[arg(long, value_enum)]
    pub splat: Option<SplatSpelling>,
    /// Box that the map of particles holds, metres; what lies outside is dropped [default: all of them].
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = corners, allow_hyphen_values = true)]
    pub bounds: Option<[Vec3; 2]>,
    /// How the volume is read [default: linear].
    #[arg(long, value_enum)]
    pub reading: Option<ReadingSpelling>,
    /// How the volume is read or made.
    #[command(flatten)]
    pub of_volume: VolumeFlags,
    /// Particles of burst, 1 to 1000000 [default: 20000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000), allow_hyphen_values = true)]
    pub count: Option<u32>,
    /// Light: directional:AZ,EL (degrees, TOWARDS the light).
    #[arg(long, value_name = "LIGHT", default_value = "directional:70,40", value_parser = parse::light)]
    pub light: LightSpelling,
    /// Linear RGB irradiance of a surface that faces the light.
    #[arg(long, value_name = "R,G,B", default_value = "26,23,19", value_parser = parse::vector, allow_hyphen_values = true)]
    pub radiance: Vec3,
    /// Single-scattering albedo, 0..1, one number or R,G,B.
    #[arg(long, value_name = "A|R,G,B", default_value = "0.98", value_parser = parse::grey_or_colour, allow_hyphen_values = true)]
    pub albedo: Vec3,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    #[arg(long, value_name = "G", default_value = "0.2", value_parser = parse::number, allow_hyphen_values = true)]
    pub g: f32,
    /// The camera.
    #[command(flatten)]
    pub view: CameraFlags,
    /// Linear RGB radiance behind the medium, one number or R,G,B [default: a sky].
    #[arg(long, value_name = "A|R,G,B", value_parser = parse::grey_or_colour, allow_hyphen_values = true)]
    pub background: Option<Vec3>,
    /// Size of the picture.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    pub size: [u32; 2],
    /// Factor on the radiance before the tone curve of a .png.
    #[arg(long, value_name = "F", default_value = "1", value_parser = parse::number, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Folder for every intermediate buffer as .npy.
    #[arg(long, value_name = "DIR")]
    pub buffers: Option<PathBuf>,
}

/// What is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source<'a> {
    Made(Made),
    VolumeFile(&'a Path),
    Burst,
    ParticleFile(&'a Path),
}

impl Options {
    /// What is seen.
    pub fn source(&self) -> Source<'_> {
        match (self.volume.as_deref(), self.particles.as_deref()) {
            (Some(path), _) => match Made::of(path) {
                Some(made @ (Made::Cloud | Made::Plume)) => Source::Made(made),
                _ => Source::VolumeFile(path),
            },
            (None, Some(path)) if path.as_os_str() != "burst" => Source::ParticleFile(path),
            (None, _) => Source::Burst,
        }
    }

    /// The map, where there is one.
    pub fn settings(&self) -> Option<MapSettings> {
        let format = self.format.unwrap_or(match self.splat {
            Some(SplatSpelling::Blend) => FormatSpelling::Float16,
            _ => FormatSpelling::Float32,
        });
        let precision = match format {
            FormatSpelling::Float32 => Precision::Single,
            FormatSpelling::Float16 => Precision::Half,
        };
        let size = [self.map_size.unwrap_or(MAP_SIZE); 2];
        let coefficients = self.coefficients.unwrap_or(COEFFICIENTS);
        self.map.form().map(|form| MapSettings { form, coefficients, size, precision })
    }

    /// How a volume is read.
    pub fn reading(&self) -> Reading {
        match self.reading {
            Some(ReadingSpelling::Nearest) => Reading::Nearest,
            _ => Reading::Linear,
        }
    }
}

/// Two corners of a box.
fn corners(text: &str) -> Result<[Vec3; 2], String> {
    let values = text.split(',').map(parse::number).collect::<Result<Vec<_>, _>>()?;
    let [_, _, _, _, _, _] = values[..] else {
        return Err(format!("`{text}` is not a box: six numbers x,y,z,x,y,z are needed, least corner first"));
    };
    Ok([Vec3::from_slice(&values), Vec3::from_slice(&values[3..])])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_read_and_nonsense_is_refused() {
        assert_eq!(corners("-1,-2,-3,1,2,3"), Ok([Vec3::new(-1.0, -2.0, -3.0), Vec3::new(1.0, 2.0, 3.0)]));
        for wrong in ["", "1,2", "nan", "red", "1,2,inf"] {
            assert!(corners(wrong).is_err(), "{wrong}");
        }
    }
}
