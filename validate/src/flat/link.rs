// SPDX-License-Identifier: MIT OR Apache-2.0
//! Putting a pass and what it uses of its modules into one text, as the sources have it.

use super::{
    items::{Item, Piece, Unsupported, split},
    source,
};
use crate::{Library, ModuleSource, PassSource, names};
use naga_oil::compose::ShaderDefValue;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A pass with what it uses.
pub(super) struct Linked {
    /// `enable` and the like, which stand first.
    pub directives: String,
    /// Of each module that something is used of, after those that it imports: its path and items.
    pub modules: Vec<(String, String)>,
    /// The items of the pass.
    pub pass: String,
    /// Names of all bindings.
    pub bindings: BTreeSet<String>,
}

/// The items of a file.
struct Unit {
    items: Vec<Item>,
    by_name: BTreeMap<String, usize>,
}

/// An item: the module it is in, none for the pass, and its number there.
type Key = (String, usize);

/// The path that the pass itself goes by.
const PASS: &str = "";

/// Why there is no such text.
pub(super) enum Failure {
    /// A feature of naga_oil that needs more than text.
    Unsupported,
    /// The text of a file is wrong.
    Wrong {
        /// The file.
        file: String,
        /// What is wrong.
        message: String,
    },
}

/// Puts a pass together; `definitions` with `GROUP`.
pub(super) fn link(
    library: &Library,
    pass: &PassSource,
    mut definitions: HashMap<String, ShaderDefValue>,
) -> Result<Linked, Failure> {
    let modules = ordered(library.closure(&pass.imports));
    definitions.extend(source::own_definitions(&pass.source));
    for module in &modules {
        for (name, value) in source::own_definitions(&module.source) {
            definitions.entry(name).or_insert(value);
        }
    }
    let mut linker = Linker { units: BTreeMap::new(), modules, definitions, used: BTreeSet::new() };
    linker.add(PASS, &pass.file, &pass.source)?;
    linker.follow()?;
    Ok(linker.write())
}

/// Each module after those it imports, and otherwise by path: whatever the order of the library.
fn ordered(mut modules: Vec<&ModuleSource>) -> Vec<&ModuleSource> {
    modules.sort_by(|a, b| a.path.cmp(&b.path));
    let mut ordered: Vec<&ModuleSource> = Vec::with_capacity(modules.len());
    while !modules.is_empty() {
        let is_open = |path: &String| modules.iter().any(|module| module.path == *path);
        // A circle of imports does not compose; it must end here all the same.
        let next = modules.iter().position(|module| !module.imports.iter().any(is_open)).unwrap_or(0);
        ordered.push(modules.remove(next));
    }
    ordered
}

struct Linker<'a> {
    units: BTreeMap<String, Unit>,
    modules: Vec<&'a ModuleSource>,
    definitions: HashMap<String, ShaderDefValue>,
    used: BTreeSet<Key>,
}

impl Linker<'_> {
    fn add(&mut self, path: &str, file: &str, text: &str) -> Result<(), Failure> {
        let text = source::resolve(text, &self.definitions)
            .map_err(|message| Failure::Wrong { file: file.to_owned(), message })?;
        let items = split(&text).map_err(|Unsupported| Failure::Unsupported)?;
        let names = items.iter().enumerate().filter_map(|(index, item)| Some((item.name.clone()?, index)));
        let by_name = names.collect();
        self.units.insert(path.to_owned(), Unit { items, by_name });
        Ok(())
    }

    /// Everything of the pass is used, and whatever that refers to.
    fn follow(&mut self) -> Result<(), Failure> {
        let mut open: Vec<Key> = self.nameless(PASS, true);
        while let Some(key) = open.pop() {
            if !self.used.insert(key.clone()) {
                continue;
            }
            let (path, index) = &key;
            let names: BTreeSet<String> = match self.units.get(path).and_then(|unit| unit.items.get(*index)) {
                Some(item) => references(item).map(str::to_owned).collect(),
                None => continue,
            };
            for name in names {
                if let Some((module, _)) = names::module_and_item(&name)
                    && !self.units.contains_key(&module)
                    && let Some(source) = self.modules.iter().copied().find(|source| source.path == module)
                {
                    self.add(&module, &source.file, &source.source)?;
                    open.extend(self.nameless(&module, false));
                }
                open.extend(self.target(path, &name));
            }
        }
        Ok(())
    }

    /// Items of a file that nothing can refer to; with `all`, every one.
    fn nameless(&self, path: &str, all: bool) -> Vec<Key> {
        let items = self.units.get(path).map(|unit| unit.items.as_slice()).unwrap_or_default();
        let wanted = items.iter().enumerate().filter(|(_, item)| all || item.name.is_none());
        wanted.map(|(index, _)| (path.to_owned(), index)).collect()
    }

    /// The item that a name means in a file.
    fn target(&self, path: &str, name: &str) -> Option<Key> {
        let (path, name) = names::module_and_item(name).unwrap_or_else(|| (path.to_owned(), name.to_owned()));
        let index = *self.units.get(&path)?.by_name.get(&name)?;
        Some((path, index))
    }

    fn item(&self, key: &Key) -> Option<&Item> {
        self.units.get(&key.0)?.items.get(key.1)
    }

    fn used_items(&self) -> impl Iterator<Item = (&Key, &Item)> {
        self.used.iter().filter_map(|key| Some((key, self.item(key)?)))
    }

    /// What each used item of a module is called.
    fn names(&self) -> BTreeMap<Key, String> {
        let decorated: BTreeMap<&Key, String> = self
            .used_items()
            .filter_map(|(key, item)| {
                let name = item.name.as_deref()?;
                let is_own = key.0 == PASS;
                Some((key, if is_own { name.to_owned() } else { names::decorate(&key.0, name) }))
            })
            .collect();
        // A name must not mean something else where the item is used: a local variable, or, anywhere,
        // a function or type of WGSL's own.
        let mut elsewhere: BTreeMap<Key, BTreeSet<String>> = BTreeMap::new();
        let mut of_the_language = BTreeSet::new();
        for (key, item) in self.used_items() {
            let free: BTreeSet<&str> =
                references(item).filter(|name| self.target(&key.0, name).is_none()).collect();
            for name in references(item) {
                if let Some(target) = self.target(&key.0, name) {
                    let free = free.iter().map(|name| (*name).to_owned());
                    elsewhere.entry(target).or_default().extend(free);
                }
            }
            let is_free = |name: &&str| free.contains(name);
            of_the_language.extend(called(item).filter(is_free).map(str::to_owned));
        }
        let list: Vec<String> = decorated.values().cloned().collect();
        let keys: BTreeMap<&str, &Key> = decorated.iter().map(|(key, name)| (name.as_str(), *key)).collect();
        let chosen = names::choose(&list, |name, candidate| {
            let captured = keys.get(name).and_then(|key| elsewhere.get(*key));
            !of_the_language.contains(candidate) && !captured.is_some_and(|names| names.contains(candidate))
        });
        decorated.iter().filter_map(|(key, name)| Some(((*key).clone(), chosen.get(name)?.clone()))).collect()
    }

    fn write(&self) -> Linked {
        let names = self.names();
        let mut directives = BTreeSet::new();
        let mut bindings = BTreeSet::new();
        for (key, item) in self.used_items() {
            if item.is_directive {
                directives.insert(self.text(&key.0, item, &names));
            }
            if item.is_binding {
                let own = || item.name.clone().unwrap_or_default();
                bindings.insert(names.get(key).cloned().unwrap_or_else(own));
            }
        }
        let paths = self.modules.iter().map(|module| module.path.clone());
        let modules = paths
            .map(|path| (path.clone(), self.section(&path, &names)))
            .filter(|(_, text)| !text.is_empty())
            .collect();
        let directives = directives.into_iter().map(|line| line + "\n").collect();
        Linked { directives, modules, pass: self.section(PASS, &names), bindings }
    }

    /// The used items of a file.
    fn section(&self, path: &str, names: &BTreeMap<Key, String>) -> String {
        let Some(unit) = self.units.get(path) else { return String::new() };
        let mut text = String::new();
        let mut spaced = false;
        for (index, item) in unit.items.iter().enumerate() {
            spaced |= item.spaced;
            if item.is_directive || !self.used.contains(&(path.to_owned(), index)) {
                continue;
            }
            if spaced && !text.is_empty() {
                text.push('\n');
            }
            text.push_str(&self.text(path, item, names));
            text.push('\n');
            spaced = false;
        }
        text
    }

    fn text(&self, path: &str, item: &Item, names: &BTreeMap<Key, String>) -> String {
        let piece = |piece: &Piece| match piece {
            Piece::Text(text) => text.clone(),
            Piece::Name(name) => match self.target(path, name).and_then(|key| names.get(&key)) {
                Some(chosen) => chosen.clone(),
                None => names::item_of(name),
            },
        };
        item.pieces.iter().map(piece).collect()
    }
}

/// Names in an item that may refer to one.
fn references(item: &Item) -> impl Iterator<Item = &str> {
    item.pieces.iter().filter_map(|piece| match piece {
        Piece::Name(name) => Some(name.as_str()),
        Piece::Text(_) => None,
    })
}

/// Names that are called, or given arguments in `<…>`.
fn called(item: &Item) -> impl Iterator<Item = &str> {
    item.pieces.windows(2).filter_map(|pair| match pair {
        [Piece::Name(name), Piece::Text(after)] if after == "(" || after == "<" => Some(name.as_str()),
        _ => None,
    })
}
