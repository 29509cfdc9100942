// SPDX-License-Identifier: MIT OR Apache-2.0
//! The scans that are part of the program, from `host/assets`.

use super::CommandError;
use crate::data::{Volume, volume_from_bytes};

/// Magnetic resonance of a head without its skull, values 0 to 255.
pub fn head() -> Result<Volume, CommandError> {
    read("head_mri.nii.gz", include_bytes!("../../assets/head_mri.nii.gz"))
}

/// Computed tomography of an abdomen with a stent in its aorta, values 0 to 32.
pub fn stent() -> Result<Volume, CommandError> {
    read("stent_ct.nii.gz", include_bytes!("../../assets/stent_ct.nii.gz"))
}

fn read(name: &str, bytes: &[u8]) -> Result<Volume, CommandError> {
    volume_from_bytes(name, bytes).map_err(CommandError::failure)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn scans_have_the_values_that_transfer_functions_expect() {
        for (volume, greatest) in [(head().unwrap(), 255.0), (stent().unwrap(), 32.0)] {
            assert_eq!(volume.values.iter().copied().fold(f32::NAN, f32::max), greatest);
            assert_eq!(volume.values.iter().copied().fold(f32::NAN, f32::min), 0.0);
        }
    }
}
