// SPDX-License-Identifier: MIT OR Apache-2.0
//! Making one module of a pass and what it imports.

use crate::{
    Definition, Definitions, Error, Library, Location, imports, library::resolve, locate, names,
    reflect::Reflection,
};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga_oil::compose::{
    ComposableModuleDescriptor, Composer, ImportDefinition, NagaModuleDescriptor, ShaderDefValue,
};
use std::{
    collections::HashMap,
    panic::{AssertUnwindSafe, catch_unwind},
};

/// What WGSL has in core WebGPU, without any optional feature.
pub fn core_capabilities() -> Capabilities {
    Capabilities::CUBE_ARRAY_TEXTURES
        | Capabilities::MULTISAMPLED_SHADING
        | Capabilities::SHADER_FLOAT16_IN_FLOAT32
}

/// A pass, or a module alone, composed with everything it imports and validated.
#[derive(Debug)]
pub struct Composed {
    /// Name of the pass, or path of the module.
    pub pass: String,
    /// File of the pass or module, relative to the root of the library.
    pub file: String,
    /// The definitions it was composed with, without the implied `GROUP=0`.
    pub definitions: Definitions,
    /// The module, with readable names.
    pub module: naga::Module,
    /// What validation found out about it.
    pub info: ModuleInfo,
}

impl Composed {
    /// Entry points, bindings and struct layouts.
    pub fn reflect(&self) -> Reflection {
        Reflection::new(&self.module, &self.info)
    }
}

/// What is to be composed.
struct Subject<'a> {
    name: &'a str,
    file: &'a str,
    source: &'a str,
    imports: &'a [String],
    additional: &'a [ImportDefinition],
}

impl Library {
    /// Composes a pass. `GROUP` is 0 unless the definitions set it.
    ///
    /// # Errors
    /// An unknown pass, or anything that does not compose or validate as core WebGPU; the error
    /// names the file, line and column of the module that is wrong.
    pub fn compose(&self, pass: &str, definitions: &Definitions) -> Result<Composed, Error> {
        let pass = self.pass(pass)?;
        let subject = Subject {
            name: &pass.name,
            file: &pass.file,
            source: &pass.source,
            imports: &pass.imports,
            additional: &[],
        };
        self.finish(&subject, definitions, self.raw(&subject, definitions)?)
    }

    /// Composes a module alone, with every item of it forced into use: a module that is imported
    /// but not used composes even with errors in it.
    ///
    /// # Errors
    /// As [`Library::compose`].
    pub fn compose_module(&self, path: &str, definitions: &Definitions) -> Result<Composed, Error> {
        let module = self.module(path)?;
        let alone = Subject {
            name: &module.path,
            file: &module.file,
            source: &module.source,
            imports: &module.imports,
            additional: &[],
        };
        // As a whole shader: every function of it is validated, used or not.
        let items = own_items(&self.raw(&alone, definitions)?);
        // As an import: what an importer sees is written out and read again, which other names and
        // constants survive.
        let additional = [ImportDefinition { import: module.path.clone(), items }];
        let imports = [module.path.clone()];
        let imported = Subject { source: "", imports: &imports, additional: &additional, ..alone };
        self.finish(&imported, definitions, self.raw(&imported, definitions)?)
    }

    /// The module with decorated names.
    fn raw(&self, subject: &Subject, definitions: &Definitions) -> Result<naga::Module, Error> {
        let modules = self.closure(subject.imports);
        for module in &modules {
            self.check_imports(&module.file, &module.source, Some(&module.path))?;
        }
        self.check_imports(subject.file, subject.source, None)?;

        let shader_defs = shader_definitions(definitions);
        let composing = AssertUnwindSafe(|| {
            let mut composer = Composer::default().with_capabilities(core_capabilities());
            for module in &modules {
                let added = composer.add_composable_module(ComposableModuleDescriptor {
                    source: &module.source,
                    file_path: &module.file,
                    // A file that is imported by its name has no path of its own.
                    as_name: module.path.starts_with('"').then(|| module.path.clone()),
                    ..Default::default()
                });
                if let Err(error) = added {
                    let (file, source) = (&module.file, &module.source);
                    return Err(locate::locate(&error, &composer, self, file, source));
                }
            }
            let made = composer.make_naga_module(NagaModuleDescriptor {
                source: subject.source,
                file_path: subject.file,
                shader_defs,
                additional_imports: subject.additional,
                ..Default::default()
            });
            made.map_err(|error| locate::locate(&error, &composer, self, subject.file, subject.source))
        });
        // The composer unwraps in places; a shader must not bring its host down.
        catch_unwind(composing).unwrap_or_else(|_| {
            Err(Error::Shader {
                location: Location::file(subject.file),
                message: "the composer panicked on it or on a module that it imports".to_owned(),
            })
        })
    }

    fn finish(
        &self,
        subject: &Subject,
        definitions: &Definitions,
        mut module: naga::Module,
    ) -> Result<Composed, Error> {
        names::make_readable(&mut module);
        let info = validate(&module).map_err(|error| Error::Shader {
            location: Location::file(subject.file),
            message: locate::chain(error.as_inner()),
        })?;
        Ok(Composed {
            pass: subject.name.to_owned(),
            file: subject.file.to_owned(),
            definitions: definitions.clone(),
            module,
            info,
        })
    }

    /// Every declared import is a module that is listed earlier, or an item of one.
    fn check_imports(&self, file: &str, source: &str, own: Option<&str>) -> Result<(), Error> {
        let position = |path: &str| self.modules().iter().position(|module| module.path == path);
        let limit = own.and_then(position).unwrap_or(self.modules().len());
        for import in imports::declared(source) {
            let wrong = |message: String| Error::Shader {
                location: Location {
                    file: file.to_owned(),
                    line: Some(import.line),
                    column: Some(import.column),
                },
                message,
            };
            let module = resolve(&import.path, |path| position(path).is_some());
            let Some(index) = module.and_then(position) else {
                let path = &import.path;
                if self.is_namespace(path) {
                    continue;
                }
                return Err(wrong(format!("import of `{path}`, which is no module of the library")));
            };
            if index == limit {
                return Err(wrong("a module cannot import itself".to_owned()));
            }
            if index > limit {
                let path = &import.path;
                return Err(wrong(format!("import of `{path}`, which is listed after this module")));
            }
        }
        Ok(())
    }
}

/// Validates against core WebGPU.
pub(crate) fn validate(
    module: &naga::Module,
) -> Result<ModuleInfo, Box<naga::WithSpan<naga::valid::ValidationError>>> {
    let mut validator = Validator::new(ValidationFlags::all(), core_capabilities());
    validator.validate(module).map_err(Box::new)
}

pub(crate) fn shader_definitions(definitions: &Definitions) -> HashMap<String, ShaderDefValue> {
    let mut all: HashMap<String, ShaderDefValue> = definitions
        .iter()
        .map(|(name, value)| {
            let value = match value {
                Definition::Flag(value) => ShaderDefValue::Bool(value),
                Definition::Int(value) => ShaderDefValue::Int(value),
                Definition::Unsigned(value) => ShaderDefValue::UInt(value),
            };
            (name.to_owned(), value)
        })
        .collect();
    all.entry("GROUP".to_owned()).or_insert(ShaderDefValue::UInt(0));
    all
}

/// Names of the items that a module composed as a whole shader declares itself.
fn own_items(module: &naga::Module) -> Vec<String> {
    let functions = module.functions.iter().filter_map(|(_, item)| item.name.clone());
    let constants = module.constants.iter().filter_map(|(_, item)| item.name.clone());
    let variables = module.global_variables.iter().filter_map(|(_, item)| item.name.clone());
    let types = module.types.iter().filter_map(|(_, item)| item.name.clone());
    functions
        .chain(constants)
        .chain(variables)
        .chain(types)
        .filter(|name| !names::is_decorated(name))
        .collect()
}

#[cfg(test)]
mod tests;
