// SPDX-License-Identifier: MIT OR Apache-2.0
//! The folder that cases are written to.

use super::CaptureError;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A folder.
pub(super) struct Store {
    root: PathBuf,
}

impl Store {
    pub(super) fn new(root: &Path) -> Result<Self, CaptureError> {
        for folder in ["blobs", "cases", "shaders"] {
            let path = root.join(folder);
            fs::create_dir_all(&path).map_err(|error| failed(&path, &error))?;
        }
        Ok(Self { root: root.to_owned() })
    }

    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), CaptureError> {
        let path = self.root.join(name);
        fs::write(&path, bytes).map_err(|error| failed(&path, &error))
    }

    pub(super) fn append(&self, name: &str, line: &str) -> Result<(), CaptureError> {
        let path = self.root.join(name);
        let file = fs::OpenOptions::new().create(true).append(true).open(&path);
        file.and_then(|mut file| writeln!(file, "{line}")).map_err(|error| failed(&path, &error))
    }

    /// Keeps bytes once, under a name that says what they are.
    pub(super) fn keep(&self, bytes: &[u8]) -> Result<String, CaptureError> {
        let name = name_of(bytes);
        let path = self.root.join("blobs").join(&name);
        if !path.exists() {
            fs::write(&path, bytes).map_err(|error| failed(&path, &error))?;
        }
        Ok(name)
    }
}

fn failed(path: &Path, error: &std::io::Error) -> CaptureError {
    CaptureError::File { path: path.display().to_string(), message: error.to_string() }
}

/// The 128-bit FNV-1a hash of some bytes, in hexadecimal digits.
pub(super) fn name_of(bytes: &[u8]) -> String {
    const START: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let hash = bytes.iter().fold(START, |hash, byte| (hash ^ u128::from(*byte)).wrapping_mul(PRIME));
    format!("{hash:032x}")
}

#[cfg(test)]
mod tests {
    use super::name_of;

    /// Test vectors of the FNV reference implementation.
    #[test]
    fn hashes_are_fnv() {
        assert_eq!(name_of(b""), "6c62272e07bb014262b821756295c58d");
        assert_eq!(name_of(b"a"), "d228cb696f1a8caf78912b704e4a8964");
        assert_eq!(name_of(b"foobar"), "343e1662793c64bf6f0d3597ba446f18");
    }
}
