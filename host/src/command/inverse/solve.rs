// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight inverse solve`: the volume, or the light, that looks as its views were painted.

use super::between::between;
use super::cancel::Cancel;
use super::conflicts::{check, check_views};
use super::error::SolveError;
use super::field::reduced;
use super::fits::Needs;
use super::light::Lights;
use super::options::{SolveOptions, Wanted};
use super::parts::Property;
use super::places::check_names;
use super::refraction::Refraction;
use super::render::{known, steps};
use super::report::StageReport;
use super::stage::Stages;
use super::studio::{Look, Seen, Setting, Shot, Studio};
use super::views::{ViewDescription, read_views};
use super::volumes::Matter;
use crate::command::staging::Staging;
use crate::command::{CommandError, progress};
use crate::data::srgb_from_linear;
use crate::formats::{WriteError, write_exr, write_png, write_whole};
use crate::inverse::{Basis, Channels};
use crate::{Gpu, Shaders};
use glam::{Mat4, Vec3};
use serde_json::json;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// The map of light that was solved for.
const ENVIRONMENT: &str = "environment.exr";

/// Runs the command.
pub fn run(options: &SolveOptions, quiet: bool) -> Result<(), CommandError> {
    let begun = Instant::now();
    check(options)?;
    let flags = &options.medium;
    let views = read_views(&flags.views)?;
    if options.hull && views.iter().all(|view| view.mask.is_none()) {
        return Err(SolveError::NoMasks(flags.views.clone()).into());
    }
    check_views(options, &views)?;
    let names = names(options, &views);
    check_names(flags, &views, &names)?;
    // Said now, and not after an hour.
    drop(Staging::new(&flags.out, names.clone())?);
    let cancel = Cancel::listening()?;
    let channels = Channels::from(options.channels);
    let passes = options.wanted.iter().map(|wanted| Stages::passes(*wanted, channels)).sum::<u32>();
    let bar = progress::bar(2 + u64::from(passes) * u64::from(options.iterations), quiet);
    bar.set_message("reading the volume and the views");
    let matter = Matter::new(flags, channels)?;
    let steps = steps(flags.steps, matter.extinction.size);
    let refraction = Refraction::new(flags, &matter)?;
    let lights = Lights::new(&flags.light, &views, &matter.bounds())?;
    let seen = views.iter().zip(&lights.of_views);
    let seen = seen.map(|(view, light)| Seen::new(view, &matter, steps, channels, *light));
    let seen = seen.collect::<Result<Vec<_>, _>>()?;
    for seen in &seen {
        seen.loaded.required_target()?;
    }
    bar.inc(1);

    let gpu = pollster::block_on(Gpu::new())?;
    fits(options, &gpu, &known(&matter, refraction.as_ref()), matter.place, &seen)?;
    let basis = Basis::from(options.basis);
    let (shaders, place) = (Shaders::builtin(), matter.place);
    let setting = Setting {
        place,
        steps,
        refraction: refraction.as_ref(),
        light_resolution: flags.light.light_resolution,
    };
    let studio = Studio::new((&gpu, &shaders), (channels, basis), &setting)?;
    let mut look = Look {
        extinction: Arc::new(matter.extinction),
        emission: matter.emission,
        albedo: matter.albedo,
        lights: lights.all,
    };
    let medium = reduced(options.medium_radiance.unwrap_or(Vec3::ZERO), channels);
    let stages = Stages { studio: &studio, flags: options, seen: &seen, medium, cancel: &cancel, bar: &bar };
    let mut done: Vec<(Wanted, StageReport)> = Vec::new();
    for wanted in options.wanted.iter().copied().take_while(|_| !cancel.asked()) {
        bar.set_message(format!("{}: preparing", wanted.name()));
        let report = stages.run(wanted, &mut look)?;
        // Memory that ran out is said here.
        gpu.check()?;
        if report.iterations > 0 {
            done.push((wanted, report));
        }
    }
    let Some((last, _)) = done.last() else { return Err(SolveError::Interrupted.into()) };

    bar.set_message("writing");
    let shown = stages.shown(*last, &look);
    let staging = Staging::new(&flags.out, names)?;
    let said = |error: WriteError| CommandError::failure(format!("--out: {error}"));
    let mut files: Vec<String> = Vec::new();
    for (property, field) in [
        (Property::Extinction, look.extinction.as_ref()),
        (Property::Emission, &look.emission),
        (Property::Albedo, &look.albedo),
    ] {
        if done.iter().any(|(wanted, _)| Property::of(*wanted).contains(&property)) {
            field.write(&staging.path(""), property.name(), place, channels)?;
            files.extend(["nii.gz", "npy"].map(|ending| format!("{}.{ending}", property.name())));
        }
    }
    if let Some(discs) = look.found() {
        let map = discs.environment().map_err(CommandError::failure)?;
        let values: Vec<f32> = map.texels().iter().flat_map(|texel| texel.to_array()).collect();
        write_exr(staging.path(ENVIRONMENT), map.size()[0], map.size()[1], &values).map_err(said)?;
        files.push(ENVIRONMENT.to_owned());
    }
    for (seen, picture) in seen.iter().zip(stages.pictures(&shown)?) {
        let name = format!("solved_{}", seen.name());
        let composed = picture.over(&seen.background);
        let [width, height] = seen.loaded.description.size;
        write_png(staging.path(format!("{name}.png")), width, height, &bytes(&composed)).map_err(said)?;
        let values: Vec<f32> = composed.iter().flat_map(|colour| colour.to_array()).collect();
        write_exr(staging.path(format!("{name}.exr")), width, height, &values).map_err(said)?;
    }
    write_between(&studio, &shown, &seen, &staging)?;
    let report = json!({
        "volume": flags.volume.display().to_string(),
        "voxels": look.extinction.size,
        "channels": if channels == Channels::One { "one" } else { "rgb" },
        "basis": if basis == Basis::Box { "box" } else { "triangle" },
        "steps": steps,
        "laplacian": options.laplacian,
        "smallness": options.smallness,
        "oneness": options.oneness,
        "cancelled": cancel.asked(),
        "stages": done.iter().map(|(_, report)| report.json()).collect::<Vec<_>>(),
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
        matter.report.iter().for_each(|line| println!("{line}"));
        done.iter().flat_map(|(_, report)| report.lines()).for_each(|line| println!("{line}"));
        println!("{}", flags.out.join("report.json").display());
    }
    Ok(())
}

/// Files that may be written.
fn names(options: &SolveOptions, views: &[ViewDescription]) -> Vec<PathBuf> {
    let mut names = vec!["report.json".to_owned()];
    for property in options.wanted.iter().flat_map(|wanted| Property::of(*wanted)) {
        names.extend(["nii.gz", "npy"].map(|ending| format!("{}.{ending}", property.name())));
    }
    names.extend(options.any(|wanted| wanted == Wanted::Light).then(|| ENVIRONMENT.to_owned()));
    names.extend(
        views.iter().flat_map(|view| ["png", "exr"].map(|ending| format!("solved_{}.{ending}", view.name))),
    );
    names.extend(views.windows(2).map(|pair| between_name(&pair[0], &pair[1])));
    names.into_iter().map(PathBuf::from).collect()
}

fn between_name(first: &ViewDescription, second: &ViewDescription) -> String {
    format!("between_{}_{}.png", first.name, second.name)
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

/// Pictures between successive views, in the light of the first and before the mean of what lies behind both.
fn write_between(
    studio: &Studio<'_>,
    shown: &Look,
    seen: &[Seen],
    staging: &Staging,
) -> Result<(), CommandError> {
    let mut cameras = Vec::new();
    for pair in seen.windows(2) {
        if let Some(camera) = between(&pair[0].loaded.description, &pair[1].loaded.description) {
            cameras.push((studio.rays(&camera, shown)?, pair));
        }
    }
    let shots: Vec<Shot<'_>> =
        cameras.iter().map(|(slices, pair)| Shot { slices, depths: None, light: pair[0].light }).collect();
    let mean = |seen: &Seen| seen.background.iter().sum::<Vec3>() / seen.background.len().max(1) as f32;
    for (picture, (_, pair)) in studio.pictures(shown, &shots)?.iter().zip(&cameras) {
        let [one, other] = [&pair[0].loaded.description, &pair[1].loaded.description];
        let behind = vec![mean(&pair[0]).midpoint(mean(&pair[1])); picture.radiance.len()];
        let [width, height] = one.size;
        let path = staging.path(between_name(one, other));
        write_png(path, width, height, &bytes(&picture.over(&behind)))
            .map_err(|error| CommandError::failure(format!("--out: {error}")))?;
    }
    Ok(())
}

/// As a .png has it: sRGB, clipped.
fn bytes(colours: &[Vec3]) -> Vec<u8> {
    let encode = |value: f32| (255.0 * srgb_from_linear(value.max(0.0)) + 0.5) as u8;
    colours.iter().flat_map(|colour| colour.to_array().map(encode)).collect()
}
