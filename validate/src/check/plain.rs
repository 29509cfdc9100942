// SPDX-License-Identifier: MIT OR Apache-2.0
//! A file without directives, straight through naga and Tint: their places are its own.

use super::{
    lint::uniformity,
    origin::characters,
    tools,
    unit::{Context, check_backends, check_limits},
};
use crate::{
    Composed, Definitions, Location,
    check::{Finding, Severity, Tool},
    compose::validate,
    locate,
};

/// All findings about a plain file.
pub(super) fn check(context: &Context, file: &str, number: usize) -> Vec<Finding> {
    let Some(source) = context.library.text(file) else { return Vec::new() };
    let mut findings = Vec::new();
    let place = |line: Option<u32>, column: Option<u32>| {
        let column = line.zip(column).map(|(line, column)| characters(source, line, column));
        Location { file: file.to_owned(), line, column }
    };
    let span = |span: Option<naga::SourceLocation>| {
        place(span.map(|at| at.line_number), span.map(|at| at.line_position))
    };
    match naga::front::wgsl::parse_str(source) {
        Err(error) => {
            let mut message = error.message().to_owned();
            for note in error.notes() {
                message = format!("{message}; {note}");
            }
            findings.push(Finding::new(Severity::Error, span(error.location(source)), "compose", message));
        }
        Ok(module) => match validate(&module) {
            Err(error) => {
                let message = locate::chain(error.as_inner());
                findings.push(Finding::new(
                    Severity::Error,
                    span(error.location(source)),
                    "compose",
                    message,
                ));
            }
            Ok(info) => {
                let (pass, definitions) = (file.to_owned(), Definitions::new());
                let composed = Composed { file: pass.clone(), pass, definitions, module, info };
                compiled(context, &composed, number, &mut findings);
                if context.tool(Tool::Tint).is_none() {
                    for hit in uniformity::find(&composed.module) {
                        let location = span(Some(hit.span.location(source)));
                        findings.push(Finding::new(Severity::Error, location, "uniformity", hit.message()));
                    }
                }
            }
        },
    }
    if let Some(program) = context.tool(Tool::Tint) {
        // Tint wants an entry point; one more on the last line moves nothing.
        let entry_point = "\n@compute @workgroup_size(1) fn airlight_check() {}\n";
        for diagnostic in
            tools::tint(program, &format!("{source}{entry_point}"), &context.file(number, "wgsl"))
        {
            let lines = source.matches('\n').count() as u32 + 1;
            let line = diagnostic.line.map(|line| line.min(lines));
            let location = place(line, diagnostic.column);
            let message = diagnostic.message.clone();
            findings.push(Finding::new(diagnostic.severity, location, diagnostic.check(), message));
        }
    }
    for finding in &mut findings {
        finding.pass = Some(file.to_owned());
    }
    findings
}

/// What a file that compiles needs of a device and of the back ends.
fn compiled(context: &Context, composed: &Composed, number: usize, findings: &mut Vec<Finding>) {
    let reflection = composed.reflect();
    let place = |name: &str| super::origin::of_declaration(&context.library, composed, name);
    check_limits(&reflection, "default", place, findings);
    check_backends(context, composed, &reflection, "default", number, findings);
}
