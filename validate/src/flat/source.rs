// SPDX-License-Identifier: MIT OR Apache-2.0
//! A shader's text with directives carried out: conditions decided, definitions put in, imported names
//! decorated as naga_oil decorates them, and the lines that this leaves empty taken out.

use naga_oil::compose::{ShaderDefValue, get_preprocessor_data, preprocess::Preprocessor};
use std::{collections::HashMap, sync::LazyLock};

static PREPROCESSOR: LazyLock<Preprocessor> = LazyLock::new(Preprocessor::default);

/// Definitions that a source makes itself with `#define`.
pub(super) fn own_definitions(source: &str) -> HashMap<String, ShaderDefValue> {
    get_preprocessor_data(source).2
}

/// The text without directives and without the header; what is wrong with it otherwise.
pub(super) fn resolve(source: &str, definitions: &HashMap<String, ShaderDefValue>) -> Result<String, String> {
    let resolved = PREPROCESSOR.preprocess(source, definitions).map_err(|error| error.to_string())?;
    let header = header(source).count();
    let mut text = String::with_capacity(resolved.preprocessed_source.len());
    let mut before = "";
    for (line, original) in resolved.preprocessed_source.lines().zip(source.lines()).skip(header) {
        let line = line.trim_end();
        let taken_out = line.is_empty() && !original.trim().is_empty();
        // No blank line at the beginning of a block, at its end, or twice.
        let needless = line.is_empty() && (before.is_empty() || before.ends_with('{'));
        if taken_out || needless {
            continue;
        }
        if line.trim_start().starts_with('}') && text.ends_with("\n\n") {
            text.pop();
        }
        text.push_str(line);
        text.push('\n');
        before = line;
    }
    Ok(text)
}

/// The lines of comment that a shader starts with, and its `#define_import_path` among them.
pub(super) fn header(source: &str) -> impl Iterator<Item = &str> {
    source.lines().take_while(|line| line.starts_with("//") || line.starts_with("#define_import_path"))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn directives_are_carried_out_and_comments_kept() {
        let source = "// SPDX\n#define_import_path a::b\n// summary: x.\n\n#import a::c::f\n\n/// Calls f.\n\
            #ifdef ON\nfn g() {\n\n#ifdef OFF\n    off();\n#else\n    f(#{N}); // on\n#endif\n\n}\n#else\nfn h() {}\n#endif\n";
        let definitions = HashMap::from([
            ("ON".to_owned(), ShaderDefValue::Bool(true)),
            ("N".to_owned(), ShaderDefValue::Int(3)),
        ]);
        let text = resolve(source, &definitions).unwrap();
        let call = crate::names::decorate("a::c", "f");
        assert_eq!(text, format!("/// Calls {call}.\nfn g() {{\n    {call}(3); // on\n}}\n"));
        assert!(resolve("#endif\n", &definitions).is_err());
    }
}
