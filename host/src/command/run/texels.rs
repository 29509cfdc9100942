// SPDX-License-Identifier: MIT OR Apache-2.0
//! Between the numbers of an array and the bytes of texels.

use crate::formats::ArrayData;
use airlight_validate::Sample;
use half::f16;
use wgpu::TextureFormat as Format;

/// How one channel of a texel is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Float32,
    Float16,
    Unorm8,
    Snorm8,
    Uint(u8),
    Sint(u8),
}

fn channel(format: Format) -> Option<Channel> {
    Some(match format {
        Format::R32Float | Format::Rg32Float | Format::Rgba32Float => Channel::Float32,
        Format::R16Float | Format::Rg16Float | Format::Rgba16Float => Channel::Float16,
        Format::R8Unorm | Format::Rg8Unorm | Format::Rgba8Unorm => Channel::Unorm8,
        Format::Rgba8Snorm => Channel::Snorm8,
        Format::R32Uint | Format::Rg32Uint | Format::Rgba32Uint => Channel::Uint(4),
        Format::Rgba16Uint => Channel::Uint(2),
        Format::Rgba8Uint => Channel::Uint(1),
        Format::R32Sint | Format::Rg32Sint | Format::Rgba32Sint => Channel::Sint(4),
        Format::Rgba16Sint => Channel::Sint(2),
        Format::Rgba8Sint => Channel::Sint(1),
        _ => return None,
    })
}

/// The format of a sampled texture that `data` of `channels` (1 to 4, three are padded) becomes; an error says which
/// data it takes.
pub fn format_for(
    sample: Sample,
    filtered: bool,
    channels: u32,
    data: &ArrayData,
) -> Result<Format, &'static str> {
    let pick = |formats: [Format; 3]| Ok(formats[[0, 0, 1, 2, 2][channels.min(4) as usize]]);
    match (sample, data) {
        (Sample::Float, ArrayData::U8(_)) => pick([Format::R8Unorm, Format::Rg8Unorm, Format::Rgba8Unorm]),
        (Sample::Float, ArrayData::F32(_)) if filtered => {
            pick([Format::R16Float, Format::Rg16Float, Format::Rgba16Float])
        }
        (Sample::Float, ArrayData::F32(_)) => {
            pick([Format::R32Float, Format::Rg32Float, Format::Rgba32Float])
        }
        (Sample::Float, _) => Err("f32 or u8 (0..255 for 0..1)"),
        (Sample::Uint, ArrayData::U32(_)) => pick([Format::R32Uint, Format::Rg32Uint, Format::Rgba32Uint]),
        (Sample::Uint, _) => Err("u32"),
        (Sample::Sint, ArrayData::I32(_)) => pick([Format::R32Sint, Format::Rg32Sint, Format::Rgba32Sint]),
        (Sample::Sint, _) => Err("i32"),
        (Sample::Depth, _) => Err("no array: nothing can be copied into a depth texture"),
    }
}

/// The bytes of `data` in `format`, where each texel has `channels` numbers; missing ones become 0, the last of four 1.
pub fn encode(format: Format, channels: u32, data: &ArrayData) -> Result<Vec<u8>, String> {
    let stored = usize::from(format.components());
    let channels = channels as usize;
    let wrong = |wanted: &str| Err(format!("{format:?} takes {wanted}, not {}", data.type_name()));
    match (channel(format), data) {
        (Some(Channel::Float32), ArrayData::F32(values)) => {
            pad(values, channels, stored, 1.0, |value| Ok(value.to_le_bytes()))
        }
        (Some(Channel::Float16), ArrayData::F32(values)) => pad(values, channels, stored, 1.0, |value| {
            let half = f16::from_f32(value);
            if value.is_finite() && !half.is_finite() {
                return Err(format!("{value} does not fit {format:?}, whose largest number is 65504"));
            }
            Ok(half.to_le_bytes())
        }),
        (Some(Channel::Snorm8), ArrayData::F32(values)) => pad(values, channels, stored, 1.0, |value| {
            // A NaN becomes 0.
            Ok([(value.clamp(-1.0, 1.0) * 127.0).round() as i8 as u8])
        }),
        (Some(Channel::Float32 | Channel::Float16 | Channel::Snorm8), _) => wrong("f32"),
        (Some(Channel::Unorm8), ArrayData::U8(values)) => {
            pad(values, channels, stored, 255, |value| Ok([value]))
        }
        (Some(Channel::Unorm8), _) => wrong("u8"),
        (Some(Channel::Uint(bytes)), ArrayData::U32(values)) => whole(
            pad(values, channels, stored, 1, |value| Ok(i64::from(value).to_le_bytes()))?,
            bytes,
            false,
            format,
        ),
        (Some(Channel::Uint(1)), ArrayData::U8(values)) => {
            pad(values, channels, stored, 1, |value| Ok([value]))
        }
        (Some(Channel::Uint(_)), _) => wrong("u32"),
        (Some(Channel::Sint(bytes)), ArrayData::I32(values)) => whole(
            pad(values, channels, stored, 1, |value| Ok(i64::from(value).to_le_bytes()))?,
            bytes,
            true,
            format,
        ),
        (Some(Channel::Sint(_)), _) => wrong("i32"),
        (None, _) => Err(format!("{format:?} cannot be filled from an array")),
    }
}

fn pad<T: Copy + Default, const BYTES: usize>(
    values: &[T],
    channels: usize,
    stored: usize,
    last: T,
    encode: impl Fn(T) -> Result<[u8; BYTES], String>,
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(values.len().div_ceil(channels.max(1)) * stored * BYTES);
    for texel in values.chunks(channels.max(1)) {
        for at in 0..stored {
            let missing = if at == 3 { last } else { T::default() };
            bytes.extend_from_slice(&encode(texel.get(at).copied().unwrap_or(missing))?);
        }
    }
    Ok(bytes)
}

/// 64-bit integers narrowed to `bytes` each, if they fit.
fn whole(wide: Vec<u8>, bytes: u8, signed: bool, format: Format) -> Result<Vec<u8>, String> {
    let bits = u32::from(bytes) * 8;
    let range = if signed { -(1_i64 << (bits - 1))..1_i64 << (bits - 1) } else { 0..1_i64 << bits };
    let mut narrow = Vec::with_capacity(wide.len() / 8 * usize::from(bytes));
    for word in wide.chunks_exact(8) {
        let value = word.iter().rev().fold(0_u64, |value, byte| value << 8 | u64::from(*byte)).cast_signed();
        if !range.contains(&value) {
            return Err(format!("{value} does not fit {format:?}"));
        }
        narrow.extend_from_slice(&word[..usize::from(bytes)]);
    }
    Ok(narrow)
}

/// The numbers in the bytes of texels: f32 for floats and snorm, u8 for unorm and 8-bit integers, u32 and i32.
pub fn decode(format: Format, bytes: &[u8]) -> Result<ArrayData, String> {
    let word = |word: &[u8]| [word[0], word[1], word[2], word[3]];
    let half = |word: &[u8]| [word[0], word[1]];
    Ok(match channel(format).ok_or_else(|| format!("{format:?} cannot be written as an array"))? {
        Channel::Float32 => {
            ArrayData::F32(bytes.chunks_exact(4).map(|b| f32::from_le_bytes(word(b))).collect())
        }
        Channel::Float16 => {
            ArrayData::F32(bytes.chunks_exact(2).map(|b| f16::from_le_bytes(half(b)).to_f32()).collect())
        }
        Channel::Unorm8 | Channel::Uint(1) => ArrayData::U8(bytes.to_vec()),
        // -128 and -127 both mean -1.
        Channel::Snorm8 => {
            ArrayData::F32(bytes.iter().map(|b| (f32::from(b.cast_signed()) / 127.0).max(-1.0)).collect())
        }
        Channel::Uint(2) => {
            ArrayData::U32(bytes.chunks_exact(2).map(|b| u32::from(u16::from_le_bytes(half(b)))).collect())
        }
        Channel::Uint(_) => {
            ArrayData::U32(bytes.chunks_exact(4).map(|b| u32::from_le_bytes(word(b))).collect())
        }
        Channel::Sint(1) => ArrayData::I32(bytes.iter().map(|b| i32::from(b.cast_signed())).collect()),
        Channel::Sint(2) => {
            ArrayData::I32(bytes.chunks_exact(2).map(|b| i32::from(i16::from_le_bytes(half(b)))).collect())
        }
        Channel::Sint(_) => {
            ArrayData::I32(bytes.chunks_exact(4).map(|b| i32::from_le_bytes(word(b))).collect())
        }
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn every_format_goes_round() {
        let floats = ArrayData::F32(vec![-1.0, 0.5, 0.0, 1.0]);
        let cases = [
            (Format::Rgba32Float, floats.clone()),
            (Format::Rgba16Float, floats),
            (Format::Rgba8Snorm, ArrayData::F32(vec![-1.0, 0.0, 1.0, 1.0])),
            (Format::Rgba8Unorm, ArrayData::U8(vec![0, 1, 128, 255])),
            (Format::Rgba8Uint, ArrayData::U8(vec![0, 1, 128, 255])),
            (Format::Rgba16Uint, ArrayData::U32(vec![0, 1, 256, 65535])),
            (Format::Rgba32Uint, ArrayData::U32(vec![0, 1, 16_777_217, u32::MAX])),
            (Format::Rgba8Sint, ArrayData::I32(vec![0, -1, 127, -128])),
            (Format::Rgba16Sint, ArrayData::I32(vec![0, -1, 32767, -32768])),
            (Format::Rgba32Sint, ArrayData::I32(vec![0, -1, i32::MAX, i32::MIN])),
        ];
        for (format, data) in cases {
            let bytes = encode(format, 4, &data).unwrap();
            assert_eq!(bytes.len() as u32, format.block_copy_size(None).unwrap(), "{format:?}");
            assert_eq!(decode(format, &bytes).unwrap(), data, "{format:?}");
        }
    }

    #[test]
    fn three_channels_are_padded() {
        let bytes =
            encode(Format::Rgba32Float, 3, &ArrayData::F32(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0])).unwrap();
        let padded = ArrayData::F32(vec![1.0, 2.0, 3.0, 1.0, 4.0, 5.0, 6.0, 1.0]);
        assert_eq!(decode(Format::Rgba32Float, &bytes).unwrap(), padded);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        for (format, data) in [
            (Format::R16Float, ArrayData::F32(vec![65520.0])),
            (Format::R32Float, ArrayData::U32(vec![1])),
            (Format::R32Uint, ArrayData::F32(vec![1.0])),
            (Format::Rgba8Uint, ArrayData::U32(vec![256])),
            (Format::Rgba8Sint, ArrayData::I32(vec![128])),
            (Format::Depth32Float, ArrayData::F32(vec![1.0])),
        ] {
            assert!(encode(format, 1, &data).is_err(), "{format:?} {data:?}");
        }
        assert!(encode(Format::R16Float, 1, &ArrayData::F32(vec![f32::NAN, f32::INFINITY])).is_ok());
    }
}
