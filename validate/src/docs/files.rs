// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which files each pass takes, for those who copy them.

use super::{
    header,
    text::{GENERATED, short, systems, table},
};
use crate::{Library, PassSource};

const INTRODUCTION: &str = "# Files of each pass

Modules, [callbacks](../architecture.md#modules-callbacks-passes) and passes are plain files in `wgsl/`. What each pass takes, for all
of its permutations, with what the files import in turn; names without a folder are of `core` in the third column and of the pass's own
system in the others. `airlight-validate vendor` copies them, and leaves out what the named permutations do not reach.

";

pub(super) fn page(library: &Library) -> String {
    let mut page = format!("{GENERATED}{INTRODUCTION}");
    for system in systems(library) {
        let passes = library.passes().iter().filter(|pass| pass.name.split('/').next() == Some(system));
        let rows: Vec<_> = passes.map(|pass| row(library, pass)).collect();
        if !rows.is_empty() {
            page += &format!("## {system}\n\n");
            page += &table(&["pass", "callbacks", "modules of core", "other modules"], &rows);
        }
    }
    page.trim_end().to_owned() + "\n"
}

/// Whether a module is a callback: it says so.
pub(super) fn is_callback(source: &str) -> bool {
    header(source).summary.to_lowercase().contains("callback")
}

fn row(library: &Library, pass: &PassSource) -> Vec<String> {
    let own = pass.name.split('/').next().unwrap_or_default();
    let mut closure = library.closure(&pass.imports);
    closure.sort_by(|a, b| a.path.cmp(&b.path));
    let mut cells = [const { Vec::new() }; 3];
    for module in closure {
        let name = short(&module.path);
        let at = if is_callback(&module.source) { 0 } else { 2 - usize::from(name.starts_with("core/")) };
        let bare = name.trim_start_matches("core/").trim_start_matches(&format!("{own}/"));
        cells[at].push(bare.to_owned());
    }
    let cells = cells.map(|names| if names.is_empty() { "none".to_owned() } else { names.join(", ") });
    [vec![format!("`{}`", pass.name)], cells.to_vec()].concat()
}
