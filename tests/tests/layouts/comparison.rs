// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins against what naga reports of the structs.

use crate::twins::{Twin, twins};
use airlight_validate::{BindingKind, Library, Member, StructLayout};
use std::collections::BTreeSet;

/// Twins that the host keeps to itself; the tests of the systems named here would fail without them.
const PRIVATE: [(&str, &str); 1] = [("ScanParameters", "tests/tests/core/scans.rs")];

/// What is wrong with a twin; none where it fits.
fn difference(layout: &StructLayout, twin: &Twin) -> Option<String> {
    let name = &layout.name;
    if u64::from(layout.size) != twin.size {
        return Some(format!("{name} has {} bytes in WGSL and {} in Rust", layout.size, twin.size));
    }
    let shader: Vec<&str> = layout.members.iter().map(|member| member.name.as_str()).collect();
    let host: Vec<&str> = twin.fields.iter().map(|field| field.0).collect();
    if shader != host {
        return Some(format!("{name} has {shader:?} in WGSL and {host:?} in Rust"));
    }
    for (member, (field, ty, words, bytes)) in layout.members.iter().zip(&twin.fields) {
        if member.ty != *ty {
            return Some(format!("{name}.{field} is {} in WGSL and {ty} in Rust", member.ty));
        }
        let mut expected = vec![0_u8; twin.size as usize];
        for (at, word) in words {
            let at = (member.offset + at) as usize;
            expected[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
        if *bytes != expected {
            let at = bytes.iter().position(|byte| *byte != 0);
            return Some(format!("{name}.{field} is at {} in WGSL and at {at:?} in Rust", member.offset));
        }
    }
    None
}

/// Every struct of a uniform or of the storage buffer that later passes read as one, with its pass.
fn shared_structs() -> Vec<(String, StructLayout)> {
    let library = Library::builtin();
    let mut found = Vec::new();
    for pass in library.passes() {
        for permutation in library.permutations(&pass.name).unwrap() {
            let reflection = library.compose(&pass.name, &permutation.definitions).unwrap().reflect();
            for binding in &reflection.bindings {
                let (BindingKind::Uniform { ty, .. } | BindingKind::Storage { ty, .. }) = &binding.kind
                else {
                    continue;
                };
                let place = format!("{}:{} binding {}", pass.name, permutation.name, binding.name);
                match (reflection.layout(ty), &binding.kind) {
                    (Some(layout), _) => found.push((place, layout.clone())),
                    (None, BindingKind::Uniform { .. }) => {
                        panic!("{place}: uniform of {ty}, which is no struct")
                    }
                    (None, _) => {}
                }
            }
        }
    }
    found
}

#[test]
fn every_shared_struct_has_a_twin_with_the_same_layout() {
    let twins = twins();
    let mut seen = BTreeSet::new();
    for (place, layout) in shared_structs() {
        if PRIVATE.iter().any(|(name, _)| *name == layout.name) {
            seen.insert(layout.name);
            continue;
        }
        let twin = twins.get(layout.name.as_str());
        let twin =
            twin.unwrap_or_else(|| panic!("{place}: the struct {} has no Rust twin here", layout.name));
        assert_eq!(difference(&layout, twin), None, "{place}");
        // Uniforms are bound whole: WGSL's alignment of structs is 16.
        assert_eq!(twin.size % 16, 0, "{place}");
        seen.insert(layout.name);
    }
    let known: BTreeSet<String> =
        twins.keys().chain(PRIVATE.iter().map(|(name, _)| name)).map(|name| (*name).to_owned()).collect();
    assert_eq!(seen, known, "a twin whose struct no pass has any more");
}

#[test]
fn a_wrong_layout_is_noticed() {
    let twins = twins();
    let (_, right) = shared_structs().into_iter().find(|(_, layout)| layout.name == "Medium").unwrap();
    let twin = &twins["Medium"];
    assert_eq!(difference(&right, twin), None);
    let wrong = |change: fn(&mut StructLayout)| {
        let mut layout = right.clone();
        change(&mut layout);
        difference(&layout, twin)
    };
    assert!(wrong(|l| l.size += 16).unwrap().contains("48 bytes"));
    assert!(wrong(|l| l.members[1].offset = 16).unwrap().contains("Medium.extinction"));
    assert!(wrong(|l| l.members.swap(1, 2)).is_some());
    assert!(wrong(|l| l.members[2].ty = "u32".to_owned()).unwrap().contains("u32"));
    let extra = Member { name: "x".to_owned(), ty: "f32".to_owned(), offset: 28, size: 4, stride: None };
    let mut longer = right.clone();
    longer.members.push(extra);
    assert!(difference(&longer, twin).is_some());
}
