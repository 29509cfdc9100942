// SPDX-License-Identifier: MIT OR Apache-2.0
//! The book's lines that call this program are lines that it understands.
#![allow(clippy::unwrap_used)]

use super::Arguments;
use airlight_validate::files_below;
use clap::{CommandFactory, Parser};
use std::{fs, path::Path};

/// Every line of the book's blocks that calls the program, with its chapter.
fn calls() -> Vec<(String, String)> {
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src");
    let mut found = Vec::new();
    for chapter in files_below(&book, "md").unwrap() {
        let text = fs::read_to_string(book.join(&chapter)).unwrap();
        found.extend(called(&text).into_iter().map(|line| (chapter.clone(), line)));
    }
    found
}

/// Lines of fenced `sh` blocks and of indented ones.
fn called(text: &str) -> Vec<String> {
    let mut fence: Option<&str> = None;
    let mut found = Vec::new();
    for line in text.lines() {
        if let Some(kind) = line.strip_prefix("```") {
            fence = if fence.is_some() { None } else { Some(kind) };
            continue;
        }
        let block = match fence {
            Some(kind) => kind == "sh",
            None => line.starts_with("    "),
        };
        let line = line.trim();
        let line = line.strip_prefix("target/release/").unwrap_or(line);
        if block && line.starts_with("airlight-validate ") {
            let plain = line.split(" # ").next().unwrap().split(" > ").next().unwrap();
            found.push(plain.trim().to_owned());
        }
    }
    found
}

#[test]
fn calls_in_the_book_are_understood() {
    let program = Arguments::command();
    let mut understood = 0;
    for (chapter, call) in calls() {
        let name = call.split_whitespace().nth(1).unwrap();
        let job = program.find_subcommand(name);
        let job = job.unwrap_or_else(|| panic!("{chapter}: `{call}`: there is no `{name}`"));
        // A synopsis has brackets and choices: its flags exist. Others are calls as they stand.
        if call.contains(['[', '|', '…']) {
            for flag in call.split(|letter: char| !(letter.is_alphanumeric() || letter == '-')) {
                let Some(flag) = flag.strip_prefix("--") else { continue };
                let known = job.get_arguments().any(|argument| argument.get_long() == Some(flag));
                assert!(known, "{chapter}: `{call}`: there is no --{flag}");
            }
        } else {
            let parsed = Arguments::try_parse_from(call.split_whitespace());
            assert!(parsed.is_ok(), "{chapter}: `{call}`: {}", parsed.err().unwrap());
        }
        understood += 1;
    }
    assert!(understood >= 8, "{understood}");
}

#[test]
fn lines_are_found_in_blocks_alone() {
    let text = "airlight-validate a\n\n    airlight-validate b > x  # c\n\n```sh\nairlight-validate c   # d\n```\n\n```text\nairlight-validate e\n```\n";
    assert_eq!(called(text), ["airlight-validate b", "airlight-validate c"]);
}
