// SPDX-License-Identifier: MIT OR Apache-2.0
//! How light goes from sheet to sheet: flags, and what cannot be meant.

use crate::command::parse::{self, LightSpelling};
use crate::splatting::{LightTransport, ScatteringSettings, SoftShadows};

/// Flags of the way of the light.
#[derive(clap::Args, Clone, Debug)]
pub struct TransportFlags {
    /// Light is scattered forward, again and again.
    #[arg(long)]
    pub forward: bool,
    /// Light is scattered back as well; with it --forward is meant.
    #[arg(long)]
    pub back: bool,
    /// How often light goes back and forth, 1 to 16; --back [default: 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16), allow_hyphen_values = true)]
    pub sweeps: Option<u32>,
    /// Half angle of the cone into which light is scattered forward, degrees, 0.5 to 80; --forward [default: 60].
    #[arg(long, value_name = "DEG", value_parser = parse::positive, allow_hyphen_values = true)]
    pub cone: Option<f32>,
    /// Metres over which light that is scattered forward spreads by that cone; --forward [default: the thickness of a sheet].
    #[arg(long, value_name = "M", value_parser = parse::positive, allow_hyphen_values = true)]
    pub free_path: Option<f32>,
    /// Soft shadows of an area light.
    #[arg(long)]
    pub soft: bool,
}

/// Widest cone, degrees.
const WIDEST: f32 = 80.0;

impl TransportFlags {
    /// Whether light is scattered again and again.
    pub fn scatters(&self) -> bool {
        self.forward || self.back
    }

    /// What cannot be meant: whether it is so, the flag, the problem.
    pub fn rules(&self, light: LightSpelling) -> [(bool, &'static str, &'static str); 7] {
        const FORWARD: &str = "it is of scattering: give --forward or --back as well, or leave it out";
        let area = matches!(light, LightSpelling::Area { .. });
        [
            (
                self.soft && self.scatters(),
                "--soft",
                "scattered light is soft by itself: leave it out, or --forward and --back",
            ),
            (self.soft && !area, "--soft", "only an area light casts soft shadows: take --light area:…"),
            (
                area && !self.soft,
                "--light",
                "`area` is for soft shadows: give --soft as well, or take directional or point",
            ),
            (
                self.sweeps.is_some() && !self.back,
                "--sweeps",
                "light goes forth once: give --back as well, or leave it out",
            ),
            (self.cone.is_some() && !self.scatters(), "--cone", FORWARD),
            (
                self.cone.is_some_and(|cone| cone > WIDEST),
                "--cone",
                "it is impossible: above 0 to 80 degrees are possible",
            ),
            (self.free_path.is_some() && !self.scatters(), "--free-path", FORWARD),
        ]
    }
}

/// The way of the light that the flags ask for.
pub fn transport(flags: &TransportFlags, light: LightSpelling) -> LightTransport {
    let usual = ScatteringSettings::default();
    match light {
        LightSpelling::Area { extent, .. } if flags.soft => LightTransport::Soft(SoftShadows::new(extent)),
        _ if flags.scatters() => LightTransport::Scattering(ScatteringSettings {
            cone: flags.cone.unwrap_or(usual.cone),
            free_path: flags.free_path.unwrap_or(usual.free_path),
            back: flags.back,
            sweeps: flags.sweeps.unwrap_or(1),
        }),
        _ => LightTransport::Direct,
    }
}
