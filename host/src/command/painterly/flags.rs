// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flags of `airlight painterly`.

use crate::command::camera::CameraFlags;
use crate::command::parse::{self, LightSpelling};
use crate::command::scattering::JitterSpelling;
use crate::command::sequence::{FrameRange, frames, rate};
use crate::data::linear_from_hexadecimal;
use crate::painterly::{IsoSettings, Orientation};
use clap::ValueEnum;
use glam::{Vec3, Vec4};
use std::path::PathBuf;

/// `--orientation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OrientationSpelling {
    /// At right angles to the gradient in the picture.
    Gradient,
    /// All at the style's angle.
    Fixed,
    /// Along the direction of greatest curvature.
    Curvature,
}

impl OrientationSpelling {
    /// The library's.
    pub fn orientation(self) -> Orientation {
        match self {
            Self::Gradient => Orientation::Gradient,
            Self::Fixed => Orientation::Fixed,
            Self::Curvature => Orientation::Curvature,
        }
    }
}

/// Flags of the command. Every flag but the volume and --out has a default.
#[derive(clap::Args)]
pub struct Options {
    /// Volume: NIfTI (.nii, .nii.gz) or a .npy array [z, y, x].
    #[arg(long, value_name = "FILE")]
    pub volume: PathBuf,
    /// Folder for painting.png; it is created.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Colours and opacities of values: head, stent, or a TOML file [default: a ramp from the least value to the greatest].
    #[arg(long, value_name = "FILE.toml|head|stent")]
    pub transfer: Option<PathBuf>,
    /// Opacity from which on the volume is solid, above 0, at most 1.
    #[arg(long, value_name = "V", default_value = "0.5", value_parser = parse::number, allow_hyphen_values = true)]
    pub iso: f32,
    /// Style of the strokes: a, b, c, dense, or a TOML file.
    #[arg(long, value_name = "a|b|c|dense|FILE.toml", default_value = "dense")]
    pub style: PathBuf,
    /// Which way strokes run [default: as the style says].
    #[arg(long, value_enum)]
    pub orientation: Option<OrientationSpelling>,
    /// A brush, a stroke from left to right, in place of the computed ones; may be given several times.
    #[arg(long, value_name = "PNG")]
    pub brush: Vec<PathBuf>,
    /// Degrees that the volume turns about the vertical axis from frame to frame [default: 3].
    #[arg(long, value_name = "DEG/FRAME", value_parser = parse::number, allow_hyphen_values = true)]
    pub turn: Option<f32>,
    /// Frames A to B, both included: pictures painting.0000.png, and painting.png as an animated PNG of them.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true)]
    pub frames: Option<FrameRange>,
    /// Frames a second, by which strokes fade [default: 24].
    #[arg(long, value_name = "N", value_parser = rate, allow_hyphen_values = true)]
    pub rate: Option<f32>,
    /// Frames before the first, in which strokes gather unseen; each counts as a second. 0 to 1000.
    #[arg(long, value_name = "N", default_value = "12", value_parser = clap::value_parser!(u32).range(0..=1000), allow_hyphen_values = true)]
    pub settle: u32,
    /// Size of the picture.
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse::size)]
    pub size: [u32; 2],
    /// Rays along a side of the picture over its pixels, 0.01 to 1; strokes are drawn at full size.
    #[arg(long, value_name = "S", default_value = "1", value_parser = source_scale, allow_hyphen_values = true)]
    pub source_scale: f32,
    /// Averages N x N x N voxels before the upload, 1 to 64.
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u32).range(1..=64), allow_hyphen_values = true)]
    pub downsample: u32,
    /// Side of a voxel of a .npy volume, metres [default: the longest side is 4 m].
    #[arg(long, value_name = "M", value_parser = parse::positive, allow_hyphen_values = true)]
    pub voxel: Option<f32>,
    /// Light: directional:AZ,EL (degrees, TOWARDS the light). It stands still where the volume turns.
    #[arg(long, value_name = "LIGHT", default_value = "directional:-40,45", value_parser = parse::light)]
    pub light: LightSpelling,
    /// Factor on the light, 0 to 1000.
    #[arg(long, value_name = "F", default_value = "1", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: f32,
    /// The camera.
    #[command(flatten)]
    pub view: CameraFlags,
    /// A plane in the world that cuts away what lies where NX x + NY y + NZ z + OFFSET < 0; up to eight may be given.
    #[arg(long, value_name = "NX,NY,NZ,OFFSET", value_parser = plane, allow_hyphen_values = true)]
    pub clip: Vec<Vec4>,
    /// Steps of a ray along the shortest side of a voxel, 0.25 to 16.
    #[arg(long, value_name = "N", default_value = "2", value_parser = parse::number, allow_hyphen_values = true)]
    pub steps: f32,
    /// How the starts of steps are shifted from pixel to pixel.
    #[arg(long, value_enum, default_value = "none")]
    pub jitter: JitterSpelling,
    /// Other strokes for another number.
    #[arg(long, value_name = "N", default_value = "1", allow_hyphen_values = true)]
    pub seed: u32,
    /// Strokes that there may be at a time; where more would be born they are dropped, and counted.
    #[arg(long, value_name = "N", default_value = "98304", allow_hyphen_values = true)]
    pub capacity: u32,
    /// Colour that strokes are put on.
    #[arg(long, value_name = "#rrggbb", default_value = "#f4efe4", value_parser = colour)]
    pub canvas: Vec3,
    /// How much of the surface is painted under the strokes, 0 to 1.
    #[arg(long, value_name = "U", default_value = "0.5", value_parser = share, allow_hyphen_values = true)]
    pub underpainting: f32,
    /// Folder for what rays found and what strokes there are in the last frame, as .npy.
    #[arg(long, value_name = "DIR")]
    pub buffers: Option<PathBuf>,
}

/// Degrees from frame to frame where none are asked for.
const TURN: f32 = 3.0;

impl Options {
    /// The frames that are written.
    pub fn shown(&self) -> FrameRange {
        self.frames.unwrap_or(FrameRange { first: 0, count: 1 })
    }

    /// Degrees from frame to frame.
    pub fn turning(&self) -> f32 {
        self.turn.unwrap_or(TURN)
    }

    /// Columns and rows of rays.
    pub fn source_size(&self) -> [u32; 2] {
        self.size.map(|side| ((side as f32 * self.source_scale).round() as u32).clamp(1, side))
    }

    /// Which surface is seen. `distance_limit`: where rays end, metres.
    pub fn surface(&self, distance_limit: f32) -> IsoSettings {
        IsoSettings {
            iso_value: self.iso,
            steps_per_voxel: self.steps,
            distance_limit,
            clip_planes: self.clip.clone(),
            ..IsoSettings::default()
        }
    }
}

fn within(text: &str, low: f32, high: f32) -> Result<f32, String> {
    let value = parse::number(text)?;
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(format!("`{text}` is impossible: {low} to {high} is possible"))
    }
}

fn source_scale(text: &str) -> Result<f32, String> {
    within(text, 0.01, 1.0)
}

fn exposure(text: &str) -> Result<f32, String> {
    within(text, 0.0, 1000.0)
}

fn share(text: &str) -> Result<f32, String> {
    within(text, 0.0, 1.0)
}

/// `nx,ny,nz,offset`.
fn plane(text: &str) -> Result<Vec4, String> {
    let values = text.split(',').map(parse::number).collect::<Result<Vec<_>, _>>()?;
    let [x, y, z, offset] = values[..] else {
        return Err(format!("`{text}` is not a plane: four numbers nx,ny,nz,offset are needed"));
    };
    Ok(Vec4::new(x, y, z, offset))
}

/// `#rrggbb` in linear light.
fn colour(text: &str) -> Result<Vec3, String> {
    linear_from_hexadecimal(text)
        .map(Vec3::from)
        .ok_or_else(|| format!("`{text}` is no colour: write #rrggbb, such as #ffffff"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_colours_and_shares_are_read_and_nonsense_is_refused() {
        assert_eq!(plane("0,1,-2,0.5"), Ok(Vec4::new(0.0, 1.0, -2.0, 0.5)));
        assert_eq!(colour("#ff0000"), Ok(Vec3::X));
        assert_eq!((share("0"), source_scale("0.5"), exposure("2")), (Ok(0.0), Ok(0.5), Ok(2.0)));
        for wrong in ["", "1,2,3", "1,2,3,4,5", "a,b,c,d", "1,2,3,nan"] {
            assert!(plane(wrong).is_err() && colour(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "-0.1", "1.1", "nan", "half"] {
            assert!(share(wrong).is_err() && source_scale(wrong).is_err(), "{wrong}");
        }
        assert!(source_scale("0").is_err_and(|error| error.contains("0.01 to 1")));
        assert!(exposure("-1").is_err_and(|error| error.contains("0 to 1000")));
    }
}
