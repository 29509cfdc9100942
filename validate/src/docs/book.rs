// SPDX-License-Identifier: MIT OR Apache-2.0
//! The page of a system, and the entries of the book's table of contents.

use super::{
    Book, files, header,
    text::{GENERATED, prose, section, short, systems, table},
};
use crate::Library;

/// Where the generated part of `SUMMARY.md` begins.
pub const BEGIN: &str = "<!-- Below: written by `airlight-validate docs`. -->";
/// Where it ends.
pub const END: &str = "<!-- Above: written by `airlight-validate docs`. -->";

/// The page that lists modules and passes of a system.
pub(super) fn index(book: &Book, system: &str) -> String {
    let mut page = format!("{GENERATED}# {system}\n\n{}", book.pictures.markdown(system, 2));
    let mut modules = Vec::new();
    let mut callbacks = Vec::new();
    for module in book.library.modules().iter().filter(|module| of_system(&module.file, system)) {
        let name = short(&module.path);
        let bare = name.rsplit('/').next().unwrap_or(&name);
        let list = if files::is_callback(&module.source) { &mut callbacks } else { &mut modules };
        list.push(vec![format!("[{bare}]({bare}.md)"), prose(&header(&module.source).summary)]);
    }
    let passes = book.library.passes().iter().filter(|pass| of_system(&pass.file, system));
    let mut passes: Vec<_> = passes
        .filter_map(|pass| Some((pass.name.split_once('/')?.1, pass)))
        .map(|(bare, pass)| vec![format!("[{bare}](passes/{bare}.md)"), prose(&header(&pass.source).summary)])
        .collect();
    for (heading, list) in [("Modules", &mut modules), ("Callbacks", &mut callbacks), ("Passes", &mut passes)]
    {
        list.sort();
        page += &section(heading, &table(&["name", "what it does"], list));
    }
    page.trim_end().to_owned() + "\n"
}

fn of_system(file: &str, system: &str) -> bool {
    file.split('/').next() == Some(system)
}

/// `SUMMARY.md` with the part between the markers written anew.
///
/// # Errors
/// A sentence that says which marker is missing.
pub fn summary(library: &Library, before: &str) -> Result<String, String> {
    let missing = |marker: &str| format!("there is no line `{marker}`");
    let (head, rest) = before.split_once(BEGIN).ok_or_else(|| missing(BEGIN))?;
    let (_, tail) = rest.split_once(END).ok_or_else(|| missing(END))?;
    let mut list =
        String::from("- [What each pass needs](needs.md)\n- [Files of each pass](vendoring/files.md)\n");
    for system in systems(library) {
        list += &format!("- [{system}](modules/{system}/index.md)\n");
        let modules = library.modules().iter().filter(|module| of_system(&module.file, system));
        let mut names: Vec<String> = modules.map(|module| short(&module.path)).collect();
        names.sort();
        for name in names {
            list += &format!("  - [{name}](modules/{name}.md)\n");
        }
        let passes = library.passes().iter().filter(|pass| of_system(&pass.file, system));
        let mut names: Vec<_> = passes.filter_map(|pass| pass.name.split_once('/')).collect();
        names.sort_unstable();
        for (system, name) in names {
            list += &format!("  - [{system}/{name}, pass](modules/{system}/passes/{name}.md)\n");
        }
    }
    Ok(format!("{head}{BEGIN}\n\n{list}\n{END}{tail}"))
}
