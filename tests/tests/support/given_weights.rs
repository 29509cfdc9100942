// SPDX-License-Identifier: MIT OR Apache-2.0
//! Columns whose weights the test gives.

/// The callback of the tests: fall-off and weight of each column come from a texture.
pub const GIVEN_WEIGHTS: &str = "#define_import_path airlight::scattering::column_weights
@group(#{GROUP}) @binding(1) var given: texture_2d<f32>;
struct WeightedColumn { row: u32, column: u32, weight: f32 }
fn weighted_column(row: u32, size: vec2<u32>, first: u32, column: u32) -> WeightedColumn {
    return WeightedColumn(row, column, textureLoad(given, vec2<u32>(min(column, size.x - 1u), row), 0).w);
}
fn next_column(current: WeightedColumn, size: vec2<u32>) -> WeightedColumn {
    return weighted_column(current.row, size, 0u, current.column + 1u);
}
fn falloff_of_column(row: u32, unit: f32) -> vec3<f32> {
    let size = textureDimensions(given);
    return textureLoad(given, vec2<u32>(min(u32(unit * f32(size.x)), size.x - 1u), row), 0).xyz;
}
";
