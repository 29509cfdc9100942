// SPDX-License-Identifier: MIT OR Apache-2.0
//! How lights are spelt.

use super::numbers;
use crate::Lighting;
use crate::core::{Light, direction_from_angles};
use glam::Vec3;

/// Radius of a spot or point light, metres: that of a lantern.
const RADIUS: f32 = 0.05;
/// Share of a spot's angle that is in full light, where no inner angle is said.
const INNER: f32 = 0.8;

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSpelling {
    /// `directional:AZIMUTH,ELEVATION` in degrees.
    Directional {
        /// From +z towards +x.
        azimuth: f32,
        /// Above the horizon.
        elevation: f32,
    },
    /// `spot:X,Y,Z,TX,TY,TZ,ANGLE[,INNER]`, metres and degrees.
    Spot {
        /// Where it is.
        position: Vec3,
        /// Where its axis points.
        target: Vec3,
        /// From the axis to where there is no light.
        outer: f32,
        /// From the axis to where the light begins to fall off.
        inner: f32,
    },
    /// `point:X,Y,Z`, metres.
    Point {
        /// Where it is.
        position: Vec3,
    },
}

impl LightSpelling {
    /// The light with a radiance: irradiance of a directional light, radiant intensity of the others.
    pub fn lighting(self, radiance: Vec3) -> Lighting {
        match self {
            Self::Directional { azimuth, elevation } => {
                Lighting::directional(direction_from_angles(azimuth, elevation), radiance)
            }
            Self::Spot { position, target, outer, inner } => Lighting::Spot {
                position,
                target,
                outer_degrees: outer,
                inner_degrees: inner,
                intensity: radiance,
                radius: RADIUS,
            },
            Self::Point { position } => Lighting::Point { position, intensity: radiance, radius: RADIUS },
        }
    }
}

/// `directional:AZ,EL`, `spot:X,Y,Z,TX,TY,TZ,ANGLE[,INNER]` or `point:X,Y,Z`.
pub fn light(text: &str) -> Result<LightSpelling, String> {
    let wrong = || {
        format!(
            "`{text}` is not a light such as directional:135,40 (azimuth, elevation in degrees), \
             spot:0,5,0,0,0,0,25 (position, target, degrees from the axis) or point:0,2,0"
        )
    };
    let (kind, rest) = text.split_once(':').ok_or_else(wrong)?;
    match kind {
        "directional" => {
            let values = numbers(rest)?;
            let [azimuth, elevation] = values[..] else { return Err(wrong()) };
            if elevation.abs() > 90.0 {
                return Err(format!(
                    "elevation {elevation} is impossible: it must be from -90 to 90 degrees"
                ));
            }
            Ok(LightSpelling::Directional { azimuth, elevation })
        }
        "spot" => {
            let values = numbers(rest)?;
            let (place, outer, inner) = match values[..] {
                [_, _, _, _, _, _, outer] => (&values[..6], outer, outer * INNER),
                [_, _, _, _, _, _, outer, inner] => (&values[..6], outer, inner),
                _ => return Err(wrong()),
            };
            let (position, target) = (Vec3::from_slice(place), Vec3::from_slice(&place[3..]));
            // The range of blockers is not known yet, and does not matter to the rest.
            Light::spot(position, target, outer, inner, Vec3::ONE, RADIUS, 0.1, 1.0)
                .map_err(|error| error.to_string())?;
            Ok(LightSpelling::Spot { position, target, outer, inner })
        }
        "point" => {
            let values = numbers(rest)?;
            let [x, y, z] = values[..] else { return Err(wrong()) };
            Ok(LightSpelling::Point { position: Vec3::new(x, y, z) })
        }
        "area" | "textured" | "environment" => {
            Err(format!("light `{kind}` is not there yet; directional, spot and point are"))
        }
        _ => Err(wrong()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_read() {
        assert_eq!(
            light("directional:10,20").unwrap(),
            LightSpelling::Directional { azimuth: 10.0, elevation: 20.0 }
        );
        let spot = |inner| LightSpelling::Spot {
            position: Vec3::new(1.0, 5.0, -2.0),
            target: Vec3::new(0.0, 0.5, 0.0),
            outer: 25.0,
            inner,
        };
        assert_eq!(light("spot:1,5,-2,0,0.5,0,25").unwrap(), spot(20.0));
        assert_eq!(light("spot:1,5,-2,0,0.5,0,25,10").unwrap(), spot(10.0));
        assert_eq!(
            light("point:1,-2,3.5").unwrap(),
            LightSpelling::Point { position: Vec3::new(1.0, -2.0, 3.5) }
        );
        let Lighting::Point { intensity, .. } = light("point:0,0,0").unwrap().lighting(Vec3::Y) else {
            panic!("no point light");
        };
        assert_eq!(intensity, Vec3::Y);
    }

    #[test]
    fn nonsense_is_refused_with_the_value_and_what_is_possible() {
        for (wrong, said) in [
            ("sun", "directional:135,40"),
            ("directional", "directional:135,40"),
            ("directional:1", "directional:1"),
            ("directional:0,91", "-90 to 90"),
            ("directional:nan,0", "nan"),
            ("spot:1,2", "spot:1,2"),
            ("spot:0,0,0,0,0,0,20", "finite and apart"),
            ("spot:0,1,0,0,0,0,90", "outer <= 80"),
            ("spot:0,1,0,0,0,0,0", "outer <= 80"),
            ("spot:0,1,0,0,0,0,20,30", "inner <= outer"),
            ("spot:0,1,0,0,0,0,20,10,5", "spot:0,5,0"),
            ("spot:0,1,0,0,0,inf,20", "inf"),
            ("point:1,2", "point:1,2"),
            ("point:1,2,three", "three"),
            ("area:1", "not there yet"),
            ("", "``"),
        ] {
            let error = light(wrong).unwrap_err();
            assert!(error.contains(said) && error.lines().count() == 1, "{wrong}: {error}");
        }
    }
}
