// SPDX-License-Identifier: MIT OR Apache-2.0
//! Putting files into a folder, all of them or none, without losing what others wrote there.

use super::{
    Problem,
    lock::{LOCK_FILE, Lock, sum},
};
use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
};

/// What was done to a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Installed {
    /// Files that were written.
    pub written: Vec<String>,
    /// Files that were there already.
    pub unchanged: Vec<String>,
    /// Files of an earlier vendoring that are no longer needed.
    pub removed: Vec<String>,
    /// Such files that stay, because they were changed locally.
    pub kept: Vec<String>,
}

/// Makes a folder hold `files` and their lock, and no file of an earlier vendoring that is not among them.
///
/// # Errors
/// A broken lock file; without `force`, files that vendoring did not write or that were changed since; a file that
/// cannot be written. The folder is then as it was.
pub fn install(
    folder: &Path,
    lock: &Lock,
    files: &BTreeMap<String, String>,
    force: bool,
) -> Result<Installed, Problem> {
    let earlier = match Lock::read(folder) {
        Ok(earlier) => earlier.map(|lock| lock.files).unwrap_or_default(),
        Err(Problem::File { what, path, source }) => return Err(Problem::File { what, path, source }),
        Err(problem) if !force => return Err(problem),
        Err(_) => BTreeMap::new(),
    };
    let mut done = Installed::default();
    let mut in_the_way = Vec::new();
    for (file, text) in files {
        match present(folder, file)? {
            None => done.written.push(file.clone()),
            Some(there) if there == text.as_bytes() => done.unchanged.push(file.clone()),
            Some(there) => {
                let own = earlier.get(file).map(|locked| *locked == sum(&there));
                match own {
                    Some(true) => {}
                    Some(false) => in_the_way.push(format!("{file} was changed locally")),
                    None => in_the_way.push(format!("{file} was not written by vendor")),
                }
                done.written.push(file.clone());
            }
        }
    }
    if !force && !in_the_way.is_empty() {
        return Err(Problem::InTheWay(in_the_way));
    }
    for (file, locked) in earlier.iter().filter(|(file, _)| !files.contains_key(*file)) {
        match present(folder, file)? {
            None => {}
            Some(there) if sum(&there) == *locked => done.removed.push(file.clone()),
            Some(_) => done.kept.push(file.clone()),
        }
    }
    let mut texts: Vec<(&str, &str)> =
        done.written.iter().filter_map(|file| Some((file.as_str(), files.get(file)?.as_str()))).collect();
    let lock = lock.text();
    texts.push((LOCK_FILE, &lock));
    replace(folder, &texts, &done.removed)?;
    Ok(done)
}

/// The bytes of a file; none where there is none. A link on the way would lead out of the folder.
pub(super) fn present(folder: &Path, file: &str) -> Result<Option<Vec<u8>>, Problem> {
    let mut path = folder.to_owned();
    for part in file.split('/') {
        path.push(part);
        match fs::symlink_metadata(&path) {
            Ok(there) if there.file_type().is_symlink() => {
                let source = io::Error::other("it is a symbolic link");
                return Err(Problem::File { what: "use", path, source });
            }
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(Problem::File { what: "read", path, source }),
        }
    }
    fs::read(&path).map(Some).map_err(|source| Problem::File { what: "read", path, source })
}

/// Writes and removes files, or leaves everything as it was.
pub(super) fn replace(folder: &Path, texts: &[(&str, &str)], removed: &[String]) -> Result<(), Problem> {
    let wrong = |what: &'static str, path: &Path| {
        let path = path.to_owned();
        move |source| Problem::File { what, path, source }
    };
    fs::create_dir_all(folder).map_err(wrong("create", folder))?;
    // In the folder itself, so that moving is renaming; gone when this returns.
    let stage = tempfile::Builder::new().prefix(".airlight-").tempdir_in(folder);
    let stage = stage.map_err(wrong("write to", folder))?;
    let (fresh, old) = (stage.path().join("fresh"), stage.path().join("old"));
    for (file, text) in texts {
        let path = fresh.join(file);
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent).and_then(|()| fs::write(&path, text)).map_err(wrong("write", &path))?;
    }
    let mut undo = Undo { moved: Vec::new(), made: Vec::new(), armed: true };
    for file in texts.iter().map(|(file, _)| *file).chain(removed.iter().map(String::as_str)) {
        let (path, backup) = (folder.join(file), old.join(file));
        if path.exists() {
            fs::create_dir_all(backup.parent().unwrap_or(&old)).map_err(wrong("write", &backup))?;
            fs::rename(&path, &backup).map_err(wrong("replace", &path))?;
            undo.moved.push((backup, path));
        }
    }
    for (file, _) in texts {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().unwrap_or(folder)).map_err(wrong("write", &path))?;
        fs::rename(fresh.join(file), &path).map_err(wrong("write", &path))?;
        undo.made.push(path);
    }
    undo.armed = false;
    // Folders that are empty now; others stay.
    for file in removed {
        for parent in Path::new(file).ancestors().skip(1).filter(|parent| !parent.as_os_str().is_empty()) {
            let _ = fs::remove_dir(folder.join(parent));
        }
    }
    Ok(())
}

/// Puts files back unless everything went well.
struct Undo {
    moved: Vec<(PathBuf, PathBuf)>,
    made: Vec<PathBuf>,
    armed: bool,
}

impl Drop for Undo {
    fn drop(&mut self) {
        if !self.armed {
            return;
        }
        // What fails here cannot be helped; the error that led here is told.
        for path in &self.made {
            let _ = fs::remove_file(path);
        }
        for (backup, path) in &self.moved {
            let _ = fs::rename(backup, path);
        }
    }
}
