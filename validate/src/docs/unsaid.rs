// SPDX-License-Identifier: MIT OR Apache-2.0
//! What modules leave unsaid: parameters without a word, headers without equations or error bounds.

use super::{Kind, described, header, items};
use crate::Library;
use std::collections::BTreeSet;

/// What is missing in the headers and comments of modules, each as `FILE:LINE: what`.
///
/// A module has at least one line `// equation:` and one `// error:`. Each parameter of a function is named in the
/// comment of the function in backticks, or explained for the whole module by `// parameter NAME: …`, or is of a struct
/// of the library, whose members have comments of their own.
pub fn unsaid(library: &Library) -> Vec<String> {
    let modules = library.modules().iter();
    let all: Vec<_> = modules.map(|module| (module, header(&module.source), items(&module.source))).collect();
    let structs: BTreeSet<&str> = all
        .iter()
        .flat_map(|(_, _, items)| items)
        .filter(|item| item.kind == Kind::Struct)
        .map(|item| item.name.as_str())
        .collect();
    let mut missing = Vec::new();
    for (module, header, items) in &all {
        let file = &module.file;
        if header.equations.is_empty() {
            missing.push(format!("{file}:1: no line `// equation: …`"));
        }
        if header.errors.is_empty() {
            missing.push(format!("{file}:1: no line `// error: …`"));
        }
        for (name, text) in &header.parameters {
            let used = items.iter().flat_map(|item| &item.parts).any(|part| part.name == *name);
            if !used || text.len() < 5 {
                missing.push(format!("{file}:1: `// parameter {name}` explains nothing"));
            }
        }
        for item in items.iter().filter(|item| item.kind == Kind::Function) {
            for part in &item.parts {
                let ty = part.ty.trim_start_matches("ptr<function, ").trim_end_matches('>');
                let shared = header.parameters.iter().any(|(name, _)| *name == part.name);
                if !structs.contains(ty) && !shared && described(&item.docs, &part.name).is_none() {
                    missing.push(format!(
                        "{file}:{}: `{}` says neither unit nor range of `{}: {}`",
                        item.line, item.name, part.name, part.ty
                    ));
                }
            }
        }
    }
    missing
}
