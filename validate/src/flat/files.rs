// SPDX-License-Identifier: MIT OR Apache-2.0
//! The folder of flat files: `<system>/<pass>.wgsl` for the permutation `default` of each pass, and
//! `<system>/<pass>.<permutation>.wgsl` for the others.

use super::text;
use crate::{Error, Library, files_below, threads};
use std::{collections::BTreeMap, fmt::Write as _, fs, io, path::Path};

/// Every permutation of every pass: the file, relative to the folder, and its text.
///
/// # Errors
/// The first pass that does not compose.
pub fn render(library: &Library) -> Result<BTreeMap<String, String>, Error> {
    let mut subjects = Vec::new();
    for pass in library.passes() {
        for permutation in library.permutations(&pass.name)? {
            subjects.push((pass.name.as_str(), permutation.name.as_str()));
        }
    }
    let texts = threads::each(&subjects, |(pass, permutation)| text(library, pass, permutation));
    let files = subjects.iter().map(|(pass, permutation)| name(pass, permutation));
    files.zip(texts).map(|(file, text)| Ok((file, text?))).collect()
}

/// The file of a permutation.
pub(crate) fn name(pass: &str, permutation: &str) -> String {
    match permutation {
        "default" => format!("{pass}.wgsl"),
        _ => format!("{pass}.{permutation}.wgsl"),
    }
}

/// The list of flat files that the crate `airlight-wgsl` includes.
pub fn list(library: &Library) -> String {
    let mut text = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense\n\
        //! Every permutation of every pass as stand-alone WGSL. Written by `airlight-validate flatten`.\n\n\
        crate::flat! {\n"
        .to_owned();
    for (pass, permutations) in &library.permutations {
        let others = permutations.iter().map(|permutation| &permutation.name);
        let others: Vec<String> =
            others.filter(|name| *name != "default").map(|name| format!("\"{name}\"")).collect();
        let _ = writeln!(text, "    \"{pass}\" [{}],", others.join(", "));
    }
    text.push_str("}\n");
    text
}

/// What the folder has to be made to hold, or is to be compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Files are written and superfluous ones removed.
    Written,
    /// Nothing is written.
    Compared,
}

/// Makes the `.wgsl` files of a folder those of `files`, or says what differs first.
///
/// # Errors
/// A file that cannot be read, written or removed; with [`Kept::Compared`], the first that is missing, stale or
/// superfluous.
pub fn sync(
    folder: &Path,
    files: &BTreeMap<String, String>,
    kept: Kept,
    write: impl Fn(&Path, &str) -> io::Result<()>,
) -> Result<(), String> {
    sync_files(folder, files, kept, write)?;
    let there =
        files_below(folder, "wgsl").map_err(|error| format!("cannot read {}: {error}", folder.display()))?;
    for file in there.iter().filter(|file| !files.contains_key(*file)) {
        let path = folder.join(file);
        if kept == Kept::Compared {
            return Err(format!("{} is superfluous", path.display()));
        }
        fs::remove_file(&path).map_err(|error| format!("cannot remove {}: {error}", path.display()))?;
    }
    Ok(())
}

/// As [`sync`], but leaves other files of the folder alone.
///
/// # Errors
/// A file that cannot be written; with [`Kept::Compared`], the first that is missing or stale.
pub fn sync_files(
    folder: &Path,
    files: &BTreeMap<String, String>,
    kept: Kept,
    write: impl Fn(&Path, &str) -> io::Result<()>,
) -> Result<(), String> {
    for (file, text) in files {
        let path = folder.join(file);
        let there = fs::read(&path);
        if there.as_ref().is_ok_and(|bytes| bytes == text.as_bytes()) {
            continue;
        }
        if kept == Kept::Compared {
            let state = if there.is_ok() { "stale" } else { "missing" };
            return Err(format!("{} is {state}", path.display()));
        }
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent)
            .and_then(|()| write(&path, text))
            .map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    }
    Ok(())
}
