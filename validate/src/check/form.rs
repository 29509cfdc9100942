// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flat form of a composed module: what it loses, and what another compiler says of it.

use super::{
    lint::uniformity,
    origin::{self, Word},
    unit::{Context, about},
};
use crate::{
    Composed, EntryPoint, Location, Reflection,
    check::{Finding, Severity, Tool, tools},
    compose::validate,
    flat, locate,
};

/// The flat form parses, validates, has the same interface, and passes the other compiler.
pub(super) fn check(
    context: &Context,
    composed: &Composed,
    reflection: &Reflection,
    number: usize,
    findings: &mut Vec<Finding>,
) {
    // In a tree of others, what the writer of flat text cannot do is no fault of the shader.
    let severity = if context.is_foreign() { Severity::Warning } else { Severity::Error };
    let text = match flat::write(composed) {
        Ok(text) => text,
        Err(error) => return findings.push(Finding { severity, ..Finding::of("flat", &error) }),
    };
    let place = |line, column| origin::of_flat(&context.library, composed, &text, line, column);
    match naga::front::wgsl::parse_str(&text) {
        Err(error) => {
            let (line, column) = start(error.location(&text));
            let message = quoted(error.message(), &text, line);
            findings.push(Finding::new(severity, place(line, column), "flat", message));
        }
        Ok(module) => match validate(&module) {
            Err(error) => {
                let (line, column) = start(error.location(&text));
                let message = quoted(&locate::chain(error.as_inner()), &text, line);
                findings.push(Finding::new(severity, place(line, column), "flat", message));
            }
            Ok(info) => {
                let again = Reflection::new(&module, &info);
                if let Some(message) = difference(reflection, &again).filter(|_| !context.is_foreign()) {
                    findings.push(about(composed, Severity::Error, "flat", message));
                }
            }
        },
    }
    if let Some(program) = context.tool(Tool::Tint) {
        let path = context.file(number, "wgsl");
        // Tint wants an entry point.
        let entry_point = match reflection.entry_points.is_empty() {
            true => "\n@compute @workgroup_size(1)\nfn airlight_check() {}\n",
            false => "",
        };
        for diagnostic in tools::tint(program, &format!("{text}{entry_point}"), &path) {
            let message = quoted(&diagnostic.message, &text, diagnostic.line);
            let location = place(diagnostic.line, diagnostic.column);
            findings.push(Finding::new(diagnostic.severity, location, diagnostic.check(), message));
        }
    } else {
        for hit in uniformity::find(&composed.module) {
            let word = Word { declaration: &hit.function, word: hit.word, ordinal: hit.ordinal, total: None };
            let location = origin::of_word(&context.library, composed, word);
            findings.push(Finding::new(Severity::Error, location, "uniformity", hit.message()));
        }
    }
}

/// The flat file that ships has the expressions of the sources, where naga's writer sets brackets that the other compiler
/// may ask for.
pub(super) fn check_shipped(
    context: &Context,
    composed: &Composed,
    permutation: &str,
    number: usize,
    findings: &mut Vec<Finding>,
) {
    let Some(program) = context.tool(Tool::Tint).filter(|_| !context.is_foreign()) else { return };
    let text = match flat::text(&context.library, &composed.pass, permutation) {
        Ok(text) => text,
        Err(error) => return findings.push(Finding::of("flat", &error)),
    };
    for diagnostic in tools::tint(program, &text, &context.file(number, "wgsl")) {
        let message = quoted(&diagnostic.message, &text, diagnostic.line);
        let location = Location::file(&composed.file);
        let finding = Finding::new(diagnostic.severity, location, diagnostic.check(), message);
        // What both forms have is said once, with its place.
        if !findings.iter().any(|said| said.check == finding.check && said.severity == finding.severity) {
            findings.push(finding);
        }
    }
}

/// Line and column of a place that naga gives.
fn start(location: Option<naga::SourceLocation>) -> (Option<u32>, Option<u32>) {
    (location.map(|at| at.line_number), location.map(|at| at.line_position))
}

/// The message with the line of the flat file that it is about, which no one has open.
fn quoted(message: &str, text: &str, line: Option<u32>) -> String {
    let code = line.and_then(|line| text.lines().nth(line.saturating_sub(1) as usize));
    match code {
        Some(code) => format!("{message}; in `{}`", code.trim()),
        None => message.to_owned(),
    }
}

/// What the flat form lost, if anything.
fn difference(before: &Reflection, after: &Reflection) -> Option<String> {
    for binding in &before.bindings {
        if !after.bindings.contains(binding) {
            return Some(format!("the flat form does not keep the binding {binding:?}"));
        }
    }
    for layout in &before.structs {
        if !after.structs.contains(layout) {
            let name = &layout.name;
            return Some(format!(
                "the flat form does not keep the names or the layout of struct `{name}`: use \
                 padding members instead of `@size` and `@align`, and no name that ends in a digit"
            ));
        }
    }
    // Arguments are told apart by their locations; the writer numbers names that come twice.
    let nameless = |entry: &EntryPoint| {
        let mut entry = entry.clone();
        entry.inputs.iter_mut().for_each(|input| input.name.clear());
        entry
    };
    let kept: Vec<EntryPoint> = after.entry_points.iter().map(nameless).collect();
    for entry in &before.entry_points {
        if !kept.contains(&nameless(entry)) {
            let name = &entry.name;
            return Some(format!("the flat form does not keep the entry point `{name}` as it is"));
        }
    }
    None
}
