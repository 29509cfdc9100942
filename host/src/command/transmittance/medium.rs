// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is seen: a volume or particles, read or made, without what cannot be drawn.

use super::flags::{Options, Source};
use crate::Lighting;
use crate::command::CommandError;
use crate::command::error::medium_error;
use crate::command::volumes::load;
use crate::core::{Light, LightError};
use crate::data::{Bounds, Particles, Volume, burst, load_particles};
use crate::transmittance::ParticleCounts;
use glam::Vec3;

/// Optical depth along the longest side of a file of a volume, were all of it as dense as its densest voxel.
const OPTICAL_DEPTH: f32 = 32.0;
/// Voxels along the longest side of what is made.
const VOXELS: u32 = 160;
/// Share of the greatest extinction below which nothing is to be framed.
const SEEN: f32 = 0.05;
/// Farther from the origin nothing is seen, metres.
const FARTHEST: f32 = 1e6;

/// A medium with the boxes that hold it.
pub struct Medium {
    /// What it is made of.
    pub matter: Matter,
    /// What the map has to hold.
    pub bounds: Bounds,
    /// What the camera is to see.
    pub framed: Bounds,
    /// The box of the map was given.
    pub boxed: bool,
    /// What is to be said of it, a line each.
    pub report: Vec<String>,
}

/// Volume or particles.
pub enum Matter {
    /// Values 0..1, and from them to 1/m.
    Volume(Volume, f32),
    /// Those that can be drawn, and how many of others there were.
    Particles(Particles, ParticleCounts),
}

impl Medium {
    /// Reads or makes it.
    ///
    /// # Errors
    /// Misuse: an unknown name. A failure: a file, or nothing in it.
    pub fn new(flags: &Options) -> Result<Self, CommandError> {
        let seed = flags.of_volume.seed();
        let scale = flags.of_volume.extinction_scale;
        let count = flags.of_volume.voxels.unwrap_or(VOXELS);
        match flags.source() {
            Source::Made(own) => made(own.volume(count, seed), scale),
            Source::VolumeFile(path) => {
                let known = "cloud, plume, or a file that ends in .nii, .nii.gz or .npy";
                let volume = load(path, flags.of_volume.voxel, known)?;
                let threshold = flags.of_volume.threshold.unwrap_or(0.0);
                Self::of_volume(volume, threshold, scale).map_err(|problem| {
                    CommandError::failure(format!("--volume: {}: {problem}", path.display()))
                })
            }
            Source::Burst => Self::of_particles(burst(flags.count.unwrap_or(20_000) as usize, seed), flags)
                .map_err(CommandError::Failure),
            Source::ParticleFile(path) => {
                let read = load_particles(path);
                let read = read.map_err(|error| {
                    medium_error("--particles", error, "burst, or a file that ends in .npy")
                })?;
                Self::of_particles(read, flags).map_err(|problem| {
                    CommandError::failure(format!("--particles: {}: {problem}", path.display()))
                })
            }
        }
    }

    /// The light, fitted to the medium; to the box of the map where one was given.
    ///
    /// # Errors
    /// [`LightError`].
    pub fn light(&self, light: Lighting) -> Result<Light, LightError> {
        match (light, &self.matter) {
            (Lighting::Directional { towards, radiance }, Matter::Volume(volume, _)) => {
                Light::directional_leaning(towards, radiance, volume.occupied_points())
            }
            (Lighting::Directional { towards, radiance }, Matter::Particles(particles, _)) if !self.boxed => {
                Light::directional_around_balls(towards, radiance, particles.balls())
            }
            _ => light.fitted(&self.bounds),
        }
    }

    fn of_volume(mut volume: Volume, threshold: f32, scale: Option<f32>) -> Result<Self, String> {
        let bad = volume.values.iter().filter(|value| !value.is_finite()).count();
        let below = volume.values.iter().filter(|value| **value < 0.0).count();
        let exceeding = |value: &f32| if value.is_finite() { (value - threshold).max(0.0) } else { 0.0 };
        let greatest = volume.values.iter().map(exceeding).fold(0.0, f32::max);
        if greatest <= 0.0 || !greatest.is_finite() {
            return Err(format!(
                "no voxel exceeds {threshold}, all of it is empty: give a smaller --threshold"
            ));
        }
        // Half floats hold 0..1 whatever the file held.
        volume.values.iter_mut().for_each(|value| *value = exceeding(value) / greatest);
        let longest = volume.bounds().size().max_element();
        let scale = scale.unwrap_or(OPTICAL_DEPTH / (longest * greatest));
        let mut report = vec![format!("extinction: {scale:.4} 1/m a unit of value above {threshold}")];
        if bad + below > 0 {
            let voxels = volume.values.len();
            report.push(format!("voxels: {voxels}; taken as empty: {bad} not finite, {below} negative"));
        }
        let (bounds, framed) = (occupied(&volume, 0.0), occupied(&volume, SEEN));
        let extinction = (scale * greatest).min(f32::MAX);
        Ok(Self { matter: Matter::Volume(volume, extinction), bounds, framed, boxed: false, report })
    }

    fn of_particles(particles: Particles, flags: &Options) -> Result<Self, String> {
        let all = particles.list.len();
        let (mut kept, counts) = sound(particles);
        if kept.list.is_empty() {
            let dropped = described(&counts);
            return Err(format!("none of {all} particles can be drawn ({dropped}): check columns and units"));
        }
        let scale = flags.of_volume.extinction_scale.unwrap_or(1.0);
        kept.list
            .iter_mut()
            .for_each(|particle| particle.extinction = (particle.extinction * scale).min(1e6));
        let own = kept.bounds().unwrap_or(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
        let bounds = flags.bounds.map_or(own, |[min, max]| Bounds { min, max });
        let (matter, boxed) = (Matter::Particles(kept, counts), flags.bounds.is_some());
        Ok(Self { matter, bounds, framed: bounds, boxed, report: Vec::new() })
    }
}

/// A volume of a generator, whose values are extinction in 1/m.
fn made(volume: Volume, scale: Option<f32>) -> Result<Medium, CommandError> {
    let mut medium =
        Medium::of_volume(volume, 0.0, Some(scale.unwrap_or(1.0))).map_err(CommandError::Failure)?;
    medium.report.clear();
    Ok(medium)
}

/// The box around all voxels of more than `share`.
fn occupied(volume: &Volume, share: f32) -> Bounds {
    let Some([least, greatest]) = volume.occupied_voxels(share) else { return volume.bounds() };
    // Between voxels their neighbours are read.
    let sides = Vec3::from(volume.size.map(|side| side as f32));
    let (least, greatest) = ((least - 0.5).max(Vec3::ZERO) / sides, (greatest + 1.5).min(sides) / sides);
    let corners = Bounds { min: least, max: greatest }.corners();
    let corners = corners.map(|unit| volume.world_from_unit.transform_point3(unit));
    Bounds::of(corners).unwrap_or_else(|| volume.bounds())
}

/// The particles that can be drawn, and counts of the others. A radius is huge where it exceeds the box around all middles and
/// eight times the median: such a ball would hide all others.
fn sound(particles: Particles) -> (Particles, ParticleCounts) {
    let mut counts = ParticleCounts::default();
    let mut kept = particles.list;
    kept.retain(|particle| {
        let finite =
            particle.position.is_finite() && particle.radius.is_finite() && particle.extinction.is_finite();
        let defect = if !finite {
            &mut counts.not_finite
        } else if particle.radius <= 0.0 || particle.radius > FARTHEST {
            &mut counts.radius
        } else if particle.extinction < 0.0 {
            &mut counts.extinction
        } else if particle.position.abs().max_element() > FARTHEST {
            &mut counts.outside
        } else {
            return true;
        };
        *defect += 1;
        false
    });
    let mut radii: Vec<f32> = kept.iter().map(|particle| particle.radius).collect();
    radii.sort_by(f32::total_cmp);
    let median = radii.get(radii.len().saturating_sub(1) / 2).copied().unwrap_or(0.0);
    let middles = Bounds::of(kept.iter().map(|particle| particle.position));
    let most = middles.map_or(0.0, |bounds| 2.0 * bounds.radius()).max(8.0 * median);
    let before = kept.len();
    kept.retain(|particle| particle.radius <= most);
    counts.radius += (before - kept.len()) as u32;
    counts.kept = kept.len() as u32;
    (Particles { list: kept }, counts)
}

/// Why particles were dropped.
pub fn described(counts: &ParticleCounts) -> String {
    let reasons = [
        (counts.not_finite, "not finite"),
        (counts.radius, "of zero, negative or huge radius"),
        (counts.extinction, "of negative extinction"),
        (counts.outside, "outside of the map"),
    ];
    let said: Vec<String> =
        reasons.iter().filter(|(count, _)| *count > 0).map(|(count, why)| format!("{count} {why}")).collect();
    if said.is_empty() { "none dropped".to_owned() } else { format!("dropped {}", said.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Particle;

    #[test]
    fn what_cannot_be_drawn_is_dropped_and_counted() {
        let mut particles = burst(100, 2);
        let one = particles.list[3];
        for (position, radius, extinction) in [
            (Vec3::new(f32::NAN, 0.0, 0.0), 0.1, 1.0),
            (Vec3::ZERO, f32::INFINITY, 1.0),
            (Vec3::ZERO, 0.0, 1.0),
            (Vec3::ZERO, -1.0, 1.0),
            (Vec3::ZERO, 300.0, 1.0),
            (Vec3::ZERO, 1e30, 1.0),
            (Vec3::ZERO, 0.1, -1.0),
            (Vec3::splat(1e20), 0.1, 1.0),
        ] {
            particles.list.insert(7, Particle { position, radius, extinction });
        }
        let (kept, counts) = sound(particles);
        assert_eq!(kept, burst(100, 2));
        let expected =
            ParticleCounts { kept: 100, not_finite: 2, radius: 4, extinction: 1, outside: 1, overflows: 0 };
        assert_eq!(counts, expected);
        let said = described(&counts);
        assert!(said.starts_with("dropped 2 not finite, 4 of zero"), "{said}");
        // One alone is not huge, whatever its radius.
        let (kept, _) = sound(Particles { list: vec![Particle { radius: 500.0, ..one }] });
        assert_eq!(kept.list.len(), 1);
        assert!(sound(Particles::default()).0.list.is_empty());
    }

    #[test]
    fn volumes_are_cleaned_and_framed_by_what_is_in_them() {
        let mut values = vec![0.0; 10 * 10 * 10];
        values[5 + 50 + 500] = 300.0;
        values[2 + 50 + 500] = 3.0;
        values[0] = f32::NAN;
        values[1] = -4.0;
        let space = glam::Mat4::from_scale(Vec3::splat(10.0));
        let volume = Volume { size: [10; 3], values, world_from_unit: space };
        let medium = Medium::of_volume(volume.clone(), 0.0, None);
        let Ok(Medium { matter: Matter::Volume(clean, scale), bounds, framed, report, .. }) = medium else {
            panic!("no volume");
        };
        assert!((scale - 3.2).abs() < 1e-6 && clean.values[555] == 1.0 && clean.values[..2] == [0.0, 0.0]);
        assert_eq!((bounds.min, bounds.max), (Vec3::new(1.5, 4.5, 4.5), Vec3::splat(6.5)));
        assert_eq!((framed.min, framed.max), (Vec3::splat(4.5), Vec3::splat(6.5)));
        assert!(report[1].contains("1 not finite, 1 negative"), "{report:?}");
        assert!(Medium::of_volume(volume, 300.0, None).is_err_and(|error| error.contains("--threshold")));
    }
}
