// SPDX-License-Identifier: MIT OR Apache-2.0
//! Snapshots themselves: what their text keeps, what counts as a difference, and what is refused.

use crate::snapshot::{Buffer, Mode, Picture, mode};
use crate::tolerance;

fn sample() -> Buffer {
    Buffer {
        adapter: "A (driver 1)".to_owned(),
        shape: [10, 10, 2],
        tolerance: tolerance(1e-3, 1e-2, 0.02),
        values: (0..200).map(|i| (i as f32 * 0.37).sin() * 3.0).collect(),
    }
}

#[test]
fn text_keeps_a_buffer_within_a_tenth_of_its_tolerance() {
    let mut buffer = sample();
    buffer.values[..6].copy_from_slice(&[f32::NAN, f32::INFINITY, 0.0, -0.0, 1e-9, -12345.6]);
    let text = buffer.to_text();
    let back = Buffer::from_text(&text).unwrap();
    assert_eq!(
        (&back.adapter, back.shape, back.tolerance),
        (&buffer.adapter, buffer.shape, buffer.tolerance)
    );
    assert_eq!(buffer.difference(&back), None);
    let mut strict = buffer.clone();
    strict.tolerance = tolerance(1e-4, 1e-3, 0.0);
    assert_eq!(strict.difference(&back), None);
    assert_eq!(Buffer::from_text("adapter: A\nshape: 1 2\n"), None);
    assert_eq!(back.to_text(), Buffer::from_text(&back.to_text()).unwrap().to_text());
}

#[test]
fn one_texel_too_far_off_is_named() {
    let blessed = sample();
    let mut new = sample();
    new.values[2 * 34 + 1] += 0.02;
    assert!(blessed.values[2 * 34 + 1].abs() < 1.6);
    let message = new.difference(&blessed).unwrap();
    assert!(message.contains("(4, 3), channel 1") && message.starts_with("1 of 100"), "{message}");
    // Another adapter has its outliers, as many as are stated.
    new.adapter = "B (driver 7)".to_owned();
    assert_eq!(new.difference(&blessed), None);
    (0..6).for_each(|i| new.values[i] += 1.0);
    assert!(new.difference(&blessed).unwrap().starts_with("4 of 100"));
    // A NaN is never within a tolerance; nor is another shape.
    let mut broken = sample();
    broken.values[0] = f32::NAN;
    assert!(broken.difference(&blessed).is_some());
    let mut narrow = sample();
    narrow.shape = [20, 5, 2];
    assert!(narrow.difference(&blessed).unwrap().contains("shape"));
}

#[test]
fn pictures_are_compared_by_structure() {
    let size = [32, 24];
    let pixels: Vec<u8> =
        (0..32 * 24).flat_map(|i| [(i % 32 * 8) as u8, (i / 32 * 10) as u8, 90, 255]).collect();
    let picture = Picture { size, pixels };
    assert_eq!(Picture::from_png(&picture.to_png()), Some(picture.clone()));
    let changed = |amount: u8| {
        let mut other = picture.clone();
        other.pixels.iter_mut().step_by(3).for_each(|p| *p = p.saturating_add(amount));
        picture.similarity(&other)
    };
    assert_eq!(picture.similarity(&picture).1, 0.0);
    assert!(picture.similarity(&picture).0 > 0.9999);
    let (little, much) = (changed(1), changed(60));
    assert!(little.0 > 0.99 && little.1 < 1.0, "{little:?}");
    assert!(much.0 < 0.95 && much.1 > 10.0, "{much:?}");
    assert!(Picture::from_png(b"no picture").is_none());
}

#[test]
fn blessing_from_another_adapter_is_refused() {
    let (here, there) = ("A (driver 1)", "A (driver 2)");
    assert_eq!(mode(None, None, Some(there), here), Ok(Mode::Compare));
    assert_eq!(mode(Some("no"), Some(""), None, here), Ok(Mode::Compare));
    assert_eq!(mode(Some("always"), Some("1"), Some(here), here), Ok(Mode::Bless));
    assert_eq!(mode(Some("always"), Some("1"), None, here), Ok(Mode::Bless));
    let refused = mode(Some("always"), Some("1"), Some(there), here).unwrap_err();
    assert!(refused.contains(here) && refused.contains(there));
    assert!(mode(Some("always"), None, None, here).is_err());
    assert!(mode(None, Some("1"), Some(here), here).is_err());
}
