// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stand-alone WGSL: a pass and everything it uses in one file without directives, for engines without
//! a composer.
//!
//! [`text`] puts the sources together: functions, structs and constants with their comments, as they are
//! written, each module under its path, summary and source. What a module declares has its short name, or the
//! module's name before it where that would be ambiguous; what the pass declares keeps its name.

mod files;
mod items;
mod link;
mod source;
#[cfg(test)]
mod tests;
mod written;

use crate::{
    Error, Library, Location, PassSource, Permutation,
    compose::{shader_definitions, validate},
    locate,
};
pub(crate) use files::name as file_name;
pub use files::{Kept, list, render, sync, sync_files};
use link::{Failure, Linked, link};
use std::fmt::Write as _;
pub use written::write;

/// A permutation of a pass as stand-alone WGSL, with its licence, version, header and comments.
///
/// It parses and validates as core WebGPU. A pass that overrides virtual functions of `naga_oil` is taken from
/// the composed module instead, which has no comments.
///
/// # Errors
/// An unknown pass or permutation, or a pass that does not compose.
pub fn text(library: &Library, pass: &str, permutation: &str) -> Result<String, Error> {
    let source = library.pass(pass)?;
    let permutation = library.permutation(pass, permutation)?;
    let failed = |message: String| {
        // The composer knows the line of a source that is wrong.
        let composed = library.compose(pass, &permutation.definitions).err();
        composed.unwrap_or_else(|| Error::Write {
            location: Location::file(&source.file),
            form: format!("flat WGSL (permutation `{}`)", permutation.name),
            message,
        })
    };
    let text = match link(library, source, shader_definitions(&permutation.definitions)) {
        Ok(linked) => document(library, source, permutation, &linked),
        Err(Failure::Unsupported) => {
            let composed = library.compose(pass, &permutation.definitions)?;
            return Ok(format!("{}\n{}", title(library, source, permutation), write(&composed)?));
        }
        Err(Failure::Wrong { file, message }) => return Err(failed(format!("{file}: {message}"))),
    };
    let module = naga::front::wgsl::parse_str(&text)
        .map_err(|error| failed(error.emit_to_string_with_path(&text, "flat.wgsl")))?;
    validate(&module).map_err(|error| failed(locate::chain(error.as_inner())))?;
    Ok(text)
}

/// Licence, version, name and definitions.
fn title(library: &Library, pass: &PassSource, permutation: &Permutation) -> String {
    let mut text = String::new();
    let licence = source::header(&pass.source).find(|line| line.starts_with("// SPDX"));
    if let Some(licence) = licence {
        let _ = writeln!(text, "{licence}");
    }
    let is_airlight = library.modules().iter().any(|module| module.path.starts_with("airlight::"));
    let maker = if is_airlight { concat!("Airlight ", env!("CARGO_PKG_VERSION"), ": ") } else { "" };
    let definitions = match permutation.definitions.is_empty() {
        true => String::new(),
        false => format!(" ({})", permutation.definitions),
    };
    let _ = writeln!(text, "// {maker}{}, permutation {}{definitions}", pass.name, permutation.name);
    text
}

fn document(library: &Library, pass: &PassSource, permutation: &Permutation, linked: &Linked) -> String {
    let mut text = title(library, pass, permutation);
    for line in source::header(&pass.source).filter(|line| !line.starts_with("// SPDX")) {
        // Of definitions and bindings those that this permutation has.
        let entry = |key: &str| line.strip_prefix(key).and_then(|rest| rest.split(':').next());
        let applies = match (entry("// definition "), entry("// binding ")) {
            (Some(name), _) => permutation.definitions.contains(name),
            (_, Some(name)) => linked.bindings.contains(name),
            _ => true,
        };
        if applies {
            let _ = writeln!(text, "{line}");
        }
    }
    if !linked.directives.is_empty() {
        let _ = write!(text, "\n{}", linked.directives);
    }
    for (path, items) in &linked.modules {
        let _ = writeln!(text, "\n// ---- {path} ----");
        let module = library.modules().iter().find(|module| module.path == *path);
        let header = module.into_iter().flat_map(|module| source::header(&module.source));
        for line in header.filter(|line| line.starts_with("// summary: ") || line.starts_with("// source: "))
        {
            let _ = writeln!(text, "{line}");
        }
        let _ = write!(text, "\n{items}");
    }
    if !linked.modules.is_empty() {
        let _ = writeln!(text, "\n// ---- {} ----", pass.name);
    }
    let _ = write!(text, "\n{}", linked.pass);
    text
}
