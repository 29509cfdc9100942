// SPDX-License-Identifier: MIT OR Apache-2.0
//! Functions, structs and constants of a shader as its text has them, with their `///` comments.

/// What an item is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `fn`
    Function,
    /// `struct`
    Struct,
    /// `const`
    Constant,
}

/// A documented item.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// What it is.
    pub kind: Kind,
    /// Its name.
    pub name: String,
    /// Its line, from 1.
    pub line: u32,
    /// Its `///` comment as one line.
    pub docs: String,
    /// A function's signature, a constant's declaration; of a struct `struct NAME`.
    pub declaration: String,
    /// A function's parameters or a struct's members.
    pub parts: Vec<Part>,
    /// Directives that it stands in, `#ifdef X` from the outermost on.
    pub conditions: Vec<String>,
}

/// A parameter or a member.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// Its type as the source has it.
    pub ty: String,
    /// A member's own `///` comment.
    pub docs: String,
}

/// The items of a source in its order; entry points are not among them.
pub fn items(source: &str) -> Vec<Item> {
    let lines: Vec<&str> = source.lines().collect();
    let mut found = Vec::new();
    let mut docs: Vec<&str> = Vec::new();
    let mut conditions: Vec<String> = Vec::new();
    let mut entry = false;
    let mut index = 0;
    while index < lines.len() {
        let line = lines[index];
        if let Some(text) = line.strip_prefix("///") {
            docs.push(text.trim());
        } else if line.starts_with("#") {
            condition(line, &mut conditions);
        } else if line.starts_with('@') {
            entry = !line.contains("@group");
            docs.clear();
        } else if let Some((kind, name)) = begin(line) {
            let end = end_of(&lines, index, kind);
            if !entry {
                let (declaration, parts) = match kind {
                    Kind::Function => function(&lines[index..=end]),
                    Kind::Struct => (format!("struct {name}"), members(&lines[index + 1..=end])),
                    Kind::Constant => (line.trim_end_matches(';').to_owned(), Vec::new()),
                };
                found.push(Item {
                    kind,
                    name: name.to_owned(),
                    line: index as u32 + 1,
                    docs: docs.join(" "),
                    declaration,
                    parts,
                    conditions: conditions.clone(),
                });
            }
            entry = false;
            docs.clear();
            index = end;
        } else {
            docs.clear();
        }
        index += 1;
    }
    found
}

/// What a line begins.
fn begin(line: &str) -> Option<(Kind, &str)> {
    let kinds = [("fn ", Kind::Function), ("struct ", Kind::Struct), ("const ", Kind::Constant)];
    let (rest, kind) = kinds.into_iter().find_map(|(word, kind)| Some((line.strip_prefix(word)?, kind)))?;
    let end = rest.find(|letter| !crate::scan::is_identifier(letter)).unwrap_or(rest.len());
    Some((kind, &rest[..end]))
}

/// The last line of a signature, of a struct, or of a constant.
fn end_of(lines: &[&str], begin: usize, kind: Kind) -> usize {
    let ends = |line: &str| match kind {
        Kind::Function => line.trim_end().ends_with('{'),
        Kind::Struct => line.starts_with('}') || line.ends_with('}'),
        Kind::Constant => line.trim_end().ends_with(';'),
    };
    (begin..lines.len()).find(|&at| ends(lines[at])).unwrap_or(begin)
}

/// Takes a directive into account.
fn condition(line: &str, conditions: &mut Vec<String>) {
    let line = line.trim();
    if line.starts_with("#endif") {
        conditions.pop();
    } else if line.starts_with("#if") {
        conditions.push(line.to_owned());
    } else if line.starts_with("#else") {
        let before = conditions.pop().unwrap_or_default();
        conditions.push(format!("{line} of {before}"));
    }
}

/// Signature and parameters.
fn function(lines: &[&str]) -> (String, Vec<Part>) {
    let text = lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
    let text = text.trim_end_matches('{').trim_end().replace("( ", "(").replace(" )", ")").replace(",)", ")");
    let open = text.find('(').unwrap_or(0);
    let mut depth = 0;
    let mut parts = vec![String::new()];
    for letter in text[open..].chars().skip(1) {
        match letter {
            '(' | '<' => depth += 1,
            ')' if depth == 0 => break,
            ')' | '>' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(last) = parts.last_mut() {
            last.push(letter);
        }
    }
    let parts = parts.iter().filter_map(|part| part.split_once(':')).map(|(name, ty)| Part {
        name: name.trim().to_owned(),
        ty: ty.trim().to_owned(),
        docs: String::new(),
    });
    (text.clone(), parts.collect())
}

/// Members of a struct; of those that directives leave out, too.
fn members(lines: &[&str]) -> Vec<Part> {
    let mut docs: Vec<&str> = Vec::new();
    let mut members: Vec<Part> = Vec::new();
    for line in lines.iter().map(|line| line.trim()) {
        if let Some(text) = line.strip_prefix("///") {
            docs.push(text.trim());
        } else if let Some((name, ty)) = line.split_once(": ").filter(|_| !line.starts_with("//")) {
            let name = name.rsplit(' ').next().unwrap_or(name).to_owned();
            let ty = ty.trim_end_matches(',').to_owned();
            if !members.iter().any(|member| member.name == name && member.ty == ty) {
                members.push(Part { name, ty, docs: docs.join(" ") });
            }
            docs.clear();
        }
    }
    members
}

/// What a comment says of a parameter: the text behind `` `name`: ``, or `None` where it does not name it; empty where
/// it names it in passing.
pub fn described(docs: &str, name: &str) -> Option<String> {
    let quoted = format!("`{name}`");
    let mut named = None;
    for (at, _) in docs.match_indices(&quoted) {
        let mut rest = &docs[at + quoted.len()..];
        // `a`, `b` and `c`: the text belongs to all.
        while let Some(next) = [", `", " and `", ": `"].iter().find_map(|between| rest.strip_prefix(between))
        {
            match next.split_once('`') {
                Some((other, after)) if !other.contains(' ') => rest = after,
                _ => break,
            }
        }
        if let Some(text) = rest.strip_prefix(": ") {
            return Some(sentence(text));
        }
        named.get_or_insert_with(String::new);
    }
    named
}

/// Up to the next parameter or the end of the sentence.
fn sentence(text: &str) -> String {
    let letters: Vec<(usize, char)> = text.char_indices().collect();
    for (index, &(at, letter)) in letters.iter().enumerate() {
        let rest = &text[at + letter.len_utf8()..];
        let next = rest.trim_start().chars().next();
        let ends = match letter {
            ';' => rest.starts_with(" `"),
            '.' => {
                let inside = index > 0 && letters[index - 1].1 == '.';
                rest.starts_with(' ')
                    && !inside
                    && next.is_some_and(|next| next.is_uppercase() || next == '`')
            }
            _ => false,
        };
        if ends {
            return text[..at].to_owned();
        }
    }
    text.trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const SOURCE: &str = "/// A number.\nconst X: f32 = 1.0;\n\n/// A place.\nstruct Place {\n    /// Metres.\n    at: vec3<f32>,\n#ifdef WIDE\n    /// More.\n    more: f32,\n#endif\n}\n\n#ifdef A\n/// Adds `a`, metres,\n/// to it. `b`, `c`: 0..1; `d`: radians.\nfn add(\n    p: ptr<function, f32>, a: f32, b: f32,\n    c: f32, d: f32\n) -> f32 {\n    return a;\n}\n#endif\n\n/// Not one.\n@compute @workgroup_size(1)\nfn main() {\n}\n";

    #[test]
    fn items_have_their_parts() {
        let found = items(SOURCE);
        let names: Vec<&str> = found.iter().map(|item| item.name.as_str()).collect();
        assert_eq!(names, ["X", "Place", "add"]);
        assert_eq!(found[0].declaration, "const X: f32 = 1.0");
        assert_eq!(found[1].parts.len(), 2);
        assert_eq!(
            (found[1].parts[0].ty.as_str(), found[1].parts[0].docs.as_str()),
            ("vec3<f32>", "Metres.")
        );
        let add = &found[2];
        assert_eq!(add.declaration, "fn add(p: ptr<function, f32>, a: f32, b: f32, c: f32, d: f32) -> f32");
        let parts: Vec<&str> = add.parts.iter().map(|part| part.ty.as_str()).collect();
        assert_eq!(parts, ["ptr<function, f32>", "f32", "f32", "f32", "f32"]);
        assert_eq!(add.conditions, ["#ifdef A"]);
        assert_eq!(add.line, 17);
        assert_eq!(described(&add.docs, "a").as_deref(), Some(""));
        assert_eq!(described(&add.docs, "b").as_deref(), Some("0..1"));
        assert_eq!(described(&add.docs, "c").as_deref(), Some("0..1"));
        assert_eq!(described(&add.docs, "d").as_deref(), Some("radians"));
        assert_eq!(described(&add.docs, "p"), None);
    }
}
