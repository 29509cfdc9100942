// SPDX-License-Identifier: MIT OR Apache-2.0
//! One module in WESL.

use super::branches::{self, Line, Literal};
use crate::{Error, Location, scan::is_identifier, scan::without_comments};
use std::collections::BTreeSet;

/// Why a module has no WESL form.
#[derive(Debug)]
pub(super) struct Refusal {
    /// Line, from 1.
    pub line: u32,
    /// What WESL cannot say.
    pub message: String,
}

impl Refusal {
    pub(super) fn in_file(self, file: &str) -> Error {
        Error::Write {
            location: Location::line(file, self.line),
            form: "WESL".to_owned(),
            message: self.message,
        }
    }
}

/// The text of a module in WESL, without what needs a definition of `off`. `root`: the first part of import paths.
pub(super) fn translate(source: &str, root: &str, off: &BTreeSet<String>) -> Result<String, Refusal> {
    let places = branches::lines(source, off)?;
    let mut reader = Reader { starts: true, ..Reader::default() };
    let mut output = String::with_capacity(source.len() + 256);
    let code = without_comments(source);
    for (index, ((text, code), place)) in source.lines().zip(code.lines()).zip(&places).enumerate() {
        reader.line = index as u32 + 1;
        match place {
            // What is left out leaves its lines, so that those of messages are those of the module.
            Line::Out => {}
            Line::Directive => output += &format!("// {}", text.trim_start()),
            Line::In(branches) if code.trim_start().starts_with("#define_import_path") => {
                reader.enter(branches)?;
                output += &format!("// {}", text.trim_start());
            }
            Line::In(branches) => {
                reader.enter(branches)?;
                reader.read(text, code, root, &mut output)?;
            }
        }
        output.push('\n');
    }
    reader.enter(&[])?;
    Ok(output)
}

/// A branch that the reader is in.
struct Branch {
    number: usize,
    /// How many brackets are open around it.
    depth: usize,
    condition: Vec<Literal>,
}

#[derive(Default)]
struct Reader {
    line: u32,
    /// Brackets that are open.
    open: Vec<char>,
    /// Whether what comes next begins an item, a member or a statement.
    starts: bool,
    /// Whether a branch began since the last word or mark.
    entered: bool,
    /// Whether an import goes on.
    importing: bool,
    branches: Vec<Branch>,
}

impl Reader {
    fn refuse<T>(&self, message: impl Into<String>) -> Result<T, Refusal> {
        Err(Refusal { line: self.line, message: message.into() })
    }

    /// Leaves and enters branches, which hold whole items, members or statements.
    fn enter(&mut self, branches: &[(usize, Vec<Literal>)]) -> Result<(), Refusal> {
        let pairs = self.branches.iter().zip(branches);
        let same = pairs.take_while(|(now, (next, _))| now.number == *next).count();
        if same == self.branches.len() && same == branches.len() {
            return Ok(());
        }
        let whole = self.starts && self.open.last().is_none_or(|bracket| *bracket == '{');
        let left = self.branches.get(same);
        if !whole || left.is_some_and(|branch| branch.depth != self.open.len()) {
            return self
                .refuse("a condition around part of a statement or of a list; `@if` takes whole ones");
        }
        self.branches.truncate(same);
        for (number, condition) in &branches[same..] {
            let (number, depth, condition) = (*number, self.open.len(), condition.clone());
            self.branches.push(Branch { number, depth, condition });
            self.entered = true;
        }
        Ok(())
    }

    /// `@if(…) ` before what begins here, if it stands in a branch of its own level.
    fn begin(&mut self, output: &mut String) {
        if std::mem::take(&mut self.starts) {
            let own = self.branches.iter().filter(|branch| branch.depth == self.open.len());
            let literals = own.flat_map(|branch| &branch.condition);
            let words: Vec<String> = literals
                .map(|(name, defined)| format!("{}{name}", if *defined { "" } else { "!" }))
                .collect();
            if !words.is_empty() {
                *output += &format!("@if({}) ", words.join(" && "));
            }
        }
        self.entered = false;
    }

    /// A line, into `output`. `code` is its text with spaces for comments.
    fn read(&mut self, text: &str, code: &str, root: &str, output: &mut String) -> Result<(), Refusal> {
        let text: Vec<char> = text.chars().collect();
        let code: Vec<char> = code.chars().collect();
        let end = code.iter().rposition(|letter| !letter.is_whitespace()).map_or(0, |last| last + 1);
        let mut at = 0;
        while at < end {
            let begin = at;
            while at < end && is_identifier(code[at]) {
                at += 1;
            }
            if at > begin {
                self.word(&code, begin, at, root, output)?;
            } else if code[at].is_whitespace() {
                output.push(text[at]);
                at += 1;
            } else {
                at = self.mark(&code, at, output)?;
            }
        }
        if self.importing && self.open.is_empty() {
            self.importing = false;
            self.starts = true;
            output.push(';');
        }
        output.extend(&text[end..]);
        Ok(())
    }

    /// A word or a number, `begin..end` of a line.
    fn word(
        &mut self,
        code: &[char],
        begin: usize,
        end: usize,
        root: &str,
        output: &mut String,
    ) -> Result<(), Refusal> {
        let word: String = code[begin..end].iter().collect();
        let rest: String = code[end..].iter().collect();
        match word.as_str() {
            "virtual" | "override" if self.starts && rest.trim_start().starts_with("fn ") => {
                return self.refuse(format!("`{word} fn`: WESL overrides no functions"));
            }
            "as" | "import" | "package" | "self" | "super" if !self.importing => {
                return self.refuse(format!("`{word}` is a keyword of WESL"));
            }
            "else" if self.entered => {
                return self.refuse("a condition before `else`; `@if` takes whole statements");
            }
            "else" => self.starts = false,
            _ => self.begin(output),
        }
        let first = begin == 0 || !matches!(code[begin - 1], ':' | '.' | '@');
        let in_package = word == root && first && rest.starts_with("::");
        output.push_str(if in_package { "package" } else { &word });
        Ok(())
    }

    /// A single character at `at`, or the beginning of an import; returns where to go on.
    fn mark(&mut self, code: &[char], at: usize, output: &mut String) -> Result<usize, Refusal> {
        let rest: String = code[at + 1..].iter().collect();
        let mark = code[at];
        match mark {
            '#' if rest.starts_with("import ") && self.starts && self.open.is_empty() => {
                self.begin(output);
                self.importing = true;
                *output += "import";
                return Ok(at + 1 + "import".len());
            }
            '#' if rest.starts_with('{') => {
                let name: String = rest.chars().skip(1).take_while(|letter| is_identifier(*letter)).collect();
                return self
                    .refuse(format!("takes the value of `{name}`; WESL knows no values of definitions"));
            }
            '#' => return self.refuse("a directive that WESL has nothing for"),
            '@' if rest.starts_with("group") || rest.starts_with("binding") => {
                return self.refuse("a binding; a package of algorithms has none");
            }
            '"' => return self.refuse("a quoted path, which WESL does not know"),
            ',' if self.importing && self.open.is_empty() => {
                return self.refuse("several paths in one import; write a line each");
            }
            '(' | '[' | '{' => {
                self.begin(output);
                self.open.push(mark);
                self.starts = mark == '{' && !self.importing;
            }
            ')' | ']' | '}' => {
                self.open.pop();
                self.starts = mark == '}' && !self.importing;
            }
            ';' => self.starts = self.open.last().is_none_or(|bracket| *bracket == '{'),
            ',' => self.starts = self.open.last() == Some(&'{') && !self.importing,
            _ => self.begin(output),
        }
        self.entered = false;
        output.push(mark);
        Ok(at + 1)
    }
}
