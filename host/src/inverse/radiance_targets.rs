// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures less what is known of them: the left sides of equations 7.3, 7.5 and 7.7 of the thesis.

use super::InverseError;

/// What emission or albedo has to add to a picture: the picture, less what shines through from behind, less what the volume shows
/// that is not solved for. All have as many numbers, in the same order, and are radiance but for `through`, the transmittance.
///
/// # Errors
/// [`InverseError::Count`] where they differ in size.
pub fn radiance_targets(
    picture: &[f32],
    background: &[f32],
    through: &[f32],
    known: &[f32],
) -> Result<Vec<f32>, InverseError> {
    let needed = picture.len();
    for (name, given) in [
        ("numbers of a background", background.len()),
        ("transmittances of a picture", through.len()),
        ("numbers of what is known of a picture", known.len()),
    ] {
        if given != needed {
            return Err(InverseError::Count { name, needed, given });
        }
    }
    let pixels = picture.iter().zip(background).zip(through).zip(known);
    Ok(pixels.map(|(((picture, behind), through), known)| picture - through * behind - known).collect())
}
