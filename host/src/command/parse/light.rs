// SPDX-License-Identifier: MIT OR Apache-2.0
//! How lights are spelt.

use super::numbers;
use crate::Lighting;
use crate::core::{Light, direction_from_angles};
use crate::data::Bounds;
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
    /// `area:AZIMUTH,ELEVATION,DEGREES` or `area:X,Y,Z,SIDE`.
    Area {
        /// What its middle alone would be.
        middle: AreaMiddle,
        /// How wide it is: the angle in degrees that it is seen under, or its side in metres.
        extent: f32,
    },
}

/// Where an area light is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AreaMiddle {
    /// At infinity, a disc in the sky.
    Directional {
        /// From +z towards +x, degrees.
        azimuth: f32,
        /// Above the horizon, degrees.
        elevation: f32,
    },
    /// A square around a point.
    Point {
        /// Metres.
        position: Vec3,
    },
}

impl LightSpelling {
    /// Where it is, metres; none at infinity.
    pub fn position(self) -> Option<Vec3> {
        match self {
            Self::Directional { .. } | Self::Area { middle: AreaMiddle::Directional { .. }, .. } => None,
            Self::Spot { position, .. }
            | Self::Point { position }
            | Self::Area { middle: AreaMiddle::Point { position }, .. } => Some(position),
        }
    }

    /// The radiance by which the light gives the middle of `bounds` what a directional light of `radiance` gives it, and no more than
    /// that within.
    pub fn radiance_as(self, radiance: Vec3, bounds: &Bounds) -> Vec3 {
        self.position().map_or(radiance, |position| {
            let distance = position.distance(bounds.center()).max(0.25 * bounds.radius());
            radiance * (distance * distance).clamp(1e-6, 1e6)
        })
    }

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
            Self::Area { middle: AreaMiddle::Directional { azimuth, elevation }, .. } => {
                Lighting::directional(direction_from_angles(azimuth, elevation), radiance)
            }
            // On its axis a disc of that area has this fall-off.
            Self::Area { middle: AreaMiddle::Point { position }, extent } => Lighting::Point {
                position,
                intensity: radiance,
                radius: extent / std::f32::consts::PI.sqrt(),
            },
        }
    }
}

/// `directional:AZ,EL`, `spot:X,Y,Z,TX,TY,TZ,ANGLE[,INNER]`, `point:X,Y,Z`, `area:AZ,EL,DEGREES` or `area:X,Y,Z,SIDE`.
pub fn light(text: &str) -> Result<LightSpelling, String> {
    let wrong = || {
        format!(
            "`{text}` is not a light such as directional:135,40 (azimuth, elevation in degrees), \
             spot:0,5,0,0,0,0,25 (position, target, degrees from the axis), point:0,2,0, \
             area:135,40,5 (degrees across) or area:0,5,0,0.5 (position, metres of its side)"
        )
    };
    let (kind, rest) = text.split_once(':').ok_or_else(wrong)?;
    match kind {
        "directional" => {
            let values = numbers(rest)?;
            let [azimuth, elevation] = values[..] else { return Err(wrong()) };
            check_elevation(elevation)?;
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
        "area" => match numbers(rest)?[..] {
            [azimuth, elevation, extent] => {
                check_elevation(elevation)?;
                if !(0.0..=60.0).contains(&extent) || extent == 0.0 {
                    return Err(format!(
                        "{extent} degrees across are impossible: above 0 to 60 are possible"
                    ));
                }
                Ok(LightSpelling::Area { middle: AreaMiddle::Directional { azimuth, elevation }, extent })
            }
            [x, y, z, extent] if extent > 0.0 => {
                Ok(LightSpelling::Area { middle: AreaMiddle::Point { position: Vec3::new(x, y, z) }, extent })
            }
            [_, _, _, extent] => Err(format!("a side of {extent} m is impossible: it must be positive")),
            _ => Err(wrong()),
        },
        "textured" | "environment" => {
            Err(format!("light `{kind}` is not there yet; directional, spot, point and area are"))
        }
        _ => Err(wrong()),
    }
}

fn check_elevation(elevation: f32) -> Result<(), String> {
    if elevation.abs() <= 90.0 {
        return Ok(());
    }
    Err(format!("elevation {elevation} is impossible: it must be from -90 to 90 degrees"))
}

/// What commands without soft shadows say of area lights.
pub const NO_AREA: &str =
    "`area` casts soft shadows, which only `airlight splatting` has: take directional, spot or point";

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
        let sun = AreaMiddle::Directional { azimuth: 10.0, elevation: 20.0 };
        assert_eq!(light("area:10,20,3").unwrap(), LightSpelling::Area { middle: sun, extent: 3.0 });
        let window = light("area:1,2,3,0.5").unwrap();
        let position = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(window, LightSpelling::Area { middle: AreaMiddle::Point { position }, extent: 0.5 });
        let Lighting::Point { radius, .. } = window.lighting(Vec3::ONE) else { panic!("no point light") };
        assert!((std::f32::consts::PI * radius * radius - 0.25).abs() < 1e-6);
        assert!(matches!(light("area:0,0,1").unwrap().lighting(Vec3::Y), Lighting::Directional { .. }));
        assert_eq!((window.position(), light("directional:0,0").unwrap().position()), (Some(position), None));
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
            ("area:1", "area:135,40,5"),
            ("area:0,91,5", "-90 to 90"),
            ("area:0,30,0", "above 0 to 60"),
            ("area:0,30,61", "above 0 to 60"),
            ("area:0,5,0,0", "must be positive"),
            ("area:0,5,0,-1", "must be positive"),
            ("environment:a.exr", "not there yet"),
            ("", "``"),
        ] {
            let error = light(wrong).unwrap_err();
            assert!(error.contains(said) && error.lines().count() == 1, "{wrong}: {error}");
        }
    }
}
