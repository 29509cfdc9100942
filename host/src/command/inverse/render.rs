// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight inverse render`: pictures to paint on.

use super::conflicts::check_medium;
use super::fits::Needs;
use super::keys::{Key, matters};
use super::light::Lights;
use super::options::RenderOptions;
use super::places::check_names;
use super::refraction::Refraction;
use super::studio::{Look, Seen, Setting, Shot, Studio};
use super::views::{read_views, write_views};
use super::volumes::Matter;
use crate::command::staging::Staging;
use crate::command::{CommandError, progress};
use crate::inverse::{Basis, Channels};
use crate::{Gpu, Shaders};
use glam::Vec3;
use std::path::PathBuf;

/// Runs the command.
pub fn run(options: &RenderOptions, quiet: bool) -> Result<(), CommandError> {
    let flags = &options.medium;
    check_medium(flags)?;
    let views = read_views(&flags.views)?;
    let mut names: Vec<PathBuf> = vec!["views.toml".into()];
    names.extend(
        views.list.iter().flat_map(|view| ["png", "exr"].map(|end| format!("{}.{end}", view.name).into())),
    );
    check_names(flags, &views, &names)?;
    let staging = Staging::new(&flags.out, names)?;
    let bar = progress::bar(3, quiet);
    bar.set_message("reading the volume");
    let channels = Channels::Rgb;
    let keys = Key::of_volumes(flags, &views);
    let matters = matters(flags, &keys, channels)?;
    let matter = &matters[0];
    let steps = steps(flags.steps, matter.extinction.size);
    let refraction = Refraction::new(flags, matter)?;
    let lights = Lights::new(&flags.light, &views.list, &matter.bounds())?;
    let seen = views.list.iter().zip(&lights.of_views);
    let seen = seen.map(|(view, light)| Seen::new(view, matter, steps, channels, *light));
    let seen = seen.collect::<Result<Vec<_>, _>>()?;
    bar.inc(1);

    bar.set_message("rendering");
    let gpu = pollster::block_on(Gpu::new())?;
    let known = known(matter, refraction.as_ref());
    let sizes: Vec<(&str, [u32; 2])> =
        seen.iter().map(|seen| (seen.name(), seen.loaded.description.size)).collect();
    Needs { channels, known: &known, unknown: &[], views: &sizes, steps: false }.check(&gpu.limits)?;
    let shaders = Shaders::builtin();
    let setting = Setting {
        place: matter.place,
        steps,
        refraction: refraction.as_ref(),
        light_resolution: flags.light.light_resolution,
    };
    let studio = Studio::new((&gpu, &shaders), (channels, Basis::Triangle), &setting)?;
    let mut pictures = Vec::with_capacity(seen.len());
    for (key, matter) in keys.iter().zip(&matters) {
        let own = seen.iter().skip(pictures.len()).take(key.views.len());
        let shots: Vec<Shot<'_>> = own.map(Seen::shot).collect();
        pictures.extend(studio.pictures(&Look::of(matter, &lights), &shots)?);
    }
    bar.inc(1);

    bar.set_message("writing");
    let composed: Vec<Vec<Vec3>> =
        seen.iter().zip(&pictures).map(|(seen, picture)| picture.over(&seen.background)).collect();
    let written: Vec<_> = views.list.iter().zip(composed.iter().map(Vec::as_slice)).collect();
    let written = write_views(staging.path(""), &written, &views.keys)?;
    staging.publish()?;
    bar.finish_and_clear();
    for (view, written) in views.list.iter().zip(&written).filter(|(_, written)| written.clipped > 0) {
        eprintln!(
            "airlight: warning: view `{}`: {} pixels are brighter than {}.png holds: let `target` name the .exr, or give less light",
            view.name, written.clipped, view.name
        );
    }
    if !quiet {
        matters.iter().flat_map(|matter| &matter.report).for_each(|line| println!("{line}"));
        println!("views: {}", views.list.len());
        println!("{}", flags.out.join("views.toml").display());
    }
    Ok(())
}

/// Steps of rays where none are asked for: as many as voxels along the longest side.
pub fn steps(asked: Option<u32>, size: [u32; 3]) -> u32 {
    asked.unwrap_or_else(|| size.into_iter().max().unwrap_or(1).min(2048))
}

/// What of a volume has to fit.
pub fn known(
    matter: &Matter,
    refraction: Option<&Refraction>,
) -> Vec<(&'static str, &'static str, [u32; 3])> {
    let mut known = vec![
        ("--volume", "extinction", matter.extinction.size),
        ("--emission", "emission", matter.emission.size),
        ("--albedo", "albedo", matter.albedo.size),
    ];
    known.extend(refraction.map(|own| ("--refraction", "index of refraction", own.index.size)));
    known
}
