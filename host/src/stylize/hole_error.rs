// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible of holes.

/// Why holes cannot be made as asked.
#[derive(Debug, thiserror::Error)]
pub enum HoleError {
    /// A number out of its range, or not finite.
    #[error("holes of {name} {value} are impossible: it must be {range}")]
    Value {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// Number of octaves.
    #[error("{0} octaves are impossible: the number must be from 1 to 8")]
    Octaves(u32),
    /// Holes smaller than any texel.
    #[error(
        "holes of {size} m are too small in a map of {extent} m: their noise has {cells:.0} cells across, and may \
         have 65536; make them larger, or take fewer octaves"
    )]
    TooSmall {
        /// Mean chord, metres.
        size: f32,
        /// The longer side of the map, metres.
        extent: f32,
        /// Cells of the finest octave.
        cells: f64,
    },
    /// Holes that are torn by their motion.
    #[error("holes of {size} m cannot move by {distance} m: with these octaves they may by {most:.3} m")]
    TooFar {
        /// Mean chord, metres.
        size: f32,
        /// The distance asked for, metres.
        distance: f32,
        /// The distance possible, metres.
        most: f64,
    },
}
