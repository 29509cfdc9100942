// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--transfer`: transfer functions of volumes by name or from a file.

use super::CommandError;
use crate::core::{TRANSFERS, TransferFunction, parse_transfer, read_transfer};
use std::path::Path;

/// A transfer function.
///
/// # Errors
/// Misuse: an unknown name. A failure: a file that cannot be read, or that is wrong.
pub fn transfer(path: &Path) -> Result<TransferFunction, CommandError> {
    if let Some((name, text)) = TRANSFERS.iter().find(|(name, _)| path.as_os_str() == *name) {
        return Ok(parse_transfer(name, text)?);
    }
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        return Ok(read_transfer(path)?);
    }
    let known: Vec<_> = TRANSFERS.iter().map(|(name, _)| *name).collect();
    let (path, known) = (path.display(), known.join(", "));
    let problem = format!("`{path}` is unknown: give {known}, or a file that ends in .toml");
    Err(CommandError::misuse("--transfer", problem))
}
