// SPDX-License-Identifier: MIT OR Apache-2.0
//! Translation of directives.

#![allow(clippy::unwrap_used)]
use crate::Library;

/// The WESL of one module `airlight::core::m` of `text` beside `airlight::core::leaf`.
fn wesl(text: &str) -> Result<String, String> {
    let text = format!("#define_import_path airlight::core::m\n{text}");
    let leaf = "#define_import_path airlight::core::leaf\nfn f() {}\n";
    let library = Library::from_text(&[("core/leaf.wgsl", leaf), ("core/m.wgsl", &text)], &[], &[]);
    let files = super::package(&library, &["airlight::core::m"]).map_err(|error| error.to_string())?;
    let (path, text) = files.last().unwrap();
    assert_eq!(path, "core/m.wesl");
    Ok(text.strip_prefix("// #define_import_path airlight::core::m\n").unwrap().to_owned())
}

#[test]
fn imports_keep_their_form() {
    let text = "// airlight::core::leaf\n#import airlight::core::leaf::{\n    f, // the function\n    f as g\n}\n#import airlight::core::leaf // all\nfn h() { airlight::core::leaf::f(); g(); }\n";
    let expected = "// airlight::core::leaf\nimport package::core::leaf::{\n    f, // the function\n    f as g\n};\nimport package::core::leaf; // all\nfn h() { package::core::leaf::f(); g(); }\n";
    assert_eq!(wesl(text).unwrap(), expected);
}

#[test]
fn conditions_stand_before_items_members_and_statements() {
    let text = "#ifdef A\n#import airlight::core::leaf\n/// One.\nconst a: u32 = 1u;\n#else ifdef B\nconst a: u32 = 2u;\n#else\nconst a: u32 = 3u;\n#endif\nstruct S {\n    x: f32,\n#ifndef A\n    y: f32, z: f32,\n#endif\n}\n@const fn h() -> u32 {\n#ifdef A\n    let b = 1u;\n    if b > a {\n        return a; // }\n    } else {\n        return b;\n    }\n#ifdef B\n    for (var i = 0u; i < b; i++) { leaf::f(); }\n#endif\n#endif\n    return 0u;\n}\n";
    let expected = "// #ifdef A\n@if(A) import package::core::leaf;\n/// One.\n@if(A) const a: u32 = 1u;\n// #else ifdef B\n@if(!A && B) const a: u32 = 2u;\n// #else\n@if(!A && !B) const a: u32 = 3u;\n// #endif\nstruct S {\n    x: f32,\n// #ifndef A\n    @if(!A) y: f32, @if(!A) z: f32,\n// #endif\n}\n@const fn h() -> u32 {\n// #ifdef A\n    @if(A) let b = 1u;\n    @if(A) if b > a {\n        return a; // }\n    } else {\n        return b;\n    }\n// #ifdef B\n    @if(A && B) for (var i = 0u; i < b; i++) { leaf::f(); }\n// #endif\n// #endif\n    return 0u;\n}\n";
    assert_eq!(wesl(text).unwrap(), expected);
}

#[test]
fn a_definition_that_brings_a_binding_is_off() {
    let text = "#ifdef S\n@group(#{GROUP}) @binding(1) var s: sampler;\n#endif\nfn h() -> u32 {\n#ifdef S\n    return 1u;\n#else\n    return 0u;\n#endif\n}\n";
    let expected =
        "// #ifdef S\n\n// #endif\nfn h() -> u32 {\n// #ifdef S\n\n// #else\n    return 0u;\n// #endif\n}\n";
    assert_eq!(wesl(text).unwrap(), expected);
}

#[test]
fn what_has_no_form_is_refused_with_its_line() {
    for (text, line, part) in [
        ("@group(0) @binding(0) var s: sampler;\n", 2, "a binding"),
        ("\nconst a: u32 = #{N};\n", 3, "value of `N`"),
        ("#if N == 1\n#endif\n", 2, "compares the value"),
        ("#define N\n", 2, "`#define`"),
        ("virtual fn f() {}\n", 2, "overrides no functions"),
        ("override fn leaf::f() {}\n", 2, "overrides no functions"),
        ("#ifdef A\n", 2, "without `#endif`"),
        ("#endif\n", 2, "without a beginning"),
        ("#else\n", 2, "without a beginning"),
        ("const a = 1\n#ifdef A\n + 1\n#endif\n;\n", 4, "part of a statement"),
        ("fn h(\n#ifdef A\n x: f32\n#endif\n) {}\n", 4, "part of a statement"),
        ("fn h() {\n#ifdef A\n if true {\n#endif\n }\n}\n", 6, "part of a statement"),
        ("fn h() {\n if true {\n }\n#ifdef A\n else {\n }\n#endif\n}\n", 6, "before `else`"),
        ("const package = 1;\n", 2, "keyword"),
    ] {
        let error = wesl(text).unwrap_err();
        assert!(error.starts_with(&format!("core/m.wgsl:{line}: ")), "{text}: {error}");
        assert!(error.contains(part), "{text}: {error}");
    }
}

#[test]
fn a_module_has_no_form_if_one_that_it_imports_has_none() {
    let leaf = "#define_import_path airlight::core::leaf\n@group(0) @binding(0) var s: sampler;\n";
    let m = "#define_import_path airlight::core::m\n#import airlight::core::leaf\n";
    let other = "#define_import_path airlight::core::other\n";
    let library = Library::from_text(
        &[("core/leaf.wgsl", leaf), ("core/m.wgsl", m), ("core/other.wgsl", other)],
        &[],
        &[],
    );
    assert_eq!(super::modules(&library), ["airlight::core::other"]);
    let error = super::package(&library, &["airlight::core::m"]).unwrap_err();
    assert!(error.to_string().starts_with("core/leaf.wgsl:2: cannot be written as WESL"), "{error}");
    assert!(super::package(&library, &["airlight::core::none"]).is_err());
}
