// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pages of the book that follow from the shaders: one for each module and each pass, one a system, what each pass
//! needs of a device, and what files it takes.

mod book;
mod cost;
mod files;
mod header;
mod items;
mod module;
mod needs;
mod pass;
mod pictures;
mod text;
mod unsaid;

pub use book::{BEGIN, END, summary};
pub use cost::{Cost, Named, costs};
pub use header::{Budget, Header, header};
pub use items::{Item, Kind, Part, described, items};
pub use pictures::Pictures;
pub use unsaid::unsaid;

use crate::{Composed, Definitions, Error, Library, check};
use std::collections::BTreeMap;

/// What is known of a library before pages are written.
struct Book<'a> {
    library: &'a Library,
    pictures: &'a Pictures,
    /// Each module alone, by path, with the definitions that the first permutation to reach it gives.
    modules: BTreeMap<String, Composed>,
    /// Permutations of each pass, in order.
    passes: BTreeMap<String, Vec<(String, Composed)>>,
}

impl Book<'_> {
    /// The struct of a name in one of some modules, or in what they import: the path of its module, and the struct.
    fn struct_of(&self, paths: &[String], name: &str) -> Option<(String, Item)> {
        let closure = self.library.closure(paths);
        // Those that were asked for first.
        let (own, others): (Vec<_>, Vec<_>) =
            closure.into_iter().partition(|module| paths.contains(&module.path));
        own.into_iter().chain(others).find_map(|module| {
            let mut items = items(&module.source).into_iter();
            let found = items.find(|item| item.kind == Kind::Struct && item.name == name)?;
            Some((module.path.clone(), found))
        })
    }
}

/// Every generated page by its path in the book's folder, `modules/core/phase.md`.
///
/// # Errors
/// The first shader that does not compose.
pub fn pages(library: &Library, pictures: &Pictures) -> Result<BTreeMap<String, String>, Error> {
    let mut passes: BTreeMap<String, Vec<(String, Composed)>> = BTreeMap::new();
    for pass in library.passes() {
        for permutation in library.permutations(&pass.name)? {
            let composed = library.compose(&pass.name, &permutation.definitions)?;
            passes.entry(pass.name.clone()).or_default().push((permutation.name.clone(), composed));
        }
    }
    let mut modules = BTreeMap::new();
    let none = Definitions::new();
    for (module, sets) in check::definitions_of_modules(library) {
        // With the most definitions most of it is there to be counted.
        let definitions = sets.iter().max_by_key(|set| (set.iter().count(), std::cmp::Reverse(*set)));
        let composed = library.compose_module(&module.path, definitions.unwrap_or(&none))?;
        modules.insert(module.path.clone(), composed);
    }
    let book = Book { library, pictures, modules, passes };
    let mut pages = BTreeMap::new();
    for module in library.modules() {
        let name = text::short(&module.path);
        pages.insert(format!("modules/{name}.md"), module::page(&book, module));
    }
    for source in library.passes() {
        if let Some((system, name)) = source.name.split_once('/') {
            pages.insert(format!("modules/{system}/passes/{name}.md"), pass::page(&book, source));
        }
    }
    for system in text::systems(library) {
        pages.insert(format!("modules/{system}/index.md"), book::index(&book, system));
    }
    pages.insert("needs.md".to_owned(), needs::page(&book));
    pages.insert("vendoring/files.md".to_owned(), files::page(library));
    Ok(pages)
}

#[cfg(test)]
mod tests;
