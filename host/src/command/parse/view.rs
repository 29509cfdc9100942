// SPDX-License-Identifier: MIT OR Apache-2.0
//! How cameras and what belongs to them are spelt.

use crate::core::{Cascades, DepthRange, MAX_VIEWS};
use clap::ValueEnum;

/// `--camera`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Projection {
    /// View rays leave the eye.
    Perspective,
    /// View rays are parallel.
    Orthographic,
}

impl Projection {
    /// Whether a flag that only the other projection has was given, that flag, and what is wrong. `fov`, `height`: given.
    pub fn framing_rules(self, fov: bool, height: bool) -> [(bool, &'static str, &'static str); 2] {
        let orthographic = self == Self::Orthographic;
        [
            (orthographic && fov, "--fov", "an orthographic camera has no field of view: give --height"),
            (
                !orthographic && height,
                "--height",
                "a perspective camera has none: give --fov, or --camera orthographic",
            ),
        ]
    }
}

/// `--depth-range`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DepthSpelling {
    /// Near 0, far 1.
    Forward,
    /// Near 1, far 0.
    Reversed,
    /// Near 1, and 0 at infinity: no far plane.
    Infinite,
}

impl DepthSpelling {
    /// The direction of depth, and the far plane where one at `far` metres was meant.
    pub fn range(self, far: f32) -> (DepthRange, f32) {
        match self {
            Self::Forward => (DepthRange::Forward, far),
            Self::Reversed => (DepthRange::Reversed, far),
            Self::Infinite => (DepthRange::Reversed, f32::INFINITY),
        }
    }
}

/// `--samples`: 1 or 4.
pub fn samples(text: &str) -> Result<u32, String> {
    match text {
        "1" => Ok(1),
        "4" => Ok(4),
        _ => Err(format!("`{text}` samples a pixel are impossible: 1 and 4 are possible")),
    }
}

/// `--cascades`: 1 to 6.
pub fn cascades(text: &str) -> Result<Cascades, String> {
    let count = text.parse().ok().filter(|count| (1..=MAX_VIEWS as u32).contains(count));
    let count = count.ok_or_else(|| {
        format!("`{text}` cascades are impossible: a number from 1 to {MAX_VIEWS} is needed")
    })?;
    Ok(Cascades::new(count))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_belongs_to_cameras_is_read_and_nonsense_refused() {
        let names = |values: &[DepthSpelling]| {
            values.iter().map(|v| v.to_possible_value().unwrap().get_name().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(names(DepthSpelling::value_variants()), ["forward", "reversed", "infinite"]);
        assert_eq!(Projection::from_str("orthographic", false), Ok(Projection::Orthographic));
        assert_eq!(DepthSpelling::Infinite.range(9.0), (DepthRange::Reversed, f32::INFINITY));
        assert_eq!(DepthSpelling::Forward.range(9.0), (DepthRange::Forward, 9.0));
        assert_eq!((samples("1"), samples("4")), (Ok(1), Ok(4)));
        assert_eq!(cascades("3").unwrap().count, 3);
        for wrong in ["", "0", "2", "16", "four", "-1"] {
            assert!(samples(wrong).unwrap_err().contains("1 and 4"), "{wrong}");
        }
        for wrong in ["", "0", "7", "-1", "2.5", "many"] {
            assert!(cascades(wrong).unwrap_err().contains("1 to 6"), "{wrong}");
        }
    }
}
