// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers to feed to a shader: sane ones, some that are not finite, and the ends of every range.

use crate::gpu::Random;
use half::f16;

/// What a case is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Sane parameters, finite texels.
    Finite,
    /// Sane parameters; among the texels are NaN, infinities and denormals.
    NonFinite,
    /// One in four numbers of every parameter, buffer and texture is an end of its range.
    Rough,
    /// All of them are.
    Extreme,
}

impl Content {
    /// Whether all outputs have to be finite.
    pub fn is_sane(self) -> bool {
        matches!(self, Self::Finite | Self::NonFinite)
    }

    /// The share of numbers of a buffer that are an end of their range.
    pub fn extreme_share(self) -> f64 {
        match self {
            Self::Finite | Self::NonFinite => 0.0,
            Self::Rough => 0.25,
            Self::Extreme => 1.0,
        }
    }
}

/// A float that no artist would set.
pub fn extreme_float(random: &mut Random) -> f32 {
    const ENDS: [f32; 18] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        1e38,
        -1e38,
        f32::MAX,
        f32::MIN,
        1e-40,
        1e-30,
        f32::MIN_POSITIVE,
        4_294_967_296.0,
        -2_147_483_648.0,
        16_777_217.0,
        0.5,
    ];
    ENDS[random.below(ENDS.len())]
}

/// A whole number that no artist would set.
pub fn extreme_word(random: &mut Random) -> u32 {
    const ENDS: [u32; 12] =
        [0, 0, 1, 2, u32::MAX, u32::MAX - 1, i32::MIN as u32, i32::MAX as u32, 65_535, 65_536, 4096, 1 << 30];
    ENDS[random.below(ENDS.len())]
}

/// How the finite texels of a texture are spread.
#[derive(Clone, Copy)]
pub enum Spread {
    /// One number everywhere.
    Even(f32),
    /// Between two numbers.
    Between(f32, f32),
}

impl Spread {
    /// Any.
    pub fn any(random: &mut Random) -> Self {
        match random.below(10) {
            0 => Self::Even(random.below(3) as f32 * 0.5),
            1 | 2 => Self::Between(-1.0, 1.0),
            3 | 4 => Self::Between(0.0, 10.0),
            _ => Self::Between(0.0, 1.0),
        }
    }

    fn value(self, random: &mut Random) -> f32 {
        match self {
            Self::Even(value) => value,
            Self::Between(low, high) => random.between(f64::from(low), f64::from(high)) as f32,
        }
    }
}

/// The bits of a component of a texel of floats.
pub fn texel_float(random: &mut Random, content: Content, spread: Spread) -> f32 {
    const NOT_FINITE: [f32; 6] = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-40, -0.0];
    match content {
        Content::NonFinite if random.below(4) == 0 => NOT_FINITE[random.below(NOT_FINITE.len())],
        Content::Rough if random.below(4) == 0 => extreme_float(random),
        Content::Extreme => extreme_float(random),
        _ => spread.value(random),
    }
}

/// The same of half precision.
pub fn texel_half(random: &mut Random, content: Content, spread: Spread) -> f16 {
    const NOT_FINITE: [u16; 6] = [0x7e00, 0xfe00, 0x7c00, 0xfc00, 0x0001, 0x8000];
    match content {
        Content::NonFinite if random.below(4) == 0 => {
            f16::from_bits(NOT_FINITE[random.below(NOT_FINITE.len())])
        }
        _ => f16::from_f32(texel_float(random, content, spread)),
    }
}
