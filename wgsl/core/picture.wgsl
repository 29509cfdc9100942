// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::picture
// summary: One triangle over the whole picture, for passes in fragment form.
// source: the usual full-screen triangle.

/// Clip-space position of corner `index`, 0..2, of a triangle that covers the picture.
fn picture_corner(index: u32) -> vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}
