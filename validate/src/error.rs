// SPDX-License-Identifier: MIT OR Apache-2.0
//! The errors of this crate, with the file and line that they are about.

use std::{fmt, io, path::PathBuf};

/// Where in a source file something is.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Location {
    /// The file, relative to the root of the library.
    pub file: String,
    /// Line, from 1.
    pub line: Option<u32>,
    /// Column in characters, from 1.
    pub column: Option<u32>,
}

impl Location {
    /// A whole file.
    pub fn file(file: impl Into<String>) -> Self {
        Self { file: file.into(), line: None, column: None }
    }

    /// A line of a file.
    pub fn line(file: impl Into<String>, line: u32) -> Self {
        Self { file: file.into(), line: Some(line), column: None }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
            if let Some(column) = self.column {
                write!(f, ":{column}")?;
            }
        }
        Ok(())
    }
}

/// What can go wrong between a folder of WGSL and a composed module.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// What was read.
        path: PathBuf,
        /// Why it failed.
        source: io::Error,
    },
    /// A folder that holds no shader library.
    #[error("{} holds no `<system>/<module>.wgsl`; give the folder that holds the systems", .0.display())]
    Empty(PathBuf),
    /// A shader, module or pass that does not compose or validate.
    #[error("{location}: {message}")]
    Shader {
        /// The module's or pass's own file.
        location: Location,
        /// What is wrong, in WGSL's names.
        message: String,
    },
    /// A line of a `permutations` file.
    #[error("{location}: {message}")]
    Permutations {
        /// The line.
        location: Location,
        /// What is wrong.
        message: String,
    },
    /// Modules that import each other in a circle.
    #[error("{location}: import cycle {}", cycle.join(" -> "))]
    Cycle {
        /// The file of the first of them.
        location: Location,
        /// Their import paths, the first repeated at the end.
        cycle: Vec<String>,
    },
    /// A pass that is not in the library.
    #[error("no pass `{name}`; there are {}", list(known))]
    UnknownPass {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// A module that is not in the library.
    #[error("no module `{path}`; there are {}", list(known))]
    UnknownModule {
        /// What was asked for.
        path: String,
        /// What there is.
        known: Vec<String>,
    },
    /// A permutation that the pass does not have.
    #[error("pass `{pass}` has no permutation `{name}`; it has {}", list(known))]
    UnknownPermutation {
        /// The pass.
        pass: String,
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// Text that is no set of definitions.
    #[error("definition `{text}`: {message}")]
    Definition {
        /// The text.
        text: String,
        /// What is wrong.
        message: String,
    },
    /// A composed module that cannot be written in some form.
    #[error("{location}: cannot be written as {form}: {message}")]
    Write {
        /// The pass's own file.
        location: Location,
        /// The language or format.
        form: String,
        /// Why not.
        message: String,
    },
}

impl Error {
    /// The file, line and column that the error is about, where it is about one.
    pub fn location(&self) -> Option<&Location> {
        match self {
            Self::Shader { location, .. }
            | Self::Permutations { location, .. }
            | Self::Cycle { location, .. }
            | Self::Write { location, .. } => Some(location),
            _ => None,
        }
    }

    /// The error without its location.
    pub fn message(&self) -> String {
        let text = self.to_string();
        match self.location() {
            Some(location) => {
                let prefix = format!("{location}: ");
                text.strip_prefix(&prefix).map(str::to_owned).unwrap_or(text)
            }
            None => text,
        }
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
