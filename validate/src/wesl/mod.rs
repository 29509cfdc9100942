// SPDX-License-Identifier: MIT OR Apache-2.0
//! A WESL package from the modules of a library.
//!
//! `airlight::core::phase` becomes the file `core/phase.wesl`, which a shader of the package imports as
//! `package::core::phase` and a shader elsewhere as `airlight::core::phase`. Line for line it is the module: comments stay,
//! and what a directive stood on is a comment.
//!
//! | naga_oil | WESL |
//! |---|---|
//! | `#define_import_path airlight::core::phase` | the path of the file |
//! | `#import airlight::core::phase::henyey_greenstein` | `import package::core::phase::henyey_greenstein;` |
//! | `#ifdef NAME`, `#ifndef NAME`, `#else`, `#else ifdef NAME` | `@if(NAME)`, `@if(!NAME)` … before each item, member or statement between them |
//! | a definition between whose `#ifdef` and `#endif` a binding is declared | off: its parts are left out |
//!
//! WESL knows no values of definitions and no overriding of functions, and a binding belongs to the engine that has it.
//! So these modules have no such form, and neither have those that import them:
//!
//! | What | Why |
//! |---|---|
//! | bindings | a package of algorithms has none; callbacks are what an engine writes itself |
//! | `#{NAME}`, `#if NAME == 1` | the value of a definition; `@if` knows only whether there is one |
//! | `#define NAME` | only who compiles sets the features of WESL |
//! | `virtual fn`, `override fn` | WESL has neither |
//! | `#ifdef` around part of a statement or of a list | `@if` stands before whole items, members and statements |

mod branches;
mod module;

use crate::{Error, Library, ModuleSource};
use std::collections::BTreeSet;

/// What WESL tools read about the package.
const WESL_TOML: &str = "\
# SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
# Airlight as a WESL package; its folder is what `airlight::` or `package::` begins at.
edition = \"2026_pre\"
root = \"./\"
";

/// Paths of the modules that have a WESL form, in the order of the library.
pub fn modules(library: &Library) -> Vec<&str> {
    let has_form = |module: &&ModuleSource| translated(library, module).is_ok();
    library.modules().iter().filter(has_form).map(|module| module.path.as_str()).collect()
}

/// A WESL package of `modules` and of what they import: each file's path with `/`, relative to the folder of the package,
/// and its text. The first is `wesl.toml`.
///
/// # Errors
/// An unknown module, or one without a WESL form; the error names file, line and reason.
pub fn package(library: &Library, modules: &[&str]) -> Result<Vec<(String, String)>, Error> {
    let wanted = modules.iter().map(|path| library.module(path).map(|module| module.path.clone()));
    let wanted = wanted.collect::<Result<Vec<_>, _>>()?;
    let mut files = vec![("wesl.toml".to_owned(), WESL_TOML.to_owned())];
    for module in library.closure(&wanted) {
        files.push((file(module)?, translate(library, module)?));
    }
    Ok(files)
}

/// That a module and all that it imports have a form.
fn translated(library: &Library, module: &ModuleSource) -> Result<(), Error> {
    let all = library.closure(std::slice::from_ref(&module.path));
    all.into_iter().try_for_each(|module| translate(library, module).map(|_| ()))
}

fn translate(library: &Library, module: &ModuleSource) -> Result<String, Error> {
    let all = library.closure(std::slice::from_ref(&module.path));
    let off: BTreeSet<String> =
        all.iter().flat_map(|module| branches::bringing_bindings(&module.source)).collect();
    let root = module.path.split("::").next().unwrap_or_default();
    module::translate(&module.source, root, &off).map_err(|refusal| refusal.in_file(&module.file))
}

/// Where in the package a module lies.
fn file(module: &ModuleSource) -> Result<String, Error> {
    let mut names = module.path.split("::").skip(1).peekable();
    if names.peek().is_none() {
        let message = format!("the path `{}` needs a package before it, as `airlight::`", module.path);
        return Err(module::Refusal { line: 1, message }.in_file(&module.file));
    }
    Ok(names.collect::<Vec<_>>().join("/") + ".wesl")
}

#[cfg(test)]
mod tests;
