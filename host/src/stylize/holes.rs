// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random holes: from what an artist asks for to the parameters of the noise.

use super::HoleError;
use super::hole_statistics::Distribution;
use crate::core::DepthRange;
use encase::ShaderType;
use glam::{DVec2, Mat4, Vec2};

/// Octaves at most.
const MOST_OCTAVES: u32 = 8;
/// Cells of the finest octave across a map at most: a position in a map is a float, which has 1/256 of such a cell left.
const MOST_CELLS: f64 = 65536.0;
/// Densities nearer to 0 or 1 have the hole size of this distance: their holes have no size, or no end.
const LEAST_SHARE: f64 = 0.002;
/// A displacement of the noise by more cells than this tears holes to pieces.
const MOST_DISPLACEMENT: f64 = 1.0;

/// The uniform `HoleParameters` of `stylize/perlin_holes`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct HoleParameters {
    /// Cells of the first octave across width and height of the map.
    pub cells: Vec2,
    /// Noise below it is a hole: none at 0 and below, all above 1.
    pub threshold: f32,
    /// Weight of an octave over that of the one before, 0..1.
    pub persistence: f32,
    /// Number of octaves, 1..8.
    pub octaves: u32,
    /// Any number: other holes.
    pub seed: u32,
    /// How far the first look-up has travelled, whole cells, modulo 2^32.
    pub travel: u32,
    /// The rest of it, 0..1, cells.
    pub travel_part: f32,
    /// How far the second look-up is displaced at most, cells.
    pub displacement: f32,
    /// By how much the displacement turns, radians.
    pub turn: f32,
    /// Depth of an empty texel: 1 forward, 0 reversed.
    pub far_depth: f32,
    /// Padding.
    pub reserved: f32,
}

impl HoleParameters {
    /// Checks parameters that do not come from a [`HolePattern`].
    ///
    /// # Errors
    /// [`HoleError::Octaves`], [`HoleError::Value`].
    pub fn validate(&self) -> Result<(), HoleError> {
        check_octaves(self.octaves)?;
        for cells in self.cells.to_array() {
            let fits = cells > 0.0 && f64::from(cells) <= MOST_CELLS;
            check("cells", cells, fits, "positive and at most 65536")?;
        }
        check("threshold", self.threshold, self.threshold.is_finite(), "finite")?;
        check("persistence", self.persistence, (0.0..=1.0).contains(&self.persistence), "from 0 to 1")?;
        check(
            "travel",
            self.travel_part,
            (0.0..=1.0).contains(&self.travel_part),
            "from 0 to 1 besides whole cells",
        )?;
        let displacement = f64::from(self.displacement);
        check(
            "displacement",
            self.displacement,
            (0.0..=MOST_DISPLACEMENT).contains(&displacement),
            "from 0 to 1 cell",
        )?;
        check("turn", self.turn, self.turn.abs() <= 100.0, "from -100 to 100 radians")?;
        check("far depth", self.far_depth, self.far_depth == 0.0 || self.far_depth == 1.0, "0 or 1")
    }
}

fn check(name: &'static str, value: f32, fits: bool, range: &'static str) -> Result<(), HoleError> {
    if fits { Ok(()) } else { Err(HoleError::Value { name, value: f64::from(value), range }) }
}

fn check_octaves(octaves: u32) -> Result<(), HoleError> {
    if (1..=MOST_OCTAVES).contains(&octaves) { Ok(()) } else { Err(HoleError::Octaves(octaves)) }
}

/// How holes move, as leaves do in the wind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoleMotion {
    /// How far a piece of an edge moves from its place at most, metres; 0 for holes that stand still. It is less for most:
    /// three tenths on average over space and time.
    pub distance: f32,
    /// By how much the direction turns between the middle and the end of the way, radians; 0 moves along a line.
    pub turn: f32,
    /// Cells of the travelling noise a second: about how often a piece comes to rest in a second.
    pub pace: f32,
}

impl Default for HoleMotion {
    fn default() -> Self {
        Self { distance: 0.0, turn: 1.5, pace: 0.5 }
    }
}

/// Holes in the words of an artist.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Holes {
    /// Mean chord, metres (or whatever the extent of the map is in): the mean length of the pieces that holes cut from lines
    /// along the sides of the map. Up to a density of about 0.35 that is a size; then holes grow together.
    pub size: f32,
    /// Share of the area that is hole, 0..1.
    pub density: f32,
    /// Octaves of the noise, 1..8: how ragged edges are. Octaves with cells of less than three texels are wasted: the map
    /// misses the shortest pieces, and the others come out longer than asked for.
    pub octaves: u32,
    /// Persistence of Eq. 5, 0..1: how much the finer octaves count.
    pub persistence: f32,
    /// Any number: other holes.
    pub seed: u32,
    /// How they move.
    pub motion: HoleMotion,
}

impl Default for Holes {
    fn default() -> Self {
        Self { size: 0.3, density: 0.2, octaves: 3, persistence: 0.5, seed: 1, motion: HoleMotion::default() }
    }
}

impl Holes {
    /// Checks every number.
    ///
    /// # Errors
    /// [`HoleError::Value`], [`HoleError::Octaves`].
    pub fn validate(&self) -> Result<(), HoleError> {
        check("size", self.size, self.size > 0.0 && self.size.is_finite(), "positive and finite, metres")?;
        check(
            "density",
            self.density,
            (0.0..=1.0).contains(&self.density),
            "from 0 to 1, a share of the area",
        )?;
        check_octaves(self.octaves)?;
        check("persistence", self.persistence, (0.0..=1.0).contains(&self.persistence), "from 0 to 1")?;
        let HoleMotion { distance, turn, pace } = self.motion;
        check("distance", distance, distance >= 0.0 && distance.is_finite(), "0 or more and finite, metres")?;
        check("turn", turn, turn.abs() <= 100.0, "from -100 to 100 radians")?;
        check("pace", pace, pace.abs() <= 1000.0, "from -1000 to 1000 cells a second")
    }

    /// Weights of the octaves, the coarsest first (Eq. 5).
    fn weights(&self) -> Vec<f64> {
        let weight = |octave: u32| {
            f64::from(self.persistence).powi(octave as i32) / f64::from((self.octaves - octave).max(2) - 1)
        };
        (0..self.octaves).map(weight).collect()
    }
}

/// Width and height in metres of a shadow map with the matrix `clip_from_world`; that of a light at a point widens with the
/// distance from it, and is meant at `distance` metres. A directional light's is the same at all distances.
pub fn shadow_map_extent(clip_from_world: &Mat4, distance: f32) -> [f32; 2] {
    let rows = clip_from_world.transpose();
    // The row of w is that of a unit vector along the axis for a light at a point, else (0, 0, 0, 1).
    let along = rows.w_axis.truncate().length();
    let w = if along > 0.0 { along * distance } else { rows.w_axis.w };
    [2.0 * w / rows.x_axis.truncate().length(), 2.0 * w / rows.y_axis.truncate().length()]
}

/// Holes as the noise that makes them, for any time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HolePattern {
    parameters: HoleParameters,
    pace: f32,
}

impl HolePattern {
    /// The noise that has the density and size asked for. `extent`: metres across the map, see [`shadow_map_extent`];
    /// `depth`: which way depth runs in it.
    ///
    /// # Errors
    /// [`HoleError`].
    pub fn new(holes: &Holes, extent: [f32; 2], depth: DepthRange) -> Result<Self, HoleError> {
        holes.validate()?;
        for side in extent {
            check("map extent", side, side > 0.0 && side.is_finite(), "positive and finite, metres")?;
        }
        let distribution = Distribution::new(&holes.weights());
        let density = f64::from(holes.density);
        let chord =
            distribution.mean_chord(distribution.level(density.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE)));
        let cell = cell_size(holes, chord);
        let distance = f64::from(holes.motion.distance);
        if distance > MOST_DISPLACEMENT * cell {
            return Err(HoleError::TooFar {
                size: holes.size,
                distance: holes.motion.distance,
                most: furthest(f64::from(holes.size), chord, holes.motion.turn),
            });
        }
        let cells = DVec2::new(f64::from(extent[0]), f64::from(extent[1])) / cell;
        let finest = cells.max_element() * f64::from(1_u32 << (holes.octaves - 1));
        if finest.is_nan() || finest > MOST_CELLS {
            return Err(HoleError::TooSmall {
                size: holes.size,
                extent: extent[0].max(extent[1]),
                cells: finest,
            });
        }
        let threshold = match holes.density {
            // Noise ends at 0 and 1, and may by rounding be either.
            0.0 => -1.0,
            1.0 => 2.0,
            _ => (0.5 + 0.5 * distribution.level(density)) as f32,
        };
        let parameters = HoleParameters {
            cells: cells.as_vec2().max(Vec2::splat(f32::MIN_POSITIVE)),
            threshold,
            persistence: holes.persistence,
            octaves: holes.octaves,
            seed: holes.seed,
            travel: 0,
            travel_part: 0.0,
            displacement: ((distance / cell).min(MOST_DISPLACEMENT)) as f32,
            turn: holes.motion.turn,
            far_depth: if depth == DepthRange::Forward { 1.0 } else { 0.0 },
            reserved: 0.0,
        };
        Ok(Self { parameters, pace: holes.motion.pace })
    }

    /// The parameters at a time, seconds: as fine after a year as after a second.
    ///
    /// # Errors
    /// [`HoleError::Value`] for a time that is not finite or beyond 1e9 seconds.
    pub fn at(&self, seconds: f64) -> Result<HoleParameters, HoleError> {
        if seconds.is_nan() || seconds.abs() > 1e9 {
            return Err(HoleError::Value { name: "time", value: seconds, range: "from -1e9 to 1e9 seconds" });
        }
        let travelled = seconds * f64::from(self.pace);
        let whole = travelled.floor();
        Ok(HoleParameters {
            travel: whole.rem_euclid(4_294_967_296.0) as u32,
            travel_part: (travelled - whole) as f32,
            ..self.parameters
        })
    }
}

/// A displacement d = D v (cos t v, sin t v) by a noise v stretches what is looked up: the length of a line grows, on average
/// over lines along both sides of the map, by sqrt(1 + k D^2), and chords shrink by it. This is k, per square cell.
fn stretch(turn: f32) -> f64 {
    let travelling = Distribution::new(&[1.0]);
    let turning = 1.0 + f64::from(turn).powi(2) * travelling.variance();
    0.5 * travelling.mean_square_slope() * turning
}

/// Metres of a cell of the first octave: the c of c chord = size sqrt(1 + k (distance / c)^2).
fn cell_size(holes: &Holes, chord: f64) -> f64 {
    let (size, distance) = (f64::from(holes.size), f64::from(holes.motion.distance));
    let half = 0.5 * (size / chord).powi(2);
    (half + (half * half + 2.0 * half * stretch(holes.motion.turn) * distance * distance).sqrt()).sqrt()
}

/// The distance, metres, that is a displacement by MOST_DISPLACEMENT cells.
fn furthest(size: f64, chord: f64, turn: f32) -> f64 {
    MOST_DISPLACEMENT * size / chord * (1.0 + stretch(turn) * MOST_DISPLACEMENT * MOST_DISPLACEMENT).sqrt()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::Light;
    use glam::Vec3;

    fn pattern(holes: &Holes) -> Result<HolePattern, HoleError> {
        HolePattern::new(holes, [10.0, 5.0], DepthRange::Forward)
    }

    #[test]
    fn what_is_impossible_is_refused() {
        type Change = fn(&mut Holes, f32);
        let changes: [(&str, Change, &[f32]); 6] = [
            ("size", |h, x| h.size = x, &[0.0, -1.0]),
            ("density", |h, x| h.density = x, &[-0.01, 1.01]),
            ("persistence", |h, x| h.persistence = x, &[-0.1, 1.1]),
            ("distance", |h, x| h.motion.distance = x, &[-0.1]),
            ("turn", |h, x| h.motion.turn = x, &[101.0]),
            ("pace", |h, x| h.motion.pace = x, &[1001.0]),
        ];
        for (name, change, values) in changes {
            for value in values.iter().copied().chain([f32::NAN, f32::INFINITY, f32::NEG_INFINITY]) {
                let mut holes = Holes::default();
                change(&mut holes, value);
                let error = pattern(&holes).unwrap_err();
                assert!(
                    matches!(error, HoleError::Value { name: n, .. } if n == name),
                    "{name} {value}: {error}"
                );
            }
        }
        for octaves in [0, 9, u32::MAX] {
            let error = pattern(&Holes { octaves, ..Holes::default() }).unwrap_err();
            assert!(matches!(error, HoleError::Octaves(n) if n == octaves));
        }
        for side in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(HolePattern::new(&Holes::default(), [side, 1.0], DepthRange::Forward).is_err(), "{side}");
            assert!(HolePattern::new(&Holes::default(), [1.0, side], DepthRange::Forward).is_err(), "{side}");
        }
        let still = pattern(&Holes::default()).unwrap();
        for time in [f64::NAN, f64::INFINITY, -1.1e9] {
            assert!(matches!(still.at(time), Err(HoleError::Value { name: "time", .. })));
        }
        let small = pattern(&Holes { size: 1e-6, ..Holes::default() });
        assert!(matches!(small, Err(HoleError::TooSmall { .. })));
    }

    #[test]
    fn holes_move_as_far_as_the_error_says() {
        let far =
            |distance| Holes { motion: HoleMotion { distance, ..HoleMotion::default() }, ..Holes::default() };
        let Err(HoleError::TooFar { most, .. }) = pattern(&far(100.0)) else { panic!("100 m") };
        let parameters = pattern(&far(most as f32 * 0.9999)).unwrap().at(0.0).unwrap();
        assert!((0.99..=1.0).contains(&parameters.displacement), "{}", parameters.displacement);
        assert!(matches!(pattern(&far(most as f32 * 1.001)), Err(HoleError::TooFar { .. })));
    }

    #[test]
    fn parameters_are_checked_on_their_own() {
        type Change = fn(&mut HoleParameters, f32);
        let good = pattern(&Holes::default()).unwrap().at(3.0).unwrap();
        assert!(good.validate().is_ok());
        let changes: [Change; 8] = [
            |p, x| p.cells.x = x,
            |p, x| p.cells.y = x,
            |p, x| p.threshold = x,
            |p, x| p.persistence = x,
            |p, x| p.travel_part = x,
            |p, x| p.displacement = x,
            |p, x| p.turn = x,
            |p, x| p.far_depth = x,
        ];
        for change in changes {
            for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let mut parameters = good;
                change(&mut parameters, value);
                assert!(parameters.validate().is_err());
            }
        }
        assert!(HoleParameters { octaves: 0, ..good }.validate().is_err());
    }

    #[test]
    fn time_is_as_fine_late_as_early() {
        let moving = HoleMotion { distance: 0.1, turn: 0.0, pace: 0.5 };
        let pattern = pattern(&Holes { motion: moving, ..Holes::default() }).unwrap();
        let early = pattern.at(2.25).unwrap();
        assert_eq!((early.travel, early.travel_part), (1, 0.125));
        let late = pattern.at(2.25 + 2.0 * 300_000_000.0).unwrap();
        assert_eq!((late.travel, late.travel_part), (300_000_001, 0.125));
        let before = pattern.at(-0.5).unwrap();
        assert_eq!((before.travel, before.travel_part), (u32::MAX, 0.75));
    }

    #[test]
    fn the_extent_of_a_map_is_that_of_its_light() {
        let [min, max] = [Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.0, 1.0, 2.0)];
        let light = Light::directional(Vec3::Y, Vec3::ONE, min, max).unwrap();
        let mut extent = shadow_map_extent(&light.clip_from_world, 7.0);
        extent.sort_by(f32::total_cmp);
        // A little room is left around the scene.
        assert!((4.0..4.4).contains(&extent[0]) && (6.0..6.4).contains(&extent[1]), "{extent:?}");
        // The map of a spot of 45 degrees to each side is as wide as twice the distance.
        let spot = Light::spot(Vec3::ONE, Vec3::ZERO, 45.0, 40.0, Vec3::ONE, 0.1, 0.1, 50.0).unwrap();
        let [width, height] = shadow_map_extent(&spot.clip_from_world, 7.0);
        assert!((14.0..14.6).contains(&width) && (width - height).abs() < 1e-4, "{width} {height}");
    }
}
