// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbered frames and their time.

use super::CommandError;
use crate::formats::{WriteError, write_animation, write_png};
use std::io;
use std::path::{Path, PathBuf};

/// Frames of a sequence at most.
const MOST: u32 = 10_000;
/// Frames a second where none are asked for.
pub const RATE: f32 = 24.0;

/// Frames, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRange {
    /// The first.
    pub first: u32,
    /// How many, at least one.
    pub count: u32,
}

impl FrameRange {
    /// The last.
    pub fn last(self) -> u32 {
        self.first + (self.count - 1)
    }
}

/// `A..B`.
pub fn frames(text: &str) -> Result<FrameRange, String> {
    let wrong = || format!("`{text}` is not a range of frames A..B such as 0..48");
    let (first, last) = text.split_once("..").ok_or_else(wrong)?;
    let parse = |end: &str| end.trim().parse::<u32>().map_err(|_| wrong());
    let (first, last) = (parse(first)?, parse(last)?);
    let Some(more) = last.checked_sub(first) else {
        return Err(format!("`{text}` ends before it begins: give the first frame first"));
    };
    if more >= MOST {
        let count = u64::from(more) + 1;
        return Err(format!("`{text}` are {count} frames, and may be {MOST}: take fewer"));
    }
    Ok(FrameRange { first, count: more + 1 })
}

/// Frames a second.
pub fn rate(text: &str) -> Result<f32, String> {
    let rate = crate::command::parse::positive(text)?;
    if (0.001..=1000.0).contains(&rate) {
        Ok(rate)
    } else {
        Err(format!("{text} frames a second are impossible: 0.001 to 1000 are possible"))
    }
}

/// Seconds that a frame is shown, as a fraction of two numbers of 16 bits.
pub fn delay(rate: f32) -> [u16; 2] {
    let numerator = if rate.fract() == 0.0 {
        1.0
    } else if rate <= 65.0 {
        1000.0
    } else {
        10.0
    };
    [numerator as u16, (numerator * rate).round() as u16]
}

/// The picture of a frame beside the animation: its number before the ending, four digits or more.
pub fn numbered(out: &Path, frame: u32) -> PathBuf {
    let part = |name: Option<&std::ffi::OsStr>| name.unwrap_or_default().to_string_lossy().into_owned();
    out.with_file_name(format!("{}.{frame:04}.{}", part(out.file_stem()), part(out.extension())))
}

/// Writes frames as [`numbered`] pictures beside `out`, an animated PNG of them. `picture`: pixels of a frame, 3 or 4 bytes each.
///
/// # Errors
/// The first of `picture`; a failure where a file cannot be written.
pub fn write_frames(
    out: &Path,
    [width, height]: [u32; 2],
    frames: FrameRange,
    rate: Option<f32>,
    mut picture: impl FnMut(u32) -> Result<Vec<u8>, CommandError>,
) -> Result<(), CommandError> {
    let failed = |error: WriteError| CommandError::failure(format!("--out: {error}"));
    let mut problem = None;
    let pictures = (0..frames.count as usize).map(|index| {
        let frame = frames.first + index as u32;
        let written = picture(frame).and_then(|pixels| {
            write_png(numbered(out, frame), width, height, &pixels).map_err(failed)?;
            Ok(pixels)
        });
        written.map_err(|error| {
            problem = Some(error);
            io::Error::other("a frame could not be made")
        })
    });
    let written = write_animation(out, width, height, pictures, delay(rate.unwrap_or(RATE)));
    problem.map_or(Ok(()), Err)?;
    written.map_err(failed)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_rates_are_read_and_nonsense_refused() {
        assert_eq!(frames("0..48"), Ok(FrameRange { first: 0, count: 49 }));
        assert_eq!(frames("7..7"), Ok(FrameRange { first: 7, count: 1 }));
        assert_eq!(frames("0..9999").unwrap().count, MOST);
        for (wrong, said) in [
            ("5..3", "before it begins"),
            ("0..10000", "10001 frames"),
            ("0..4294967295", "4294967296 frames"),
            ("5", "`5`"),
            ("-1..3", "-1..3"),
            ("0...3", "0...3"),
            ("a..b", "a..b"),
            ("", "``"),
        ] {
            let error = frames(wrong).unwrap_err();
            assert!(error.contains(said), "{wrong}: {error}");
        }
        assert_eq!(rate("29.97"), Ok(29.97));
        for wrong in ["0", "-1", "nan", "1001", "0.0001"] {
            assert!(rate(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn frames_are_shown_as_long_as_asked() {
        assert_eq!(delay(24.0), [1, 24]);
        for rate in [0.001, 0.5, 1.0, 12.5, 23.976, 29.97, 64.9, 65.1, 119.88, 999.9, 1000.0] {
            let [numerator, denominator] = delay(rate).map(f64::from);
            let error = denominator / numerator / f64::from(rate) - 1.0;
            assert!(error.abs() < 1e-3, "{rate}: {error}");
        }
    }

    #[test]
    fn frames_lie_beside_the_animation() {
        assert_eq!(numbered(Path::new("a/walk.png"), 7), Path::new("a/walk.0007.png"));
        assert_eq!(numbered(Path::new("walk.1.PNG"), 12345), Path::new("walk.1.12345.PNG"));
    }
}
