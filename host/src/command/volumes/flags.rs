// SPDX-License-Identifier: MIT OR Apache-2.0
//! Flags of volumes beside `--volume`, which each command spells for itself. A command says with `mut_arg` what it does where a
//! flag is not given.

use crate::command::CommandError;
use crate::command::parse;

/// Greatest extinction a unit of value, 1/m.
const MOST_SCALE: f32 = 1e6;

/// Flags of volumes.
#[derive(clap::Args, Clone, Debug)]
pub struct VolumeFlags {
    /// Factor from values to extinction in 1/m, 0 to 1e6.
    #[arg(long, value_name = "S", value_parser = parse::number, allow_hyphen_values = true)]
    pub extinction_scale: Option<f32>,
    /// Value up to which voxels are empty.
    #[arg(long, value_name = "V", value_parser = parse::number, allow_hyphen_values = true)]
    pub threshold: Option<f32>,
    /// Side of a voxel of a .npy --volume, metres [default: the longest side of the volume is 4 m].
    #[arg(long, value_name = "M", value_parser = parse::positive, allow_hyphen_values = true)]
    pub voxel: Option<f32>,
    /// Voxels along the longest side of a volume that is made, 4 to 512.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=512), allow_hyphen_values = true)]
    pub voxels: Option<u32>,
    /// Another volume, where one is made, for another number [default: 1].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub seed: Option<u64>,
}

impl VolumeFlags {
    /// Which of the volumes that are made.
    pub fn seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }

    /// What cannot be meant: whether it is broken, the flag, the problem. `array`: there is a .npy volume. Of voxels and seeds:
    /// whether there is what has them, and what is said where there is not.
    pub fn rules(
        &self,
        array: bool,
        (voxels, without_voxels): (bool, &'static str),
        (seed, without_seed): (bool, &'static str),
    ) -> [(bool, &'static str, &'static str); 3] {
        [
            (!array && self.voxel.is_some(), "--voxel", "it is of .npy files of --volume: leave it out"),
            (!voxels && self.voxels.is_some(), "--voxels", without_voxels),
            (!seed && self.seed.is_some(), "--seed", without_seed),
        ]
    }

    /// Checks the factor.
    ///
    /// # Errors
    /// Misuse.
    pub fn check_scale(&self) -> Result<(), CommandError> {
        match self.extinction_scale.filter(|scale| !(0.0..=MOST_SCALE).contains(scale)) {
            Some(scale) => Err(CommandError::misuse(
                "--extinction-scale",
                format!("{scale} is impossible: 0 to 1e6 is possible"),
            )),
            None => Ok(()),
        }
    }
}
