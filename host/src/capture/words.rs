// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the 32-bit words of a buffer are.

use airlight_validate::naga::{self, AddressSpace, ArraySize, Handle, Module, ScalarKind, Type, TypeInner};
use serde_json::{Value, json};
use std::collections::HashMap;

/// For each uniform and storage buffer, by name, a letter a word (`f`, `u`, `i`, and `.` for padding): of what comes first, and
/// of each element of an array without a length after it.
pub(super) fn of_buffers(module: &Module) -> HashMap<String, Value> {
    let variables = module.global_variables.iter();
    variables
        .filter(|(_, variable)| {
            matches!(variable.space, AddressSpace::Uniform | AddressSpace::Storage { .. })
        })
        .map(|(_, variable)| (variable.name.clone().unwrap_or_default(), words(module, variable.ty)))
        .collect()
}

fn words(module: &Module, ty: Handle<Type>) -> Value {
    let (mut head, mut repeated) = (Vec::new(), Vec::new());
    match &module.types[ty].inner {
        TypeInner::Array { base, size: ArraySize::Dynamic, stride } => {
            element(module, *base, *stride, &mut repeated);
        }
        TypeInner::Struct { members, .. } => {
            for member in members {
                let start = member.offset as usize / 4;
                match module.types[member.ty].inner {
                    TypeInner::Array { base, size: ArraySize::Dynamic, stride } => {
                        head.resize(start, b'.');
                        element(module, base, stride, &mut repeated);
                    }
                    _ => fill(module, member.ty, start, &mut head),
                }
            }
        }
        _ => fill(module, ty, 0, &mut head),
    }
    let text = |letters: Vec<u8>| letters.into_iter().map(char::from).collect::<String>();
    json!({ "head": text(head), "repeated": text(repeated) })
}

fn element(module: &Module, base: Handle<Type>, stride: u32, letters: &mut Vec<u8>) {
    fill(module, base, 0, letters);
    letters.resize(stride as usize / 4, b'.');
}

/// Writes the letters of a value that starts at the word `start`.
fn fill(module: &Module, ty: Handle<Type>, start: usize, letters: &mut Vec<u8>) {
    match &module.types[ty].inner {
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => put(*scalar, start, letters),
        TypeInner::Vector { size, scalar } => {
            (0..*size as usize).for_each(|k| put(*scalar, start + k, letters));
        }
        TypeInner::Matrix { columns, rows, scalar } => {
            let stride = if *rows as usize == 2 { 2 } else { 4 };
            for column in 0..*columns as usize {
                (0..*rows as usize).for_each(|k| put(*scalar, start + column * stride + k, letters));
            }
        }
        TypeInner::Array { base, size: ArraySize::Constant(count), stride } => {
            for k in 0..count.get() as usize {
                fill(module, *base, start + k * *stride as usize / 4, letters);
            }
        }
        TypeInner::Struct { members, .. } => {
            for member in members {
                fill(module, member.ty, start + member.offset as usize / 4, letters);
            }
        }
        _ => {}
    }
}

fn put(scalar: naga::Scalar, place: usize, letters: &mut Vec<u8>) {
    if letters.len() <= place {
        letters.resize(place + 1, b'.');
    }
    letters[place] = match scalar.kind {
        ScalarKind::Float => b'f',
        ScalarKind::Sint => b'i',
        _ => b'u',
    };
}
