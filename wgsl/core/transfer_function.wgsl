// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::transfer_function
// summary: What colour and opacity a value of a volume has, by a table.
// source: none; the usual 1D transfer function, dissertation on painterly volume rendering, 4.1.1.
// note: The first texel is value 0 and the last value 1, whatever the table's length; between texels it is linear.
// equation: (r, g, b, a)(v) = table at (v (width − 1) + ½) / width, linear between texels
// error: of the texture unit, 8 bits of a share; whole pictures hold it; test painterly/iso_raycast::hits_are_those_of_dense_sampling.
// parameter value: 0..1; beyond that the end of the table.

/// Colour, linear RGB, and opacity 0..1 of a value 0..1; beyond that the end of the table. `transfer`: one row, linear RGB and
/// opacity, rgba16float or rgba8unorm; `linear_sampler`: linear, clamped to the edge.
fn classified(transfer: texture_2d<f32>, linear_sampler: sampler, value: f32) -> vec4<f32> {
    let width = f32(textureDimensions(transfer).x);
    return textureSampleLevel(transfer, linear_sampler, vec2<f32>((value * (width - 1.0) + 0.5) / width, 0.5), 0.0);
}
