// SPDX-License-Identifier: MIT OR Apache-2.0
#![allow(clippy::unwrap_used)]
use super::*;

const LEAF: &str = "// SPDX\n#define_import_path airlight::core::leaf\n// summary: A leaf.\n// source: none.\n\
    // equation: f(x) = x + 1\n// error: exact.\n\n/// A place.\nstruct Place {\n    /// Metres.\n    at: vec3<f32>,\n\
    \x20   /// Seconds.\n    time: f32,\n}\n\n/// One more. `x`: metres, from 0 up.\nfn more(x: f32, place: Place) -> f32 {\n\
    \x20   return x + 1.0;\n}\n";
const PASS: &str = "// SPDX\n// summary: A pass.\n// source: none.\n// binding values: what it writes.\n\
    #import airlight::core::leaf::{Place, more}\n\
    @group(#{GROUP}) @binding(0) var<storage, read_write> values: array<f32>;\n\
    @compute @workgroup_size(64)\nfn main() {\n    values[0] = more(values[1], Place(vec3<f32>(0.0), 0.0));\n}\n";

fn library(leaf: &str) -> Library {
    Library::from_text(
        &[("core/leaf.wgsl", leaf)],
        &[("core/passes/pass.wgsl", PASS)],
        &[("core", "pass\n+ default:\n")],
    )
}

#[test]
fn pages_say_what_is_known() {
    let pictures = Pictures::parse("core = leaf.png | A leaf.").unwrap();
    let pages = pages(&library(LEAF), &pictures).unwrap();
    let names: Vec<&str> = pages.keys().map(String::as_str).collect();
    let expected =
        ["modules/core/index.md", "modules/core/leaf.md", "modules/core/passes/pass.md", "needs.md"];
    assert_eq!(names[..4], expected);
    let leaf = &pages["modules/core/leaf.md"];
    for line in [
        "# core/leaf",
        "![A leaf.](../../pictures/leaf.png)",
        "f(x) = x + 1",
        "| `x` | `f32` | metres, from 0 up |",
        "| `place` | `Place` | see [Place](#place) |",
        "| `time` | `f32` | 12 | Seconds. |",
        "| `more` | 1 | 0 | 0 | 0 | 0 |",
        "[core/pass](../../modules/core/passes/pass.md)",
    ] {
        assert!(leaf.contains(line), "{line}\n{leaf}");
    }
    let pass = &pages["modules/core/passes/pass.md"];
    assert!(pass.contains(
        "| 0 | `values` | storage `array<f32>`, read and written, from 4 bytes | what it writes. | all |"
    ));
    assert!(
        pages["needs.md"]
            .contains("| `core/pass` | `main`, compute | 64 x 1 x 1 | 0 | 1 | 0 | 0 | 0 | 0 |  |  |")
    );
    assert!(pages["vendoring/files.md"].contains("| `core/pass` | none | leaf | none |"));
}

#[test]
fn what_is_not_said_is_found() {
    assert!(unsaid(&library(LEAF)).is_empty(), "{:?}", unsaid(&library(LEAF)));
    let silent = LEAF.replace(" `x`: metres, from 0 up.", "");
    assert!(
        unsaid(&library(&silent))[0]
            .contains("core/leaf.wgsl:17: `more` says neither unit nor range of `x: f32`")
    );
    let shared = silent.replace("// error: exact.", "// error: exact.\n// parameter x: metres.");
    assert!(unsaid(&library(&shared)).is_empty());
    let needless = LEAF.replace("// error: exact.", "// error: exact.\n// parameter y: metres.");
    assert!(unsaid(&library(&needless))[0].contains("parameter y"));
    for line in ["// equation: f(x) = x + 1\n", "// error: exact.\n"] {
        assert_eq!(unsaid(&library(&LEAF.replace(line, ""))).len(), 1);
    }
}

#[test]
fn contents_are_written_between_markers() {
    let before = format!("# Summary\n\n- [A](a.md)\n\n{BEGIN}\nold\n{END}\n");
    let after = summary(&library(LEAF), &before).unwrap();
    assert!(
        after.starts_with("# Summary\n\n- [A](a.md)\n\n")
            && after.contains("  - [core/leaf](modules/core/leaf.md)\n")
    );
    assert!(!after.contains("old") && after.ends_with(&format!("{END}\n")));
    assert_eq!(summary(&library(LEAF), &after).unwrap(), after);
    assert!(summary(&library(LEAF), "# Summary").unwrap_err().contains("no line"));
}
