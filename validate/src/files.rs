// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files below a folder.

use std::{collections::BTreeSet, io, path::Path};
use walkdir::WalkDir;

/// The files below a folder whose names end in `.` and `extension`, relative to it, with `/`; none where there is no folder.
///
/// # Errors
/// A folder that cannot be read.
pub fn files_below(folder: &Path, extension: &str) -> io::Result<BTreeSet<String>> {
    let mut found = BTreeSet::new();
    if !folder.exists() {
        return Ok(found);
    }
    for entry in WalkDir::new(folder) {
        let entry = entry?;
        let path = entry.path();
        if entry.file_type().is_file() && path.extension().is_some_and(|ending| ending == extension) {
            let parts = path.strip_prefix(folder).unwrap_or(path).components();
            let names: Vec<_> = parts.map(|part| part.as_os_str().to_string_lossy()).collect();
            found.insert(names.join("/"));
        }
    }
    Ok(found)
}
