// SPDX-License-Identifier: MIT OR Apache-2.0
//! One stage of a solve: emission and albedo, extinction, or light.

mod light;

use super::cancel::Cancel;
use super::descent::{Descent, Iterated, descend, sum};
use super::error::SolveError;
use super::field::{Field, colours, numbers};
use super::light::Illumination;
use super::options::{SolveOptions, Wanted};
use super::parts::{self, Property};
use super::report::{Distance, StageReport, ViewReport};
use super::studio::{Look, Picture, Seen, Shot, Studio};
use crate::command::CommandError;
use crate::inverse::{
    Channels, InverseError, LogCounts, LogTargets, Medium, Projector, Solved, Solver, Target, log_targets,
    radiance_targets,
};
use glam::Vec3;
use indicatif::ProgressBar;
use std::sync::Arc;
use std::time::Instant;

/// Greatest optical depth that a picture may ask for.
const MOST_DEPTH: f32 = 6.0;

/// What all stages share.
pub struct Stages<'a> {
    /// Where pictures are made.
    pub studio: &'a Studio<'a>,
    /// The flags.
    pub flags: &'a SolveOptions,
    /// The views, each with a target.
    pub seen: &'a [Seen],
    /// Radiance of the medium where extinction is solved for, as the channels have it.
    pub medium: Vec3,
    /// Whether to stop.
    pub cancel: &'a Cancel,
    /// A step an iteration.
    pub bar: &'a ProgressBar,
}

/// What iterations left.
struct Left {
    look: Look,
    residuals: Vec<[f32; 3]>,
    volumes: Vec<(Property, [u32; 3], usize)>,
    counts: Vec<Option<LogCounts>>,
}

impl Stages<'_> {
    /// Channels that are solved for one after another, each a system of its own.
    pub fn passes(wanted: Wanted, channels: Channels) -> u32 {
        if wanted == Wanted::Extinction && channels == Channels::Rgb { 3 } else { 1 }
    }

    /// What is seen of a volume while a property is solved for: for extinction a medium of one radiance.
    pub fn shown(&self, wanted: Wanted, look: &Look) -> Look {
        if wanted != Wanted::Extinction {
            return look.clone();
        }
        let [emission, albedo] = [self.medium, Vec3::ZERO].map(Field::constant);
        Look { emission, albedo, ..in_the_dark(look) }
    }

    /// Pictures of all views.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn pictures(&self, look: &Look) -> Result<Vec<Picture>, InverseError> {
        let shots: Vec<Shot<'_>> = self.seen.iter().map(Seen::shot).collect();
        self.studio.pictures(look, &shots)
    }

    /// Solves, and changes the volume.
    ///
    /// # Errors
    /// A failure: nothing to solve for, or the device.
    pub fn run(&self, wanted: Wanted, look: &mut Look) -> Result<StageReport, CommandError> {
        let begun = Instant::now();
        let before = self.distances(&self.pictures(&self.shown(wanted, look))?);
        let left = match wanted {
            Wanted::Extinction => self.extinction(look)?,
            Wanted::Light => self.light(look)?,
            _ => self.radiance(wanted, look)?,
        };
        *look = left.look;
        let after = self.distances(&self.pictures(&self.shown(wanted, look))?);
        let views = self.seen.iter().zip(before.into_iter().zip(after)).zip(left.counts);
        let views = views.map(|((seen, (before, after)), counts)| {
            let name = seen.name().to_owned();
            ViewReport { name, before, after, counts }
        });
        Ok(StageReport {
            wanted: wanted.name(),
            iterations: left.residuals.len().saturating_sub(1) as u32,
            residuals: left.residuals,
            volumes: left.volumes,
            light: look.found().filter(|_| wanted == Wanted::Light).cloned(),
            views: views.collect(),
            seconds: begun.elapsed().as_secs_f64(),
        })
    }

    fn distances(&self, pictures: &[Picture]) -> Vec<Distance> {
        let seen = self.seen.iter().zip(pictures);
        seen.map(|(seen, picture)| {
            Distance::new(&picture.over(&seen.background), &seen.target, &seen.weights)
        })
        .collect()
    }

    /// Emission, albedo or both.
    fn radiance(&self, wanted: Wanted, look: &Look) -> Result<Left, CommandError> {
        let Self { studio, flags, seen, .. } = *self;
        let channels = studio.channels;
        let properties = Property::of(wanted);
        let starts: Vec<Field> = properties
            .iter()
            .map(|property| {
                let own = if *property == Property::Emission { &look.emission } else { &look.albedo };
                own.resized(property.size(flags, studio.place, look.extinction.size))
            })
            .collect();
        let solved = properties.iter().zip(&starts).map(|(property, start)| {
            property.solved(flags, studio.place, start.size, &look.extinction, seen)
        });
        let solved = solved.collect::<Result<Vec<_>, _>>()?;
        parts::some(wanted, &solved)?;
        let volumes = volumes(&properties, &starts, &solved);

        let mut known = look.clone();
        for property in &properties {
            let none = Field::constant(Vec3::ZERO);
            *(if *property == Property::Emission { &mut known.emission } else { &mut known.albedo }) = none;
        }
        let kind = match wanted {
            Wanted::Emission => Solved::Emission,
            Wanted::Albedo => Solved::Albedo,
            _ => Solved::Both,
        };
        let projector = studio.projector(kind, channels)?;
        let targets = self.targets(&projector, &known, |seen| studio.medium(&known, seen.light))?;
        let unknowns: Vec<_> = properties
            .iter()
            .zip(solved.into_iter().zip(&starts))
            .map(|(property, (solved, start))| property.unknown(flags, solved, start, channels))
            .collect();
        let mut solver = Solver::new(studio.gpu, studio.shaders, projector, targets, &unknowns)?;
        let descent = self.descend(wanted, &mut solver)?;

        let with = |solutions: &[Vec<f32>]| {
            let mut look = look.clone();
            for ((property, start), values) in properties.iter().zip(&starts).zip(solutions) {
                let found = Field { size: start.size, values: colours(values, channels) };
                *(if *property == Property::Emission { &mut look.emission } else { &mut look.albedo }) =
                    found;
            }
            look
        };
        let counts = vec![None; seen.len()];
        let (look, residuals) = self.choose(wanted, &descent, look, with, |look| self.squares(look))?;
        Ok(Left { look, residuals: only(residuals, channels), volumes, counts })
    }

    /// What is wanted of all views beyond the pictures of what is known. `medium`: of a view.
    fn targets(
        &self,
        projector: &Projector,
        known: &Look,
        medium: impl Fn(&Seen) -> Result<Arc<Medium>, InverseError>,
    ) -> Result<Vec<Target>, CommandError> {
        let Self { studio, seen, .. } = *self;
        let target = |(seen, picture): (&Seen, Picture)| {
            let shot = seen.shot();
            let [target, background, through, radiance] =
                [&seen.target, &seen.background, &picture.through, &picture.radiance]
                    .map(|colours| numbers(colours, studio.channels));
            Ok(Target {
                view: projector.view(studio.gpu, shot.slices, shot.depths)?,
                medium: medium(seen)?,
                wanted: radiance_targets(&target, &background, &through, &radiance)?,
                weights: seen.weights.clone(),
            })
        };
        seen.iter().zip(self.pictures(known)?).map(target).collect()
    }

    /// What is wrong in all pictures: weighed sums of squares by channel.
    fn squares(&self, look: &Look) -> Result<[f64; 3], InverseError> {
        let pictures = self.pictures(look)?;
        let wrong = self.seen.iter().zip(&pictures);
        let wrong = wrong
            .map(|(seen, picture)| squares(&picture.over(&seen.background), &seen.target, &seen.weights));
        Ok(wrong.fold([0.0; 3], |all, own| [0, 1, 2].map(|channel| all[channel] + own[channel])))
    }

    /// Extinction: each channel by itself, since each pixel counts otherwise in each.
    fn extinction(&self, look: &Look) -> Result<Left, CommandError> {
        let Self { studio, flags, seen, .. } = *self;
        let property = Property::Extinction;
        let start = look.extinction.resized(property.size(flags, studio.place, look.extinction.size));
        let solved = property.solved(flags, studio.place, start.size, &start, seen)?;
        parts::some(Wanted::Extinction, std::slice::from_ref(&solved))?;
        let count = Self::passes(Wanted::Extinction, studio.channels) as usize;
        let rows = (0..count).map(|channel| self.depths(channel)).collect::<Result<Vec<_>, _>>()?;
        let together = |rows: &mut dyn Iterator<Item = &LogTargets>| {
            rows.fold(LogCounts::default(), |all, row| all.and(row.counts))
        };
        let all = together(&mut rows.iter().flatten());
        if all.kept == 0 {
            return Err(SolveError::NoDepths(all).into());
        }
        let counts = (0..seen.len()).map(|view| Some(together(&mut rows.iter().map(|rows| &rows[view]))));
        let counts = counts.collect();

        let (mut found, mut residuals) = (Arc::new(start.clone()), vec![Vec::new(); count]);
        let nothing = Field::constant(Vec3::ZERO);
        for (channel, rows) in rows.iter().enumerate() {
            // Pictures that say nothing of a channel leave it as it is.
            if rows.iter().all(|row| row.weights.iter().all(|weight| *weight == 0.0)) {
                continue;
            }
            let projector = studio.projector(Solved::Extinction, Channels::One)?;
            let [extinction, scattered] = [(); 2].map(|()| nothing.texture(studio.gpu, Channels::One));
            let medium = Arc::new(Medium {
                extinction: extinction?,
                scattered: scattered?,
                index: studio.index.clone(),
            });
            let mut targets = Vec::with_capacity(seen.len());
            for (seen, row) in seen.iter().zip(rows) {
                targets.push(Target {
                    view: projector.view(studio.gpu, seen.shot().slices, seen.shot().depths)?,
                    medium: Arc::clone(&medium),
                    wanted: row.depths.clone(),
                    weights: row.weights.clone(),
                });
            }
            let grey = start.values.iter().map(|value| Vec3::splat(value[channel])).collect();
            let grey = Field { size: start.size, values: grey };
            let unknown = property.unknown(flags, solved.clone(), &grey, Channels::One);
            let mut solver = Solver::new(studio.gpu, studio.shaders, projector, targets, &[unknown])?;
            let descent = self.descend(Wanted::Extinction, &mut solver)?;
            let with = |solutions: &[Vec<f32>]| {
                let mut found = Field::clone(&found);
                let numbers = solutions.first().into_iter().flatten();
                for (value, number) in found.values.iter_mut().zip(numbers) {
                    match studio.channels {
                        Channels::One => *value = Vec3::splat(*number),
                        Channels::Rgb => value[channel] = *number,
                    }
                }
                Look { extinction: Arc::new(found), ..look.clone() }
            };
            let (look, own) = self.choose(Wanted::Extinction, &descent, look, with, |look| {
                let pictures = self.pictures(&self.shown(Wanted::Extinction, look))?;
                let wrong =
                    pictures.iter().zip(rows).map(|(picture, row)| depth_squares(picture, row, channel));
                Ok([wrong.sum(), 0.0, 0.0])
            })?;
            residuals[channel] = own.iter().map(|row| row[0]).collect();
            if !own.is_empty() {
                found = look.extinction;
            }
        }
        let volumes = volumes(&[property], std::slice::from_ref(&start), std::slice::from_ref(&solved));
        let longest = residuals.iter().map(Vec::len).max().unwrap_or(0);
        let at = |channel: usize, row: usize| {
            let own: &[f32] = residuals.get(channel).map_or(&[], Vec::as_slice);
            own.get(row).or(own.last()).copied().unwrap_or(0.0)
        };
        let residuals: Vec<_> = (0..longest).map(|row| [0, 1, 2].map(|channel| at(channel, row))).collect();
        let look =
            if residuals.is_empty() { look.clone() } else { Look { extinction: found, ..look.clone() } };
        Ok(Left { look, residuals, volumes, counts })
    }

    /// Optical depths of one channel of all views.
    fn depths(&self, channel: usize) -> Result<Vec<LogTargets>, InverseError> {
        let most = self.flags.most_depth.unwrap_or(MOST_DEPTH);
        let own = |colours: &[Vec3]| -> Vec<f32> { colours.iter().map(|colour| colour[channel]).collect() };
        let row = |seen: &Seen| {
            let (target, background) = (own(&seen.target), own(&seen.background));
            log_targets(&target, &background, &seen.weights, self.medium[channel], most)
        };
        self.seen.iter().map(row).collect()
    }

    fn descend(&self, wanted: Wanted, solver: &mut impl Iterated) -> Result<Descent, InverseError> {
        let iterations = self.flags.iterations;
        descend(self.studio.gpu, solver, iterations, self.cancel, |residuals| {
            let (first, last) = (residuals.first().map_or(0.0, sum), residuals.last().map_or(0.0, sum));
            let share = if first > 0.0 { 100.0 * last / first } else { 0.0 };
            self.bar.inc(1);
            let (name, count) = (wanted.name(), residuals.len());
            self.bar.set_message(format!("{name}: iteration {count} of {iterations}, residual {share:.3} %"));
        })
    }

    /// The volume after the last iteration, or, of one that was cut short and of light, the best one, for clamped coefficients of light may
    /// overshoot; and the residuals with that of what is kept. Without an iteration the volume stays as it was.
    fn choose(
        &self,
        wanted: Wanted,
        descent: &Descent,
        look: &Look,
        with: impl Fn(&[Vec<f32>]) -> Look,
        wrong: impl Fn(&Look) -> Result<[f64; 3], InverseError>,
    ) -> Result<(Look, Vec<[f32; 3]>), InverseError> {
        let Some((least, best)) = &descent.best else { return Ok((look.clone(), Vec::new())) };
        let last = with(&descent.last);
        let mut own = wrong(&last)?;
        let mut kept = last;
        if (self.cancel.asked() || wanted == Wanted::Light) && *least < own.iter().sum() {
            kept = with(best);
            own = wrong(&kept)?;
        }
        let mut residuals = descent.residuals.clone();
        residuals.push(own.map(|channel| channel as f32));
        Ok((kept, residuals))
    }
}

/// The same without any light.
fn in_the_dark(look: &Look) -> Look {
    let dark = Illumination::dark();
    Look { lights: vec![dark; look.lights.len()], ..look.clone() }
}

fn volumes(
    properties: &[Property],
    starts: &[Field],
    solved: &[Vec<bool>],
) -> Vec<(Property, [u32; 3], usize)> {
    let count = |solved: &Vec<bool>| solved.iter().filter(|solved| **solved).count();
    let all = properties.iter().zip(starts).zip(solved);
    all.map(|((property, start), solved)| (*property, start.size, count(solved))).collect()
}

/// Weighed sums of squares by channel.
fn squares(found: &[Vec3], wanted: &[Vec3], weights: &[f32]) -> [f64; 3] {
    found.iter().zip(wanted).zip(weights).fold([0.0; 3], |all, ((found, wanted), weight)| {
        let off = (found - wanted).as_dvec3();
        let own = f64::from(*weight) * off * off;
        [0, 1, 2].map(|channel| all[channel] + own[channel])
    })
}

/// The same of optical depths.
fn depth_squares(picture: &Picture, row: &LogTargets, channel: usize) -> f64 {
    let pixels = picture.through.iter().zip(&row.depths).zip(&row.weights);
    pixels
        .map(|((through, wanted), weight)| {
            let depth = -f64::from(through[channel]).max(1e-38).ln();
            f64::from(*weight) * (depth - f64::from(*wanted)).powi(2)
        })
        .sum()
}

/// With one channel the last residual is counted once, as the solver does.
fn only(mut residuals: Vec<[f32; 3]>, channels: Channels) -> Vec<[f32; 3]> {
    if channels == Channels::One {
        for row in &mut residuals {
            (row[1], row[2]) = (0.0, 0.0);
        }
    }
    residuals
}
