// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stand-alone WGSL: a composed pass in one file, for engines without a composer.

use crate::{Composed, Error, Location};

/// The composed module as WGSL without directives.
///
/// naga's writer drops comments, writes `for` as `loop` and folds constants.
///
/// # Errors
/// Something that naga cannot write as WGSL.
pub fn write(composed: &Composed) -> Result<String, Error> {
    let flags = naga::back::wgsl::WriterFlags::empty();
    naga::back::wgsl::write_string(&composed.module, &composed.info, flags).map_err(|error| {
        Error::Write {
            location: Location::file(&composed.file),
            form: "flat WGSL".to_owned(),
            message: error.to_string(),
        }
    })
}
