// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `core/sort`: a stable radix sort of keys with values.

use super::Scan;
use crate::gpu::Gpu;
use crate::pass::{Pass, PassError};
use crate::resource::Buffer;
use crate::shaders::Shaders;
use encase::ShaderType;

/// Keys a workgroup sorts.
const BLOCK: u32 = 1024;
/// Values of a digit.
const DIGITS: u32 = 16;
/// Bits of a digit.
const DIGIT_BITS: u32 = 4;

/// The uniform `SortParameters` of the pass.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SortParameters {
    /// Number of keys.
    pub count: u32,
    /// The digit's lowest bit.
    pub shift: u32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
}

/// Sorts `u32` keys in ascending order, each with a `u32` value; equal keys keep their order.
pub struct Sort {
    pass: Pass,
    scan: Scan,
}

impl Sort {
    /// Builds the passes.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        Ok(Self {
            pass: Pass::compute(gpu, shaders, "core/sort", "default")?,
            scan: Scan::new(gpu, shaders)?,
        })
    }

    /// Records the sort of the first `count` keys and values, storage buffers, in place. `bits`: of the keys that are sorted
    /// by, from the lowest on, at most 32; for each 8 of them
    /// the keys go to another buffer and back.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        [keys, values]: [&Buffer; 2],
        count: u32,
        bits: u32,
    ) -> Result<(), PassError> {
        if count == 0 {
            return Ok(());
        }
        let blocks = count.div_ceil(BLOCK);
        let spare = [0; 2].map(|_| Buffer::storage(gpu, u64::from(count) * 4));
        let counts = Buffer::storage(gpu, u64::from(DIGITS * blocks) * 4);
        let (mut from, mut to) = ([keys, values], [&spare[0], &spare[1]]);
        // An even number of digits ends where it began.
        let digits = bits.clamp(1, 32).div_ceil(2 * DIGIT_BITS) * 2;
        for digit in 0..digits {
            let parameters =
                SortParameters { count, shift: digit * DIGIT_BITS, reserved_a: 0, reserved_b: 0 };
            let parameters = Buffer::uniform(gpu, &parameters);
            let resources = [
                ("parameters", (&parameters).into()),
                ("keys", from[0].into()),
                ("values", from[1].into()),
                ("counts", (&counts).into()),
                ("sorted_keys", to[0].into()),
                ("sorted_values", to[1].into()),
            ];
            let bound = self.pass.bind(gpu, &resources)?;
            self.pass.dispatch_groups(encoder, &bound, "count_digits", [blocks, 1, 1])?;
            self.scan.record(gpu, encoder, &counts, DIGITS * blocks)?;
            self.pass.dispatch_groups(encoder, &bound, "scatter", [blocks, 1, 1])?;
            (from, to) = (to, from);
        }
        Ok(())
    }
}
