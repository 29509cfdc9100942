// SPDX-License-Identifier: MIT OR Apache-2.0
//! How often a loop turns is bounded whatever parameters and buffers say, by a scan of the composed modules: software adapters
//! end loops by themselves after 65535 turns, so no run of them would show one that hangs elsewhere.
//!
//! A loop is bounded where one of its conditions compares with a number that goes back to constants, sizes of textures,
//! lengths of buffers, or what `min`, `clamp`, `&` and `%` keep to those. It need not be few turns.

use crate::cases::shaders;
use airlight::validate::naga::{
    BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, MathFunction, Module,
    Statement,
};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Functions with loops that end for another reason.
const REVIEWED: &[(&str, &str)] = &[
    ("add", "compares and exchanges until no other thread was faster"),
    ("list_births", "takes a bit away in each turn"),
    (
        "column_from_x",
        "splits, which the host holds to 1..4; with a bound lavapipe takes minutes to compile it",
    ),
    ("soften", "the reach that `prepare` left in workgroup memory, at most 12"),
];

#[test]
fn loops_are_bounded_whatever_parameters_say() {
    let mut unbounded: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut loops = 0;
    for pass in shaders().library().passes() {
        for permutation in shaders().library().permutations(&pass.name).unwrap() {
            let composed = shaders().compose_with(&pass.name, &permutation.definitions).unwrap();
            let scan = Scan::new(&composed.module);
            for (index, function) in scan.functions.iter().enumerate() {
                let mut found = Vec::new();
                collect_loops(&function.body, &mut found);
                loops += found.len();
                for whole in found {
                    if !scan.is_bounded(index, whole) {
                        let name = function.name.clone().unwrap_or_default();
                        unbounded.entry(name).or_default().insert(pass.name.clone());
                    }
                }
            }
        }
    }
    println!("{loops} loops, {} functions with one that needs review", unbounded.len());
    for (name, reason) in REVIEWED {
        assert!(unbounded.remove(*name).is_some(), "`{name}` needs no review any more ({reason})");
    }
    assert!(unbounded.is_empty(), "loops that parameters or data may keep turning: {unbounded:#?}");
}

/// The body and what follows it in each turn.
type Loop<'a> = (&'a Block, &'a Block, Option<Handle<Expression>>);

fn collect_loops<'a>(block: &'a Block, found: &mut Vec<Loop<'a>>) {
    for statement in block {
        if let Statement::Loop { body, continuing, break_if } = statement {
            found.push((body, continuing, *break_if));
        }
        for inner in inner_blocks(statement) {
            collect_loops(inner, found);
        }
    }
}

fn inner_blocks(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        _ => vec![],
    }
}

/// A call: who calls, and with what.
type Call<'a> = (usize, &'a [Handle<Expression>]);

/// All functions of a module, entry points behind the others, and who calls them with what.
struct Scan<'a> {
    functions: Vec<&'a Function>,
    first_entry: usize,
    calls: HashMap<usize, Vec<Call<'a>>>,
    stores: Vec<HashMap<Handle<LocalVariable>, Vec<Handle<Expression>>>>,
}

impl<'a> Scan<'a> {
    fn new(module: &'a Module) -> Self {
        let mut functions: Vec<&Function> = module.functions.iter().map(|(_, function)| function).collect();
        let first_entry = functions.len();
        functions.extend(module.entry_points.iter().map(|entry| &entry.function));
        let mut scan = Self { functions, first_entry, calls: HashMap::new(), stores: Vec::new() };
        for index in 0..scan.functions.len() {
            let function = scan.functions[index];
            let mut stores = HashMap::new();
            scan.read(index, function, &function.body, &mut stores);
            scan.stores.push(stores);
        }
        scan
    }

    fn read(
        &mut self,
        index: usize,
        function: &'a Function,
        block: &'a Block,
        stores: &mut HashMap<Handle<LocalVariable>, Vec<Handle<Expression>>>,
    ) {
        for statement in block {
            match statement {
                Statement::Store { pointer, value } => {
                    if let Some(variable) = variable_of(function, *pointer) {
                        stores.entry(variable).or_default().push(*value);
                    }
                }
                Statement::Call { function: called, arguments, .. } => {
                    self.calls.entry(called.index()).or_default().push((index, arguments));
                }
                _ => {}
            }
            for inner in inner_blocks(statement) {
                self.read(index, function, inner, stores);
            }
        }
    }

    fn is_bounded(&self, index: usize, (body, continuing, break_if): Loop<'_>) -> bool {
        let mut conditions: Vec<_> = break_if.into_iter().collect();
        for statement in body.iter().chain(continuing) {
            if let Statement::If { condition, accept, reject } = statement
                && [accept, reject].into_iter().any(|block| block.iter().any(ends))
            {
                conditions.push(*condition);
            }
        }
        conditions.into_iter().any(|condition| self.is_limit(index, condition))
    }

    /// Whether a condition compares with what is limited.
    fn is_limit(&self, index: usize, condition: Handle<Expression>) -> bool {
        use BinaryOperator as B;
        match &self.functions[index].expressions[condition] {
            Expression::Unary { expr, .. } => self.is_limit(index, *expr),
            Expression::Binary { op: B::LogicalAnd | B::LogicalOr | B::And, left, right } => {
                self.is_limit(index, *left) || self.is_limit(index, *right)
            }
            Expression::Binary { op, left, right } if is_comparison(*op) => {
                let [left, right] = [*left, *right];
                // What counts up may begin anywhere.
                let counts_up = matches!(op, B::Less | B::LessEqual) && self.is_counter(index, left);
                let limited = |value| self.is_limited(index, value, &mut BTreeSet::new());
                limited(right) && (counts_up || limited(left))
            }
            // A flag that ends the loop after its first turn.
            Expression::Load { pointer } => self.stored(index, *pointer).iter().any(|value| {
                matches!(self.functions[index].expressions[*value], Expression::Literal(Literal::Bool(_)))
            }),
            _ => false,
        }
    }

    /// What is stored anywhere to the variable that a pointer leads to.
    fn stored(&self, index: usize, pointer: Handle<Expression>) -> Vec<Handle<Expression>> {
        let function = self.functions[index];
        let Some(variable) = variable_of(function, pointer) else { return Vec::new() };
        let own = function.local_variables[variable].init;
        own.into_iter().chain(self.stores[index].get(&variable).into_iter().flatten().copied()).collect()
    }

    /// Whether a value is a variable to which something is added.
    fn is_counter(&self, index: usize, value: Handle<Expression>) -> bool {
        let expressions = &self.functions[index].expressions;
        let Expression::Load { pointer } = &expressions[value] else { return false };
        let own = |value: &Handle<Expression>| match &expressions[*value] {
            Expression::Load { pointer: other } => other == pointer,
            _ => false,
        };
        self.stored(index, *pointer).iter().any(|stored| match &expressions[*stored] {
            Expression::Binary { op: BinaryOperator::Add, left, right } => own(left) || own(right),
            _ => false,
        })
    }

    /// Whether a member of a value is bounded.
    fn is_part_limited(
        &self,
        index: usize,
        (base, member): (Handle<Expression>, usize),
        open: &mut BTreeSet<(usize, usize)>,
    ) -> bool {
        match &self.functions[index].expressions[base] {
            Expression::Compose { components, .. } if components.len() > member => {
                self.is_limited(index, components[member], open)
            }
            Expression::CallResult(called) => {
                let called = called.index();
                let mut results = Vec::new();
                returned(&self.functions[called].body, &mut results);
                results.iter().all(|result| self.is_part_limited(called, (*result, member), open))
            }
            Expression::FunctionArgument(number) if index < self.first_entry => {
                let calls = self.calls.get(&index).map(Vec::as_slice).unwrap_or_default();
                calls.iter().all(|(caller, arguments)| {
                    self.is_part_limited(*caller, (arguments[*number as usize], member), open)
                })
            }
            Expression::Load { pointer }
                if matches!(self.functions[index].expressions[*pointer], Expression::LocalVariable(_)) =>
            {
                let stored = self.stored(index, *pointer);
                !stored.is_empty()
                    && stored.iter().all(|value| self.is_part_limited(index, (*value, member), open))
            }
            _ => self.is_limited(index, base, open),
        }
    }

    /// Whether a value is bounded by constants and sizes. `open`: values that are being looked at; a loop's own counter is one.
    fn is_limited(
        &self,
        index: usize,
        value: Handle<Expression>,
        open: &mut BTreeSet<(usize, usize)>,
    ) -> bool {
        use BinaryOperator as B;
        if !open.insert((index, value.index())) {
            return true;
        }
        let function = self.functions[index];
        let mut all =
            |values: &[Handle<Expression>]| values.iter().all(|value| self.is_limited(index, *value, open));
        match &function.expressions[value] {
            Expression::Literal(_)
            | Expression::Constant(_)
            | Expression::Override(_)
            | Expression::ZeroValue(_)
            | Expression::ArrayLength(_)
            | Expression::ImageQuery { .. }
            | Expression::Relational { .. } => true,
            Expression::Compose { components, .. } => all(components),
            Expression::Splat { value, .. } | Expression::Swizzle { vector: value, .. } => all(&[*value]),
            Expression::Unary { expr, .. } | Expression::As { expr, .. } => all(&[*expr]),
            Expression::Select { accept, reject, .. } => all(&[*accept, *reject]),
            Expression::Binary { op, left, right } => match op {
                B::And => all(&[*left]) || all(&[*right]),
                B::Modulo => all(&[*right]) || all(&[*left]),
                B::Divide | B::ShiftRight => all(&[*left]),
                B::Add | B::Subtract | B::Multiply | B::ShiftLeft | B::ExclusiveOr | B::InclusiveOr => {
                    all(&[*left, *right])
                }
                _ => true,
            },
            Expression::Math { fun, arg, arg1, arg2, .. } => match (fun, arg1, arg2) {
                (MathFunction::Min, Some(other), _) => all(&[*arg]) || all(&[*other]),
                (MathFunction::Clamp, _, Some(most)) => all(&[*most]),
                (MathFunction::CountOneBits | MathFunction::Saturate | MathFunction::Fract, ..) => true,
                (_, a, b) => all(&[Some(*arg), *a, *b].into_iter().flatten().collect::<Vec<_>>()),
            },
            Expression::AccessIndex { base, index: member } => {
                self.is_part_limited(index, (*base, *member as usize), open)
            }
            Expression::Access { base, .. } => all(&[*base]),
            Expression::FunctionArgument(number) => {
                if index >= self.first_entry {
                    // What the dispatch sets.
                    return true;
                }
                let calls = self.calls.get(&index).map(Vec::as_slice).unwrap_or_default();
                calls
                    .iter()
                    .all(|(caller, arguments)| self.is_limited(*caller, arguments[*number as usize], open))
            }
            Expression::CallResult(called) => {
                let called = called.index();
                let mut results = Vec::new();
                returned(&self.functions[called].body, &mut results);
                results.iter().all(|result| self.is_limited(called, *result, open))
            }
            Expression::Load { pointer } => {
                let stored = self.stored(index, *pointer);
                !stored.is_empty() && stored.iter().all(|value| self.is_limited(index, *value, open))
            }
            _ => false,
        }
    }
}

fn is_comparison(op: BinaryOperator) -> bool {
    use BinaryOperator as B;
    matches!(op, B::Less | B::LessEqual | B::Greater | B::GreaterEqual | B::Equal | B::NotEqual)
}

/// The local variable that a pointer leads to.
fn variable_of(function: &Function, pointer: Handle<Expression>) -> Option<Handle<LocalVariable>> {
    match &function.expressions[pointer] {
        Expression::LocalVariable(variable) => Some(*variable),
        Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => {
            variable_of(function, *base)
        }
        _ => None,
    }
}

fn ends(statement: &Statement) -> bool {
    matches!(statement, Statement::Break | Statement::Return { .. } | Statement::Kill)
}

fn returned(block: &Block, results: &mut Vec<Handle<Expression>>) {
    for statement in block {
        if let Statement::Return { value: Some(value) } = statement {
            results.push(*value);
        }
        for inner in inner_blocks(statement) {
            returned(inner, results);
        }
    }
}
