// SPDX-License-Identifier: MIT OR Apache-2.0
//! The long tables of the system `transmittance`: errors of every form, medium, optical depth and number of coefficients, and
//! maps of up to a million particles.

use super::light_rays::LightRays;
use super::transmittance::{SYSTEM, form_name, particles};
use super::{Row, figure};
use crate::command::{CommandError, progress};
use crate::transmittance::Form;
use crate::{Gpu, Shaders};
use airlight_tests::media::{self, EACH, Medium, OPTICAL_DEPTHS};

/// Every form with every number of coefficients that it is offered in.
const FORMS: [(Form, u32); 17] = [
    (Form::Extinction, 4),
    (Form::Bounded, 4),
    (Form::Opacity, 4),
    (Form::Function, 4),
    (Form::FunctionPeriodic, 4),
    (Form::Extinction, 8),
    (Form::Bounded, 8),
    (Form::Opacity, 8),
    (Form::Function, 8),
    (Form::FunctionPeriodic, 8),
    (Form::PowerMoments, 8),
    (Form::TrigonometricMoments, 8),
    (Form::Extinction, 16),
    (Form::Bounded, 16),
    (Form::Opacity, 16),
    (Form::Function, 16),
    (Form::FunctionPeriodic, 16),
];

/// Both tables. The errors are printed as the book has them, too.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(FORMS.len() as u64 + 1, quiet);
    let rays = LightRays::new(media::table());
    let mut rows = Vec::new();
    let mut lines = Vec::new();
    for (form, coefficients) in FORMS {
        bar.set_message(format!("errors of {} {coefficients}", form_name(form)));
        let errors = rays.errors(gpu, shaders, (form, coefficients), EACH)?;
        lines.push(line(form, coefficients, &errors));
        for (kind, errors) in Medium::ALL.iter().zip(errors.chunks(OPTICAL_DEPTHS.len())) {
            for (total, error) in OPTICAL_DEPTHS.iter().zip(errors) {
                let name = format!("error_{}_{coefficients}_{}_{total}", form_name(form), kind.name());
                rows.push(figure(SYSTEM, name, *error, "fraction"));
            }
        }
        bar.inc(1);
    }
    bar.set_message("particles by their number");
    rows.extend(particles(gpu, shaders, &[10_000, 100_000, 1_000_000])?);
    bar.finish_and_clear();
    println!("{}", heading());
    for line in lines {
        println!("{line}");
    }
    Ok(rows)
}

/// The head of the table of errors, Markdown.
fn heading() -> String {
    let kinds: Vec<String> = Medium::ALL.iter().map(|kind| kind.name().replace('_', " ")).collect();
    format!("| form, numbers | {} |\n|---|{}", kinds.join(" | "), "---|".repeat(kinds.len()))
}

/// A line of it: mean errors times 10⁴, media by columns, optical depths within.
fn line(form: Form, coefficients: u32, errors: &[f64]) -> String {
    let cell = |errors: &[f64]| {
        errors.iter().map(|error| format!("{:.0}", 1e4 * error)).collect::<Vec<_>>().join(" / ")
    };
    let cells: Vec<String> = errors.chunks(OPTICAL_DEPTHS.len()).map(cell).collect();
    format!("| {} {coefficients} | {} |", form_name(form).replace('_', " "), cells.join(" | "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_hold_a_cell_a_medium() {
        let errors: Vec<f64> = (0..20).map(|i| f64::from(i) * 1e-4).collect();
        let line = line(Form::FunctionPeriodic, 4, &errors);
        assert_eq!(
            line,
            "| tfm fourier 4 | 0 / 1 / 2 / 3 | 4 / 5 / 6 / 7 | 8 / 9 / 10 / 11 | 12 / 13 / 14 / 15 | \
             16 / 17 / 18 / 19 |"
        );
        let columns = |line: &str| line.matches('|').count();
        assert!(heading().lines().all(|head| columns(head) == columns(&line)));
    }
}
