// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files that appear in a folder all together, when all of them are written.

use super::CommandError;
use super::error::one_line;
use crate::formats::create_folder;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder that is filled elsewhere. Dropped before [`Staging::publish`], it leaves nothing behind.
pub struct Staging {
    filled: TempDir,
    out: PathBuf,
}

impl Staging {
    /// For files with these names in `out`, which need not be there yet.
    ///
    /// # Errors
    /// A failure where files cannot be written there, or where one of the names is a folder's.
    pub fn new(out: &Path, names: impl IntoIterator<Item = PathBuf>) -> Result<Self, CommandError> {
        let failed = |problem: String| CommandError::failure(format!("--out: {problem}"));
        let there = out.ancestors().find(|path| path.exists()).unwrap_or(Path::new("."));
        if !there.is_dir() {
            return Err(failed(format!("{} is a file; give the name of a folder", there.display())));
        }
        if let Some(folder) = names.into_iter().map(|name| out.join(name)).find(|path| path.is_dir()) {
            return Err(failed(format!("{} is a folder; remove it first", folder.display())));
        }
        let filled = tempfile::Builder::new().prefix(".airlight-").tempdir_in(there);
        let filled = filled
            .map_err(|error| failed(format!("cannot write into {}: {}", there.display(), one_line(error))))?;
        Ok(Self { filled, out: out.to_owned() })
    }

    /// Where a file is to be written for now.
    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.filled.path().join(name)
    }

    /// Makes the folder, and puts all files into it.
    ///
    /// # Errors
    /// A failure.
    pub fn publish(self) -> Result<(), CommandError> {
        let failed = |problem: String| CommandError::failure(format!("--out: {problem}"));
        create_folder(&self.out).map_err(|error| failed(error.to_string()))?;
        let said = |error: std::io::Error| failed(format!("{}: {}", self.out.display(), one_line(error)));
        for file in std::fs::read_dir(self.filled.path()).map_err(said)? {
            let file = file.map_err(said)?;
            std::fs::rename(file.path(), self.out.join(file.file_name())).map_err(said)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_appear_together_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let count = || std::fs::read_dir(folder.path()).expect("the folder").count();
        let out = folder.path().join("a/b");
        let staging = Staging::new(&out, []).expect("a place");
        std::fs::write(staging.path("x"), "1").expect("written");
        drop(staging);
        assert_eq!(count(), 0);
        for text in ["1", "2"] {
            let staging = Staging::new(&out, ["x".into()]).expect("a place");
            std::fs::write(staging.path("x"), text).expect("written");
            staging.publish().expect("published");
            assert_eq!(std::fs::read_to_string(out.join("x")).expect("a file"), text);
        }
        let said = |out: &Path, name: &str| {
            Staging::new(out, [name.into()]).err().map(|error| error.to_string()).unwrap_or_default()
        };
        assert!(said(&folder.path().join("a"), "b").contains("is a folder"));
        assert!(said(&out.join("x"), "y").contains("is a file"));
        assert!(said(&out.join("x/z"), "y").contains("x is a file"));
        assert_eq!(count(), 1);
    }
}
