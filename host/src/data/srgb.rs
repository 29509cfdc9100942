// SPDX-License-Identifier: MIT OR Apache-2.0
//! Colours as people write them.

/// IEC 61966-2-1.
pub(crate) fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Of a linear value, likewise.
#[cfg(feature = "command")]
pub(crate) fn srgb_from_linear(value: f32) -> f32 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// Linear RGB of `#rrggbb`, sRGB.
#[cfg(feature = "command")]
pub(crate) fn linear_from_hexadecimal(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let channel = |at: usize| {
        let digits = digits.get(at..at + 2).filter(|two| two.bytes().all(|byte| byte.is_ascii_hexdigit()))?;
        let value = u8::from_str_radix(digits, 16).ok()?;
        Some(linear_from_srgb(f32::from(value) / 255.0))
    };
    Some([channel(0)?, channel(2)?, channel(4)?])
}

#[cfg(all(test, feature = "command"))]
mod tests {
    use super::*;

    #[test]
    fn colours_are_linear_and_nonsense_is_none() {
        assert_eq!(linear_from_hexadecimal("#ff0000"), Some([1.0, 0.0, 0.0]));
        let grey = linear_from_hexadecimal("#bcBCbc").map_or(0.0, |rgb| rgb[1]);
        assert!((grey - 0.502_886).abs() < 1e-5, "{grey}");
        for wrong in ["", "#", "ff0000", "#ff000", "#ff00000", "#+f0000", "#gg0000", "#ffé000"] {
            assert_eq!(linear_from_hexadecimal(wrong), None, "{wrong}");
        }
    }
}
