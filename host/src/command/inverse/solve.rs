// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight inverse solve`: the volume, or the light, that looks as its views were painted.

use super::cancel::Cancel;
use super::conflicts::{check, check_views};
use super::error::SolveError;
use super::field::reduced;
use super::fits::Needs;
use super::keys::{Key, matters};
use super::light::Lights;
use super::options::{SolveOptions, Wanted};
use super::parts::Property;
use super::places::check_names;
use super::refraction::Refraction;
use super::render::{known, steps};
use super::report::StageReport;
use super::stage::Stages;
use super::studio::{Look, Seen, Setting, Studio};
use super::views::{Views, read_views};
use super::written::{
    Frames, frame_names, said, view_names, volume_names, write_radiance, write_views, write_volume,
};
use crate::command::staging::Staging;
use crate::command::{CommandError, progress};
use crate::formats::write_whole;
use crate::inverse::{Basis, Channels};
use crate::{Gpu, Shaders};
use glam::{Mat4, Vec3};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// The map of light that was solved for.
const ENVIRONMENT: &str = "environment.exr";

/// Runs the command.
pub fn run(options: &SolveOptions, quiet: bool) -> Result<(), CommandError> {
    let begun = Instant::now();
    check(options)?;
    let flags = &options.medium;
    let views = read_views(&flags.views)?;
    if options.hull && views.list.iter().all(|view| view.mask.is_none()) {
        return Err(SolveError::NoMasks(flags.views.clone()).into());
    }
    check_views(options, &views.list)?;
    let keys = Key::of_solve(options, &views)?;
    let properties = properties(options, &views);
    let names: Vec<PathBuf> = names(options, &keys, &properties).into_iter().map(PathBuf::from).collect();
    check_names(flags, &views, &names)?;
    // Said now, and not after an hour.
    drop(Staging::new(&flags.out, names.clone())?);
    let cancel = Cancel::listening()?;
    let channels = Channels::from(options.channels);
    let passes = options.wanted.iter().map(|wanted| Stages::passes(*wanted, channels)).sum::<u32>();
    let iterations = keys.len() as u64 * u64::from(passes) * u64::from(options.iterations);
    let shown_frames = options.frames.map_or(0, |frames| u64::from(frames.count));
    let bar = progress::bar(2 + iterations + shown_frames, quiet);
    bar.set_message("reading the volume and the views");
    let matters = matters(flags, &keys, channels)?;
    let matter = &matters[0];
    let steps = steps(flags.steps, matter.extinction.size);
    let refraction = Refraction::new(flags, matter)?;
    let lights = Lights::new(&flags.light, &views.list, &matter.bounds())?;
    let seen = views.list.iter().zip(&lights.of_views);
    let seen = seen.map(|(view, light)| Seen::new(view, matter, steps, channels, *light));
    let seen = seen.collect::<Result<Vec<_>, _>>()?;
    for seen in &seen {
        seen.loaded.required_target()?;
    }
    bar.inc(1);

    let gpu = pollster::block_on(Gpu::new())?;
    fits(options, &gpu, &known(matter, refraction.as_ref()), matter.place, &seen)?;
    let basis = Basis::from(options.basis);
    let shaders = Shaders::builtin();
    let setting = Setting {
        place: matter.place,
        steps,
        refraction: refraction.as_ref(),
        light_resolution: flags.light.light_resolution,
    };
    let studio = Studio::new((&gpu, &shaders), (channels, basis), &setting)?;
    let medium = reduced(options.medium_radiance.unwrap_or(Vec3::ZERO), channels);
    let (mut rest, mut stages) = (seen.as_slice(), Vec::with_capacity(keys.len()));
    for key in &keys {
        let (own, others) = rest.split_at(key.views.len());
        rest = others;
        stages.push(Stages {
            studio: &studio,
            flags: options,
            seen: own,
            medium,
            cancel: &cancel,
            bar: &bar,
        });
    }
    let (mut looks, mut done) = (Vec::with_capacity(keys.len()), Vec::new());
    for ((key, stages), matter) in keys.iter().zip(&stages).zip(&matters) {
        let mut look = Look::of(matter, &lights);
        for wanted in options.wanted.iter().copied().take_while(|_| !cancel.asked()) {
            let at = key.time.map_or(String::new(), |time| format!(" at time {time}"));
            bar.set_message(format!("{}{at}: preparing", wanted.name()));
            let report = stages.run(wanted, &mut look)?;
            // Memory that ran out is said here.
            gpu.check()?;
            if report.iterations > 0 {
                done.push(Done { time: key.time, wanted, report });
            }
        }
        looks.push(look);
    }
    let Some(last) = done.last().map(|done| done.wanted) else { return Err(SolveError::Interrupted.into()) };

    bar.set_message("writing");
    let staging = Staging::new(&flags.out, names)?;
    let mut files: Vec<String> = Vec::new();
    if let Some(range) = options.frames {
        let times: Vec<f32> = keys.iter().filter_map(|key| key.time).collect();
        let chosen = options.seen_from.as_deref().unwrap_or(seen[0].name());
        let seen = seen.iter().find(|seen| seen.name() == chosen).unwrap_or(&seen[0]);
        let frames = Frames { range, times: &times, looks: &looks, properties: &properties, seen };
        frames.write(&stages[0], last, options, &staging, &bar)?;
        files.extend(frame_names(range, &properties));
    } else {
        let solved =
            |property: &&Property| done.iter().any(|done| Property::of(done.wanted).contains(property));
        for property in properties.iter().filter(solved) {
            write_volume(&stages[0], &looks[0], *property, property.name(), &staging)?;
            files.extend(volume_names(*property));
        }
    }
    if let Some(discs) = looks[0].found() {
        let map = discs.environment().map_err(CommandError::failure)?;
        write_radiance(&staging.path(ENVIRONMENT), map.size(), map.texels())?;
        files.push(ENVIRONMENT.to_owned());
    }
    for (stages, look) in stages.iter().zip(&looks) {
        write_views(stages, &stages.shown(last, look), &staging)?;
    }
    let report = json!({
        "volume": flags.volume.display().to_string(),
        "voxels": looks[0].extinction.size,
        "channels": if channels == Channels::One { "one" } else { "rgb" },
        "basis": if basis == Basis::Box { "box" } else { "triangle" },
        "steps": steps,
        "laplacian": options.laplacian,
        "smallness": options.smallness,
        "oneness": options.oneness,
        "cancelled": cancel.asked(),
        "stages": done.iter().map(Done::json).collect::<Vec<_>>(),
        "files": files,
        "adapter": gpu.description(),
        "seconds": begun.elapsed().as_secs_f64(),
    });
    let text = serde_json::to_string_pretty(&report).map_err(CommandError::failure)?;
    write_whole(staging.path("report.json"), |writer| writeln!(writer, "{text}")).map_err(said)?;
    staging.publish()?;
    bar.finish_and_clear();
    if cancel.asked() {
        eprintln!("airlight: warning: interrupted: the best of what was found so far is written");
    }
    if !quiet {
        matters.iter().flat_map(|matter| &matter.report).for_each(|line| println!("{line}"));
        done.iter().flat_map(Done::lines).for_each(|line| println!("{line}"));
        println!("{}", flags.out.join("report.json").display());
    }
    Ok(())
}

/// A stage that was done.
struct Done {
    /// Of its key frame.
    time: Option<f32>,
    wanted: Wanted,
    report: StageReport,
}

impl Done {
    fn json(&self) -> serde_json::Value {
        let mut report = self.report.json();
        if let Some(time) = self.time {
            report["time"] = time.into();
        }
        report
    }

    fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.time.map(|time| format!("time {time}")).into_iter().collect();
        lines.extend(self.report.lines());
        lines
    }
}

/// What is written: all that is solved for, and what changes from one key frame to another.
fn properties(options: &SolveOptions, views: &Views) -> Vec<Property> {
    let all = [Property::Extinction, Property::Emission, Property::Albedo];
    let changes = |property: &Property| *property == Property::Extinction && !views.keys.is_empty();
    let solved = |property: &Property| options.any(|wanted| Property::of(wanted).contains(property));
    all.into_iter().filter(|property| solved(property) || changes(property)).collect()
}

/// Files that may be written.
fn names(options: &SolveOptions, keys: &[Key<'_>], properties: &[Property]) -> Vec<String> {
    let mut names = vec!["report.json".to_owned()];
    match options.frames {
        Some(frames) => names.extend(frame_names(frames, properties)),
        None => names.extend(properties.iter().flat_map(|property| volume_names(*property))),
    }
    names.extend(options.any(|wanted| wanted == Wanted::Light).then(|| ENVIRONMENT.to_owned()));
    names.extend(keys.iter().flat_map(|key| view_names(key.views)));
    names
}

/// `known`: volumes that are read, the extinction first.
fn fits(
    options: &SolveOptions,
    gpu: &Gpu,
    known: &[(&'static str, &'static str, [u32; 3])],
    place: Mat4,
    seen: &[Seen],
) -> Result<(), SolveError> {
    let volume = known.first().map_or([1; 3], |(_, _, size)| *size);
    let properties = options.wanted.iter().flat_map(|wanted| Property::of(*wanted));
    let unknown: Vec<_> = properties.map(|property| property.size(options, place, volume)).collect();
    let views: Vec<_> = seen.iter().map(|seen| (seen.name(), seen.loaded.description.size)).collect();
    let straight = options.medium.refraction.is_none();
    let needs = Needs {
        channels: options.channels.into(),
        known,
        unknown: &unknown,
        views: &views,
        steps: straight && options.any(|wanted| wanted != Wanted::Extinction),
    };
    needs.check(&gpu.limits)
}
