// SPDX-License-Identifier: MIT OR Apache-2.0
//! Tables of a TOML document whose errors know file, line, column and key.

use crate::stylize::TransferError;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A file.
pub(super) struct Document<'a> {
    /// Where it lies.
    pub(super) path: &'a Path,
    /// What is in it.
    pub(super) text: &'a str,
}

impl<'a> Document<'a> {
    pub(super) fn parse(&self) -> Result<Spanned<DeTable<'a>>, TransferError> {
        DeTable::parse(self.text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            self.error(at, "TOML".to_owned(), error.message().trim().replace('\n', ", "))
        })
    }

    /// A path that the file names.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(name)
    }

    /// `at`: the byte where it is.
    fn error(&self, at: usize, key: String, reason: String) -> TransferError {
        let before = self.text.get(..at).unwrap_or(self.text);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        TransferError::File { path: self.path.to_owned(), line, column, key, reason }
    }
}

/// A value and the byte where it begins.
pub(super) type Located<T> = (T, usize);

/// A table.
pub(super) struct Fields<'a, 'i> {
    /// The file.
    pub(super) document: &'a Document<'i>,
    /// Where the table begins, bytes.
    pub(super) at: usize,
    path: String,
    table: &'a DeTable<'i>,
}

impl<'a, 'i> Fields<'a, 'i> {
    pub(super) fn new(document: &'a Document<'i>, path: &str, at: usize, table: &'a DeTable<'i>) -> Self {
        Self { document, at, path: path.to_owned(), table }
    }

    fn name(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    pub(super) fn error(&self, key: &str, at: usize, reason: String) -> TransferError {
        self.document.error(at, self.name(key), reason)
    }

    pub(super) fn refuse(&self, key: &str, at: usize, wrong: Option<String>) -> Result<(), TransferError> {
        wrong.map_or(Ok(()), |reason| Err(self.error(key, at, reason)))
    }

    pub(super) fn missing(&self, key: &str) -> TransferError {
        self.error(key, self.at, "the key is missing".to_owned())
    }

    /// Refuses every key but those.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), TransferError> {
        let unknown = self.table.keys().filter(|key| !known.contains(&key.get_ref().as_ref()));
        match unknown.min_by_key(|key| key.span().start) {
            None => Ok(()),
            Some(key) => {
                let reason = format!("the key is unknown here; known are {}", known.join(", "));
                Err(self.error(key.get_ref(), key.span().start, reason))
            }
        }
    }

    fn value(&self, key: &str) -> Option<Located<&'a DeValue<'i>>> {
        let (_, value) = self.table.iter().find(|(name, _)| name.get_ref().as_ref() == key)?;
        Some((value.get_ref(), value.span().start))
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    pub(super) fn is_text(&self, key: &str) -> bool {
        matches!(self.value(key), Some((DeValue::String(_), _)))
    }

    pub(super) fn required<T>(
        &self,
        key: &str,
        read: impl Fn(&Self, &str) -> Result<Option<Located<T>>, TransferError>,
    ) -> Result<Located<T>, TransferError> {
        read(self, key)?.ok_or_else(|| self.missing(key))
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<Located<String>>, TransferError> {
        match self.value(key) {
            None => Ok(None),
            Some((DeValue::String(text), at)) => Ok(Some((text.to_string(), at))),
            Some((_, at)) => Err(self.error(key, at, "a text in quotes is needed".to_owned())),
        }
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<Located<f64>>, TransferError> {
        let Some((value, at)) = self.value(key) else { return Ok(None) };
        let number = number(value).ok_or_else(|| self.error(key, at, "a number is needed".to_owned()))?;
        Ok(Some((number, at)))
    }

    pub(super) fn whole(&self, key: &str) -> Result<Option<Located<i64>>, TransferError> {
        let Some((number, at)) = self.number(key)? else { return Ok(None) };
        let fits = number.fract() == 0.0 && number.abs() < 1e15;
        self.refuse(key, at, (!fits).then(|| format!("{number} is no whole number")))?;
        Ok(Some((number as i64, at)))
    }

    /// A number that passes a check, as f32.
    pub(super) fn checked(
        &self,
        key: &str,
        wrong: fn(f64) -> Option<String>,
    ) -> Result<Option<f32>, TransferError> {
        let Some((number, at)) = self.number(key)? else { return Ok(None) };
        self.refuse(key, at, wrong(number))?;
        Ok(Some(number as f32))
    }

    pub(super) fn numbers<const N: usize>(
        &self,
        key: &str,
    ) -> Result<Option<Located<[f64; N]>>, TransferError> {
        let Some((value, at)) = self.value(key) else { return Ok(None) };
        let list = if let DeValue::Array(list) = value {
            list.iter().map(|item| number(item.get_ref())).collect::<Option<Vec<_>>>()
        } else {
            None
        };
        match list.and_then(|list| <[f64; N]>::try_from(list).ok()) {
            Some(numbers) => Ok(Some((numbers, at))),
            None => Err(self.error(key, at, format!("a list of {N} numbers is needed"))),
        }
    }

    pub(super) fn choice<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<Option<T>, TransferError> {
        let Some((text, at)) = self.text(key)? else { return Ok(None) };
        match words.iter().find(|(word, _)| *word == text) {
            Some((_, value)) => Ok(Some(*value)),
            None => {
                let known: Vec<_> = words.iter().map(|(word, _)| *word).collect();
                Err(self.error(key, at, format!("`{text}` is unknown; known are {}", known.join(", "))))
            }
        }
    }

    pub(super) fn table(&self, key: &str) -> Result<Option<Fields<'a, 'i>>, TransferError> {
        match self.value(key) {
            None => Ok(None),
            Some((DeValue::Table(table), at)) => {
                Ok(Some(Fields::new(self.document, &self.name(key), at, table)))
            }
            Some((_, at)) => Err(self.error(key, at, "a table in braces is needed".to_owned())),
        }
    }

    /// Tables of a list; none where it is missing.
    pub(super) fn tables(&self, key: &str) -> Result<Vec<Fields<'a, 'i>>, TransferError> {
        let wrong =
            |at| self.error(key, at, format!("tables are needed, each headed [[{}]]", self.header(key)));
        let (list, _) = match self.value(key) {
            None => return Ok(Vec::new()),
            Some((DeValue::Array(list), at)) => (list, at),
            Some((_, at)) => return Err(wrong(at)),
        };
        let table = |(number, item): (usize, &'a Spanned<DeValue<'i>>)| match item.get_ref() {
            DeValue::Table(table) => {
                let path = format!("{}[{number}]", self.name(key));
                Ok(Fields::new(self.document, &path, item.span().start, table))
            }
            _ => Err(wrong(item.span().start)),
        };
        list.iter().enumerate().map(table).collect()
    }

    /// How the tables of a list are headed: without numbers.
    fn header(&self, key: &str) -> String {
        let name = self.name(key);
        name.split('.').map(|part| part.split('[').next().unwrap_or(part)).collect::<Vec<_>>().join(".")
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(number) => {
            i64::from_str_radix(number.as_str(), number.radix()).ok().map(|number| number as f64)
        }
        DeValue::Float(number) => number.as_str().parse().ok(),
        _ => None,
    }
}
