// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flags of light, and of light that is solved for.

use crate::command::parse::{self, LightSpelling};
use crate::inverse::LightStrategy;
use clap::ValueEnum;
use glam::Vec3;
use std::path::PathBuf;

/// Where light comes from.
#[derive(clap::Args, Clone)]
pub struct LightFlags {
    /// Linear RGB radiance from all around that an albedo of 1 scatters, one number or R,G,B, 0 to 1e4; nothing takes it away on its way
    /// [default: 1 without --environment and --light]. A solve for light begins here.
    #[arg(long, value_name = "A|R,G,B", value_parser = parse::grey_or_colour, allow_hyphen_values = true)]
    pub ambient: Option<Vec3>,
    /// Surroundings that light the volume, which shadows itself: a latitude-longitude picture, .exr or .hdr (linear) or .png (sRGB). Views with
    /// an `environment` of their own have that instead of all other light.
    #[arg(long, value_name = "MAP")]
    pub environment: Option<PathBuf>,
    /// Directional lights that stand for --environment, 1 to 4096 [default: 64].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096), allow_hyphen_values = true)]
    pub environment_lights: Option<u32>,
    /// A light, whose way goes through the volume; may be given several times: directional:AZ,EL (degrees, TOWARDS the light),
    /// spot:X,Y,Z,TX,TY,TZ,ANGLE[,INNER] or point:X,Y,Z.
    #[arg(long, value_name = "LIGHT", value_parser = parse::light)]
    pub light: Vec<LightSpelling>,
    /// Linear RGB irradiance of each --light, one number or R,G,B, 0 to 1e4: of a surface that faces it, at one metre from a spot or point
    /// light; once for all, or once a light [default: 12,10.5,8.4; of a spot or point light as much in the middle of the volume].
    #[arg(long, value_name = "A|R,G,B", value_parser = parse::grey_or_colour, allow_hyphen_values = true)]
    pub radiance: Vec<Vec3>,
    /// Voxels of scattered light along the longest side, 1 to 512 [default: as many as --volume, 128 at most; of light that is solved for 32 at
    /// most].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=512), allow_hyphen_values = true)]
    pub light_resolution: Option<u32>,
}

/// How light is solved for.
#[derive(clap::Args)]
pub struct DiscFlags {
    /// With --for light: discs of light around the volume, 16 to 256 [default: 64].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=256), allow_hyphen_values = true)]
    pub lights: Option<u32>,
    /// With --for light: only above the horizon.
    #[arg(long)]
    pub upper: bool,
    /// With --for light: by volumes that lights are added up in, or by stored pictures of each light, which is faster where there are few lights
    /// and pixels [default: volumes].
    #[arg(long, value_enum)]
    pub light_strategy: Option<StrategySpelling>,
}

/// `--light-strategy`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StrategySpelling {
    /// A volume a light.
    Volumes,
    /// A picture a light and view.
    Stored,
}

impl From<StrategySpelling> for LightStrategy {
    fn from(of: StrategySpelling) -> Self {
        match of {
            StrategySpelling::Volumes => Self::Volumes,
            StrategySpelling::Stored => Self::Columns,
        }
    }
}
