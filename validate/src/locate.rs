// SPDX-License-Identifier: MIT OR Apache-2.0
//! From naga_oil's errors to the module's own file, line and column.
//!
//! naga_oil keeps lines while it preprocesses, but shifts columns (it replaces names) and prepends
//! a header; a span carries the number of its module in the bits above [`SPAN_BITS`].

use crate::{
    Error, Library, Location,
    names::undecorate,
    scan::{is_identifier, without_comments},
};
use naga_oil::compose::{Composer, ComposerError, ComposerErrorInner, ErrSource};

/// Bits of a span that are a position; naga_oil's `SPAN_SHIFT`.
const SPAN_BITS: u32 = 21;

/// The located form of a composer's error; `file` and `source` are what was being composed.
pub(crate) fn locate(
    error: &ComposerError,
    composer: &Composer,
    library: &Library,
    file: &str,
    source: &str,
) -> Error {
    let (file, preprocessed) = match &error.source {
        ErrSource::Module { name, .. } => match composer.module_sets.get(name) {
            Some(set) => (set.file_path.clone(), error.source.source(composer).into_owned()),
            None => (file.to_owned(), String::new()),
        },
        ErrSource::Constructing { path, source, .. } => (path.clone(), source.clone()),
    };
    let original = library.text(&file).unwrap_or(source).replace("\r\n", "\n");
    let (message, position) = describe(&error.inner, error.source.offset());
    let (line, column) = match position {
        Position::None => (None, None),
        Position::Line(line) => (Some(line), None),
        Position::Byte(byte) => place(&original, &preprocessed, byte),
        Position::Directive(byte, word) => (directive(&original, byte, word), None),
        Position::Text(text) => (line_with(&original, &text, ""), None),
    };
    // What the composer appends is beyond the end.
    let last = original.matches('\n').count() as u32 + 1;
    let line = line.map(|line: u32| line.clamp(1, last));
    let mut message = undecorate(&message);
    if let Some(hint) = hint(&message, library) {
        message = format!("{message}; {hint}");
    }
    Error::Shader { location: Location { file, line, column }, message }
}

/// Why an item that is there is not found by an importer.
fn hint(message: &str, library: &Library) -> Option<&'static str> {
    let path = message.strip_prefix("no definition in scope for identifier: `")?;
    let (module, item) = path.split('`').next()?.rsplit_once("::")?;
    let source = without_comments(&library.module(module).ok()?.source);
    let declares = |text: String| source.lines().any(|line| line.trim_start().starts_with(&text));
    if declares(format!("const {item} =")) {
        Some("a constant without a type cannot be imported; write it as `const NAME: f32 = …`")
    } else if declares(format!("override {item}")) {
        Some("a pipeline override cannot be imported by name")
    } else {
        None
    }
}

enum Position<'a> {
    None,
    /// A line, from 1.
    Line(u32),
    /// A byte of the preprocessed source.
    Byte(usize),
    /// Near a byte of the source: a directive, with a word in it.
    Directive(usize, &'a str),
    /// The first line with this text.
    Text(String),
}

fn describe(error: &ComposerErrorInner, offset: usize) -> (String, Position<'_>) {
    use ComposerErrorInner as E;
    let message = error.to_string();
    match error {
        E::WgslParseError(parse) => {
            let mut message = parse.message().to_owned();
            for note in parse.notes() {
                message = format!("{message}; {note}");
            }
            let spans = parse.labels().map(|(span, _)| span);
            (message, first_position(spans, offset))
        }
        E::HeaderValidationError(invalid) | E::ShaderValidationError(invalid) => {
            (chain(invalid.as_inner()), validation_position(invalid, offset))
        }
        E::InvalidIdentifier { original, at } => {
            let message = format!(
                "`{original}` would be renamed when composed: a name of a module must not end in \
                 a digit or `_`, hold `__`, be a reserved word, or be an `alias`"
            );
            let position = match first_position([*at], offset) {
                Position::None => Position::Text(undecorate(original)),
                position => position,
            };
            (message, position)
        }
        E::ImportNotFound(path, _) => {
            let short = path.rsplit("::").next().unwrap_or(path);
            (format!("import of `{path}`, which is no module"), Position::Text(short.to_owned()))
        }
        E::ImportParseError(_, at) => (message, Position::Directive(*at, "import")),
        E::UnknownShaderDef { pos, shader_def_name }
        | E::InvalidShaderDefComparisonValue { pos, shader_def_name, .. } => {
            (message, Position::Directive(*pos, shader_def_name))
        }
        E::UnknownShaderDefOperator { pos, .. } => (message, Position::Directive(*pos, "if")),
        E::InvalidShaderDefDefinitionValue { pos, .. } | E::DefineInModule(pos) => {
            (message, Position::Directive(*pos, "define"))
        }
        E::TooManyEndIfs(pos) => (message, Position::Directive(*pos, "endif")),
        E::ElseWithoutCondition(pos) => (message, Position::Directive(*pos, "else")),
        E::NotEnoughEndIfs(pos) => (message, Position::Byte(pos.saturating_sub(1))),
        E::OverrideNotVirtual { name, .. } => (message, Position::Text(format!("::{name}"))),
        E::DecorationInSource(range) => (message, Position::Byte(range.start)),
        E::InvalidWgslDirective { position, .. } => {
            (message, Position::Line(u32::try_from(*position).unwrap_or(0)))
        }
        E::NoModuleName => (message, Position::Line(1)),
        _ => (message, Position::None),
    }
}

/// The error and everything that it was caused by, in one line.
pub(crate) fn chain(error: &dyn std::error::Error) -> String {
    let mut parts = vec![error.to_string()];
    let mut next = error.source();
    while let Some(error) = next {
        let text = error.to_string();
        if parts.last() != Some(&text) {
            parts.push(text);
        }
        next = error.source();
    }
    parts.join(": ")
}

fn first_position(spans: impl IntoIterator<Item = naga::Span>, offset: usize) -> Position<'static> {
    let starts = spans.into_iter().filter_map(|span| Some(span.to_range()?.start));
    starts
        .filter_map(|start| (start & ((1 << SPAN_BITS) - 1)).checked_sub(offset))
        .map(Position::Byte)
        .next()
        .unwrap_or(Position::None)
}

/// naga reports the narrowest span first; naga_oil attributes the error by the last, so only spans
/// of that module count.
fn validation_position(
    error: &naga::WithSpan<naga::valid::ValidationError>,
    offset: usize,
) -> Position<'static> {
    let spans: Vec<naga::Span> = error.spans().map(|(span, _)| *span).collect();
    let module = |span: &naga::Span| span.to_range().map(|range| range.start >> SPAN_BITS);
    let Some(last) = spans.last().and_then(module) else {
        return Position::None;
    };
    first_position(spans.into_iter().filter(|span| module(span) == Some(last)), offset)
}

/// Line and column in the original of a byte in the preprocessed text.
fn place(original: &str, preprocessed: &str, byte: usize) -> (Option<u32>, Option<u32>) {
    let text = if preprocessed.is_empty() { original } else { preprocessed };
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    let before = &text[..byte];
    let line = before.matches('\n').count();
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    let (before, whole) = (&text[start..byte], text[start..].lines().next().unwrap_or_default());
    let own = original.lines().nth(line);
    let column = own.and_then(|own| {
        if own.starts_with(before) {
            return Some(before.chars().count());
        }
        // Names before the place have grown, but there are as many words and signs as there were.
        let (now, then) = (words(whole), words(own));
        let index = now.iter().position(|&at| at >= before.chars().count())?;
        (now.len() == then.len()).then(|| then[index])
    });
    (Some(line as u32 + 1), column.map(|column| column as u32 + 1))
}

/// Where the words and signs of a line begin, in characters: a path is one, and so is `#{NAME}`.
fn words(line: &str) -> Vec<usize> {
    let letters: Vec<char> = line.chars().collect();
    let mut starts = Vec::new();
    let mut at = 0;
    while at < letters.len() {
        let start = at;
        if letters[at..].starts_with(&['#', '{']) {
            let end = letters[at..].iter().position(|&letter| letter == '}');
            at = end.map_or(letters.len(), |end| at + end + 1);
        } else {
            let in_word = |at: usize| {
                let joins = letters[at..].starts_with(&[':', ':']);
                let joined = at > start && letters[at] == ':' && letters[at - 1] == ':';
                is_identifier(letters[at]) || joins || joined
            };
            while at < letters.len() && in_word(at) {
                at += 1;
            }
            at = at.max(start + 1);
        }
        if !letters[start].is_whitespace() {
            starts.push(start);
        }
    }
    starts
}

/// The first line with a word and another text, comments aside.
pub(crate) fn line_with(original: &str, word: &str, also: &str) -> Option<u32> {
    let code = without_comments(original);
    let index = code.lines().position(|line| {
        line.contains(also)
            && line.match_indices(word).any(|(at, _)| {
                let (before, after) = (&line[..at], &line[at + word.len()..]);
                !before.ends_with(is_identifier) && !after.starts_with(is_identifier)
            })
    })?;
    Some(index as u32 + 1)
}

/// The line of the directive nearest to a byte that holds a word: positions that naga_oil gives for
/// directives shift by what was substituted above them.
fn directive(original: &str, byte: usize, word: &str) -> Option<u32> {
    let mut start = 0_usize;
    let mut best: Option<(usize, u32)> = None;
    for (number, line) in (1..).zip(original.split('\n')) {
        if line.trim_start().starts_with('#') && line.contains(word) {
            let distance = start.abs_diff(byte);
            if best.is_none_or(|(nearest, _)| distance < nearest) {
                best = Some((distance, number));
            }
        }
        start += line.len() + 1;
    }
    best.map(|(_, number)| number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_survive_replaced_names() {
        let own = "  let a = m::f(x) + #{N} * n::o::g(bad);";
        let now = "  let a = fX_naga_oil_mod_XAAX(x) + 128 * gX_naga_oil_mod_XBBX(bad);";
        let text = |line: &str| format!("first\n{line}\nlast\n");
        let byte = text(now).find("bad").unwrap_or(0);
        let column = own.find("bad").map(|at| at as u32 + 1);
        assert_eq!(place(&text(own), &text(now), byte), (Some(2), column));
        // Where words were added, the line alone is certain.
        let now = now.replace("128", "- 128");
        let byte = text(&now).find("bad").unwrap_or(0);
        assert_eq!(place(&text(own), &text(&now), byte), (Some(2), None));
    }

    #[test]
    fn words_are_found_as_wholes() {
        let source = "#define A\n// Scale\nfn Scaled() {}\nconst Scale = 1;\n";
        assert_eq!(line_with(source, "Scale", "const"), Some(4));
        assert_eq!(line_with(source, "Missing", ""), None);
    }
}
