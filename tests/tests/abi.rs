// SPDX-License-Identifier: MIT OR Apache-2.0
//! The shader interface under semantic versions: what was released holds until the version says otherwise, and no
//! change of the manifest goes unnoticed.
#![allow(clippy::unwrap_used)]

use airlight_validate::abi::{Effect, compare, read};
use serde_json::{Value, json};
use std::path::Path;

fn manifest(file: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../wgsl").join(file);
    read(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn a_breaking_change_comes_with_a_version() {
    let comparison = compare(&manifest("manifest.released.json"), &manifest("manifest.json"));
    assert!(
        !comparison.is_breaking() || comparison.is_bumped(),
        "since version {} of wgsl/manifest.released.json:\n{}raise the version, or undo it",
        comparison.versions[0],
        comparison.render()
    );
    assert_eq!(comparison.versions[1], env!("CARGO_PKG_VERSION"));
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((z ^ (z >> 31)) % bound as u64).unwrap()
    }
}

/// Descends to a random value and changes or removes it; says where.
fn mutate(value: &mut Value, random: &mut Random, place: &mut String) {
    let stop = random.below(12) == 0;
    match value {
        Value::Object(members) if !members.is_empty() => {
            let at = random.below(members.len());
            let name = members.keys().nth(at).unwrap().clone();
            *place += &format!("/{name}");
            if stop {
                members.remove(&name);
            } else {
                mutate(&mut members[&name], random, place);
            }
        }
        Value::Array(items) if !items.is_empty() => {
            let at = random.below(items.len());
            *place += &format!("/{at}");
            if stop {
                items.remove(at);
            } else {
                mutate(&mut items[at], random, place);
            }
        }
        Value::Object(members) => drop(members.insert("more".to_owned(), json!(1))),
        Value::Array(items) => items.push(json!("more")),
        Value::String(text) => text.push('x'),
        Value::Bool(on) => *on = !*on,
        Value::Number(number) => {
            let number = number.as_i64().unwrap();
            *value = json!(if random.below(2) == 0 { number + 1 } else { number - 1 });
        }
        Value::Null => *value = json!(0),
    }
}

#[test]
fn every_change_is_reported() {
    let old = manifest("manifest.json");
    assert_eq!(compare(&old, &old).changes, []);
    let mut random = Random(1);
    let mut breaking = 0;
    for case in 0..400 {
        // One list at a time: modules are few and passes large.
        let list = if random.below(8) == 0 { "modules" } else { "passes" };
        let mut new = json!({ "format": 1, "version": "0.1.0", "modules": [], "passes": [] });
        let at = random.below(old[list].as_array().unwrap().len());
        new[list] = json!([old[list][at].clone()]);
        let before = new.clone();
        let mut place = format!("/{list}");
        mutate(&mut new[list], &mut random, &mut place);
        assert_ne!(before, new);
        let comparison = compare(&before, &new);
        assert!(!comparison.changes.is_empty(), "case {case}: nothing about {place}");
        assert_eq!(comparison.render().is_empty(), comparison.changes.is_empty());
        breaking += usize::from(comparison.is_breaking());
        // And backwards.
        assert!(!compare(&new, &before).changes.is_empty(), "case {case}: nothing about {place} backwards");
    }
    assert!((100..400).contains(&breaking), "{breaking} of 400 are breaking");
}

#[test]
fn additions_alone_are_compatible() {
    let new = manifest("manifest.json");
    let mut random = Random(2);
    for _ in 0..20 {
        let mut old = new.clone();
        for _ in 0..=random.below(4) {
            let passes = old["passes"].as_array_mut().unwrap();
            let pass = random.below(passes.len());
            let permutations = passes[pass]["permutations"].as_array_mut().unwrap();
            match random.below(2) {
                0 if permutations.len() > 1 => drop(permutations.pop()),
                _ => drop(passes.remove(pass)),
            }
            let modules = old["modules"].as_array_mut().unwrap();
            let module = random.below(modules.len());
            modules.remove(module);
        }
        let comparison = compare(&old, &new);
        assert!(
            comparison.changes.iter().all(|change| change.effect == Effect::Compatible),
            "{}",
            comparison.render()
        );
        assert!(comparison.changes.len() >= 2);
        // Taken away again, they are missed.
        assert!(compare(&new, &old).is_breaking());
    }
}
