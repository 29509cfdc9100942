// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a pass needs that evaluates a prefiltered method and does more with it than write its light.

use super::Inputs;
use crate::pass::Resource;
use crate::resource::Texture;
use airlight_validate::Definitions;

/// A prefiltered method whose last pass, the evaluation of every pixel, another may stand for: one that imports the callback
/// `scattering/evaluated`, `scattering/evaluated_local` with the definition LOCAL, or `scattering/evaluated_projective` with
/// PROJECTIVE. It is recorded instead of `record_evaluation`, as `stylize::StylizedEvaluation` is.
pub trait Evaluated {
    /// Definitions of the evaluation; with LOCAL or PROJECTIVE where one of them says which callback it is.
    fn evaluation_definitions(&self) -> Definitions;

    /// Everything that the callbacks bind, and more, by name: of `inputs` and of what the method holds.
    fn evaluation_resources<'a>(&'a self, inputs: &Inputs<'a>) -> Vec<(&'static str, Resource<'a>)>;

    /// What the method's own evaluation writes: of the size of the picture.
    fn scattered(&self) -> &Texture;
}
