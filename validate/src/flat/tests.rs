// SPDX-License-Identifier: MIT OR Apache-2.0
//! Flat files of small libraries.

#![allow(clippy::unwrap_used)]
use super::*;

const LEAF: &str = "// SPDX-License-Identifier: MIT\n#define_import_path airlight::core::leaf\n// summary: Leaves.\n\
    // source: none.\n// note: not repeated.\n\n/// How much.\nconst SCALE: f32 = 2.0;\n\n#ifdef UNUSED\nfn gone() {}\n#endif\n\
    /// Scaled by `SCALE`.\nfn scaled(x: f32) -> f32 {\n    // Once.\n    return x * SCALE;\n}\n\nfn idle() -> f32 { return 0.0; }\n";
const OTHER: &str = "// SPDX-License-Identifier: MIT\n#define_import_path airlight::core::other\n// summary: Others.\n\
    // source: Book.\n#import airlight::core::leaf\n\nconst SCALE: f32 = 3.0;\n\n\
    fn both(leaf_SCALE: f32) -> f32 {\n    return leaf_SCALE * SCALE + leaf::SCALE;\n}\n";
const PASS: &str = "// SPDX-License-Identifier: MIT\n// summary: A pass.\n// definition WIDE: wide.\n// definition NARROW: narrow.\n\
    // binding view: what is seen.\n// binding later: only with NARROW.\n\n#import airlight::core::leaf::scaled\n\
    #import airlight::core::other::both\n\n/// The view.\nstruct View {\n    /// Its gain.\n    gain: f32,\n}\n\n\
    @group(#{GROUP}) @binding(0) var<storage, read_write> view: View;\n#ifdef NARROW\n\
    @group(#{GROUP}) @binding(1) var<storage> later: View;\n#endif\n\n@compute @workgroup_size(1)\nfn main() {\n\
    for (var i = 0u; i < 2u; i++) {\n#ifdef WIDE\n        view.gain = scaled(view.gain);\n#endif\n        view.gain = both(1.0);\n    }\n}\n";

fn library(listing: &str) -> Library {
    let modules = [("core/leaf.wgsl", LEAF), ("core/other.wgsl", OTHER)];
    Library::from_text(&modules, &[("core/passes/pass.wgsl", PASS)], &[("core", listing)])
}

#[test]
fn sources_are_put_together() {
    let text = text(&library("pass\n+ default:\n+ wide: WIDE\n"), "core/pass", "wide").unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let head = format!(
        "// SPDX-License-Identifier: MIT\n// Airlight {version}: core/pass, permutation wide (WIDE)\n// summary: A pass.\n\
         // definition WIDE: wide.\n// binding view: what is seen.\n\n// ---- airlight::core::leaf ----\n// summary: Leaves.\n\
         // source: none.\n\n/// How much.\n"
    );
    assert!(text.starts_with(&head), "{text}");
    for kept in [
        "    // Once.\n",
        "    /// Its gain.\n",
        "for (var i = 0u;",
        "@group(0) @binding(0)",
        "// source: Book.",
    ] {
        assert!(text.contains(kept), "{kept} in {text}");
    }
    for gone in ["idle", "gone", "#", "naga_oil", "later", "not repeated", "\n\n\n"] {
        assert!(!text.contains(gone), "{gone} in {text}");
    }
}

#[test]
fn a_name_is_not_captured_by_a_local_variable() {
    let text = text(&library("pass\n+ default:\n"), "core/pass", "default").unwrap();
    // `leaf_SCALE` is an argument where the constant of that module is used.
    assert!(text.contains("const airlight_core_leaf_SCALE: f32 = 2.0;"), "{text}");
    assert!(text.contains("return leaf_SCALE * other_SCALE + airlight_core_leaf_SCALE;"), "{text}");
}

#[test]
fn a_builtin_function_is_not_hidden() {
    let leaf = "#define_import_path airlight::core::leaf\nfn distance() -> f32 { return 1.0; }\n";
    let pass = "#import airlight::core::leaf\n@group(0) @binding(0) var<storage, read_write> x: f32;\n\
        @compute @workgroup_size(1) fn main() { x = distance(vec2<f32>(x), vec2<f32>(1.0)) + leaf::distance(); }\n";
    let library = Library::from_text(
        &[("core/leaf.wgsl", leaf)],
        &[("core/passes/pass.wgsl", pass)],
        &[("core", "pass\n+ default:\n")],
    );
    let text = text(&library, "core/pass", "default").unwrap();
    assert!(text.contains("+ leaf_distance()"), "{text}");
}

#[test]
fn what_does_not_compose_is_located_in_its_source() {
    let broken = LEAF.replace("return x * SCALE", "return x * nothing");
    let library = Library::from_text(
        &[("core/leaf.wgsl", &broken), ("core/other.wgsl", OTHER)],
        &[("core/passes/pass.wgsl", PASS)],
        &[("core", "pass\n+ default:\n+ wide: WIDE\n")],
    );
    let error = text(&library, "core/pass", "wide").unwrap_err();
    assert_eq!(error.location().unwrap().file, "core/leaf.wgsl");
    assert!(text(&library, "core/none", "default").unwrap_err().message().contains("core/pass"));
    assert!(text(&library, "core/pass", "none").unwrap_err().message().contains("wide"));
}

#[test]
fn overridden_functions_are_written_from_the_composed_module() {
    let leaf = "#define_import_path airlight::core::leaf\nvirtual fn one() -> f32 { return 1.0; }\n";
    let pass = "#import airlight::core::leaf\n@group(0) @binding(0) var<storage, read_write> x: f32;\n\
        override fn leaf::one() -> f32 { return 2.0; }\n@compute @workgroup_size(1) fn main() { x = leaf::one(); }\n";
    let library = Library::from_text(
        &[("core/leaf.wgsl", leaf)],
        &[("core/passes/pass.wgsl", pass)],
        &[("core", "pass\n+ default:\n")],
    );
    let text = text(&library, "core/pass", "default").unwrap();
    assert!(text.contains("permutation default") && text.contains("return 2f;"), "{text}");
}

#[test]
fn a_folder_is_made_fresh() {
    let files = render(&library("pass\n+ default:\n+ wide: WIDE\n")).unwrap();
    assert_eq!(files.keys().collect::<Vec<_>>(), ["core/pass.wgsl", "core/pass.wide.wgsl"]);
    let folder = tempfile::tempdir().unwrap();
    let write = |path: &std::path::Path, text: &str| std::fs::write(path, text);
    let compare = || sync(folder.path(), &files, Kept::Compared, write);
    assert!(compare().unwrap_err().ends_with("pass.wgsl is missing"));
    sync(folder.path(), &files, Kept::Written, write).unwrap();
    assert_eq!(compare(), Ok(()));
    std::fs::write(folder.path().join("core/pass.wide.wgsl"), "x").unwrap();
    assert!(compare().unwrap_err().ends_with("pass.wide.wgsl is stale"));
    std::fs::write(folder.path().join("core/old.wgsl"), "x").unwrap();
    sync(folder.path(), &files, Kept::Written, write).unwrap();
    assert_eq!(compare(), Ok(()));
    assert!(!folder.path().join("core/old.wgsl").exists());
    std::fs::create_dir(folder.path().join("gone")).unwrap();
    std::fs::write(folder.path().join("gone/old.wgsl"), "x").unwrap();
    assert!(compare().unwrap_err().ends_with("old.wgsl is superfluous"));
}
