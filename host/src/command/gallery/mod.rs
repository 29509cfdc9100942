// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight gallery`: every picture from real data, with an index page.

mod album;
mod epipole;
mod lights;
mod methods;
mod page;
mod plate;
mod plates;
mod studio;

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
    /// Only one system, or one picture of it: a scene or sheet, such as scattering/foliage or scattering/lights.
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
}

/// What is shown where nothing is chosen.
const ALL: [Subject; 10] = [
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
    /// Its name, as in `--only scattering/NAME`; sheets of several scenes share one.
    fn name(self) -> &'static str {
        match self {
            Self::Scene(name) => name,
            Self::Methods(_) => "methods",
            Self::Epipole => "epipole",
            Self::Lights => "lights",
        }
    }

    /// Where its pictures go.
    fn folder(self) -> String {
        match self {
            Self::Methods(scene) => format!("scattering/methods/{scene}"),
            _ => format!("scattering/{}", self.name()),
        }
    }
}

fn choose(only: Option<&str>) -> Result<Vec<Subject>, CommandError> {
    let Some(only) = only else { return Ok(ALL.to_vec()) };
    let (system, picture) =
        only.split_once('/').map_or((only, None), |(system, picture)| (system, Some(picture)));
    // Scenes that only a sheet shows can be asked for as well.
    let scenes = scenes::SCENES.map(Subject::Scene);
    let mut subjects = ALL.to_vec();
    subjects.extend(scenes.iter().filter(|scene| !ALL.contains(scene)));
    if system == "scattering" {
        let Some(picture) = picture else { return Ok(ALL.to_vec()) };
        let path = format!("scattering/{picture}");
        let named = |subject: &Subject| subject.name() == picture || subject.folder() == path;
        let found: Vec<Subject> = subjects.iter().copied().filter(named).collect();
        if !found.is_empty() {
            return Ok(found);
        }
    }
    let mut known: Vec<String> =
        subjects.iter().map(|subject| format!("scattering/{}", subject.name())).collect();
    known.dedup();
    let known = known.join(", ");
    Err(CommandError::misuse("--only", format!("there is no `{only}`; there is scattering, {known}")))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn everything_on_the_page_can_be_chosen_alone() {
        assert_eq!(choose(None).unwrap(), ALL);
        assert_eq!(choose(Some("scattering")).unwrap(), ALL);
        for subject in ALL {
            assert!(choose(Some(&format!("scattering/{}", subject.name()))).unwrap().contains(&subject));
            assert_eq!(choose(Some(&subject.folder())).unwrap(), [subject]);
        }
        assert_eq!(choose(Some("scattering/methods")).unwrap().len(), 4);
        assert_eq!(choose(Some("scattering/spot")).unwrap(), [Subject::Scene("spot")]);
    }

    #[test]
    fn what_is_not_there_is_refused_with_what_is() {
        for wrong in ["ambient", "scattering/nothing", "foliage", ""] {
            let error = choose(Some(wrong)).unwrap_err().to_string();
            assert!(error.contains("scattering/lights"), "{error}");
            assert_eq!(error.matches("scattering/methods").count(), 1, "{error}");
        }
    }
}
