// SPDX-License-Identifier: MIT OR Apache-2.0
//! What changed between two manifests, and whether a host that was written for the old one still works.
//!
//! Everything that differs is a [`Change`]; [`rules`] says of each which it is. A list is compared by the names of
//! what is in it, so that its order does not matter.

pub mod rules;
mod version;

use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// The format of manifests that can be compared.
const FORMAT: u64 = 1;

/// Whether a host notices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// A host that was written for the old manifest may fail, or do something else.
    Breaking,
    /// It goes on as before.
    Compatible,
}

/// A difference of two manifests.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Pass and permutation, `<system>/<pass>:<permutation>`, pass, or module; empty for the manifest as a whole.
    pub subject: String,
    /// What of it, `binding camera, group`; empty for all of it.
    pub part: String,
    /// The old value as JSON; none for something new.
    pub before: Option<String>,
    /// The new value as JSON; none for something removed.
    pub after: Option<String>,
    /// Whether a host notices.
    pub effect: Effect,
    /// Why.
    pub reason: &'static str,
}

/// The differences of two manifests.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Every difference, in the order of the manifests.
    pub changes: Vec<Change>,
    /// Versions, old and new; empty where a manifest has none.
    pub versions: [String; 2],
}

impl Comparison {
    /// Whether something is breaking.
    pub fn is_breaking(&self) -> bool {
        self.changes.iter().any(|change| change.effect == Effect::Breaking)
    }

    /// Whether the new version allows a breaking change: a greater major version, or, below 1.0, a greater minor one.
    pub fn is_bumped(&self) -> bool {
        version::allows_breaking(&self.versions[0], &self.versions[1])
    }

    /// The changes as lines, breaking ones first; what is the same in several permutations is said once.
    pub fn render(&self) -> String {
        let mut groups: BTreeMap<(Effect, usize), (&Change, Vec<&str>)> = BTreeMap::new();
        let mut first = BTreeMap::new();
        for (index, change) in self.changes.iter().enumerate() {
            // Whole passes and permutations stand for themselves.
            let alone = if change.part.is_empty() { change.subject.as_str() } else { "" };
            let key = (change.part.as_str(), &change.before, &change.after, alone);
            let at = *first.entry(key).or_insert(index);
            groups.entry((change.effect, at)).or_insert((change, Vec::new())).1.push(&change.subject);
        }
        let mut text = String::new();
        for ((effect, _), (change, subjects)) in groups {
            let effect = if effect == Effect::Breaking { "breaking" } else { "compatible" };
            let more = subjects.len().saturating_sub(3);
            let mut subject = subjects[..subjects.len() - more].join(", ");
            if more > 0 {
                let _ = write!(subject, " and {more} more");
            }
            let place = [subject.as_str(), change.part.as_str()];
            let place: Vec<&str> = place.into_iter().filter(|part| !part.is_empty()).collect();
            let what = match (&change.before, &change.after) {
                (Some(before), Some(after)) => format!("{} -> {}", short(before), short(after)),
                (None, Some(_)) if change.part.is_empty() => "added".to_owned(),
                (Some(_), None) if change.part.is_empty() => "removed".to_owned(),
                (None, after) => format!("added {}", short(after.as_deref().unwrap_or_default())),
                (Some(before), None) => format!("removed {}", short(before)),
            };
            let _ = writeln!(text, "{effect}: {}: {what} ({})", place.join(", "), change.reason);
        }
        text
    }
}

/// A value that fits on a line.
fn short(value: &str) -> String {
    const MOST: usize = 120;
    match value.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &value[..end]),
        None => value.to_owned(),
    }
}

/// Reads a manifest; says why it is none.
///
/// # Errors
/// Text that is no JSON, no manifest, or a manifest of another format.
pub fn read(text: &str) -> Result<Value, String> {
    let value: Value = serde_json::from_str(text).map_err(|error| format!("is no JSON: {error}"))?;
    match value.get("format").map(Value::as_u64) {
        Some(Some(FORMAT)) => {}
        Some(_) => {
            let found = &value["format"];
            return Err(format!(
                "has format {found}; this version of airlight-validate reads format {FORMAT}"
            ));
        }
        None => return Err("is no manifest: it has no `format`".to_owned()),
    }
    for list in ["modules", "passes"] {
        if !value.get(list).is_some_and(Value::is_array) {
            return Err(format!("is no manifest: it has no list `{list}`"));
        }
    }
    Ok(value)
}

/// Compares two manifests that [`read`] has read.
pub fn compare(old: &Value, new: &Value) -> Comparison {
    let version = |manifest: &Value| manifest["version"].as_str().unwrap_or_default().to_owned();
    let mut walk = Walk { changes: Vec::new(), entry_points: BTreeSet::new() };
    walk.values(&Place::default(), Some(old), Some(new));
    Comparison { changes: walk.changes, versions: [version(old), version(new)] }
}

/// Where in a manifest something is.
#[derive(Clone, Default)]
struct Place {
    /// Names of members, `*` for an element of a list: `passes/*/permutations/*/bindings/*/group`.
    pattern: String,
    subject: String,
    part: Vec<String>,
}

impl Place {
    fn step(&self, step: &str) -> Self {
        let mut place = self.clone();
        if !place.pattern.is_empty() {
            place.pattern.push('/');
        }
        place.pattern.push_str(step);
        place
    }

    fn member(&self, name: &str) -> Self {
        let mut place = self.step(name);
        if !LISTS.iter().any(|(list, _)| *list == name) {
            place.part.push(name.to_owned());
        }
        place
    }

    fn element(&self, list: &str, name: &str) -> Self {
        let mut place = self.step("*");
        match list {
            "modules" | "passes" => place.subject = name.to_owned(),
            "permutations" => place.subject = format!("{}:{name}", self.subject),
            _ => {
                let singular = LISTS.iter().find(|(known, _)| *known == list).and(list.strip_suffix('s'));
                let of = singular.map(|word| format!("{} ", word.replace('_', " "))).unwrap_or_default();
                place.part.push(format!("{of}{name}"));
            }
        }
        place
    }
}

/// Lists of objects, and the member that tells these apart.
const LISTS: [(&str, &str); 9] = [
    ("modules", "path"),
    ("passes", "name"),
    ("permutations", "name"),
    ("entry_points", "name"),
    ("bindings", "name"),
    ("structs", "name"),
    ("members", "name"),
    ("inputs", "location"),
    ("outputs", "location"),
];

/// Lists whose order says something.
const ORDERED: [&str; 1] = ["workgroup_size"];

struct Walk {
    changes: Vec<Change>,
    /// Entry points that the old permutation has.
    entry_points: BTreeSet<String>,
}

impl Walk {
    fn values(&mut self, place: &Place, old: Option<&Value>, new: Option<&Value>) {
        if old == new {
            return;
        }
        if place.pattern == rules::PERMUTATION {
            let old = old.and_then(|old| old["entry_points"].as_array());
            let names = old.into_iter().flatten().filter_map(|entry| entry["name"].as_str());
            self.entry_points = names.map(str::to_owned).collect();
        }
        let list = place.pattern.rsplit('/').next().unwrap_or_default().to_owned();
        match (old, new) {
            (Some(Value::Object(old)), Some(Value::Object(new))) => self.objects(place, old, new),
            (Some(Value::Array(old)), Some(Value::Array(new))) if !ORDERED.contains(&list.as_str()) => {
                self.lists(place, &list, old, new);
            }
            _ => {
                let (effect, reason) = rules::judge(&place.pattern, old, new, &self.entry_points);
                self.changes.push(Change {
                    subject: place.subject.clone(),
                    part: place.part.join(", "),
                    before: old.map(Value::to_string),
                    after: new.map(Value::to_string),
                    effect,
                    reason,
                });
            }
        }
    }

    fn objects(&mut self, place: &Place, old: &Map<String, Value>, new: &Map<String, Value>) {
        for (name, value) in old {
            self.values(&place.member(name), Some(value), new.get(name));
        }
        for (name, value) in new.iter().filter(|(name, _)| !old.contains_key(*name)) {
            self.values(&place.member(name), None, Some(value));
        }
    }

    fn lists(&mut self, place: &Place, list: &str, old: &[Value], new: &[Value]) {
        let key = LISTS.iter().find(|(name, _)| *name == list).map(|(_, key)| *key);
        let (old, new) = (by_name(key, old), by_name(key, new));
        for (name, value) in &old {
            let other = new.iter().find(|(other, _)| other == name).map(|(_, value)| *value);
            self.values(&place.element(list, name), Some(value), other);
        }
        for (name, value) in new.iter().filter(|(name, _)| !old.iter().any(|(other, _)| other == name)) {
            self.values(&place.element(list, name), None, Some(value));
        }
    }
}

/// The elements of a list by their names; a name that is there twice is numbered.
fn by_name<'a>(key: Option<&str>, values: &'a [Value]) -> Vec<(String, &'a Value)> {
    let mut seen: BTreeMap<String, u32> = BTreeMap::new();
    let named = values.iter().map(|value| {
        let name = key.and_then(|key| value.get(key)).unwrap_or(value);
        let name = name.as_str().map_or_else(|| name.to_string(), str::to_owned);
        let times = seen.entry(name.clone()).or_default();
        *times += 1;
        (if *times > 1 { format!("{name} ({times})") } else { name }, value)
    });
    named.collect()
}

#[cfg(test)]
mod tests;
