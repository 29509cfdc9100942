// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::sheets
// summary: Sheets: slabs of equal thickness one behind the other along the half-way vector between eye and light.
// source: Zhang and Crawfis, "Light propagation for mixed polygonal and volumetric data using splatting", 4.1, Fig. 5.
// note: The normal is the sum of the direction in which the eye looks and that in which light goes, or of the reverse of the first
// note: where they differ by more than a right angle; so the light always meets the first sheet first, and view and light
// note: rays cross sheets at 45 degrees or more from the sheet. With that choice no pair of directions leaves it undefined.
// equation: height = n · x;  sheet i: first + i thickness ≤ height < first + (i + 1) thickness;  metres = thickness / |n · d|
// equation: value = c + m / 2⁹ + f / 2¹⁴, multiples of 2⁻⁹, 2⁻⁵ and 2⁻⁵
// error: parts exact, their sum within 1.5e-6; test splatting/functions::exact_parts_are_multiples_that_half_floats_hold.
// parameter point: metres in the world.
// parameter height: metres along the normal.
// parameter value: from 0 up to 4 in all.
// parameter texel: sums of parts.
// parameter direction: unit vector in the world.

/// All sheets of a picture. 32 bytes.
struct Sheets {
    /// Unit normal in the world, from the side of the light on.
    normal: vec3<f32>,
    /// Where the first sheet begins: dot(normal, point), metres.
    first: f32,
    /// Of every sheet, metres, positive.
    thickness: f32,
    /// How many there are.
    count: u32,
    /// Sheets that one splat reaches at most.
    span: u32,
    /// 1 where the sheet nearest to the light is nearest to the eye as well, 0 where it is the farthest.
    front_to_back: u32,
}

/// A sheet that is drawn. 16 bytes.
struct SheetNumber {
    /// From 0, the sheet nearest to the light.
    index: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

/// Cosine between a ray and the normal below which the ray counts as no more oblique.
const LEAST_COSINE: f32 = 0.05;

/// Where a point lies along the normal, metres from the world's origin.
fn height_of(sheets: Sheets, point: vec3<f32>) -> f32 {
    return dot(sheets.normal, point);
}

/// Heights at which a sheet begins and ends, metres; `index`: from 0, the sheet nearest to the light.
fn sheet_heights(sheets: Sheets, index: u32) -> vec2<f32> {
    let begin = sheets.first + f32(index) * sheets.thickness;
    return vec2<f32>(begin, sheets.first + f32(index + 1u) * sheets.thickness);
}

/// The sheet in which a height lies; of what lies outside the nearest.
fn sheet_at(sheets: Sheets, height: f32) -> u32 {
    let last = f32(max(sheets.count, 1u) - 1u);
    return u32(clamp(floor((height - sheets.first) / sheets.thickness), 0.0, last));
}

/// Metres that a ray of unit `direction` passes within a sheet.
fn metres_in_sheet(sheets: Sheets, direction: vec3<f32>) -> f32 {
    return sheets.thickness / max(abs(dot(sheets.normal, direction)), LEAST_COSINE);
}

/// A value as it is added up in an rgba16float target, in three parts: multiples of 2^-9, of 2^-14 in units of 2^-9, and of 2^-19 in
/// units of 2^-14. Half floats hold the sums of these exactly, up to 4 in all, so that neither the order of splats nor how
/// blending rounds makes a difference.
fn in_exact_parts(value: f32) -> vec4<f32> {
    let coarse = floor(value * 512.0 + 0.5) / 512.0;
    let rest = (value - coarse) * 512.0;
    let medium = floor(rest * 32.0 + 0.5) / 32.0;
    let fine = floor((rest - medium) * 1024.0 + 0.5) / 32.0;
    return vec4<f32>(coarse, medium, fine, 0.0);
}

/// The mean value of a texel of a sheet, from 0 up: the sum of values that were added by `in_exact_parts`.
fn sheet_mean(texel: vec4<f32>) -> f32 {
    return max(dot(texel.xyz, vec3<f32>(1.0, 1.0 / 512.0, 1.0 / 16384.0)), 0.0);
}
