// SPDX-License-Identifier: MIT OR Apache-2.0
//! Splats of all volumes, sorted by the first sheet that they reach.

use super::passes::{GROUP, rows_of_groups};
use super::splats::Batch;
use super::{SheetTargets, Splats, SplattingError};
use crate::core::Sort;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use glam::UVec2;

/// Columns and rows of a workgroup over pixels.
const TILE: [u32; 2] = [16, 8];

/// Workgroups over the pixels of a picture.
pub(super) fn tiles(picture: &Texture) -> [u32; 3] {
    let [width, height, _] = picture.size();
    [width.div_ceil(TILE[0]), height.div_ceil(TILE[1]), 1]
}

/// Splats of one binding with what is known of them once they are sorted.
pub(super) struct SortedBatch<'a> {
    pub(super) splats: &'a Splats,
    pub(super) batch: &'a Batch,
    pub(super) ranges: Buffer,
    pub(super) draws: Buffer,
    bound: Bound,
}

/// All splats of a picture.
pub(super) struct Order<'a> {
    pub(super) batches: Vec<SortedBatch<'a>>,
    /// Of each sheet, groups over the picture and over the shadow buffer where it has splats.
    pub(super) dispatches: Buffer,
    pass: Pass,
    sort: Sort,
    count: u32,
    scanning: bool,
}

impl<'a> Order<'a> {
    /// For `count` sheets. `targets`: the picture and the shadow buffer; `scanning`: nothing is sorted, and every sheet draws all.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        splats: &'a [Splats],
        [sheets, kernel]: [&Buffer; 2],
        targets: [&Texture; 2],
        count: u32,
        scanning: bool,
    ) -> Result<Self, SplattingError> {
        let indirect = |all: &[u32]| {
            let word = |word: &u32| if scanning { *word } else { 0 };
            let bytes: Vec<u8> = all.iter().flat_map(|all| word(all).to_le_bytes()).collect();
            let bytes = bytes.repeat(count as usize);
            Buffer::with_bytes(gpu, &bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT)
        };
        let [picture, shadow] = targets.map(|target| UVec2::from_slice(&tiles(target)[..2]));
        let targets = Buffer::uniform(gpu, &SheetTargets { picture, shadow });
        let dispatches = indirect(&[picture.x, picture.y, 1, 0, shadow.x, shadow.y, 1, 0]);
        let pass = Pass::compute(gpu, shaders, "splatting/order_splats", "default")?;
        let mut batches = Vec::new();
        for splats in splats {
            for batch in &splats.batches {
                let ranges = Buffer::storage(gpu, 8 * u64::from(count));
                let draws = indirect(&[6, batch.count, 0, 0]);
                let resources: [(&str, Resource<'_>); 11] = [
                    ("volume", (&splats.uniform).into()),
                    ("sheets", sheets.into()),
                    ("kernel", kernel.into()),
                    ("batch", (&batch.uniform).into()),
                    ("splats", (&batch.splats).into()),
                    ("keys", (&batch.keys).into()),
                    ("order", (&batch.order).into()),
                    ("ranges", (&ranges).into()),
                    ("draws", (&draws).into()),
                    ("dispatches", (&dispatches).into()),
                    ("targets", (&targets).into()),
                ];
                let bound = pass.bind(gpu, &resources)?;
                batches.push(SortedBatch { splats, batch, ranges, draws, bound });
            }
        }
        Ok(Self { batches, dispatches, pass, sort: Sort::new(gpu, shaders)?, count, scanning })
    }

    /// Records the sort.
    pub(super) fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), SplattingError> {
        if self.scanning {
            return Ok(());
        }
        encoder.clear_buffer(&self.dispatches.raw, 0, None);
        for SortedBatch { batch, bound, .. } in &self.batches {
            let groups = rows_of_groups(batch.count.div_ceil(GROUP));
            self.pass.dispatch_groups(encoder, bound, "first_sheets", groups)?;
            let bits = 32 - (self.count - 1).leading_zeros();
            self.sort.record(gpu, encoder, [&batch.keys, &batch.order], batch.count, bits.max(1))?;
            self.pass.dispatch_groups(encoder, bound, "sheet_ranges", [self.count.div_ceil(64), 1, 1])?;
        }
        Ok(())
    }

    /// Bytes of its own buffers.
    pub(super) fn memory(&self) -> u64 {
        let of = |batch: &SortedBatch<'_>| batch.ranges.raw.size() + batch.draws.raw.size();
        self.dispatches.raw.size() + self.batches.iter().map(of).sum::<u64>()
    }

    /// Arguments of a dispatch over the picture where a sheet has splats, of none where it has not.
    pub(super) fn over_picture(&self, sheet: u32) -> (&Buffer, u64) {
        (&self.dispatches, 32 * u64::from(sheet))
    }

    /// The same over the shadow buffer.
    pub(super) fn over_shadow(&self, sheet: u32) -> (&Buffer, u64) {
        (&self.dispatches, 32 * u64::from(sheet) + 16)
    }
}
