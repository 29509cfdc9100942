// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random trees, the same in every run: no panic, no hang, and every place lies in its file.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::check::{self, Report};
use std::{ffi::OsString, time::Instant};

/// How many trees of a few files each.
const TREES: usize = 120;

/// A generator of random numbers.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        // splitmix64
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

const SCRAPS: [&str; 34] = [
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    "<",
    ">",
    ";",
    ",",
    "::",
    "#",
    "#{",
    "#{A}",
    "\"",
    "/*",
    "*/",
    "//",
    "#import ",
    "#import a::{b, c::{d",
    "#define_import_path x\n",
    "#ifdef A\n",
    "#else\n",
    "#endif\n",
    "#if A == 1 && B\n",
    "virtual ",
    "override fn x::f() {}",
    "@size(3) ",
    "\u{feff}",
    "é",
    "0x",
    "loop {",
    "select(a[i-1], b",
    "var<",
];

fn bytes(random: &mut Random, sources: &[&str]) -> Vec<u8> {
    let pick = |random: &mut Random| sources[random.below(sources.len())].as_bytes().to_vec();
    let mut text = pick(random);
    // Short ones, so that many are checked in time.
    text.truncate(200 + random.below(3_000));
    match random.below(8) {
        0 => return (0..random.below(400)).map(|_| random.next() as u8).collect(),
        1 => text = (0..random.below(120)).flat_map(|_| SCRAPS[random.below(SCRAPS.len())].bytes()).collect(),
        2 => {
            let other = pick(random);
            let (at, from) = (random.below(text.len()), random.below(other.len()));
            text.truncate(at);
            text.extend(other[from..].iter().take(1_500));
        }
        3 => text = SCRAPS[random.below(SCRAPS.len())].repeat(random.below(4_000)).into_bytes(),
        _ => {}
    }
    for _ in 0..random.below(6) {
        let at = random.below(text.len());
        match random.below(4) {
            0 if !text.is_empty() => text[at] = random.next() as u8,
            1 => drop(text.drain(at..(at + random.below(40)).min(text.len()))),
            _ => drop(text.splice(at..at, SCRAPS[random.below(SCRAPS.len())].bytes())),
        }
    }
    text
}

/// Whether a line and column lie in a text.
fn lies_in(text: &str, line: Option<u32>, column: Option<u32>) -> bool {
    let Some(line) = line else { return column.is_none() };
    let own = text.split('\n').nth(line.saturating_sub(1) as usize);
    line > 0
        && own.is_some_and(|own| {
            column.is_none_or(|column| column > 0 && column as usize <= own.chars().count() + 1)
        })
}

fn run(library: &Library) -> Report {
    check::run(library, &check::Options { path: Some(OsString::new()), ..Default::default() }).unwrap()
}

#[test]
fn random_trees_neither_panic_nor_hang() {
    let sources: Vec<&str> = airlight_wgsl::MODULES
        .iter()
        .map(|module| module.source)
        .chain(airlight_wgsl::PASSES.iter().map(|pass| pass.source))
        .collect();
    let mut random = Random(11);
    let start = Instant::now();
    let (mut files_seen, mut findings_seen) = (0, 0);
    for tree in 0..TREES {
        let mut files = Vec::new();
        let mut foreign = Foreign::default();
        for index in 0..1 + random.below(5) {
            let (name, content) = (format!("{index}.wgsl"), bytes(&mut random, &sources));
            files_seen += 1;
            match walk::decode(content.clone()) {
                Ok(text) => {
                    files.push(File { relative: name.clone(), name, text, is_external: random.below(6) == 0 })
                }
                Err((line, column, message)) => {
                    let lossy = String::from_utf8_lossy(&content);
                    assert!(lies_in(&lossy, line, column), "{message} {line:?} {column:?}");
                    foreign.report(Location { file: name, line, column }, "unreadable", message);
                }
            }
        }
        let texts: BTreeMap<String, String> =
            files.iter().map(|file| (file.name.clone(), file.text.clone())).collect();
        let report = run(&from_files(files, None, foreign));
        findings_seen += report.findings.len();
        for finding in &report.findings {
            assert_ne!(finding.check, "internal", "tree {tree}: {finding:?}");
            assert!(check::Lint::named(&finding.check).is_some(), "{finding:?}");
            if let Some(text) = texts.get(&finding.file) {
                assert!(lies_in(text, finding.line, finding.column), "tree {tree}: {finding:?}");
            }
        }
    }
    println!("{files_seen} files, {findings_seen} findings, {:.1} s", start.elapsed().as_secs_f32());
    assert!(files_seen >= 300 && findings_seen >= 300, "{files_seen} {findings_seen}");
}

/// Trees of which each has something that compilers recurse with.
#[test]
fn deep_texts_do_not_end_the_program() {
    let deep = |part: &str, count: usize| part.repeat(count);
    let half = bounds::MOST_LEVELS / 2;
    let mut texts = Vec::new();
    for count in [100, half, 50_000] {
        texts.extend([
            format!("fn f() -> f32 {{ return {}1.0{}; }}", deep("(", count), deep(")", count)),
            format!("fn f() -> f32 {{ return {}1.0; }}", deep("1.0 + ", count)),
            format!("fn f() -> f32 {{ return {}1.0; }}", deep("-", count)),
            format!("fn f() -> bool {{ return {}true; }}", deep("!", count)),
            format!("fn f() -> f32 {{ return {}1.0{}; }}", deep("abs(", count), deep(")", count)),
            format!("fn f() {{ {} {} }}", deep("{", count), deep("}", count)),
            format!("fn f(a: bool) {{ if a {{}} {} }}", deep("else if a {} ", count)),
            format!("fn f(a: bool) {{ {} {} }}", deep("if a {", count), deep("}", count)),
            format!("var<private> a: {}u32{};", deep("array<", count), deep(", 1>", count)),
            format!("fn f() {{ var a = 1; {}a; }}", deep("*&", count)),
            format!("fn f() {{ var a = 1; a = a{}; }}", deep("[0]", count)),
            deep("/*", count),
            deep("#ifdef A\n", count),
            format!("#import {}", deep("a::{", count)),
        ]);
    }
    for (index, text) in texts.into_iter().enumerate() {
        for prefix in ["", "#define_import_path x\n"] {
            let text = format!("{prefix}{text}");
            let file = File { name: "a".into(), relative: "a".into(), text, is_external: false };
            let report = run(&from_files(vec![file], None, Foreign::default()));
            assert!(report.findings.iter().all(|finding| finding.check != "internal"), "{index}: {report:?}");
        }
    }
}
