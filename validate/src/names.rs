// SPDX-License-Identifier: MIT OR Apache-2.0
//! Readable names for what naga_oil decorated.
//!
//! A composed item is called `<item>X_naga_oil_mod_X<module path in BASE32>X`; a function that
//! overrides a virtual one carries the path of the overridden module in `X_naga_oil_vrt_X…X` too.

use data_encoding::BASE32_NOPAD;
use std::collections::{BTreeMap, BTreeSet};

const MODULE: &str = "X_naga_oil_mod_X";
const VIRTUAL: &str = "X_naga_oil_vrt_X";

/// A decorated name, taken apart.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Decorated {
    item: String,
    /// The module that declares it; none for an override in the pass itself.
    module: Option<String>,
    /// Whether it overrides a virtual function.
    overrides: bool,
}

/// Takes a name apart; none where it carries no decoration.
fn decode(name: &str) -> Option<Decorated> {
    let (rest, module) = match name.rfind(MODULE) {
        Some(at) => (&name[..at], Some(path(&name[at + MODULE.len()..])?.0)),
        None => (name, None),
    };
    let item = rest.find(VIRTUAL).map(|at| &rest[..at]);
    if module.is_none() && item.is_none() {
        return None;
    }
    let overrides = item.is_some();
    Some(Decorated { item: item.unwrap_or(rest).to_owned(), module, overrides })
}

/// The module path at the start of `text` and the length of its code with the closing `X`.
///
/// `X` is a BASE32 letter as well, so the code is cut at the last `X` that leaves a path.
fn path(text: &str) -> Option<(String, usize)> {
    let run = text.find(|c: char| !c.is_ascii_uppercase() && !c.is_ascii_digit());
    let run = &text[..run.unwrap_or(text.len())];
    run.rmatch_indices('X').find_map(|(at, _)| {
        let bytes = BASE32_NOPAD.decode(&run.as_bytes()[..at]).ok()?;
        let path = String::from_utf8(bytes).ok()?;
        let plain = path.chars().all(|c| c.is_alphanumeric() || "_:/.\"-".contains(c));
        (plain && !path.is_empty()).then_some((path, at + 1))
    })
}

/// Whether a name comes from another file than the one that is composed.
pub(crate) fn is_decorated(name: &str) -> bool {
    name.contains(MODULE) || name.contains(VIRTUAL)
}

/// Text of a message with every decorated name written as `module::item`.
pub(crate) fn undecorate(text: &str) -> String {
    let mut output = String::with_capacity(text.len());
    let mut rest = text;
    loop {
        let next = [MODULE, VIRTUAL].iter().filter_map(|mark| rest.find(mark)).min();
        let Some(at) = next else {
            output.push_str(rest);
            return output;
        };
        let head = &rest[..at];
        let word = head
            .rfind(|c: char| !c.is_alphanumeric() && c != '_')
            .map_or(0, |i| i + head[i..].chars().next().map_or(1, char::len_utf8));
        let is_override = rest[at..].starts_with(VIRTUAL);
        let Some((module, length)) = path(&rest[at + MODULE.len()..]) else {
            output.push_str(&rest[..at + MODULE.len()]);
            rest = &rest[at + MODULE.len()..];
            continue;
        };
        output.push_str(&head[..word]);
        let item = &head[word..];
        if is_override {
            output.push_str("override of ");
        }
        output.push_str(&format!("{module}::{item}"));
        rest = &rest[at + MODULE.len() + length..];
        // The second decoration of an override says who overrides; the name is complete without.
        if is_override
            && let Some(tail) = rest.strip_prefix(MODULE)
            && let Some((_, length)) = path(tail)
        {
            rest = &tail[length..];
        }
    }
}

/// The item that a decorated name means, without its module; any other name as it is.
#[cfg_attr(not(feature = "command"), allow(dead_code))]
pub(crate) fn item_of(name: &str) -> String {
    decode(name).map_or_else(|| name.to_owned(), |decorated| decorated.item)
}

/// Module and item that a decorated name means.
#[cfg_attr(not(feature = "command"), allow(dead_code))]
pub(crate) fn module_and_item(name: &str) -> Option<(String, String)> {
    let decorated = decode(name)?;
    Some((decorated.module?, decorated.item))
}

/// The decorated name of an item of a module, as naga_oil writes it.
#[cfg_attr(not(feature = "command"), allow(dead_code))]
pub(crate) fn decorate(module: &str, item: &str) -> String {
    format!("{item}{MODULE}{}X", BASE32_NOPAD.encode(module.as_bytes()))
}

/// Gives every item of a composed module a readable name of its own: the short one where that is
/// unambiguous, else with the module's name before it. What the pass declares keeps its name.
pub(crate) fn make_readable(module: &mut naga::Module) {
    let names = choose(&global_names(module), |_, _| true);
    let rename = |name: &mut Option<String>| {
        if let Some(new) = name.as_ref().and_then(|name| names.get(name)) {
            *name = Some(new.clone());
        }
    };
    for (_, constant) in module.constants.iter_mut() {
        rename(&mut constant.name);
    }
    for (_, constant) in module.overrides.iter_mut() {
        rename(&mut constant.name);
    }
    for (_, variable) in module.global_variables.iter_mut() {
        rename(&mut variable.name);
    }
    for (_, function) in module.functions.iter_mut() {
        rename(&mut function.name);
        rename_locals(function);
    }
    for entry_point in &mut module.entry_points {
        rename_locals(&mut entry_point.function);
    }
    let types: Vec<_> = module.types.iter().map(|(handle, ty)| (handle, ty.clone())).collect();
    for (handle, mut ty) in types {
        let before = ty.clone();
        rename(&mut ty.name);
        if let naga::TypeInner::Struct { members, .. } = &mut ty.inner {
            for member in members {
                shorten(&mut member.name);
            }
        }
        // `replace` panics on a type that is already there.
        if ty != before && module.types.get(&ty).is_none() {
            module.types.replace(handle, ty);
        }
    }
}

/// Names of everything that is declared at module scope.
pub(crate) fn global_names(module: &naga::Module) -> Vec<String> {
    let constants = module.constants.iter().filter_map(|(_, item)| item.name.clone());
    let overrides = module.overrides.iter().filter_map(|(_, item)| item.name.clone());
    let variables = module.global_variables.iter().filter_map(|(_, item)| item.name.clone());
    let functions = module.functions.iter().filter_map(|(_, item)| item.name.clone());
    let types = module.types.iter().filter_map(|(_, item)| item.name.clone());
    let entry_points = module.entry_points.iter().map(|item| item.name.clone());
    constants.chain(overrides).chain(variables).chain(functions).chain(types).chain(entry_points).collect()
}

/// A name imported item by item replaces local names that shadow it; those need no module.
fn rename_locals(function: &mut naga::Function) {
    for argument in &mut function.arguments {
        shorten(&mut argument.name);
    }
    for (_, local) in function.local_variables.iter_mut() {
        shorten(&mut local.name);
    }
    for name in function.named_expressions.values_mut() {
        if let Some(decorated) = decode(name) {
            *name = decorated.item;
        }
    }
}

fn shorten(name: &mut Option<String>) {
    if let Some(decorated) = name.as_deref().and_then(decode) {
        *name = Some(decorated.item);
    }
}

/// Readable names for the decorated ones among `names`; `may(decorated, readable)` says which are allowed.
pub(crate) fn choose(names: &[String], may: impl Fn(&str, &str) -> bool) -> BTreeMap<String, String> {
    let mut taken: BTreeSet<String> = names.iter().filter(|name| decode(name).is_none()).cloned().collect();
    let decorated: BTreeMap<&String, Decorated> =
        names.iter().filter_map(|name| Some((name, decode(name)?))).collect();
    let short = |item: &Decorated| {
        let suffix = if item.overrides { "_override" } else { "" };
        format!("{}{suffix}", item.item)
    };
    let mut claims: BTreeMap<String, u32> = BTreeMap::new();
    for item in decorated.values() {
        *claims.entry(short(item)).or_default() += 1;
    }
    let mut chosen = BTreeMap::new();
    for (name, item) in decorated {
        let plain = short(&item);
        let module = item.module.clone().unwrap_or_default();
        let last = module.rsplit("::").next().unwrap_or_default();
        let candidates = [
            (claims.get(&plain) == Some(&1)).then(|| plain.clone()),
            Some(format!("{last}_{plain}")),
            Some(format!("{}_{plain}", module.replace("::", "_"))),
        ];
        let numbered = (2..).map(|number| Some(format!("{plain}_{number}x")));
        let new =
            candidates.into_iter().chain(numbered).flatten().find(|c| !taken.contains(c) && may(name, c));
        if let Some(new) = new {
            taken.insert(new.clone());
            chosen.insert(name.clone(), new);
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_name_is_taken_apart() {
        // Every length of path, so that each remainder of BASE32 and codes that end in X occur.
        for length in 1..40 {
            for tail in ["o", "W", "w", "x", "X"] {
                let module =
                    format!("{}{tail}", "airlight::core::camera_of_the_picture_plane".get(..length).unwrap());
                let name = decorate(&module, "fX");
                let parts = decode(&name).unwrap();
                assert_eq!(
                    parts,
                    Decorated { item: "fX".into(), module: Some(module.clone()), overrides: false }
                );
                assert_eq!(undecorate(&format!("no `{name}` here")), format!("no `{module}::fX` here"));
            }
        }
        assert_eq!(decode("plain"), None);
    }

    #[test]
    fn an_override_is_taken_apart() {
        let target = format!("f{VIRTUAL}{}X", BASE32_NOPAD.encode(b"airlight::core::a"));
        let parts = decode(&target).unwrap();
        assert_eq!(parts, Decorated { item: "f".into(), module: None, overrides: true });
        let full = decorate("airlight::core::b", &target);
        let parts = decode(&full).unwrap();
        assert_eq!(parts.item, "f");
        assert_eq!(parts.module.as_deref(), Some("airlight::core::b"));
        assert_eq!(undecorate(&full), "override of airlight::core::a::f");
    }

    #[test]
    fn ambiguous_names_take_the_module() {
        let names = [
            decorate("airlight::core::a", "f"),
            decorate("airlight::core::b", "f"),
            decorate("airlight::core::a", "g"),
            decorate("airlight::core::a", "own"),
            "own".to_owned(),
            "main".to_owned(),
        ];
        let chosen = choose(&names, |_, _| true);
        assert_eq!(chosen[&names[0]], "a_f");
        assert_eq!(chosen[&names[1]], "b_f");
        assert_eq!(chosen[&names[2]], "g");
        assert_eq!(chosen[&names[3]], "a_own");
        assert!(!chosen.contains_key("own"));
        let distinct: BTreeSet<_> = chosen.values().collect();
        assert_eq!(distinct.len(), chosen.len());
    }

    #[test]
    fn same_module_name_in_two_systems() {
        let names = [decorate("airlight::core::m", "f"), decorate("airlight::stylize::m", "f")];
        let chosen = choose(&names, |_, _| true);
        assert_ne!(chosen[&names[0]], chosen[&names[1]]);
    }
}
