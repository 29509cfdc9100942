// SPDX-License-Identifier: MIT OR Apache-2.0
//! How things are put into the world.

use glam::{Mat4, Vec3};
use std::path::PathBuf;

/// A file or a name, and where it is put: `FILE` or `FILE@X,Y,Z[,SCALE[,TURN]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The file, or a name.
    pub source: PathBuf,
    /// By how much it is moved, metres.
    pub offset: Vec3,
    /// Factor on its size, before it is moved.
    pub scale: f32,
    /// By how much it is turned about its own upright axis, from +z towards +x, degrees.
    pub turn: f32,
}

impl Placed {
    /// From where it would lie to where it lies.
    pub fn transform(&self) -> Mat4 {
        Mat4::from_translation(self.offset)
            * Mat4::from_rotation_y(self.turn.to_radians())
            * Mat4::from_scale(Vec3::splat(self.scale))
    }
}

/// `FILE` or `FILE@X,Y,Z[,SCALE[,TURN]]`; what follows the last `@` and begins no number belongs to the file's name.
pub fn placed(text: &str) -> Result<Placed, String> {
    let begins = |place: &str| place.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let Some((source, place)) = text.rsplit_once('@').filter(|(_, place)| begins(place)) else {
        return Ok(Placed { source: text.into(), offset: Vec3::ZERO, scale: 1.0, turn: 0.0 });
    };
    let (offset, scale, turn) = match super::numbers(place)?[..] {
        [x, y, z] => (Vec3::new(x, y, z), 1.0, 0.0),
        [x, y, z, scale] => (Vec3::new(x, y, z), scale, 0.0),
        [x, y, z, scale, turn] => (Vec3::new(x, y, z), scale, turn),
        _ => return Err(format!("`{place}` is no place: X,Y,Z, X,Y,Z,SCALE or X,Y,Z,SCALE,TURN are")),
    };
    if !(1e-6..=1e6).contains(&scale) {
        return Err(format!("a scale of {scale} is impossible: it must be from 1e-6 to 1e6"));
    }
    Ok(Placed { source: source.into(), offset, scale, turn })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_and_nonsense_is_refused() {
        let read = |text: &str| {
            let Placed { source, offset, scale, turn } = placed(text).unwrap();
            (source.display().to_string(), offset.to_array(), scale, turn)
        };
        assert_eq!(read("cloud"), ("cloud".into(), [0.0; 3], 1.0, 0.0));
        assert_eq!(read("a@b.obj"), ("a@b.obj".into(), [0.0; 3], 1.0, 0.0));
        assert_eq!(read("a@b.obj@1,-2,.5"), ("a@b.obj".into(), [1.0, -2.0, 0.5], 1.0, 0.0));
        assert_eq!(read("a@0,1,2,3,90"), ("a".into(), [0.0, 1.0, 2.0], 3.0, 90.0));
        let there = placed("a@1,2,3,2,90").unwrap().transform().transform_point3(Vec3::Z);
        assert!(there.distance(Vec3::new(3.0, 2.0, 3.0)) < 1e-5, "{there}");
        for (wrong, said) in [
            ("a@1,2", "`1,2`"),
            ("a@1,2,three", "three"),
            ("a@1,2,3,0", "scale of 0"),
            ("a@1,2,3,-1", "scale of -1"),
            ("a@1,2,3,1,0,0", "X,Y,Z,SCALE,TURN"),
        ] {
            let error = placed(wrong).unwrap_err();
            assert!(error.contains(said), "{wrong}: {error}");
        }
    }
}
