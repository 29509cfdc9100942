// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes that are made: their names, and the shapes of their boxes.

use super::voxels;
use crate::data::{Volume, cloud, cloud_bank, plume, smoke};
use std::path::Path;

/// What `--volume` takes, where it takes all.
pub const KNOWN: &str = "cloud, clouds, plume, smoke, or a file that ends in .nii, .nii.gz or .npy";
/// What is wrong with a seed of files.
pub const SEED_OF_FILES: &str = "files are as they are: leave it out, or take cloud, clouds, plume or smoke";

/// A volume that is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    Cloud,
    Clouds,
    Plume,
    Smoke,
}

impl Made {
    /// What a name means; none of the path of a file.
    pub fn of(name: &Path) -> Option<Self> {
        match name.to_str() {
            Some("cloud") => Some(Self::Cloud),
            Some("clouds") => Some(Self::Clouds),
            Some("plume") => Some(Self::Plume),
            Some("smoke") => Some(Self::Smoke),
            _ => None,
        }
    }

    /// The volume with `count` voxels along its longest side.
    pub fn volume(self, count: u32, seed: u64) -> Volume {
        match self {
            Self::Cloud => cloud(voxels(count, [6.0, 3.0, 5.0]), seed),
            Self::Clouds => cloud_bank(voxels(count, [16.0, 4.0, 16.0]), seed),
            Self::Plume => plume(voxels(count, [2.0, 5.0, 2.0]), seed),
            Self::Smoke => smoke(voxels(count, [4.0, 3.0, 4.0]), seed),
        }
    }
}
