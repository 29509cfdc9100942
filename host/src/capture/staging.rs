// SPDX-License-Identifier: MIT OR Apache-2.0
//! Copies of resources in the middle of an encoder, readable once it was submitted.

use super::CaptureError;
use super::describe::Id;
use super::store::Store;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Where each level of a texture must begin.
const ALIGNMENT: u64 = 256;

/// A copy.
pub(super) enum Staged {
    Copied {
        buffer: wgpu::Buffer,
        pieces: Vec<Piece>,
        ready: Arc<AtomicBool>,
    },
    /// What cannot be copied: several samples a pixel, or a resource of the caller's that is not a source of copies.
    Unreadable,
}

/// Rows of equal length.
pub(super) struct Piece {
    offset: u64,
    rows: u64,
    tight: u64,
    padded: u64,
}

/// Records a copy of a resource.
pub(super) fn stage(device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, id: &Id) -> Staged {
    let buffer = |size| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let (buffer, pieces) = match id {
        Id::Buffer(source) => {
            if !source.usage().contains(wgpu::BufferUsages::COPY_SRC) {
                return Staged::Unreadable;
            }
            let size = source.size();
            let copy = buffer(size);
            encoder.copy_buffer_to_buffer(source, 0, &copy, 0, size);
            (copy, vec![Piece { offset: 0, rows: 1, tight: size, padded: size }])
        }
        Id::Texture(source) => {
            let Some(pieces) = pieces(source) else { return Staged::Unreadable };
            let copy = buffer(
                pieces.iter().map(|piece| piece.offset + piece.rows * piece.padded).max().unwrap_or(4),
            );
            for (level, piece) in (0..).zip(&pieces) {
                encoder.copy_texture_to_buffer(
                    wgpu::TexelCopyTextureInfo { mip_level: level, ..source.as_image_copy() },
                    wgpu::TexelCopyBufferInfo {
                        buffer: &copy,
                        layout: wgpu::TexelCopyBufferLayout {
                            offset: piece.offset,
                            bytes_per_row: Some(piece.padded as u32),
                            rows_per_image: Some(level_size(source, level).height),
                        },
                    },
                    level_size(source, level),
                );
            }
            (copy, pieces)
        }
    };
    let ready = Arc::new(AtomicBool::new(false));
    let set = ready.clone();
    encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |result| {
        set.store(result.is_ok(), Ordering::Release);
    });
    Staged::Copied { buffer, pieces, ready }
}

/// Width, height, layers or depth of a level.
fn level_size(texture: &wgpu::Texture, level: u32) -> wgpu::Extent3d {
    texture.size().mip_level_size(level, texture.dimension())
}

/// The levels of a texture, none where it cannot be copied.
fn pieces(texture: &wgpu::Texture) -> Option<Vec<Piece>> {
    let format = texture.format();
    let texel = format.block_copy_size(Some(wgpu::TextureAspect::All)).or(format.block_copy_size(None))?;
    if texture.sample_count() > 1 || !texture.usage().contains(wgpu::TextureUsages::COPY_SRC) {
        return None;
    }
    let mut end = 0_u64;
    let levels = (0..texture.mip_level_count()).map(|level| {
        let size = level_size(texture, level);
        let tight = u64::from(size.width) * u64::from(texel);
        let padded = tight.next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
        let rows = u64::from(size.height) * u64::from(size.depth_or_array_layers);
        let offset = end;
        end = (offset + rows * padded).next_multiple_of(ALIGNMENT);
        Piece { offset, rows, tight, padded }
    });
    Some(levels.collect())
}

impl Staged {
    /// Whether its encoder was submitted and is done.
    pub(super) fn is_ready(&self) -> bool {
        match self {
            Self::Copied { ready, .. } => ready.load(Ordering::Acquire),
            Self::Unreadable => true,
        }
    }

    /// Keeps the contents; their name, none where they cannot be read.
    pub(super) fn save(&self, store: &Store) -> Result<Option<String>, CaptureError> {
        let Self::Copied { buffer, pieces, .. } = self else { return Ok(None) };
        let Ok(view) = buffer.get_mapped_range(..) else { return Ok(None) };
        let mut bytes = Vec::new();
        for piece in pieces {
            for row in 0..piece.rows {
                let start = (piece.offset + row * piece.padded) as usize;
                bytes.extend_from_slice(&view[start..start + piece.tight as usize]);
            }
        }
        store.keep(&bytes).map(Some)
    }
}
