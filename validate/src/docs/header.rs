// SPDX-License-Identifier: MIT OR Apache-2.0
//! The header of a shader: lines `// key: text` before its first item.

/// What the header of a shader says of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Header {
    /// What it computes, one sentence.
    pub summary: String,
    /// Paper, section, equation.
    pub source: String,
    /// What else there is to know, line by line as it stands.
    pub notes: Vec<String>,
    /// Its formulas, or what it does where it has none.
    pub equations: Vec<String>,
    /// Error bounds: each with the test that enforces it, `file::test` below `tests/tests`; none for what has no test
    /// of its own.
    pub errors: Vec<Budget>,
    /// Parameters that several of its functions share, with what they are.
    pub parameters: Vec<(String, String)>,
    /// Definitions that it reads, with what they do.
    pub definitions: Vec<(String, String)>,
    /// Resources that it binds, with what they hold.
    pub bindings: Vec<(String, String)>,
}

/// An error bound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Budget {
    /// The bound, in words.
    pub bound: String,
    /// The test that enforces it, `file::test` or `folder/file::test`.
    pub test: Option<String>,
}

/// Reads the header of a shader.
pub fn header(source: &str) -> Header {
    let mut header = Header::default();
    let lines =
        source.lines().take_while(|line| line.starts_with("//") || line.starts_with("#define_import_path"));
    for line in lines.filter_map(|line| line.strip_prefix("// ")) {
        let Some((key, text)) = line.split_once(':') else { continue };
        let text = text.strip_prefix(' ').unwrap_or(text);
        match key.split_once(' ') {
            None => match key {
                "summary" => text.clone_into(&mut header.summary),
                "source" => text.clone_into(&mut header.source),
                "note" => header.notes.push(text.to_owned()),
                "equation" => header.equations.push(text.to_owned()),
                "error" => budget(text, &mut header.errors),
                _ => {}
            },
            Some((key, names)) => {
                let list = match key {
                    "parameter" => &mut header.parameters,
                    "definition" => &mut header.definitions,
                    "binding" => &mut header.bindings,
                    _ => continue,
                };
                list.extend(names.split(", ").map(|name| (name.to_owned(), text.to_owned())));
            }
        }
    }
    header
}

/// `BOUND; test FILE::NAME.`, or in two lines: `BOUND;` and `test FILE::NAME.`
fn budget(text: &str, errors: &mut Vec<Budget>) {
    let named = |test: &str| Some(test.trim_end_matches('.').to_owned());
    if let (Some(test), Some(last)) = (text.strip_prefix("test "), errors.last_mut()) {
        last.test = named(test);
        return;
    }
    let (bound, test) = match text.rsplit_once("; test ") {
        Some((bound, test)) => (bound, named(test)),
        None => (text.trim_end_matches(';'), None),
    };
    errors.push(Budget { bound: bound.to_owned(), test });
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_key_is_read() {
        let source = "// SPDX\n#define_import_path a::b\n// summary: S.\n// source: T.\n// note: one\n// note: two\n\
            // equation: x = 1\n// equation:   + 2\n// error: within 1e-6; test core/values::all.\n// error: exact;\n// error: test a::b.\n\
            // parameter p, q: metres.\n// definition D: d.\n// binding b: c.\n\n// note: behind it\n";
        let found = header(source);
        assert_eq!((found.summary.as_str(), found.source.as_str()), ("S.", "T."));
        assert_eq!(found.notes, ["one", "two"]);
        assert_eq!(found.equations, ["x = 1", "  + 2"]);
        assert_eq!(found.errors[0].bound, "within 1e-6");
        assert_eq!(found.errors[0].test.as_deref(), Some("core/values::all"));
        assert_eq!(
            (found.errors[1].bound.as_str(), &found.errors[1].test),
            ("exact", &Some("a::b".to_owned()))
        );
        let names: Vec<&str> = found.parameters.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["p", "q"]);
        assert_eq!(found.definitions, [("D".to_owned(), "d.".to_owned())]);
        assert_eq!(found.bindings.len(), 1);
    }
}
