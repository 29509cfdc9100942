// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether pictures and volumes fit into the device, before anything is made.

use super::error::SolveError;
use crate::inverse::Channels;

/// What has to fit.
pub struct Needs<'a> {
    /// Of pictures and volumes.
    pub channels: Channels,
    /// Flag, name and voxels of volumes that are read.
    pub known: &'a [(&'static str, &'static str, [u32; 3])],
    /// Voxels of volumes that are solved for.
    pub unknown: &'a [[u32; 3]],
    /// Names and sizes of views.
    pub views: &'a [(&'a str, [u32; 2])],
    /// Whether steps of rays are kept between passes, as for emission and albedo.
    pub steps: bool,
}

impl Needs<'_> {
    /// Refuses what is more than the device takes.
    ///
    /// # Errors
    /// [`SolveError::TooLarge`].
    pub fn check(&self, limits: &wgpu::Limits) -> Result<(), SolveError> {
        let texel = 4 * self.channels.numbers() as u64;
        let side = u64::from(limits.max_texture_dimension_3d);
        let sides = |flag, what: String, size: &[u32], remedy| {
            let needed = size.iter().copied().max().map_or(0, u64::from);
            let (unit, limit) = ("texels along a side", side);
            refuse(needed > limit, SolveError::TooLarge { flag, what, needed, unit, limit, remedy })
        };
        for (flag, name, size) in self.known {
            let [x, y, z] = size;
            let what = format!("{name} of {x}x{y}x{z} voxels");
            sides(flag, what, size, "resample it to fewer voxels")?;
        }
        for size in self.unknown {
            let [x, y, z] = size;
            let what = || format!("volumes of {x}x{y}x{z} voxels that are solved for");
            sides("--resolution", what(), size, "give fewer")?;
            let needed = texel * size.map(u64::from).iter().product::<u64>();
            let limit = limits.max_storage_buffer_binding_size;
            let unit = "bytes in one piece";
            let (flag, remedy) = ("--resolution", "give fewer voxels, or --channels one");
            refuse(needed > limit, SolveError::TooLarge { flag, what: what(), needed, unit, limit, remedy })?;
        }
        for (name, size) in self.views {
            let [width, height] = size;
            let what = || format!("pictures of view `{name}` of {width}x{height} pixels");
            if self.steps {
                sides("--views", what(), size, "give the view a smaller size")?;
            }
            let row = (texel * u64::from(*width)).next_multiple_of(256);
            let (needed, limit) = (row * u64::from(*height), limits.max_buffer_size);
            let (flag, unit, remedy) = ("--views", "bytes in one piece", "give the view a smaller size");
            refuse(needed > limit, SolveError::TooLarge { flag, what: what(), needed, unit, limit, remedy })?;
        }
        Ok(())
    }
}

fn refuse(refused: bool, error: SolveError) -> Result<(), SolveError> {
    if refused { Err(error) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_large_is_said_with_its_bytes() {
        let limits = wgpu::Limits::default();
        let needs = |known, unknown, view| {
            let views = [("front", view)];
            let known = [("--volume", "extinction", known)];
            let unknown = [unknown];
            Needs { channels: Channels::Rgb, known: &known, unknown: &unknown, views: &views, steps: true }
                .check(&limits)
                .err()
                .map(|error| error.to_string())
                .unwrap_or_default()
        };
        assert_eq!(needs([2048, 3, 1], [200; 3], [2048, 2048]), "");
        assert!(needs([2049, 3, 1], [2; 3], [9, 9]).contains("extinction of 2049x3x1 voxels need 2049"));
        let said = needs([2; 3], [256; 3], [9, 9]);
        assert!(
            said.contains("268435456 bytes") && said.contains("134217728") && said.contains("--channels one")
        );
        assert!(needs([2; 3], [2; 3], [9, 2049]).contains("view `front` of 9x2049"));
    }
}
