// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight gallery`: every picture from real data, with an index page.

mod album;
mod ambient;
mod epipole;
mod inverse;
mod lights;
mod methods;
mod page;
mod painterly;
mod plate;
mod plates;
mod splatting;
mod studio;
mod stylize;
mod transmittance;

use super::{CommandError, parse, progress};
use crate::formats::create_folder;
use crate::{Gpu, scenes};
use album::Section;
use std::path::PathBuf;
use studio::Studio;

/// Flags of the command.
#[derive(clap::Args)]
pub struct Options {
    /// Folder for the pictures and index.html.
    #[arg(long, value_name = "DIR", default_value = "gallery")]
    out: PathBuf,
    /// Only one system, or one picture of it: a scene or sheet, such as scattering/foliage or stylize/holes.
    #[arg(long, value_name = "SYSTEM[/PICTURE]")]
    only: Option<String>,
    /// Size of the pictures.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    size: [u32; 2],
}

/// What a section of the page shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Subject {
    /// A scene with all that is between it and its picture.
    Scene(&'static str),
    /// Every method on a scene.
    Methods(&'static str),
    /// The sun in the picture.
    Epipole,
    /// A scene for every kind of light.
    Lights,
    /// What an artist makes of light shafts.
    Stylize(&'static str),
    /// Media that shadow themselves.
    Transmittance(&'static str),
    /// Scans in brush strokes.
    Painterly(&'static str),
    /// Volumes and meshes in sheets of splats.
    Splatting(&'static str),
    /// Volumes and light from painted views.
    Inverse(&'static str),
    /// Surfaces under environment maps.
    Ambient(&'static str),
}

/// What is shown of light shafts where nothing is chosen.
const SCATTERING: [Subject; 10] = [
    Subject::Scene("foliage"),
    Subject::Scene("terrain"),
    Subject::Scene("torus"),
    Subject::Scene("plane"),
    Subject::Lights,
    Subject::Methods("foliage"),
    Subject::Methods("plane"),
    Subject::Methods("terrain"),
    Subject::Methods("torus"),
    Subject::Epipole,
];

/// What is shown where nothing is chosen.
fn all() -> Vec<Subject> {
    let scattering = SCATTERING.into_iter();
    let stylize = stylize::NAMES.map(Subject::Stylize);
    let transmittance = transmittance::NAMES.map(Subject::Transmittance);
    let painterly = painterly::NAMES.map(Subject::Painterly);
    let splatting = splatting::NAMES.map(Subject::Splatting);
    let inverse = inverse::NAMES.map(Subject::Inverse);
    let ambient = ambient::NAMES.map(Subject::Ambient);
    let before = scattering.chain(stylize).chain(transmittance);
    before.chain(painterly).chain(splatting).chain(inverse).chain(ambient).collect()
}

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    let chosen = choose(options.only.as_deref())?;
    create_folder(&options.out).map_err(|error| CommandError::Failure(format!("--out: {error}")))?;
    let gpu = pollster::block_on(Gpu::new())?;
    let studio = Studio::new(gpu, options.size, &options.out)?;
    let bar = progress::bar(chosen.len() as u64, quiet);
    let mut sections: Vec<Section> = Vec::new();
    for subject in chosen {
        bar.set_message(subject.folder());
        let section = match subject {
            Subject::Scene(name) => plate::section(&studio, &subject.folder(), name),
            Subject::Methods(name) => methods::section(&studio, &subject.folder(), name),
            Subject::Epipole => epipole::section(&studio, &subject.folder()),
            Subject::Lights => lights::section(&studio, &subject.folder()),
            Subject::Stylize(name) => stylize::section(&studio, &subject.folder(), name),
            Subject::Transmittance(name) => transmittance::section(&studio, &subject.folder(), name),
            Subject::Painterly(name) => painterly::section(&studio, &subject.folder(), name),
            Subject::Splatting(name) => splatting::section(&studio, &subject.folder(), name),
            Subject::Inverse(name) => inverse::section(&studio, &subject.folder(), name),
            Subject::Ambient(name) => ambient::section(&studio, &subject.folder(), name),
        };
        sections.push(section?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let index = options.out.join("index.html");
    page::write(&index, &studio.gpu.description(), options.size, &sections)?;
    if !quiet {
        println!("{}", index.display());
    }
    Ok(())
}

impl Subject {
    /// The system that it belongs to.
    fn system(self) -> &'static str {
        match self {
            Self::Stylize(_) => "stylize",
            Self::Transmittance(_) => "transmittance",
            Self::Painterly(_) => "painterly",
            Self::Splatting(_) => "splatting",
            Self::Inverse(_) => "inverse",
            Self::Ambient(_) => "ambient",
            _ => "scattering",
        }
    }

    /// Its name, as in `--only scattering/NAME`; sheets of several scenes share one.
    fn name(self) -> &'static str {
        match self {
            Self::Scene(name)
            | Self::Stylize(name)
            | Self::Transmittance(name)
            | Self::Painterly(name)
            | Self::Splatting(name)
            | Self::Inverse(name)
            | Self::Ambient(name) => name,
            Self::Methods(_) => "methods",
            Self::Epipole => "epipole",
            Self::Lights => "lights",
        }
    }

    /// As it is asked for.
    fn path(self) -> String {
        format!("{}/{}", self.system(), self.name())
    }

    /// Where its pictures go.
    fn folder(self) -> String {
        match self {
            Self::Methods(scene) => format!("scattering/methods/{scene}"),
            _ => self.path(),
        }
    }
}

fn choose(only: Option<&str>) -> Result<Vec<Subject>, CommandError> {
    let mut subjects = all();
    let Some(only) = only else { return Ok(subjects) };
    let system: Vec<Subject> = subjects.iter().copied().filter(|subject| subject.system() == only).collect();
    if !system.is_empty() {
        return Ok(system);
    }
    // Scenes that only a sheet shows can be asked for as well.
    let scenes = scenes::SCENES.map(Subject::Scene);
    subjects.extend(scenes.iter().filter(|scene| !SCATTERING.contains(scene)));
    let named = |subject: &Subject| subject.path() == only || subject.folder() == only;
    let found: Vec<Subject> = subjects.iter().copied().filter(named).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let mut known: Vec<String> = subjects.into_iter().map(Subject::path).collect();
    known.dedup();
    let known = known.join(", ");
    let systems = "scattering, stylize, transmittance, painterly, splatting, inverse, ambient";
    let reason = format!("there is no `{only}`; there is {systems}, {known}");
    Err(CommandError::misuse("--only", reason))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn everything_on_the_page_can_be_chosen_alone() {
        assert_eq!(choose(None).unwrap(), all());
        let stylize = choose(Some("stylize")).unwrap();
        assert_eq!(choose(Some("scattering")).unwrap(), SCATTERING);
        assert_eq!(stylize.len(), stylize::NAMES.len());
        let transmittance = choose(Some("transmittance")).unwrap();
        assert_eq!(transmittance.len(), transmittance::NAMES.len());
        let painterly = choose(Some("painterly")).unwrap();
        assert_eq!(painterly.len(), painterly::NAMES.len());
        let splatting = choose(Some("splatting")).unwrap();
        assert_eq!(splatting.len(), splatting::NAMES.len());
        let inverse = choose(Some("inverse")).unwrap();
        assert_eq!(inverse.len(), inverse::NAMES.len());
        let ambient = choose(Some("ambient")).unwrap();
        assert_eq!(ambient.len(), ambient::NAMES.len());
        assert_eq!(
            [&SCATTERING[..], &stylize, &transmittance, &painterly, &splatting, &inverse, &ambient].concat(),
            all()
        );
        for subject in all() {
            assert!(choose(Some(&subject.path())).unwrap().contains(&subject));
            assert_eq!(choose(Some(&subject.folder())).unwrap(), [subject]);
        }
        assert_eq!(choose(Some("scattering/methods")).unwrap().len(), 4);
        assert_eq!(choose(Some("scattering/spot")).unwrap(), [Subject::Scene("spot")]);
        assert_eq!(choose(Some("stylize/halo")).unwrap(), [Subject::Stylize("halo")]);
        assert_eq!(choose(Some("transmittance/plume")).unwrap(), [Subject::Transmittance("plume")]);
        assert_eq!(choose(Some("painterly/stent")).unwrap(), [Subject::Painterly("stent")]);
        assert_eq!(choose(Some("inverse/logos")).unwrap(), [Subject::Inverse("logos")]);
        assert_eq!(choose(Some("ambient/room")).unwrap(), [Subject::Ambient("room")]);
        assert_eq!(choose(Some("scattering/halo")).unwrap(), [Subject::Scene("halo")]);
    }

    #[test]
    fn what_is_not_there_is_refused_with_what_is() {
        for wrong in [
            "vendoring",
            "scattering/nothing",
            "stylize/lights",
            "transmittance/halo",
            "painterly/a",
            "foliage",
        ] {
            let error = choose(Some(wrong)).unwrap_err().to_string();
            assert!(error.contains("scattering/lights") && error.contains("stylize/halo"), "{error}");
            assert_eq!(error.matches("scattering/methods").count(), 1, "{error}");
        }
    }
}
