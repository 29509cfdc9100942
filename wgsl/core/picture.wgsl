// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::picture
// summary: One triangle over the whole picture, for passes in fragment form.
// source: the usual full-screen triangle.
// equation: corners (−1, −1), (3, −1), (−1, 3): index 0, 1, 2
// error: exact: every pixel of a picture is drawn; test command/run::a_full_screen_pass_draws_the_sky.
// parameter index: 0..2.

/// Clip-space position of corner `index`, 0..2, of a triangle that covers the picture.
fn picture_corner(index: u32) -> vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}
