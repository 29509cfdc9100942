// SPDX-License-Identifier: MIT OR Apache-2.0
//! Finding and reading the files of a tree.

use super::{File, Foreign};
use crate::Location;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// The largest file that is read: naga_oil has 21 bits for a position.
const LARGEST: u64 = 1 << 20;

/// How deep folders are followed.
const DEEPEST: usize = 64;

/// The shaders below a folder, or one file; `flag` is what misuse calls the folder.
pub(super) fn read(
    dir: &Path,
    flag: &str,
    is_external: bool,
    foreign: &mut Foreign,
) -> Result<Vec<File>, String> {
    let shown = dir.display();
    let mut found = Vec::new();
    if dir.is_file() {
        let relative = dir.file_name().unwrap_or_default().to_string_lossy().into_owned();
        found.push((relative, dir.to_owned()));
    } else if dir.is_dir() {
        walk(dir, "", &mut BTreeSet::new(), &mut found, foreign);
        if found.is_empty() && !is_external {
            return Err(format!(
                "{flag} `{shown}` holds no `.wgsl` file; give a folder with shaders, or a shader"
            ));
        }
    } else {
        return Err(format!("{flag} `{shown}` does not exist; give a folder with shaders, or a shader"));
    }
    let mut files = Vec::new();
    for (relative, path) in found {
        let name = path.display().to_string();
        match text(&path) {
            Ok(text) => files.push(File { name, relative, text, is_external }),
            Err((line, column, message)) => {
                foreign.report(Location { file: name, line, column }, "unreadable", message);
            }
        }
    }
    Ok(files)
}

/// Adds the shaders of a folder in the order of their names; hidden folders are left out.
fn walk(
    folder: &Path,
    prefix: &str,
    seen: &mut BTreeSet<PathBuf>,
    found: &mut Vec<(String, PathBuf)>,
    foreign: &mut Foreign,
) {
    // A link may lead back to a folder that is being read.
    let is_new = folder.canonicalize().is_ok_and(|own| seen.insert(own));
    let depth = prefix.matches('/').count();
    if !is_new || depth > DEEPEST {
        return;
    }
    let mut entries: Vec<PathBuf> = match fs::read_dir(folder) {
        Ok(entries) => entries.flatten().map(|entry| entry.path()).collect(),
        Err(error) => {
            let location = Location::file(folder.display().to_string());
            return foreign.report(location, "unreadable", format!("cannot read the folder: {error}"));
        }
    };
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let relative = format!("{prefix}{name}");
        if path.is_dir() {
            if !name.starts_with('.') && !matches!(name.as_str(), "node_modules" | "target") {
                walk(&path, &format!("{relative}/"), seen, found, foreign);
            }
        } else if name.ends_with(".wgsl") {
            found.push((relative, path));
        }
    }
}

type Unreadable = (Option<u32>, Option<u32>, String);

/// The text of a file: without a byte order mark, with lines that end in `\n`.
fn text(path: &Path) -> Result<String, Unreadable> {
    let failed = |error: std::io::Error| (None, None, format!("cannot be read: {error}"));
    let about = fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        return Err((None, None, "is no file".to_owned()));
    }
    if about.len() > LARGEST {
        return Err((None, None, format!("has {} bytes; at most {LARGEST} are read", about.len())));
    }
    decode(fs::read(path).map_err(failed)?)
}

pub(super) fn decode(bytes: Vec<u8>) -> Result<String, Unreadable> {
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid =
            String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]).into_owned();
        let line = valid.matches('\n').count() as u32 + 1;
        let column = valid.rsplit('\n').next().unwrap_or_default().chars().count() as u32 + 1;
        (Some(line), Some(column), "is not UTF-8 from here on".to_owned())
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(&text).replace("\r\n", "\n"))
}
