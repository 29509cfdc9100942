// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stand-alone WGSL: a composed pass in one file, for engines without a composer.

use crate::{Composed, Error, Location, names};
use std::collections::BTreeSet;

/// The composed module as WGSL without directives.
///
/// Bindings, structs, constants, functions and entry points keep their names. naga's writer drops
/// comments, writes `for` as `loop` and folds constants.
///
/// # Errors
/// Something that naga cannot write as WGSL.
pub fn write(composed: &Composed) -> Result<String, Error> {
    let mut module = composed.module.clone();
    yield_names(&mut module);
    let flags = naga::back::wgsl::WriterFlags::empty();
    naga::back::wgsl::write_string(&module, &composed.info, flags).map_err(|error| Error::Write {
        location: Location::file(&composed.file),
        form: "flat WGSL".to_owned(),
        message: error.to_string(),
    })
}

/// The writer hands out names to arguments and local variables before bindings and constants, and
/// numbers what comes later; so those that shadow something of the module take another name.
fn yield_names(module: &mut naga::Module) {
    let taken: BTreeSet<String> = names::global_names(module).into_iter().collect();
    let dodge = |name: &mut Option<String>, suffix: &str| {
        while let Some(shadowing) = name.as_mut().filter(|name| taken.contains(name.as_str())) {
            shadowing.push_str(suffix);
        }
    };
    let functions = module.functions.iter_mut().map(|(_, function)| function);
    let entry_points = module.entry_points.iter_mut().map(|entry| &mut entry.function);
    for function in functions.chain(entry_points) {
        for argument in &mut function.arguments {
            dodge(&mut argument.name, "_in");
        }
        for (_, variable) in function.local_variables.iter_mut() {
            dodge(&mut variable.name, "_var");
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::{Definitions, Library};

    #[test]
    fn bindings_and_functions_keep_their_names() {
        let module = "#define_import_path airlight::core::leaf\nfn blend(view: f32, later: f32) -> f32 { var size = view; size += later; return size; }\nfn later(x: f32) -> f32 { return x; }\n";
        let pass = "#import airlight::core::leaf\nconst size: f32 = 4.0;\n@group(0) @binding(0) var<uniform> view: vec4<f32>;\n@group(0) @binding(1) var<storage, read_write> output: array<f32>;\n@compute @workgroup_size(1) fn main() { output[0] = leaf::blend(view.x, size) + leaf::later(size); }\n";
        let library = Library::from_text(
            &[("core/leaf.wgsl", module)],
            &[("core/passes/pass.wgsl", pass)],
            &[("core", "pass\n+ default:\n")],
        );
        let composed = library.compose("core/pass", &Definitions::new()).unwrap();
        let text = super::write(&composed).unwrap();
        for kept in ["> view: vec4<f32>", "output: array<f32>", "fn later(", "fn blend(view_in"] {
            assert!(text.contains(kept), "{kept} in {text}");
        }
    }
}
