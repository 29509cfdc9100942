// SPDX-License-Identifier: MIT OR Apache-2.0
//! Static counts of what functions do, from naga's module: not times, but what tells two functions apart.

use naga::{AddressSpace, Block, Expression, Function, Handle, MathFunction, Module, Statement};
use std::ops::AddAssign;

/// Counts of one function with all that it calls: every statement once, whatever runs it how often.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Operators, selections and functions such as `min` and `dot`; one of a vector counts once.
    pub arithmetic: u32,
    /// Roots, exponentials, logarithms and trigonometry.
    pub transcendental: u32,
    /// Texels loaded or sampled.
    pub texture_reads: u32,
    /// Loads from uniform and storage buffers.
    pub buffer_reads: u32,
    /// Loops.
    pub loops: u32,
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.arithmetic += other.arithmetic;
        self.transcendental += other.transcendental;
        self.texture_reads += other.texture_reads;
        self.buffer_reads += other.buffer_reads;
        self.loops += other.loops;
    }
}

/// Costs with the names of what they are of.
pub type Named = Vec<(String, Cost)>;

/// Costs of the functions of a module, and of its entry points.
pub fn costs(module: &Module) -> (Named, Named) {
    // Of a valid module every function comes after those that it calls.
    let mut known: Vec<Cost> = Vec::new();
    let mut functions = Vec::new();
    for (_, function) in module.functions.iter() {
        let cost = count(module, function, &known);
        known.push(cost);
        functions.push((function.name.clone().unwrap_or_default(), cost));
    }
    let entries = module.entry_points.iter();
    let entries = entries.map(|entry| (entry.name.clone(), count(module, &entry.function, &known)));
    (functions, entries.collect())
}

fn count(module: &Module, function: &Function, known: &[Cost]) -> Cost {
    let mut cost = Cost::default();
    block(module, function, &function.body, known, &mut cost);
    cost
}

fn block(module: &Module, function: &Function, statements: &Block, known: &[Cost], cost: &mut Cost) {
    for statement in statements {
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    expression(module, function, handle, cost);
                }
            }
            Statement::Block(inner) => block(module, function, inner, known, cost),
            Statement::If { accept, reject, .. } => {
                block(module, function, accept, known, cost);
                block(module, function, reject, known, cost);
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    block(module, function, &case.body, known, cost);
                }
            }
            Statement::Loop { body, continuing, .. } => {
                cost.loops += 1;
                block(module, function, body, known, cost);
                block(module, function, continuing, known, cost);
            }
            Statement::Call { function: callee, .. } => {
                *cost += known.get(callee.index()).copied().unwrap_or_default();
            }
            Statement::Atomic { .. } => cost.arithmetic += 1,
            _ => {}
        }
    }
}

fn expression(module: &Module, function: &Function, handle: Handle<Expression>, cost: &mut Cost) {
    use MathFunction as F;
    match function.expressions[handle] {
        Expression::Binary { .. } | Expression::Unary { .. } | Expression::Select { .. } => {
            cost.arithmetic += 1
        }
        Expression::Math { fun, .. } => match fun {
            F::Cos
            | F::Cosh
            | F::Sin
            | F::Sinh
            | F::Tan
            | F::Tanh
            | F::Acos
            | F::Asin
            | F::Atan
            | F::Atan2
            | F::Asinh
            | F::Acosh
            | F::Atanh
            | F::Exp
            | F::Exp2
            | F::Log
            | F::Log2
            | F::Pow
            | F::Sqrt
            | F::InverseSqrt
            | F::Length
            | F::Distance
            | F::Normalize => cost.transcendental += 1,
            _ => cost.arithmetic += 1,
        },
        Expression::ImageLoad { .. } | Expression::ImageSample { .. } => cost.texture_reads += 1,
        Expression::Load { pointer } if in_buffer(module, function, pointer) => cost.buffer_reads += 1,
        _ => {}
    }
}

/// Whether a pointer leads into a uniform or storage buffer.
fn in_buffer(module: &Module, function: &Function, mut pointer: Handle<Expression>) -> bool {
    loop {
        match function.expressions[pointer] {
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => pointer = base,
            Expression::GlobalVariable(variable) => {
                let space = module.global_variables[variable].space;
                return matches!(space, AddressSpace::Uniform | AddressSpace::Storage { .. });
            }
            _ => return false,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn called_functions_and_both_branches_count() {
        let source = "@group(0) @binding(0) var<uniform> u: vec4<f32>;
            @group(0) @binding(1) var t: texture_2d<f32>;
            fn root(x: f32) -> f32 { return sqrt(x) + 1.0; }
            @compute @workgroup_size(1) fn main() {
                var sum = u.x;
                for (var i = 0u; i < 4u; i++) {
                    sum += root(textureLoad(t, vec2<u32>(i), 0).x);
                }
                if sum > 1.0 { sum = sin(sum); } else { sum = root(sum); }
            }";
        let module = naga::front::wgsl::parse_str(source).unwrap();
        let (functions, entries) = costs(&module);
        let root = Cost { arithmetic: 1, transcendental: 1, ..Cost::default() };
        assert_eq!(functions, [("root".to_owned(), root)]);
        let main = entries[0].1;
        assert_eq!((main.loops, main.texture_reads, main.buffer_reads, main.transcendental), (1, 1, 1, 3));
        assert!(main.arithmetic >= 5, "{main:?}");
    }
}
