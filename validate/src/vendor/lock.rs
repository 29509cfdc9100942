// SPDX-License-Identifier: MIT OR Apache-2.0
//! The lock file of vendored passes: what was asked for, and the checksum of every file.

use super::{Form, Problem, Request};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::{
    collections::BTreeMap,
    fs, io,
    path::{Component, Path},
};

/// The name of the lock file in the folder that was vendored to.
pub const LOCK_FILE: &str = "airlight.lock.json";

/// The format of lock files.
const FORMAT: u32 = 1;

/// What a lock file holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lock {
    format: u32,
    /// The version that the files come from.
    pub version: String,
    /// Their form.
    pub form: Form,
    /// What was asked for: `<system>/<pass>` or `<system>/<pass>:<permutation>`.
    pub passes: Vec<String>,
    /// SHA-256 of each file, by its path in the folder.
    pub files: BTreeMap<String, String>,
}

impl Lock {
    /// The lock of files made by [`package`](super::package).
    pub fn new(requests: &[Request], form: Form, files: &BTreeMap<String, String>) -> Self {
        let mut passes: Vec<String> = requests.iter().map(Request::to_string).collect();
        passes.sort();
        passes.dedup();
        let files = files.iter().map(|(file, text)| (file.clone(), sum(text.as_bytes())));
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self { format: FORMAT, version, form, passes, files: files.collect() }
    }

    /// The lock file of a folder; none where there is none.
    ///
    /// # Errors
    /// One that cannot be read, is of another format, or names a file outside its folder.
    pub fn read(folder: &Path) -> Result<Option<Self>, Problem> {
        let path = folder.join(LOCK_FILE);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                return Err(Problem::BrokenLock { path, message: "it is no text".to_owned() });
            }
            Err(source) => return Err(Problem::File { what: "read", path, source }),
        };
        let broken = |message: String| Problem::BrokenLock { path: path.clone(), message };
        let lock: Self = serde_json::from_str(&text).map_err(|error| broken(error.to_string()))?;
        if lock.format != FORMAT {
            return Err(broken(format!("it has format {} and not {FORMAT}", lock.format)));
        }
        if let Some(file) = lock.files.keys().find(|file| !is_inside(file)) {
            return Err(broken(format!("it names `{file}`, which is no file in its folder")));
        }
        Ok(Some(lock))
    }

    /// The lock file's text.
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// What was asked for.
    pub fn requests(&self) -> Vec<Request> {
        self.passes.iter().map(|pass| Request::from(pass.as_str())).collect()
    }
}

/// Whether a path stays in its folder on every system, and is not the lock file itself.
fn is_inside(file: &str) -> bool {
    let is_plain = !file.is_empty() && file != LOCK_FILE && !file.contains(['\\', ':', '\0']);
    is_plain
        && !file.split('/').any(str::is_empty)
        && Path::new(file).components().all(|part| matches!(part, Component::Normal(_)))
        && file.split('/').all(|part| part != ".")
}

/// SHA-256 of a text, in hexadecimal digits.
pub(super) fn sum(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
