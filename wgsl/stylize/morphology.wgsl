// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::stylize::morphology
// summary: Dilation and erosion of shadow maps with a box or a disc: windows of rows, and the chords of a disc.
// source: stylized scattering, section 3, thesis 6.2.1; van Herk (1992), Gil and Werman (1993); Urbach and Wilkinson (2008).
// note: Depth grows away from the light, so that dilating blockers takes the minimum of depth and eroding them the
// note: maximum; in a map with reversed depth it is the other way round. Maxima are minima of negated values: exact.
// note: A window is cut at the border of the map. All windows here are intervals of a row that hold their texel, so that
// note: cutting them is the same as repeating the texel at the border: positions are clamped.
// note: The disc of radius r is the set of texels with dx^2 + dy^2 <= r^2.
// equation: half chord at row y of a disc of radius r: w = ⌊√(r² − y²)⌋;  table of level l: extremum over 2^l texels
// error: exact, every operator equals its reference; test stylize/morphology::every_operator_equals_its_reference_everywhere.
// parameter row: texels from the middle, up to `radius`.
// parameter level: 0..6.

/// Texels of a row or column over which an extremum is taken. 32 bytes.
struct Window {
    /// Texels before the own one, each `stride` from the next.
    before: u32,
    /// Texels behind it; with `before` and the own one at most LONGEST.
    after: u32,
    /// Texels from one to the next, at least 1.
    stride: u32,
    reserved_a: u32,
    /// 1 for minima, -1 for maxima.
    sign: f32,
    /// What non-finite values count as: the depth of an empty texel.
    far_depth: f32,
    reserved_b: f32,
    reserved_c: f32,
}

/// The most texels of a Window.
const LONGEST: u32 = 64u;

/// Rows of a disc whose chords are read from one table of running extrema. 32 bytes.
struct Disc {
    /// Radius, texels.
    radius: u32,
    /// The table holds extrema over windows of 2^level texels.
    level: u32,
    /// The least distance of rows from the middle that this table serves, texels.
    first_row: u32,
    /// The distance at which it ends, texels, at most the height of the map.
    end_row: u32,
    /// 1 for minima, -1 for maxima.
    sign: f32,
    /// What non-finite values count as: the depth of an empty texel.
    far_depth: f32,
    /// 1 where the table is the map itself, of level 0.
    begins: u32,
    /// 1 where no level follows.
    ends: u32,
}

/// Half the chord of a disc at `row` texels from its middle, row <= radius: the greatest w with w^2 + row^2 <= radius^2.
/// `radius`: below 32768.
fn disc_half_chord(radius: u32, row: u32) -> u32 {
    let square = radius * radius - row * row;
    var root = u32(sqrt(f32(square)));
    // The root of a rounded number may be one off.
    if root * root > square {
        root -= 1u;
    }
    if (root + 1u) * (root + 1u) <= square {
        root += 1u;
    }
    return root;
}

/// How many texels before the own one a table of `level` reaches: it holds extrema over 2^level texels.
fn table_before(level: u32) -> i32 {
    return i32((1u << max(level, 1u)) >> 1u) - 1;
}

/// How many texels behind the own one a table of `level` reaches.
fn table_after(level: u32) -> i32 {
    return i32((1u << level) >> 1u);
}
