// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::stroke_density
// summary: How densely strokes lie, and the probabilities of birth and deletion that keep it within bounds.
// source: Ramalhao (2010), 4.2.4, 4.2.5, Table 5.1.
// note: The density is the sum of kappa * opacity * brush over the strokes of a layer. The text does not say kappa: with 0.01
// note: a minimum of 0.01 is one stroke everywhere "as a bare minimum", and the counts of Table 5.1 lie near its bounds.
// note: The text counts strokes with the opacity they have. Then a gap goes on giving birth while new strokes fade in, and
// note: strokes that fade out are deleted twice. `anticipation` counts the opacity that they fade to instead.
// note: The text deletes with a probability that it does not give: 1 - D_max / D reaches D_max in one step, on average.
// equation: D = Σ κ mix(opacity, fades to, anticipation) brush
// equation: birth: p = min(p_layer, max(0, D_min − D) / (κ opacity area));  deletion: p = 1 − D_max / D where D > D_max
// error: densities within 1e-8, births 1e-5, what is left after deletion 1e-6;
// error: test painterly/stroke_functions::births_fill_gaps_and_deletions_reach_the_maximum.
// parameter anticipation: 0..1: how much of the opacity to come counts.
// parameter density, least, most: densities, from 0 up.
// parameter unit: kappa, density of one opaque stroke, above 0.

/// What a stroke adds to the density of its layer at a texel. `unit`: kappa. `opacity`, `fades_to`, `brush`: 0..1.
fn density_of_stroke(unit: f32, opacity: f32, fades_to: f32, anticipation: f32, brush: f32) -> f32 {
    return unit * mix(opacity, fades_to, anticipation) * brush;
}

/// Probability, 0..1, that a stroke is born at a pixel. `probability`: at most, of the layer. `opacity`: that it fades to.
/// `area`: in pixels that may give birth, times the mean opacity of the brush.
fn birth_probability(density: f32, least: f32, unit: f32, opacity: f32, area: f32, probability: f32) -> f32 {
    // As many as fill the gap, if every pixel within the area of a stroke draws.
    let filling = max(least - density, 0.0) / max(unit * opacity * area, 1e-12);
    return clamp(min(filling, probability), 0.0, 1.0);
}

/// Probability, 0..1, that a stroke is deleted where the density is above `most`.
fn deletion_probability(density: f32, most: f32) -> f32 {
    return select(0.0, 1.0 - most / max(density, 1e-12), density > most);
}
