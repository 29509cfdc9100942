// SPDX-License-Identifier: MIT OR Apache-2.0
//! Constants of a module that importers cannot see.

use super::text::Text;
use crate::check::{Finding, Severity};
use std::collections::BTreeSet;

/// `const X = 0.5` in a module: a value without a concrete type is lost on import.
pub(super) fn find(text: &Text, findings: &mut Vec<Finding>) {
    if !text.is_module {
        return;
    }
    let mut abstracts: BTreeSet<&str> = BTreeSet::new();
    for declaration in text.declarations.iter().filter(|declaration| declaration.keyword == "const") {
        let tokens = &text.tokens[declaration.at..declaration.range.end];
        if tokens.get(1).is_none_or(|next| next.text != "=") {
            continue;
        }
        let value = &tokens[2..];
        let is_abstract = value.iter().all(|token| match token.text {
            // Templates, members, comparisons, text for the preprocessor: something else than a plain number.
            "<" | ">" | "==" | "!=" | "<=" | ">=" | "&&" | "||" | "!" | "::" => false,
            _ if token.is_number() => is_abstract_number(token.text),
            "vec2" | "vec3" | "vec4" | "array" => true,
            name if token.is_word() => abstracts.contains(name) || is_math(name),
            _ => true,
        });
        if is_abstract && value.iter().any(|token| token.is_number() || token.is_word()) {
            abstracts.insert(declaration.name);
            let name = declaration.name;
            let message = format!(
                "constant `{name}` has no concrete type and cannot be imported; write `const {name}: f32 = …`"
            );
            findings.push(text.at(
                &text.tokens[declaration.at],
                Severity::Warning,
                "abstract-const",
                message,
            ));
        }
    }
}

fn is_abstract_number(text: &str) -> bool {
    let is_hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    let suffixes: &[char] = if is_hexadecimal { &['u', 'i'] } else { &['u', 'i', 'f', 'h'] };
    !text.ends_with(suffixes)
}

/// Functions whose result is abstract for abstract arguments.
fn is_math(name: &str) -> bool {
    matches!(
        name,
        "abs" | "cos" | "exp" | "floor" | "log" | "max" | "min" | "pow" | "radians" | "sin" | "sqrt" | "tan"
    )
}

#[cfg(test)]
mod tests {
    use super::{super::text::places, *};

    #[test]
    fn constants_without_a_type_are_found() {
        let source = "#define_import_path m\nconst A = 0.5;\n  const B = 2 * A;\nconst C = vec2(1, 2);\nconst D = sqrt(2.0);\n";
        assert_eq!(places(find, "abstract-const", source), ["2:7", "3:9", "4:7", "5:7"]);
    }

    #[test]
    fn typed_constants_are_left() {
        let source = "#define_import_path m\nconst A: f32 = 0.5;\nconst B = 4u;\nconst C = vec2<f32>(1, 2);\nconst D = f32(1);\nconst E = 1.0f;\nconst F = true;\nconst G = vec3f(1.0);\nfn f() { const local = 1; }\n";
        assert!(places(find, "abstract-const", source).is_empty());
        // A pass is imported by nobody.
        assert!(places(find, "abstract-const", "const A = 0.5;\n").is_empty());
    }
}
