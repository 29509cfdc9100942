// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which changes of a manifest a host notices.
//!
//! | what | added | removed | changed |
//! |---|---|---|---|
//! | module, pass, permutation | compatible | breaking | |
//! | file of a module or pass | | | breaking: copies and includes go by it |
//! | import of a module or pass | compatible | compatible | |
//! | definition of a permutation | breaking | breaking | breaking: the old set makes another shader |
//! | feature needed | breaking | compatible | |
//! | limit needed | breaking | compatible | breaking if greater |
//! | entry point | compatible | breaking | breaking: stage, workgroup size (hosts divide by it) |
//! | binding of an entry point | breaking | breaking: a layout that WebGPU derives loses it | |
//! | input of an entry point | breaking | compatible | breaking: type |
//! | output of an entry point | compatible | breaking | breaking: type |
//! | name of an input or output | | | compatible: found by location |
//! | resources that an entry point counts | | | compatible: what exceeds every device is a limit needed |
//! | binding | breaking, unless only new entry points use it | breaking | breaking |
//! | smallest size of a buffer | | | breaking if greater |
//! | whether a texture is filtered | | | breaking if it now is |
//! | struct | compatible: what uses it says so | breaking | breaking: size, alignment |
//! | member of a struct | breaking | breaking | breaking: type, offset, size, stride |
//!
//! Anything that these rules do not know is breaking.

use super::Effect::{self, Breaking, Compatible};
use serde_json::Value;
use std::collections::BTreeSet;

/// Where a permutation is in a manifest.
pub(super) const PERMUTATION: &str = "passes/*/permutations/*";

/// What a change is, and why. `pattern`: its place; `entry_points`: those that the old permutation has.
pub(super) fn judge(
    pattern: &str,
    old: Option<&Value>,
    new: Option<&Value>,
    entry_points: &BTreeSet<String>,
) -> (Effect, &'static str) {
    let (added, removed) = (old.is_none(), new.is_none());
    let greater = || {
        let number = |value: Option<&Value>| value.and_then(Value::as_f64);
        number(new) > number(old)
    };
    if let Some(part) = pattern.strip_prefix(PERMUTATION).map(|part| part.trim_start_matches('/')) {
        return match part {
            "" if added => (Compatible, "nobody asks for it yet"),
            "" => (Breaking, "whoever asks for it finds nothing"),
            _ if part.starts_with("definitions") => {
                (Breaking, "the old set of definitions makes another shader")
            }
            "needs/features/*" if removed => (Compatible, "fewer devices are excluded"),
            "needs/features/*" => (Breaking, "a device may lack it"),
            _ if part.starts_with("needs/limits/") && !greater() => {
                (Compatible, "less is asked of the device")
            }
            _ if part.starts_with("needs/limits/") => (Breaking, "a device may not reach it"),
            "entry_points/*" if added => (Compatible, "nobody calls it yet"),
            "entry_points/*" => (Breaking, "pipelines are made by its name"),
            "entry_points/*/bindings/*" if added => (Breaking, "a layout for the entry point lacks it"),
            "entry_points/*/bindings/*" => (Breaking, "a layout that WebGPU derives no longer has it"),
            "entry_points/*/workgroup_size" => (Breaking, "hosts divide the number of invocations by it"),
            "entry_points/*/inputs/*" if removed => (Compatible, "what is supplied is left unread"),
            "entry_points/*/inputs/*" => (Breaking, "it has to be supplied"),
            "entry_points/*/outputs/*" if added => (Compatible, "what has no target is dropped"),
            "entry_points/*/outputs/*" => (Breaking, "its target is no longer written"),
            "entry_points/*/inputs/*/name" | "entry_points/*/outputs/*/name" => {
                (Compatible, "it is found by its location")
            }
            _ if part.starts_with("entry_points/*/uses/") => {
                (Compatible, "every device has as much; what exceeds that is a limit needed")
            }
            "bindings/*" if added && only_new_entry_points(new, entry_points) => {
                (Compatible, "only new entry points use it")
            }
            "bindings/*" if added => (Breaking, "it has to be bound"),
            "bindings/*" => (Breaking, "whoever binds it finds nothing"),
            "bindings/*/size" | "bindings/*/min_size" if !added && !removed && !greater() => {
                (Compatible, "buffers of the old size are large enough")
            }
            "bindings/*/filtered" if new == Some(&Value::Bool(false)) => {
                (Compatible, "a filterable texture can be read as well")
            }
            "bindings/*/entry_points/*" => (Compatible, "the entry point says itself what it uses"),
            "structs/*" if added => (Compatible, "what uses it says so"),
            "structs/*/members/*" if added => (Breaking, "it has to be set"),
            _ if part.starts_with("structs/") => (Breaking, "the layout in memory is another"),
            _ => (Breaking, "what is bound no longer fits"),
        };
    }
    match pattern {
        "version" => (Compatible, "it says what may change"),
        "modules/*" | "passes/*" if added => (Compatible, "nobody asks for it yet"),
        "modules/*" => (Breaking, "whoever imports it finds nothing"),
        "passes/*" => (Breaking, "whoever asks for it finds nothing"),
        "modules/*/imports/*" | "passes/*/imports/*" => {
            (Compatible, "composing and vendoring follow imports")
        }
        "modules/*/file" | "passes/*/file" => (Breaking, "copies and includes go by it"),
        _ => (Breaking, "it is not known to be harmless"),
    }
}

/// Whether a new binding is used, and by entry points alone that are new as well.
fn only_new_entry_points(binding: Option<&Value>, entry_points: &BTreeSet<String>) -> bool {
    let users = binding.and_then(|binding| binding["entry_points"].as_array());
    users.is_some_and(|users| {
        let is_new = |user: &Value| user.as_str().is_some_and(|user| !entry_points.contains(user));
        !users.is_empty() && users.iter().all(is_new)
    })
}
