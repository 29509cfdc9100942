// SPDX-License-Identifier: MIT OR Apache-2.0
//! The lists of the crate `airlight-wgsl`, from its folder.

use crate::Library;
use std::collections::BTreeSet;

/// The longest line.
const WIDTH: usize = 110;

/// Rust source with every system, module and pass of a library that was read from a folder.
pub fn render(library: &Library) -> String {
    let mut text = String::from(
        "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense\n\
         // Written by `airlight-validate list`: every module after those that it imports, passes by name.\n\nuse super::{Module, Pass, System};\n\nmodules! {\n",
    );
    for module in library.modules() {
        let imports: Vec<String> = module.imports.iter().map(|path| format!("\"{}\"", bare(path))).collect();
        let head = format!("    {} [", bare(&module.path));
        let line = format!("{head}{}],", imports.join(", "));
        if line.len() <= WIDTH {
            text += &format!("{line}\n");
        } else {
            text += &format!("{head}\n{}    ],\n", wrapped(&imports));
        }
    }
    text += "}\n\npasses! {\n";
    let mut systems: BTreeSet<&str> =
        library.modules().iter().filter_map(|module| module.file.split('/').next()).collect();
    for pass in library.passes() {
        systems.extend(pass.name.split('/').next());
        text += &format!("    {},\n", pass.name);
    }
    let systems: Vec<&str> = systems.into_iter().collect();
    text + &format!("}}\n\nsystems![{}];\n", systems.join(", "))
}

/// A path without the name of the library.
fn bare(path: &str) -> &str {
    path.strip_prefix("airlight::").unwrap_or(path)
}

/// Lines of items with commas between.
fn wrapped(items: &[String]) -> String {
    let mut text = String::new();
    let mut line = String::new();
    for (index, item) in items.iter().enumerate() {
        let item = if index + 1 < items.len() { format!("{item},") } else { item.clone() };
        if !line.is_empty() && 9 + line.len() + item.len() > WIDTH {
            text += &format!("        {line}\n");
            line.clear();
        }
        line += if line.is_empty() { "" } else { " " };
        line += &item;
    }
    text + &format!("        {line}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_written_as_macros() {
        let library = Library::from_text(
            &[
                ("core/a.wgsl", "#define_import_path airlight::core::a\nconst X: f32 = 1.0;\n"),
                ("core/b.wgsl", "#define_import_path airlight::core::b\n#import airlight::core::a::X\n"),
            ],
            &[("core/passes/p.wgsl", "@compute @workgroup_size(1) fn main() {}")],
            &[("core", "p\n+ default:\n")],
        );
        let text = render(&library);
        assert!(text.contains("modules! {\n    core::a [],\n    core::b [\"core::a\"],\n}\n"), "{text}");
        assert!(text.ends_with("passes! {\n    core/p,\n}\n\nsystems![core];\n"), "{text}");
        let many: Vec<String> = (0..40).map(|i| format!("\"core::module_{i}\"")).collect();
        assert!(wrapped(&many).lines().all(|line| line.len() <= WIDTH));
        assert_eq!(wrapped(&many).split_whitespace().collect::<String>(), many.join(","));
    }
}
