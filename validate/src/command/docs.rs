// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate docs`.

use super::{Stop, in_folder, library, write_whole};
use airlight_validate::{
    docs::{self, Pictures},
    files_below,
};
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Where, in the book's folder, it says which picture shows what.
const PICTURES: &str = "pictures/modules.txt";

pub(crate) fn run(dir: &Path, out: &Path, check: bool) -> Result<ExitCode, Stop> {
    if !out.is_dir() {
        let out = out.display();
        return Err(Stop::Misuse(format!(
            "--out {out} is no folder; give that of the book's chapters, `docs/src`"
        )));
    }
    let library = library(Some(dir)).map_err(Stop::from)?;
    let unsaid = docs::unsaid(&library);
    if !unsaid.is_empty() {
        return Err(Stop::Failure(format!("modules leave something unsaid:\n{}", unsaid.join("\n"))));
    }
    let pictures = out.join(PICTURES);
    let listed = match fs::read_to_string(&pictures) {
        Ok(text) => Pictures::parse(&text).map_err(|error| failure(&pictures, &error))?,
        Err(_) => Pictures::default(),
    };
    for (name, file) in listed.entries() {
        if !out.join("pictures").join(file).is_file() {
            return Err(failure(
                &pictures,
                &format!("`{name}` has the picture {file}, which does not exist"),
            ));
        }
    }
    let mut pages = docs::pages(&library, &listed).map_err(|error| Stop::Failure(in_folder(dir, &error)))?;
    let contents = out.join("SUMMARY.md");
    if let Ok(text) = fs::read_to_string(&contents) {
        let text = docs::summary(&library, &text).map_err(|error| failure(&contents, &error))?;
        pages.insert("SUMMARY.md".to_owned(), text);
    }
    let needless = needless(out, &pages)?;
    if check {
        let stale = pages
            .iter()
            .filter(|(page, text)| fs::read_to_string(out.join(page)).ok().as_ref() != Some(text));
        let stale: Vec<String> = stale.map(|(page, _)| page.clone()).collect();
        let needless = needless.iter().map(|page| page.display().to_string());
        let wrong: Vec<String> = stale.into_iter().chain(needless).collect();
        if wrong.is_empty() {
            return Ok(ExitCode::SUCCESS);
        }
        return Err(Stop::Failure(format!(
            "stale pages in {}: {}; run `airlight-validate docs {} --out {0}`",
            out.display(),
            wrong.join(", "),
            dir.display()
        )));
    }
    for (page, text) in &pages {
        let file = out.join(page);
        let folder = file.parent().unwrap_or(out);
        fs::create_dir_all(folder)
            .and_then(|()| write_whole(&file, text))
            .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", file.display())))?;
    }
    for page in needless {
        fs::remove_file(&page)
            .map_err(|error| Stop::Failure(format!("cannot remove {}: {error}", page.display())))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn failure(file: &Path, message: &str) -> Stop {
    Stop::Failure(format!("{}: {message}", file.display()))
}

/// Pages of modules and passes that are no longer there.
fn needless(out: &Path, pages: &BTreeMap<String, String>) -> Result<Vec<PathBuf>, Stop> {
    let folder = out.join("modules");
    let there = files_below(&folder, "md")
        .map_err(|error| Stop::Failure(format!("cannot read {}: {error}", folder.display())))?;
    let needless = there.iter().filter(|page| !pages.contains_key(&format!("modules/{page}")));
    Ok(needless.map(|page| folder.join(page)).collect())
}
