// SPDX-License-Identifier: MIT OR Apache-2.0
//! A file with one set of definitions, as the lints read it.

use super::tokens::{Declaration, Token, declarations, tokens};
use crate::{
    Definitions, Location,
    check::{Finding, Severity},
    imports,
};

/// The parts of a file that a set of definitions leaves.
pub(crate) struct Text<'a> {
    pub file: &'a str,
    /// Whether other files can import it.
    pub is_module: bool,
    /// Whether a composer reads it.
    pub is_composed: bool,
    /// Without comments and inactive parts; lines and columns are those of the file.
    pub code: &'a str,
    pub tokens: Vec<Token<'a>>,
    pub declarations: Vec<Declaration<'a>>,
}

/// What [`Text`] reads.
pub(crate) fn active(source: &str, definitions: &Definitions) -> String {
    imports::active(source, definitions)
}

impl<'a> Text<'a> {
    pub fn new(file: &'a str, code: &'a str, is_module: bool, is_composed: bool) -> Self {
        let tokens = tokens(code);
        let declarations = declarations(&tokens);
        Self { file, is_module, is_composed, code, tokens, declarations }
    }

    /// A finding at a token.
    pub fn at(&self, token: &Token, severity: Severity, lint: &str, message: String) -> Finding {
        self.place(token.line, token.column, severity, lint, message)
    }

    /// A finding at a line and column.
    pub fn place(&self, line: u32, column: u32, severity: Severity, lint: &str, message: String) -> Finding {
        let location = Location { file: self.file.to_owned(), line: Some(line), column: Some(column) };
        Finding::new(severity, location, lint, message)
    }

    /// The word or sign at an index; empty beyond the end.
    pub fn text(&self, index: usize) -> &'a str {
        self.tokens.get(index).map_or("", |token| token.text)
    }
}

/// The lint's findings in a text, as `line:column`.
#[cfg(test)]
pub(crate) fn places(find: impl Fn(&Text, &mut Vec<Finding>), lint: &str, source: &str) -> Vec<String> {
    let is_module = source.contains("#define_import_path");
    let code = active(source, &Definitions::new());
    let text = Text::new("a.wgsl", &code, is_module, is_module || source.contains('#'));
    let mut findings = Vec::new();
    find(&text, &mut findings);
    assert!(findings.iter().all(|finding| finding.check == lint), "{findings:?}");
    let place = |finding: &Finding| format!("{}:{}", finding.line.unwrap_or(0), finding.column.unwrap_or(0));
    findings.iter().map(place).collect()
}
