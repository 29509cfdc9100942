// SPDX-License-Identifier: MIT OR Apache-2.0
//! Definitions: the names and values that `#ifdef`, `#if` and `#{NAME}` see.

use crate::Error;
use std::{collections::BTreeMap, fmt, str::FromStr};

/// The value of a definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Definition {
    /// `NAME` (true) or `NAME=false`. Both count as defined for `#ifdef`.
    Flag(bool),
    /// `NAME=8`.
    Int(i32),
    /// `NAME=8u`.
    Unsigned(u32),
}

impl From<bool> for Definition {
    fn from(value: bool) -> Self {
        Self::Flag(value)
    }
}

impl From<i32> for Definition {
    fn from(value: i32) -> Self {
        Self::Int(value)
    }
}

impl From<u32> for Definition {
    fn from(value: u32) -> Self {
        Self::Unsigned(value)
    }
}

impl fmt::Display for Definition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(value) => write!(f, "{value}"),
            Self::Int(value) => write!(f, "{value}"),
            Self::Unsigned(value) => write!(f, "{value}u"),
        }
    }
}

impl FromStr for Definition {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let number = match text {
            "true" => return Ok(Self::Flag(true)),
            "false" => return Ok(Self::Flag(false)),
            _ => text.strip_suffix('u').map(str::parse).map(|n| n.map(Self::Unsigned)),
        };
        number.unwrap_or_else(|| text.parse().map(Self::Int)).map_err(|_| Error::Definition {
            text: text.to_owned(),
            message: "a value is true, false, a 32-bit integer like -8, or an unsigned one like 8u"
                .to_owned(),
        })
    }
}

/// A set of definitions, ordered by name, so that it prints and compares the same way everywhere.
///
/// The text form is that of the permutations files: `BASES=32 RGBA16FLOAT`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Definitions(BTreeMap<String, Definition>);

impl Definitions {
    /// No definitions.
    pub fn new() -> Self {
        Self::default()
    }

    /// With a value for a name, replacing an earlier one.
    #[must_use]
    pub fn set(mut self, name: impl Into<String>, value: impl Into<Definition>) -> Self {
        self.insert(name, value);
        self
    }

    /// With a name that `#ifdef` finds.
    #[must_use]
    pub fn flag(self, name: impl Into<String>) -> Self {
        self.set(name, true)
    }

    /// With those names that are asked for.
    #[must_use]
    pub fn flags(self, flags: &[(&str, bool)]) -> Self {
        let asked = flags.iter().filter(|(_, asked)| *asked);
        asked.fold(self, |all, (name, _)| all.flag(*name))
    }

    /// With everything of `other`, which wins where both define a name.
    #[must_use]
    pub fn merge(mut self, other: &Definitions) -> Self {
        self.0.extend(other.0.iter().map(|(name, value)| (name.clone(), *value)));
        self
    }

    /// Defines a name; returns its earlier value.
    pub fn insert(&mut self, name: impl Into<String>, value: impl Into<Definition>) -> Option<Definition> {
        self.0.insert(name.into(), value.into())
    }

    /// The value of a name.
    pub fn get(&self, name: &str) -> Option<Definition> {
        self.0.get(name).copied()
    }

    /// Whether a name is defined.
    pub fn contains(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    /// Names and values in the order of the names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, Definition)> {
        self.0.iter().map(|(name, value)| (name.as_str(), *value))
    }

    /// Whether nothing is defined.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// How many names are defined.
    pub fn len(&self) -> usize {
        self.0.len()
    }
}

impl<N: Into<String>, V: Into<Definition>> Extend<(N, V)> for Definitions {
    fn extend<I: IntoIterator<Item = (N, V)>>(&mut self, items: I) {
        self.0.extend(items.into_iter().map(|(name, value)| (name.into(), value.into())));
    }
}

impl<N: Into<String>, V: Into<Definition>> FromIterator<(N, V)> for Definitions {
    fn from_iter<I: IntoIterator<Item = (N, V)>>(items: I) -> Self {
        let mut definitions = Self::new();
        definitions.extend(items);
        definitions
    }
}

impl fmt::Display for Definitions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.iter().enumerate() {
            let space = if index == 0 { "" } else { " " };
            match value {
                Definition::Flag(true) => write!(f, "{space}{name}")?,
                value => write!(f, "{space}{name}={value}")?,
            }
        }
        Ok(())
    }
}

impl FromStr for Definitions {
    type Err = Error;

    /// Words `NAME` or `NAME=VALUE`; a name given twice is an error.
    fn from_str(text: &str) -> Result<Self, Error> {
        let mut definitions = Self::new();
        for word in text.split_whitespace() {
            let wrong =
                |message: &str| Error::Definition { text: word.to_owned(), message: message.to_owned() };
            let (name, value) = match word.split_once('=') {
                Some((name, value)) => {
                    let value = value.parse().map_err(|error: Error| wrong(explanation(&error)))?;
                    (name, value)
                }
                None => (word, Definition::Flag(true)),
            };
            if !is_name(name) {
                return Err(wrong("a name is letters, digits and `_`, and starts with no digit"));
            }
            if definitions.insert(name, value).is_some() {
                return Err(wrong("is defined twice"));
            }
        }
        Ok(definitions)
    }
}

fn explanation(error: &Error) -> &str {
    match error {
        Error::Definition { message, .. } => message,
        _ => "is malformed",
    }
}

fn is_name(text: &str) -> bool {
    text.chars().next().is_some_and(|first| first.is_ascii_alphabetic() || first == '_')
        && text.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn text_goes_round() {
        let text = "A=-1 B C=7u D=false";
        let definitions: Definitions = text.parse().unwrap();
        assert_eq!(definitions.to_string(), text);
        assert_eq!(definitions.get("A"), Some(Definition::Int(-1)));
        assert_eq!(definitions.get("B"), Some(Definition::Flag(true)));
        assert_eq!(definitions.get("C"), Some(Definition::Unsigned(7)));
        assert_eq!(definitions.get("D"), Some(Definition::Flag(false)));
    }

    #[test]
    fn bad_text_is_named() {
        for (text, part) in
            [("A=1.5", "A=1.5"), ("1A", "1A"), ("A A=2", "twice"), ("A=", "A="), ("A-B", "letters")]
        {
            let error = text.parse::<Definitions>().unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn the_later_set_wins() {
        let merged = Definitions::new().set("A", 1).merge(&Definitions::new().set("A", 2u32));
        assert_eq!(merged.get("A"), Some(Definition::Unsigned(2)));
    }
}
