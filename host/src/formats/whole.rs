// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files that are written whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Why a file or a folder could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The folder that the file should lie in does not exist.
    #[error("{path}: there is no folder {folder:?} to write into; create it first")]
    NoFolder {
        /// The file.
        path: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The name is that of a folder, or no name at all.
    #[error("{path:?} names no file; give the name of a file")]
    NoFile {
        /// What was given.
        path: PathBuf,
    },
    /// The file could not be written; nothing of it is left.
    #[error("{path}: the file cannot be written: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The folder could not be created.
    #[error("{path}: the folder cannot be created: {source}")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The data do not have the shape that was said.
    #[error("{path}: {reason}")]
    Data {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        reason: String,
    },
}

/// Writes a file whole or not at all: `fill` writes into a temporary file in the same folder, which takes the
/// name of `path` only when everything is written. An existing file stays as it is until then.
///
/// # Errors
/// [`WriteError`]; the folder is not created, see [`create_folder`].
pub fn write_whole(
    path: impl AsRef<Path>,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    if path.file_name().is_none() || path.is_dir() {
        return Err(WriteError::NoFile { path: path.to_owned() });
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(WriteError::NoFolder { path: path.to_owned(), folder: folder.to_owned() });
    }
    let failed = |source| WriteError::File { path: path.to_owned(), source };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".airlight-");
    // A temporary file is private; the file that it becomes is not.
    #[cfg(unix)]
    builder.permissions(permissions_of(path));
    let temporary = builder.tempfile_in(folder).map_err(failed)?;
    let mut writer = BufWriter::new(temporary);
    fill(&mut writer).map_err(failed)?;
    let temporary = writer.into_inner().map_err(|error| failed(error.into_error()))?;
    temporary.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// What the file has if it exists, and otherwise what the process's mask leaves of read and write for all.
#[cfg(unix)]
fn permissions_of(path: &Path) -> std::fs::Permissions {
    use std::os::unix::fs::PermissionsExt;
    std::fs::metadata(path)
        .map(|data| data.permissions())
        .unwrap_or_else(|_| std::fs::Permissions::from_mode(0o666))
}

/// Creates a folder and those above it; one that exists is fine.
///
/// # Errors
/// [`WriteError::Folder`].
pub fn create_folder(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    std::fs::create_dir_all(path).map_err(|source| WriteError::Folder { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.txt");
        write_whole(&path, |writer| writer.write_all(b"old")).expect("written");
        let error = write_whole(&path, |writer| {
            writer.write_all(&[0; 100_000])?;
            Err(io::Error::other("out of ink"))
        });
        let message = error.expect_err("the ink is out").to_string();
        assert!(message.contains("a.txt") && message.contains("out of ink"), "{message}");
        assert_eq!(std::fs::read(&path).expect("the old file"), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 1);
        write_whole(&path, |writer| writer.write_all(b"new")).expect("written");
        assert_eq!(std::fs::read(&path).expect("the new file"), b"new");
    }

    #[test]
    fn wrong_names_are_told_apart() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let nothing = |path: &Path| write_whole(path, |_| Ok(())).expect_err("no such place");
        assert!(matches!(nothing(&folder.path().join("no/a.txt")), WriteError::NoFolder { .. }));
        assert!(matches!(nothing(folder.path()), WriteError::NoFile { .. }));
        assert!(matches!(nothing(Path::new("")), WriteError::NoFile { .. }));
        std::fs::write(folder.path().join("file"), "").expect("a file");
        let error = create_folder(folder.path().join("file/below")).expect_err("a file is no folder");
        assert!(error.to_string().contains("below: the folder cannot be created"), "{error}");
        create_folder(folder.path().join("a/b/c")).expect("created");
        create_folder(folder.path().join("a/b/c")).expect("there already");
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_what_the_mask_allows() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mode = |name: &str| {
            let data = std::fs::metadata(folder.path().join(name)).expect("written");
            data.permissions().mode() & 0o777
        };
        std::fs::write(folder.path().join("plain"), "").expect("a file");
        write_whole(folder.path().join("whole"), |_| Ok(())).expect("written");
        assert_eq!(mode("whole"), mode("plain"));
    }
}
