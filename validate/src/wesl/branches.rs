// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which lines of a module stand between which directives.

use super::module::Refusal;
use crate::scan::without_comments;
use std::collections::BTreeSet;

/// That a name is defined, or that it is not.
pub(super) type Literal = (String, bool);

/// What holds where a line stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// `#ifdef`, `#else` and the like: where branches begin and end.
    Directive,
    /// In the branches given, from the outermost. Each is a number that it shares with no other, and what holds in it
    /// beyond what holds around it.
    In(Vec<(usize, Vec<Literal>)>),
    /// In a branch that is never taken.
    Out,
}

/// One `#ifdef` and its `#else`s, while they are read.
struct Open {
    /// What is left for the branches to come.
    before: Vec<Literal>,
    /// What holds in this one.
    now: Vec<Literal>,
    /// Its number.
    number: usize,
    /// Whether it is never taken.
    never: bool,
    line: u32,
}

/// Every line of a source, with `off` never defined.
pub(super) fn lines(source: &str, off: &BTreeSet<String>) -> Result<Vec<Line>, Refusal> {
    let mut open: Vec<Open> = Vec::new();
    let mut count = 0;
    let mut lines = Vec::new();
    for (index, line) in without_comments(source).lines().enumerate() {
        let number = index as u32 + 1;
        let refuse = |message: &str| Refusal { line: number, message: message.to_owned() };
        let words: Vec<&str> = line.split_whitespace().collect();
        let tested = match words.as_slice() {
            ["#ifdef", name] | ["#else", "ifdef", name] => Some(((*name).to_owned(), true)),
            ["#ifndef", name] | ["#else", "ifndef", name] => Some(((*name).to_owned(), false)),
            ["#else"] => None,
            ["#endif"] => {
                open.pop().ok_or_else(|| refuse("`#endif` without a beginning"))?;
                lines.push(Line::Directive);
                continue;
            }
            ["#if", ..] | ["#else", "if", ..] => {
                return Err(refuse("`#if` compares the value of a definition, which WESL does not know"));
            }
            ["#define", ..] => {
                return Err(refuse("`#define` sets a definition, which WESL leaves to who compiles"));
            }
            ["#ifdef" | "#ifndef" | "#else", ..] => return Err(refuse("a condition that is not understood")),
            _ => {
                lines.push(place(&open));
                continue;
            }
        };
        count += 1;
        let before = match words[0] {
            "#else" => open.pop().ok_or_else(|| refuse("`#else` without a beginning"))?.before,
            _ => Vec::new(),
        };
        let mut next = Open { now: before.clone(), before, number: count, never: false, line: number };
        if let Some((name, defined)) = tested {
            next.now.push((name.clone(), defined));
            next.before.push((name, !defined));
        }
        let outer = open.iter().flat_map(|around| &around.now);
        let known: Vec<Literal> =
            outer.cloned().chain(off.iter().map(|name| (name.clone(), false))).collect();
        next.settle(&known);
        open.push(next);
        lines.push(Line::Directive);
    }
    match open.last() {
        Some(around) => {
            Err(Refusal { line: around.line, message: "a condition without `#endif`".to_owned() })
        }
        None => Ok(lines),
    }
}

impl Open {
    /// Leaves out what is known to hold, and finds what cannot.
    fn settle(&mut self, known: &[Literal]) {
        let mut kept: Vec<Literal> = Vec::new();
        for (name, defined) in &self.now {
            match known.iter().chain(&kept).find(|(other, _)| other == name) {
                Some((_, other)) if other == defined => {}
                Some(_) => self.never = true,
                None => kept.push((name.clone(), *defined)),
            }
        }
        self.now = kept;
    }
}

fn place(open: &[Open]) -> Line {
    if open.iter().any(|around| around.never) {
        return Line::Out;
    }
    let conditions = open.iter().filter(|around| !around.now.is_empty());
    Line::In(conditions.map(|around| (around.number, around.now.clone())).collect())
}

/// Definitions that bring a binding where they are given.
pub(super) fn bringing_bindings(source: &str) -> BTreeSet<String> {
    let Ok(places) = lines(source, &BTreeSet::new()) else { return BTreeSet::new() };
    let text = without_comments(source);
    let conditions = text.lines().zip(places).filter_map(|(line, place)| match place {
        Line::In(branches) if line.contains("@binding") => Some(branches),
        _ => None,
    });
    let literals = conditions.flatten().filter_map(|(_, literals)| literals.last().cloned());
    literals.filter(|(_, defined)| *defined).map(|(name, _)| name).collect()
}
