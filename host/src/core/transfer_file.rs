// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions of volumes as TOML files.

use super::{Transfer, TransferError, TransferPoint, entry};
use crate::data::linear_from_hexadecimal;
use crate::formats::{TomlFileError, parse_toml, read_toml};
use crate::gpu::Gpu;
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Why a file says no transfer function.
#[derive(Debug, thiserror::Error)]
pub enum TransferFileError {
    /// It cannot be read, or is no such file.
    #[error("the transfer function {0}")]
    File(#[from] TomlFileError),
    /// What it says.
    #[error("the transfer function {path}: {reason}")]
    Impossible {
        /// The file.
        path: PathBuf,
        /// What is impossible.
        reason: String,
    },
}

/// The transfer functions that come with Airlight: names and texts.
pub const TRANSFERS: [(&str, &str); 5] = [
    ("head", include_str!("../../styles/transfers/head.toml")),
    ("stent", include_str!("../../styles/transfers/stent.toml")),
    ("cloud", include_str!("../../styles/transfers/cloud.toml")),
    ("smoke", include_str!("../../styles/transfers/smoke.toml")),
    ("vessels", include_str!("../../styles/transfers/vessels.toml")),
];
/// Entries of a table.
const ENTRIES: usize = 1024;

/// A transfer function as a file says it.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// Values of the volume that become 0 and 1; where there are none, its least and greatest.
    pub range: Option<[f32; 2]>,
    /// Points, rising in value, 0..1 of the range.
    pub points: Vec<TransferPoint>,
}

impl TransferFunction {
    /// Uploads it.
    ///
    /// # Errors
    /// As [`Transfer::of_points`].
    pub fn upload(&self, gpu: &Gpu) -> Result<Transfer, TransferError> {
        Transfer::of_points(gpu, &self.points, ENTRIES)
    }

    /// The same with colours times a factor, linear RGB.
    #[must_use]
    pub fn tinted(mut self, factor: Vec3) -> Self {
        self.points.iter_mut().for_each(|point| point.color *= factor);
        self
    }

    /// The greatest value, 0..1 of the range, below which and at which nothing is opaque; 0 where all is.
    pub fn transparent_below(&self) -> f32 {
        let first = self.points.iter().position(|point| point.opacity > 0.0);
        match first {
            Some(first) if first > 0 => self.points[first - 1].value,
            Some(_) => 0.0,
            None => 1.0,
        }
    }

    /// Opacity of a value 0..1 of the range; 0 without points.
    pub fn opacity(&self, value: f32) -> f32 {
        if self.points.is_empty() { 0.0 } else { entry(&self.points, value)[3] }
    }

    /// The greatest opacity of the values from `low` to `high`, 0..1 of the range.
    pub fn greatest_opacity(&self, low: f32, high: f32) -> f32 {
        let between = self.points.iter().filter(|point| (low..=high).contains(&point.value));
        let ends = self.opacity(low).max(self.opacity(high));
        between.map(|point| point.opacity).fold(ends, f32::max)
    }
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    range: Option<[f32; 2]>,
    #[serde(default)]
    point: Vec<Point>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    value: f32,
    color: Color,
    opacity: f32,
}

#[derive(serde::Deserialize)]
#[serde(untagged, expecting = "a colour is \"#rrggbb\" (sRGB) or [red, green, blue] (linear)")]
enum Color {
    Hexadecimal(String),
    Linear([f32; 3]),
}

/// Reads a transfer function: `range = [LOW, HIGH]`, and `[[point]]` with `value` in the units of the range (0..1 without one),
/// `color` as `"#rrggbb"` in sRGB or `[r, g, b]` in linear light, and `opacity`.
///
/// # Errors
/// [`TransferFileError::File`] with line and column; [`TransferFileError::Impossible`].
pub fn read_transfer(path: impl AsRef<Path>) -> Result<TransferFunction, TransferFileError> {
    let path = path.as_ref();
    parse_transfer(path, &read_toml(path)?)
}

/// Like [`read_transfer`] for a text. `path`: where it lies, for errors.
///
/// # Errors
/// As [`read_transfer`].
pub fn parse_transfer(path: impl AsRef<Path>, text: &str) -> Result<TransferFunction, TransferFileError> {
    let path = path.as_ref();
    let File { range, point } = parse_toml(path, text)?;
    let wrong = |reason: String| TransferFileError::Impossible { path: path.to_owned(), reason };
    let [low, high] = range.unwrap_or([0.0, 1.0]);
    if !(low.is_finite() && high.is_finite() && high > low) {
        return Err(wrong(format!("a range from {low} to {high} is impossible: it must rise and be finite")));
    }
    if point.is_empty() {
        return Err(wrong("it has no points: give at least one [[point]]".to_owned()));
    }
    let mut points: Vec<TransferPoint> = Vec::new();
    for (i, Point { value, color, opacity }) in point.into_iter().enumerate() {
        let wrong = |reason: String| wrong(format!("point {i}: {reason}"));
        let color = match color {
            Color::Linear(color) => color,
            Color::Hexadecimal(text) => linear_from_hexadecimal(&text)
                .ok_or_else(|| wrong(format!("`{text}` is no colour: write \"#rrggbb\"")))?,
        };
        if color.iter().any(|channel| !(0.0..=65504.0).contains(channel)) {
            return Err(wrong(format!("a colour of {color:?} is impossible: it must lie from 0 to 65504")));
        }
        if !(0.0..=1.0).contains(&opacity) {
            return Err(wrong(format!("an opacity of {opacity} is impossible: it must lie from 0 to 1")));
        }
        let share = (value - low) / (high - low);
        if !(0.0..=1.0).contains(&share) {
            return Err(wrong(format!("a value of {value} lies beyond the range from {low} to {high}")));
        }
        if points.last().is_some_and(|before| before.value >= share) {
            return Err(wrong(format!(
                "a value of {value} does not rise: points go from low values to high"
            )));
        }
        points.push(TransferPoint { value: share, color: Vec3::from(color), opacity });
    }
    Ok(TransferFunction { range, points })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn files_say_ranges_and_points() {
        for (name, text) in TRANSFERS {
            let function = parse_transfer(name, text).unwrap();
            assert!(function.points.len() > 1, "{name}");
            let scan = ["head", "stent", "vessels"].contains(&name);
            assert_eq!(function.range.is_some(), scan, "{name}");
        }
        let text = "range = [100, 300]\n[[point]]\nvalue = 150\ncolor = [1, 2, 0.5]\nopacity = 0.25\n";
        let function = parse_transfer("f.toml", text).unwrap();
        let expected = TransferPoint { value: 0.25, color: Vec3::new(1.0, 2.0, 0.5), opacity: 0.25 };
        assert_eq!(function, TransferFunction { range: Some([100.0, 300.0]), points: vec![expected] });
    }

    #[test]
    fn opacities_are_those_of_the_points_and_between() {
        let point = |value, opacity| TransferPoint { value, color: Vec3::ONE, opacity };
        let points = vec![point(0.25, 0.0), point(0.5, 1.0), point(0.75, 0.5)];
        let function = TransferFunction { range: None, points };
        assert_eq!([0.0, 0.375, 0.5, 0.625, 1.0].map(|v| function.opacity(v)), [0.0, 0.5, 1.0, 0.75, 0.5]);
        for (low, high, greatest) in [(0.0, 1.0, 1.0), (0.0, 0.375, 0.5), (0.625, 1.0, 0.75), (0.0, 0.1, 0.0)]
        {
            assert_eq!(function.greatest_opacity(low, high), greatest, "{low} to {high}");
        }
        let none = TransferFunction { range: None, points: Vec::new() };
        assert_eq!((none.opacity(0.5), none.greatest_opacity(0.0, 1.0)), (0.0, 0.0));
    }

    #[test]
    fn where_opacity_begins_is_known() {
        let point = |value, opacity| TransferPoint { value, color: Vec3::ONE, opacity };
        let begins = |points: &[TransferPoint]| {
            TransferFunction { range: None, points: points.to_vec() }.transparent_below()
        };
        assert_eq!(begins(&[point(0.1, 0.0), point(0.25, 0.0), point(0.5, 1.0), point(0.75, 0.0)]), 0.25);
        assert_eq!(begins(&[point(0.0, 0.0), point(1.0, 1.0)]), 0.0);
        assert_eq!(begins(&[point(0.3, 0.5), point(1.0, 1.0)]), 0.0);
        assert_eq!((begins(&[point(0.3, 0.0)]), begins(&[])), (1.0, 1.0));
    }

    #[test]
    fn what_is_impossible_is_said_with_its_place() {
        let point = |value: &str, color: &str, opacity: &str| {
            format!("[[point]]\nvalue = {value}\ncolor = {color}\nopacity = {opacity}\n")
        };
        let fine = point("0.5", "\"#ffffff\"", "1");
        for (text, said) in [
            (String::new(), "no points"),
            (format!("range = [1, 0]\n{fine}"), "from 1 to 0"),
            (format!("range = [0, inf]\n{fine}"), "from 0 to inf"),
            (format!("{fine}{fine}"), "point 1: a value of 0.5 does not rise"),
            (point("nan", "[1, 1, 1]", "1"), "a value of NaN"),
            (point("1.5", "[1, 1, 1]", "1"), "a value of 1.5 lies beyond"),
            (point("0.5", "[1, -1, 1]", "1"), "a colour of [1.0, -1.0, 1.0]"),
            (point("0.5", "\"#fffff\"", "1"), "`#fffff` is no colour"),
            (point("0.5", "[1, 1, 1]", "1.1"), "an opacity of 1.1"),
            (point("0.5", "[1, 1]", "1"), "f.toml:3:9: a colour is \"#rrggbb\""),
            (format!("{fine}tint = 1\n"), "f.toml:5:1: unknown field `tint`"),
        ] {
            let error = parse_transfer("f.toml", &text).unwrap_err().to_string();
            assert!(error.contains(said) && error.contains("f.toml"), "{text}: {error}");
        }
    }
}
