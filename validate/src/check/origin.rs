// SPDX-License-Identifier: MIT OR Apache-2.0
//! From a place in a composed text to the file that it comes from.
//!
//! The writer of flat text keeps names and their order inside a declaration, not lines. So a place
//! is the declaration around it, a word, and how many of that word come before it there.

use crate::{
    Composed, Library, Location,
    check::lint::{
        text::active,
        tokens::{Declaration, Token, declarations, tokens},
    },
};

/// A word in a declaration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<'a> {
    /// Name of the declaration.
    pub declaration: &'a str,
    pub word: &'a str,
    /// How many of the word come before it in the declaration.
    pub ordinal: usize,
    /// How many of the word the declaration has, where that is known.
    pub total: Option<usize>,
}

/// The own place of a line and column (in bytes) of the flat text.
pub(crate) fn of_flat(
    library: &Library,
    composed: &Composed,
    flat: &str,
    line: Option<u32>,
    column: Option<u32>,
) -> Location {
    let unknown = Location::file(&composed.file);
    let Some(line) = line else { return unknown };
    let tokens = tokens(flat);
    let found = declarations(&tokens);
    let last_line = |declaration: &Declaration| tokens[declaration.range.end - 1].line;
    let Some(declaration) = found.iter().find(|declaration| last_line(declaration) >= line) else {
        return unknown;
    };
    let column = column.map(|column| characters(flat, line, column));
    let at = word_at(&tokens, line, column).filter(|at| declaration.range.contains(at));
    let at = at.unwrap_or(declaration.at);
    let word = tokens[at].text;
    let among =
        |range: std::ops::Range<usize>| tokens[range].iter().filter(|token| token.text == word).count();
    let word = Word {
        declaration: declaration.name,
        word,
        ordinal: among(declaration.range.start..at),
        total: Some(among(declaration.range.clone())),
    };
    of_word(library, composed, word)
}

/// The column in characters of a column in bytes, both from 1.
pub(crate) fn characters(text: &str, line: u32, column: u32) -> u32 {
    let bytes = column.saturating_sub(1) as usize;
    let line = text.lines().nth(line.saturating_sub(1) as usize).unwrap_or_default();
    line.char_indices().take_while(|(at, _)| *at < bytes).count() as u32 + 1
}

/// The word at a place: that under the column, or the first of the line.
fn word_at(tokens: &[Token], line: u32, column: Option<u32>) -> Option<usize> {
    let first = tokens.iter().position(|token| token.line == line)?;
    let under = |token: &Token, column: u32| {
        token.column <= column && column < token.column + token.text.chars().count() as u32
    };
    let on_line = tokens[first..].iter().take_while(|token| token.line == line);
    let at = column.and_then(|column| on_line.clone().position(|token| under(token, column)));
    Some(first + at.unwrap_or(0))
}

/// The own place of a declaration of a composed module, by its readable name.
pub(crate) fn of_declaration(library: &Library, composed: &Composed, name: &str) -> Location {
    of_word(library, composed, Word { declaration: name, word: name, ordinal: 0, total: None })
}

/// The own place of a word; of its declaration where the word is not certain, and of the file where neither is.
pub(crate) fn of_word(library: &Library, composed: &Composed, wanted: Word) -> Location {
    let imports = match library.pass(&composed.pass) {
        Ok(pass) => pass.imports.clone(),
        Err(_) => vec![composed.pass.clone()],
    };
    let modules = library.closure(&imports);
    let own = library.text(&composed.file).map(|source| (composed.file.as_str(), "", source));
    let modules = modules.iter().map(|module| {
        let short = module.path.rsplit("::").next().unwrap_or_default();
        (module.file.as_str(), short, module.source.as_str())
    });
    for (file, module, source) in own.into_iter().chain(modules) {
        // An ambiguous name has its module's before it.
        let plain =
            |name: &str| name.strip_prefix(module).and_then(|name| name.strip_prefix('_')).map(str::to_owned);
        let code = active(source, &composed.definitions);
        let tokens = tokens(&code);
        let found = declarations(&tokens);
        let short = plain(wanted.declaration);
        let declaration = found
            .iter()
            .find(|found| found.name == wanted.declaration || Some(found.name) == short.as_deref());
        if let Some(declaration) = declaration {
            let token = word_in(&tokens, declaration, wanted).unwrap_or(&tokens[declaration.at]);
            let (line, column) = (Some(token.line), Some(token.column));
            return Location { file: file.to_owned(), line, column };
        }
    }
    Location::file(&composed.file)
}

/// The word in the source's own declaration, if that has as many of it.
fn word_in<'a, 'b>(
    tokens: &'b [Token<'a>],
    declaration: &Declaration,
    wanted: Word,
) -> Option<&'b Token<'a>> {
    let range = tokens.get(declaration.range.clone())?;
    let spelt: Vec<&Token> = range.iter().filter(|token| token.text == wanted.word).collect();
    let is_same = wanted.total.is_none_or(|total| total == spelt.len());
    match spelt.len() {
        1 => spelt.first().copied(),
        _ if is_same => spelt.get(wanted.ordinal).copied(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Definitions, flat};

    #[test]
    fn words_of_the_flat_text_are_found_in_their_files() {
        let module = "#define_import_path m::leaf\n\nfn f(x: f32) -> f32 {\n    let y = sin(x); // sin\n    return sin(y);\n}\n";
        let pass = "#import m::leaf\n@group(0) @binding(0) var<storage, read_write> b: array<f32>;\n@compute @workgroup_size(1)\nfn main() {\n    b[0] = leaf::f(1.0);\n  workgroupBarrier();\n}\n";
        let library = Library::from_text(
            &[("m/leaf.wgsl", module)],
            &[("m/passes/p.wgsl", pass)],
            &[("m", "p\n+ default:\n")],
        );
        let composed = library.compose("m/p", &Definitions::new()).unwrap();
        let text = flat::write(&composed).unwrap();
        let place = |word: &str, nth: usize| {
            let (at, _) = text.match_indices(word).nth(nth).unwrap();
            let line = text[..at].matches('\n').count() as u32 + 1;
            let column = at - text[..at].rfind('\n').map_or(0, |at| at + 1) + 1;
            of_flat(&library, &composed, &text, Some(line), Some(column as u32)).to_string()
        };
        assert_eq!(place("sin", 0), "m/leaf.wgsl:4:13");
        assert_eq!(place("sin", 1), "m/leaf.wgsl:5:12");
        assert_eq!(place("workgroupBarrier", 0), "m/passes/p.wgsl:6:3");
        assert_eq!(of_declaration(&library, &composed, "b").to_string(), "m/passes/p.wgsl:2:48");
        assert_eq!(of_flat(&library, &composed, &text, None, None).to_string(), "m/passes/p.wgsl");
    }
}
