// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a shader file says of itself: its header, and the comments on its items.

/// The header of a shader file: `// key: text` and `// key NAME: text` before the first line of code.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Header {
    pub(super) summary: String,
    pub(super) source: String,
    pub(super) notes: Vec<String>,
    /// Names with their meaning.
    pub(super) definitions: Vec<(String, String)>,
    /// Names with their meaning.
    pub(super) bindings: Vec<(String, String)>,
}

impl Header {
    pub(super) fn new(source: &str) -> Self {
        let mut header = Self::default();
        for line in source.lines() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let Some(text) = line.strip_prefix("//").map(str::trim_start) else { break };
            let Some((key, text)) = text.split_once(':') else { continue };
            let text = text.trim().to_owned();
            let append = |to: &mut String| {
                let space = if to.is_empty() { "" } else { " " };
                to.push_str(space);
                to.push_str(&text);
            };
            match key.split_once(' ') {
                None if key == "summary" => append(&mut header.summary),
                None if key == "source" => append(&mut header.source),
                None if key == "note" => header.notes.push(text),
                Some(("definition", name)) => header.definitions.push((name.to_owned(), text)),
                Some(("binding", name)) => header.bindings.push((name.to_owned(), text)),
                _ => {}
            }
        }
        header
    }

    /// The meaning of a binding, empty where the header has none.
    pub(super) fn binding(&self, name: &str) -> &str {
        self.bindings.iter().find(|(of, _)| of == name).map_or("", |(_, text)| text)
    }
}

/// The items of a module: what is written before them and their first line.
pub(super) fn items(source: &str) -> Vec<(String, String)> {
    let mut items = Vec::new();
    let mut comment = Vec::new();
    let mut lines = source.lines();
    while let Some(line) = lines.next() {
        if let Some(text) = line.strip_prefix("///") {
            comment.push(text.trim());
        } else if ["fn ", "struct ", "const "].iter().any(|start| line.starts_with(start)) {
            let mut item = line.to_owned();
            // A signature may go over several lines.
            while line.starts_with("fn ") && !item.contains('{') {
                let Some(next) = lines.next() else { break };
                item.push(' ');
                item.push_str(next.trim());
            }
            let end = item.find('{').unwrap_or(item.len());
            items.push((item[..end].trim().to_owned(), comment.join(" ")));
            comment.clear();
        } else if !line.starts_with('@') {
            comment.clear();
        }
    }
    items
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::Shaders;

    #[test]
    fn headers_are_read() {
        let header = Header::new(
            "// SPDX-License-Identifier: MIT\n#define_import_path a::b\n\
             // summary: Does it.\n// source: a: b.\n// note: one\n\
             // note: two\n// definition M: how many.\n// binding x: out, metres.\nfn f() {}\n// summary: not this\n",
        );
        assert_eq!(header.summary, "Does it.");
        assert_eq!(header.source, "a: b.");
        assert_eq!(header.notes, ["one", "two"]);
        assert_eq!(header.definitions, [("M".to_owned(), "how many.".to_owned())]);
        assert_eq!(header.binding("x"), "out, metres.");
        assert_eq!(header.binding("y"), "");
    }

    #[test]
    fn every_builtin_pass_and_module_is_described() {
        let shaders = Shaders::builtin();
        for pass in shaders.library().passes() {
            let header = Header::new(&pass.source);
            assert!(!header.summary.is_empty(), "{}", pass.name);
            for permutation in shaders.library().permutations(&pass.name).unwrap() {
                let reflection = shaders.compose(&pass.name, &permutation.name).unwrap().reflect();
                for binding in reflection.bindings {
                    assert!(!header.binding(&binding.name).is_empty(), "{} {}", pass.name, binding.name);
                }
            }
        }
        for module in shaders.library().modules() {
            assert!(!Header::new(&module.source).summary.is_empty(), "{}", module.path);
            assert!(!items(&module.source).is_empty(), "{}", module.path);
        }
    }

    #[test]
    fn items_carry_their_comments() {
        let source = "// head\n/// What a is.\nconst A: u32 = 1u;\n\nfn f(\n    x: f32\n) -> f32 {\n    return x;\n}\n";
        let expected = [("const A: u32 = 1u;", "What a is."), ("fn f( x: f32 ) -> f32", "")];
        assert_eq!(items(source), expected.map(|(item, text)| (item.to_owned(), text.to_owned())));
    }
}
