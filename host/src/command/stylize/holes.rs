// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--holes`: random holes by their names, key-framed.

use crate::core::{DepthRange, Light};
use crate::data::Bounds;
use crate::stylize::{
    HoleError, HoleMotion, HoleParameters, HolePattern, Holes, Keyed, TransferError, shadow_map_extent,
};
use glam::Mat4;

/// Names of what can be said.
const NAMES: &str = "size, density, octaves, persistence, seed, time, distance, turn and pace";
/// Beyond it, in degrees, a turn is as good as a smaller one.
const MOST_TURN: f32 = 5729.0;

/// Holes whose numbers may change from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyedHoles {
    size: Keyed<f32>,
    density: Keyed<f32>,
    persistence: Keyed<f32>,
    distance: Keyed<f32>,
    /// Degrees.
    turn: Keyed<f32>,
    /// Seconds: of frame 0, or where it has key frames of every frame.
    time: Keyed<f32>,
    pace: f32,
    octaves: u32,
    seed: u32,
}

impl Default for KeyedHoles {
    fn default() -> Self {
        let Holes { size, density, octaves, persistence, seed, motion } = Holes::default();
        Self {
            size: Keyed::constant(size),
            density: Keyed::constant(density),
            persistence: Keyed::constant(persistence),
            distance: Keyed::constant(motion.distance),
            turn: Keyed::constant(motion.turn.to_degrees()),
            time: Keyed::constant(0.0),
            pace: motion.pace,
            octaves,
            seed,
        }
    }
}

/// `NAME=NUMBER,NAME=FRAME:NUMBER/FRAME:NUMBER`.
pub fn holes(text: &str) -> Result<KeyedHoles, String> {
    let mut holes = KeyedHoles::default();
    let mut said: Vec<&str> = Vec::new();
    for part in text.split(',') {
        let (name, value) =
            part.split_once('=').ok_or_else(|| format!("`{part}` is not NAME=NUMBER: there are {NAMES}"))?;
        let name = name.trim();
        if said.contains(&name) {
            return Err(format!("`{name}` is given twice: give it once"));
        }
        said.push(name);
        match name {
            "size" => holes.size = keyed(name, value)?,
            "density" => holes.density = keyed(name, value)?,
            "persistence" => holes.persistence = keyed(name, value)?,
            "distance" => holes.distance = keyed(name, value)?,
            "turn" => holes.turn = keyed(name, value)?,
            "time" => holes.time = keyed(name, value)?,
            "pace" => {
                holes.pace = crate::command::parse::number(value).map_err(|error| {
                    format!("{name}: {error}; for a pace that changes give key frames of time")
                })?;
            }
            "octaves" => holes.octaves = number(name, value)?,
            "seed" => holes.seed = number(name, value)?,
            _ => return Err(format!("`{name}` is nothing that holes have: there are {NAMES}")),
        }
    }
    holes.check()?;
    Ok(holes)
}

fn number(name: &str, value: &str) -> Result<u32, String> {
    value.trim().parse().map_err(|_| format!("{name}: `{value}` is not a whole number from 0 on"))
}

fn keyed(name: &str, value: &str) -> Result<Keyed<f32>, String> {
    value.replace('/', ",").parse().map_err(|error| match error {
        TransferError::KeyText(_) => {
            format!("{name}: `{value}` is neither a number nor key frames FRAME:NUMBER/FRAME:NUMBER")
        }
        other => format!("{name}: {other}"),
    })
}

impl KeyedHoles {
    /// Checks every key frame; all between two is between them.
    fn check(&self) -> Result<(), String> {
        for (frame, degrees) in self.turn.keys() {
            if degrees.abs() > MOST_TURN {
                return Err(format!(
                    "turn: {degrees} at frame {frame} is impossible: -5729 to 5729 degrees are possible"
                ));
            }
        }
        for (frame, seconds) in self.time.keys() {
            if seconds.abs() > 1e6 {
                return Err(format!(
                    "time: {seconds} at frame {frame} is impossible: -1e6 to 1e6 seconds are possible"
                ));
            }
        }
        let all = [&self.size, &self.density, &self.persistence, &self.distance];
        for (frame, _) in all.iter().flat_map(|keyed| keyed.keys()) {
            self.at(*frame).validate().map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    fn at(&self, frame: f32) -> Holes {
        Holes {
            size: self.size.value(frame),
            density: self.density.value(frame),
            octaves: self.octaves,
            persistence: self.persistence.value(frame),
            seed: self.seed,
            motion: HoleMotion {
                distance: self.distance.value(frame),
                turn: self.turn.value(frame).to_radians(),
                pace: self.pace,
            },
        }
    }

    /// Whether a frame may differ from another.
    pub fn moves(&self) -> bool {
        let keyed = [&self.size, &self.density, &self.persistence, &self.distance, &self.turn, &self.time];
        keyed.iter().any(|keyed| keyed.keys().len() > 1)
            || self.distance.keys().iter().any(|(_, metres)| *metres > 0.0)
    }

    /// The holes of every map of a light in a frame: the faces around a point light have patterns of their own. `object`:
    /// what has the holes, whose middle they are measured at.
    ///
    /// # Errors
    /// [`HoleError`].
    pub fn parameters(
        &self,
        frame: u32,
        rate: f32,
        light: &Light,
        matrices: &[Mat4],
        object: &Bounds,
    ) -> Result<Vec<HoleParameters>, HoleError> {
        let number = frame as f32;
        let mut seconds = f64::from(self.time.value(number));
        if self.time.keys().len() == 1 {
            seconds += f64::from(frame) / f64::from(rate);
        }
        // Around a light within the object the middle says nothing.
        let distance = light.position.distance(object.center()).max(0.5 * object.radius()).max(1e-3);
        let holes = self.at(number);
        let map = |(layer, matrix): (usize, &Mat4)| {
            let pattern = HolePattern::new(&holes, shadow_map_extent(matrix, distance), DepthRange::Forward)?;
            let parameters = pattern.at(seconds)?;
            // The first keeps the seed that was given.
            Ok(HoleParameters {
                seed: parameters.seed ^ (layer as u32).wrapping_mul(0x9e37_79b9),
                ..parameters
            })
        };
        matrices.iter().enumerate().map(map).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn holes_are_read_and_nonsense_refused() {
        let read = holes("size=0:0.2/48:0.6,density=0.25,octaves=2,persistence=0.4,seed=7,turn=90").unwrap();
        let at = read.at(24.0);
        assert!(
            (at.size - 0.4).abs() < 1e-6 && (at.motion.turn - std::f32::consts::FRAC_PI_2).abs() < 1e-5,
            "{at:?}"
        );
        assert_eq!((at.density, at.octaves, at.persistence, at.seed), (0.25, 2, 0.4, 7));
        assert_eq!(holes("seed=1").unwrap(), KeyedHoles::default());
        assert!(read.moves() && !holes("size=1").unwrap().moves() && holes("distance=0.1").unwrap().moves());
        for (wrong, said) in [
            ("", "NAME=NUMBER"),
            ("size", "`size` is not NAME=NUMBER"),
            ("width=3", "`width`"),
            ("size=1,size=2", "twice"),
            ("size=0", "size 0"),
            ("size=nan", "`nan`"),
            ("size=0:0.2,48:0.6", "`48:0.6` is not"),
            ("size=8:1/2:1", "ascend"),
            ("size=0:1/8:-1", "size -1"),
            ("density=1.5", "density 1.5"),
            ("density=-0.1", "density -0.1"),
            ("octaves=0", "0 octaves"),
            ("octaves=9", "9 octaves"),
            ("octaves=1.5", "octaves: `1.5`"),
            ("persistence=2", "persistence 2"),
            ("seed=-1", "seed: `-1`"),
            ("distance=-1", "distance -1"),
            ("turn=9000", "turn: 9000"),
            ("pace=0:1/8:2", "key frames of time"),
            ("pace=2000", "pace 2000"),
            ("time=1e9", "time: 1000000000"),
        ] {
            let error = holes(wrong).unwrap_err();
            assert!(error.contains(said) && error.lines().count() == 1, "{wrong}: {error}");
        }
    }

    #[test]
    fn time_runs_with_the_frames_or_is_given() {
        let bounds = Bounds { min: -Vec3::ONE, max: Vec3::ONE };
        let light = Light::directional(Vec3::Y, Vec3::ONE, bounds.min, bounds.max).unwrap();
        let travel = |text: &str, frame| {
            let matrices = [light.clip_from_world];
            let holes = holes(text).unwrap().parameters(frame, 12.0, &light, &matrices, &bounds).unwrap();
            holes[0].travel as f32 + holes[0].travel_part
        };
        assert_eq!(travel("distance=0.1,pace=2,time=1", 6), 3.0);
        assert_eq!(travel("distance=0.1,pace=2,time=0:1/12:3", 6), 4.0);
    }

    #[test]
    fn maps_have_patterns_of_their_own() {
        let bounds = Bounds { min: -Vec3::ONE, max: Vec3::ONE };
        let light = Light::directional(Vec3::Y, Vec3::ONE, bounds.min, bounds.max).unwrap();
        let maps = [light.clip_from_world; 6];
        let holes = holes("seed=5").unwrap().parameters(0, 24.0, &light, &maps, &bounds).unwrap();
        let mut seeds: Vec<u32> = holes.iter().map(|holes| holes.seed).collect();
        assert_eq!(seeds[0], 5);
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 6);
    }
}
