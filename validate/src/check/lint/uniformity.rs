// SPDX-License-Identifier: MIT OR Apache-2.0
//! The plainest cases of non-uniform control flow, for where Tint is absent.
//!
//! Only what an entry point decides by its own varying arguments: Tint follows values through
//! variables, memory and calls as well.

use naga::{
    Barrier, Binding, Block, BuiltIn, EntryPoint, Expression, Function, Handle, SampleLevel, Span, Statement,
};

/// An operation that needs uniform control flow and has none.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hit {
    /// The entry point.
    pub function: String,
    /// What WGSL calls the operation.
    pub word: &'static str,
    /// Which of the words of that name in the function it is, from 0; none where that is not known.
    pub ordinal: usize,
    pub span: Span,
}

impl Hit {
    /// What is wrong.
    pub fn message(&self) -> String {
        let Self { word, function, .. } = self;
        format!(
            "`{word}` where not all invocations of `{function}` need come: naga takes it, WebGPU wants uniform \
             control flow"
        )
    }
}

/// All of a module.
pub(crate) fn find(module: &naga::Module) -> Vec<Hit> {
    let mut hits = Vec::new();
    for entry in &module.entry_points {
        let mut walk = Walk { entry, varies: varying(entry, module), counts: Vec::new(), hits: Vec::new() };
        walk.block(&entry.function.body, false);
        hits.extend(walk.hits);
    }
    hits
}

struct Walk<'a> {
    entry: &'a EntryPoint,
    varies: Vec<bool>,
    counts: Vec<(&'static str, usize)>,
    hits: Vec<Hit>,
}

/// Whether an argument differs from one invocation to its neighbour.
fn is_varying(binding: Option<&Binding>) -> bool {
    match binding {
        Some(Binding::BuiltIn(builtin)) => matches!(
            builtin,
            BuiltIn::GlobalInvocationId
                | BuiltIn::LocalInvocationId
                | BuiltIn::LocalInvocationIndex
                | BuiltIn::Position { .. }
                | BuiltIn::FrontFacing
        ),
        Some(Binding::Location { interpolation, .. }) => *interpolation != Some(naga::Interpolation::Flat),
        None => false,
    }
}

/// For each expression of the entry point, whether it is made of a varying argument and nothing that is read.
fn varying(entry: &EntryPoint, module: &naga::Module) -> Vec<bool> {
    let function = &entry.function;
    let mut varies = vec![false; function.expressions.len()];
    // Operands come before what uses them.
    for (handle, expression) in function.expressions.iter() {
        let at = |handle: &Handle<Expression>| varies.get(handle.index()).copied().unwrap_or(false);
        varies[handle.index()] = match expression {
            Expression::FunctionArgument(index) => function
                .arguments
                .get(*index as usize)
                .is_some_and(|argument| is_varying(argument.binding.as_ref())),
            Expression::AccessIndex { base, index } => match argument_member(function, module, *base, *index)
            {
                Some(binding) => is_varying(binding),
                None => at(base),
            },
            Expression::Binary { left, right, .. } => at(left) || at(right),
            Expression::Unary { expr, .. } | Expression::As { expr, .. } => at(expr),
            Expression::Swizzle { vector, .. } => at(vector),
            Expression::Relational { argument, .. } => at(argument),
            _ => false,
        };
    }
    varies
}

/// The binding of a member of an argument that is a struct.
fn argument_member<'a>(
    function: &Function,
    module: &'a naga::Module,
    base: Handle<Expression>,
    index: u32,
) -> Option<Option<&'a Binding>> {
    let Expression::FunctionArgument(argument) = function.expressions[base] else { return None };
    let ty = function.arguments.get(argument as usize)?.ty;
    match &module.types[ty].inner {
        naga::TypeInner::Struct { members, .. } => Some(members.get(index as usize)?.binding.as_ref()),
        _ => None,
    }
}

impl Walk<'_> {
    fn meet(&mut self, word: &'static str, span: Span, is_split: bool) {
        let index = match self.counts.iter().position(|(known, _)| *known == word) {
            Some(index) => index,
            None => {
                self.counts.push((word, 0));
                self.counts.len() - 1
            }
        };
        let ordinal = self.counts[index].1;
        self.counts[index].1 += 1;
        if is_split {
            self.hits.push(Hit { function: self.entry.name.clone(), word, ordinal, span });
        }
    }

    /// Walks a block; returns whether some invocations have left the function by its end.
    fn block(&mut self, block: &Block, is_split: bool) -> bool {
        let mut split = is_split;
        for (statement, span) in block.span_iter() {
            match statement {
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        if let Some(word) = needs_neighbours(&self.entry.function.expressions[handle]) {
                            let span = self.entry.function.expressions.get_span(handle);
                            self.meet(word, span, split);
                        }
                    }
                }
                Statement::ControlBarrier(barrier) => {
                    let word = if barrier.contains(Barrier::STORAGE) {
                        "storageBarrier"
                    } else if barrier.contains(Barrier::TEXTURE) {
                        "textureBarrier"
                    } else {
                        "workgroupBarrier"
                    };
                    self.meet(word, *span, split);
                }
                Statement::WorkGroupUniformLoad { .. } => self.meet("workgroupUniformLoad", *span, split),
                Statement::Block(inner) => split |= self.block(inner, split),
                Statement::If { condition, accept, reject } => {
                    let varies = self.varies.get(condition.index()).copied().unwrap_or(false);
                    let accepted = self.block(accept, split || varies);
                    let rejected = self.block(reject, split || varies);
                    split |= varies && (accepted || rejected || returns(accept) != returns(reject));
                }
                Statement::Loop { body, continuing, .. } => {
                    self.block(body, split);
                    self.block(continuing, split);
                }
                Statement::Switch { cases, .. } => {
                    for case in cases {
                        self.block(&case.body, split);
                    }
                }
                _ => {}
            }
        }
        split && !is_split
    }
}

fn returns(block: &Block) -> bool {
    matches!(block.last(), Some(Statement::Return { .. }))
}

/// The name of an operation that looks at neighbouring invocations.
fn needs_neighbours(expression: &Expression) -> Option<&'static str> {
    match expression {
        Expression::ImageSample { level: SampleLevel::Auto, depth_ref: None, gather: None, .. } => {
            Some("textureSample")
        }
        Expression::ImageSample { level: SampleLevel::Auto, depth_ref: Some(_), gather: None, .. } => {
            Some("textureSampleCompare")
        }
        Expression::ImageSample { level: SampleLevel::Bias(_), gather: None, .. } => {
            Some("textureSampleBias")
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The operations that are found, with the text at their spans.
    fn found(source: &str) -> Vec<(&'static str, usize, u32)> {
        let module = naga::front::wgsl::parse_str(source).unwrap();
        let line = |span: Span| span.location(source).line_number;
        find(&module).into_iter().map(|hit| (hit.word, hit.ordinal, line(hit.span))).collect()
    }

    #[test]
    fn barriers_behind_a_varying_condition_are_found() {
        let source = "@compute @workgroup_size(8) fn main(@builtin(local_invocation_index) i: u32) {\n    workgroupBarrier();\n    if i < 4u {\n        workgroupBarrier();\n    }\n    if (i == 7u) { return; }\n    storageBarrier();\n}\n";
        assert_eq!(found(source), [("workgroupBarrier", 1, 4), ("storageBarrier", 0, 7)]);
    }

    #[test]
    fn samples_behind_a_varying_condition_are_found() {
        let source = "struct V { @location(0) uv: vec2<f32>, @location(1) @interpolate(flat) n: u32 }\n@group(0) @binding(0) var t: texture_2d<f32>;\n@group(0) @binding(1) var s: sampler;\n@fragment fn main(v: V) -> @location(0) vec4<f32> {\n    if v.uv.x < 0.5 {\n        return textureSample(t, s, v.uv);\n    }\n    return vec4<f32>();\n}\n";
        assert_eq!(found(source), [("textureSample", 0, 6)]);
        let level = source.replace("textureSample(t, s, v.uv)", "textureSampleLevel(t, s, v.uv, 0.0)");
        assert_eq!(found(&level), []);
    }

    #[test]
    fn uniform_conditions_are_left() {
        let source = "@group(0) @binding(0) var<uniform> n: u32;\n@compute @workgroup_size(8) fn main(@builtin(workgroup_id) g: vec3<u32>, @builtin(local_invocation_index) i: u32) {\n    if g.x < n { workgroupBarrier(); }\n    if n == 3u { return; }\n    var k = i;\n    if i < 4u { k += 1u; }\n    workgroupBarrier();\n}\n";
        assert_eq!(found(source), []);
    }
}
