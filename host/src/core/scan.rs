// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `core/scan`: exclusive prefix sums of any length.

use crate::gpu::Gpu;
use crate::pass::{Pass, PassError};
use crate::resource::Buffer;
use crate::shaders::Shaders;
use encase::ShaderType;

/// Values a workgroup scans.
const BLOCK: u32 = 1024;

#[derive(ShaderType)]
struct ScanParameters {
    count: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

/// Exclusive prefix sum of `u32` values, in place, wrapping at 2^32.
pub struct Scan {
    pass: Pass,
}

impl Scan {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "core/scan", "default")? })
    }

    /// Records the scan of the first `count` values of `values`, a storage buffer.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        values: &Buffer,
        count: u32,
    ) -> Result<(), PassError> {
        if count == 0 {
            return Ok(());
        }
        let blocks = count.div_ceil(BLOCK);
        let parameters = ScanParameters { count, reserved_a: 0, reserved_b: 0, reserved_c: 0 };
        let parameters = Buffer::uniform(gpu, &parameters);
        let block_sums = Buffer::storage(gpu, u64::from(blocks) * 4);
        let resources = [
            ("parameters", (&parameters).into()),
            ("values", values.into()),
            ("block_sums", (&block_sums).into()),
        ];
        let bound = self.pass.bind(gpu, &resources)?;
        self.pass.dispatch_groups(encoder, &bound, "scan_blocks", [blocks, 1, 1])?;
        if blocks > 1 {
            self.record(gpu, encoder, &block_sums, blocks)?;
            self.pass.dispatch_groups(encoder, &bound, "add_offsets", [blocks, 1, 1])?;
        }
        Ok(())
    }
}
