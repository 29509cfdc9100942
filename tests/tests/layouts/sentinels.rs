// SPDX-License-Identifier: MIT OR Apache-2.0
//! Values by which a field is told from all others in the bytes of a struct.

use airlight::core::MAX_VIEWS;
use airlight::painterly::MOST_CLIP_PLANES;
use glam::{Mat4, UVec2, UVec3, UVec4, Vec2, Vec3, Vec4};

/// The same distinct numbers in every field, whatever its type.
pub trait Sentinel: Copy {
    /// The WGSL type.
    const TYPE: &'static str;
    fn zero() -> Self;
    fn sentinel() -> Self;
    /// Words of the sentinel, and where each lies from the field's offset.
    fn words() -> Vec<(u32, u32)>;
}

impl Sentinel for f32 {
    const TYPE: &'static str = "f32";
    fn zero() -> Self {
        0.0
    }
    fn sentinel() -> Self {
        1.25
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1.25_f32.to_bits())]
    }
}

impl Sentinel for u32 {
    const TYPE: &'static str = "u32";
    fn zero() -> Self {
        0
    }
    fn sentinel() -> Self {
        0x0102_0304
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 0x0102_0304)]
    }
}

impl Sentinel for Vec2 {
    const TYPE: &'static str = "vec2<f32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1.5, 2.5)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1.5_f32.to_bits()), (4, 2.5_f32.to_bits())]
    }
}

impl Sentinel for Vec3 {
    const TYPE: &'static str = "vec3<f32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1.5, 2.5, 3.5)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1.5_f32.to_bits()), (4, 2.5_f32.to_bits()), (8, 3.5_f32.to_bits())]
    }
}

impl Sentinel for Vec4 {
    const TYPE: &'static str = "vec4<f32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1.5, 2.5, 3.5, 4.5)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1.5_f32.to_bits()), (4, 2.5_f32.to_bits()), (8, 3.5_f32.to_bits()), (12, 4.5_f32.to_bits())]
    }
}

impl Sentinel for UVec2 {
    const TYPE: &'static str = "vec2<u32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1, 2)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1), (4, 2)]
    }
}

impl Sentinel for UVec3 {
    const TYPE: &'static str = "vec3<u32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1, 2, 3)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1), (4, 2), (8, 3)]
    }
}

impl Sentinel for UVec4 {
    const TYPE: &'static str = "vec4<u32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1, 2, 3, 4)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1), (4, 2), (8, 3), (12, 4)]
    }
}

impl Sentinel for Mat4 {
    const TYPE: &'static str = "mat4x4<f32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::from_cols_array(&std::array::from_fn(|i| i as f32 + 1.0))
    }
    // Column after column: WGSL's m[column][row], a column every 16 bytes.
    fn words() -> Vec<(u32, u32)> {
        (0..16).map(|i| (4 * i, (i as f32 + 1.0).to_bits())).collect()
    }
}

impl Sentinel for [Mat4; MAX_VIEWS] {
    const TYPE: &'static str = "array<mat4x4<f32>, 6>";
    fn zero() -> Self {
        [Mat4::ZERO; MAX_VIEWS]
    }
    fn sentinel() -> Self {
        std::array::from_fn(|view| Mat4::sentinel() * (view as f32 + 1.0))
    }
    fn words() -> Vec<(u32, u32)> {
        let of = |view: u32| (0..16).map(move |i| (64 * view + 4 * i, ((i + 1) * (view + 1)) as f32));
        (0..MAX_VIEWS as u32).flat_map(of).map(|(at, value)| (at, value.to_bits())).collect()
    }
}

impl Sentinel for [Vec4; MOST_CLIP_PLANES] {
    const TYPE: &'static str = "array<vec4<f32>, 8>";
    fn zero() -> Self {
        [Vec4::ZERO; MOST_CLIP_PLANES]
    }
    fn sentinel() -> Self {
        std::array::from_fn(|plane| Vec4::sentinel() * (plane as f32 + 1.0))
    }
    fn words() -> Vec<(u32, u32)> {
        let scaled = |plane: u32, word: u32| (f32::from_bits(word) * (plane + 1) as f32).to_bits();
        let of = |plane: u32| {
            <Vec4 as Sentinel>::words()
                .into_iter()
                .map(move |(at, word)| (16 * plane + at, scaled(plane, word)))
        };
        (0..MOST_CLIP_PLANES as u32).flat_map(of).collect()
    }
}
