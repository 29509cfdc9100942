// SPDX-License-Identifier: MIT OR Apache-2.0
//! Findings and the forms they are printed in.

use crate::{Error, Location};
use anstyle::{AnsiColor, Style};
use serde::Serialize;
use std::{collections::HashSet, fmt::Write as _, path::Path};

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// It fails the check.
    Error,
    /// It is shown.
    Warning,
}

impl Severity {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// The form of a printed report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// For people.
    #[default]
    Human,
    /// One JSON document.
    Json,
    /// Annotations of a GitHub workflow.
    Github,
}

/// Something that is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The file; empty where it is about none.
    pub file: String,
    /// Line, from 1.
    pub line: Option<u32>,
    /// Column, from 1.
    pub column: Option<u32>,
    /// The pass, or the path of a module.
    pub pass: Option<String>,
    /// The permutation of the pass.
    pub permutation: Option<String>,
    /// What found it.
    pub check: String,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong.
    pub message: String,
    /// Whether the file is relative to the repository instead of the library.
    #[serde(skip)]
    pub(crate) is_own_file: bool,
}

impl Finding {
    /// A finding about a place.
    pub fn new(severity: Severity, location: Location, check: impl Into<String>, message: String) -> Self {
        Self {
            file: location.file,
            line: location.line,
            column: location.column,
            pass: None,
            permutation: None,
            check: check.into(),
            severity,
            message,
            is_own_file: false,
        }
    }

    /// An error as a finding.
    pub fn of(check: &str, error: &Error) -> Self {
        let location = error.location().cloned().unwrap_or_else(|| Location::file(""));
        Self::new(Severity::Error, location, check, error.message())
    }

    fn place(&self) -> String {
        let location = Location { file: self.file.clone(), line: self.line, column: self.column };
        location.to_string()
    }

    fn subject(&self) -> String {
        match (&self.pass, &self.permutation) {
            (Some(pass), Some(permutation)) => format!("{pass}:{permutation}"),
            (Some(pass), None) => pass.clone(),
            _ => String::new(),
        }
    }
}

/// What came of checking a library.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// What is wrong.
    pub findings: Vec<Finding>,
    /// What was not done, and why.
    pub skipped: Vec<String>,
    /// How many modules were checked.
    pub modules: usize,
    /// How many permutations of passes were checked.
    pub permutations: usize,
}

#[derive(Serialize)]
struct Document<'a> {
    findings: &'a [Finding],
    skipped: &'a [String],
    checked: usize,
    modules: usize,
    permutations: usize,
    errors: usize,
    warnings: usize,
}

impl Report {
    /// Whether nothing fails the check.
    pub fn is_clean(&self) -> bool {
        self.count(Severity::Error) == 0
    }

    fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|finding| finding.severity == severity).count()
    }

    /// Says each thing once, though every importer of a module repeats it, and puts the folder of
    /// the library before its files.
    pub(crate) fn tidy(&mut self, root: Option<&Path>) {
        let mut seen = HashSet::new();
        self.findings.retain(|finding| {
            let place = (finding.file.clone(), finding.line, finding.column);
            // naga's messages hold numbers that differ from composition to composition.
            let message = (finding.check != "compose").then(|| finding.message.clone());
            let text = (finding.check.clone(), message);
            // Without a line, the pass is the place.
            let subject = finding.line.is_none().then(|| finding.subject());
            seen.insert((place, text, subject))
        });
        if let Some(root) = root {
            for finding in &mut self.findings {
                if !finding.is_own_file && !finding.file.is_empty() {
                    finding.file = root.join(&finding.file).display().to_string();
                }
            }
        }
    }

    /// Findings in the order of files and lines.
    pub(crate) fn sort(&mut self) {
        let key =
            |finding: &Finding| (finding.file.clone(), finding.line, finding.column, finding.check.clone());
        self.findings.sort_by_cached_key(key);
    }

    /// The report in a form; `quiet` leaves out of the human one what is not a finding.
    pub fn render(&self, format: Format, quiet: bool, color: bool) -> String {
        match format {
            Format::Human => self.human(quiet, color),
            Format::Json => self.json(),
            Format::Github => self.github(),
        }
    }

    fn human(&self, quiet: bool, color: bool) -> String {
        let paint = |style: AnsiColor, text: &str| {
            let style = Style::new().bold().fg_color(Some(style.into()));
            if color { format!("{style}{text}{style:#}") } else { text.to_owned() }
        };
        let mut text = String::new();
        for finding in &self.findings {
            let color = match finding.severity {
                Severity::Error => AnsiColor::Red,
                Severity::Warning => AnsiColor::Yellow,
            };
            let severity = paint(color, finding.severity.name());
            let place = finding.place();
            let colon = if place.is_empty() { "" } else { ": " };
            let subject = finding.subject();
            let subject = if subject.is_empty() { subject } else { format!(" ({subject})") };
            let (check, message) = (&finding.check, &finding.message);
            // A string never fails to be written to.
            let _ = writeln!(text, "{place}{colon}{severity}: [{check}] {message}{subject}");
        }
        if quiet {
            return text;
        }
        for skipped in &self.skipped {
            let _ = writeln!(text, "{} {skipped}", paint(AnsiColor::Yellow, "skipped"));
        }
        let (errors, warnings) = (self.count(Severity::Error), self.count(Severity::Warning));
        let verdict = match (errors, warnings) {
            (0, 0) => paint(AnsiColor::Green, "clean"),
            (0, warnings) => {
                format!("{}, {}", paint(AnsiColor::Green, "clean"), plural(warnings, "warning"))
            }
            (errors, 0) => paint(AnsiColor::Red, &plural(errors, "finding")),
            (errors, warnings) => {
                let errors = paint(AnsiColor::Red, &plural(errors, "finding"));
                format!("{errors}, {}", plural(warnings, "warning"))
            }
        };
        let (modules, permutations) =
            (plural(self.modules, "module"), plural(self.permutations, "permutation"));
        let _ = writeln!(text, "checked {modules}, {permutations}: {verdict}");
        text
    }

    fn json(&self) -> String {
        let document = Document {
            findings: &self.findings,
            skipped: &self.skipped,
            checked: self.modules + self.permutations,
            modules: self.modules,
            permutations: self.permutations,
            errors: self.count(Severity::Error),
            warnings: self.count(Severity::Warning),
        };
        let mut text = serde_json::to_string_pretty(&document).unwrap_or_default();
        text.push('\n');
        text
    }

    fn github(&self) -> String {
        let mut text = String::new();
        for finding in &self.findings {
            let mut place = Vec::new();
            if !finding.file.is_empty() {
                place.push(format!("file={}", escape(&finding.file, true)));
            }
            place.extend(finding.line.map(|line| format!("line={line}")));
            place.extend(finding.column.map(|column| format!("col={column}")));
            let place = if place.is_empty() { String::new() } else { format!(" {}", place.join(",")) };
            let subject = finding.subject();
            let subject = if subject.is_empty() { subject } else { format!(" ({subject})") };
            let message = format!("[{}] {}{subject}", finding.check, finding.message);
            let severity = finding.severity.name();
            let _ = writeln!(text, "::{severity}{place}::{}", escape(&message, false));
        }
        for skipped in &self.skipped {
            let _ = writeln!(text, "::notice::skipped {}", escape(skipped, false));
        }
        text
    }
}

fn plural(count: usize, word: &str) -> String {
    if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
}

/// As GitHub's workflow commands want it.
fn escape(text: &str, is_property: bool) -> String {
    let text = text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    if is_property { text.replace(':', "%3A").replace(',', "%2C") } else { text }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn report() -> Report {
        let location = Location { file: "core/a,b.wgsl".into(), line: Some(3), column: Some(9) };
        let mut finding = Finding::new(Severity::Error, location, "compose", "50 %\nwrong".into());
        finding.pass = Some("core/scan".into());
        finding.permutation = Some("default".into());
        Report {
            findings: vec![finding],
            skipped: vec!["tint: not on the PATH".into()],
            modules: 1,
            permutations: 2,
        }
    }

    #[test]
    fn every_form_has_the_place() {
        let report = report();
        assert_eq!(
            report.render(Format::Human, false, false),
            "core/a,b.wgsl:3:9: error: [compose] 50 %\nwrong (core/scan:default)\nskipped tint: not on the PATH\nchecked 1 module, 2 permutations: 1 finding\n"
        );
        assert_eq!(
            report.render(Format::Github, false, false).lines().next().unwrap(),
            "::error file=core/a%2Cb.wgsl,line=3,col=9::[compose] 50 %25%0Awrong (core/scan:default)"
        );
        let json: serde_json::Value =
            serde_json::from_str(&report.render(Format::Json, false, false)).unwrap();
        assert_eq!(json["checked"], 3);
        assert_eq!(json["findings"][0]["line"], 3);
        assert_eq!(json["findings"][0]["severity"], "error");
        assert_eq!(json["skipped"][0], "tint: not on the PATH");
    }

    #[test]
    fn repeated_findings_are_said_once() {
        let mut report = report();
        let mut again = report.findings[0].clone();
        again.pass = Some("core/other".into());
        report.findings.push(again);
        report.tidy(Some(Path::new("wgsl")));
        assert_eq!(report.findings.len(), 1);
        assert!(report.findings[0].file.starts_with("wgsl"));
        assert!(!report.is_clean());
    }
}
