// SPDX-License-Identifier: MIT OR Apache-2.0
//! Spellings that all commands share.

mod light;
mod placed;
mod view;

pub use light::{LightSpelling, NO_AREA, light};
pub use placed::{Placed, placed};
pub use view::{DepthSpelling, Projection, cascades, samples};

use glam::Vec3;

/// `x,y,z`, finite numbers.
pub fn vector(text: &str) -> Result<Vec3, String> {
    let values = numbers(text)?;
    let [x, y, z] = values[..] else {
        return Err(format!("`{text}` is not three numbers x,y,z"));
    };
    Ok(Vec3::new(x, y, z))
}

/// `WxH`, both at least 1.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{text}` is not a size WxH such as 1280x720");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let parse = |side: &str| side.parse::<u32>().ok().filter(|side| *side > 0).ok_or_else(wrong);
    Ok([parse(width)?, parse(height)?])
}

/// A finite number.
pub fn number(text: &str) -> Result<f32, String> {
    text.trim()
        .parse::<f32>()
        .ok()
        .filter(|value| value.is_finite())
        .ok_or_else(|| format!("`{text}` is not a finite number"))
}

/// A finite number greater than 0.
pub fn positive(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    if value > 0.0 { Ok(value) } else { Err(format!("`{text}` is impossible: it must be positive")) }
}

/// One number for all colours, or `r,g,b`.
pub fn grey_or_colour(text: &str) -> Result<Vec3, String> {
    if let Ok(grey) = number(text) {
        return Ok(Vec3::splat(grey));
    }
    vector(text).map_err(|_| format!("`{text}` is neither a finite number nor three r,g,b"))
}

fn numbers(text: &str) -> Result<Vec<f32>, String> {
    text.split(',').map(number).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn spellings_are_read_and_nonsense_is_refused() {
        assert_eq!(vector("1,-2,3.5").unwrap(), Vec3::new(1.0, -2.0, 3.5));
        assert_eq!(size("640x480").unwrap(), [640, 480]);
        for wrong in ["", "1,2", "1,2,3,4", "1,nan,3", "a,b,c", "inf,0,0"] {
            assert!(vector(wrong).is_err(), "{wrong}");
        }
        assert_eq!(grey_or_colour("0.5"), Ok(Vec3::splat(0.5)));
        assert_eq!(grey_or_colour("1,0.5,0"), Ok(Vec3::new(1.0, 0.5, 0.0)));
        for wrong in ["", "1,2", "nan", "red", "1,2,inf"] {
            assert!(grey_or_colour(wrong).is_err(), "{wrong}");
        }
        assert_eq!(positive("0.5"), Ok(0.5));
        for wrong in ["", "0", "-1", "nan", "inf"] {
            assert!(positive(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "640", "0x5", "-1x5", "640x", "axb", "1.5x2", "99999999999x1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
