// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the flags of `airlight run` look like.

use airlight_validate::Definitions;
use std::path::PathBuf;

/// `NAME=FILE.npy`: an array for a binding.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    pub name: String,
    pub file: PathBuf,
}

/// `NAME=FILE.npy[:SHAPE[:TYPE]]`: where what a pass wrote goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    pub name: String,
    pub file: PathBuf,
    pub shape: Option<Vec<u32>>,
    pub scalar: Option<Scalar>,
}

/// `NAME.FIELD=VALUE`.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Everything before `=`.
    pub path: String,
    /// Everything behind it.
    pub value: String,
}

/// `SYSTEM/PASS[:PERMUTATION]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    pub pass: String,
    pub permutation: String,
}

/// What a 32-bit word of a buffer means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    F32,
    U32,
    I32,
}

impl Scalar {
    /// As WGSL and numpy's users spell it.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::U32 => "u32",
            Self::I32 => "i32",
        }
    }
}

/// `SYSTEM/PASS[:PERMUTATION]`; the permutation is `default` where none is named.
pub fn subject(text: &str) -> Result<Subject, String> {
    let (pass, permutation) = text.split_once(':').unwrap_or((text, "default"));
    let parts = pass.split_once('/');
    if permutation.is_empty() || parts.is_none_or(|(system, pass)| system.is_empty() || pass.is_empty()) {
        return Err(format!(
            "`{text}` is not SYSTEM/PASS or SYSTEM/PASS:PERMUTATION such as scattering/filter:average"
        ));
    }
    Ok(Subject { pass: pass.to_owned(), permutation: permutation.to_owned() })
}

/// `NAME=FILE`.
pub fn input(text: &str) -> Result<Input, String> {
    match text.split_once('=') {
        Some((name, file)) if !name.is_empty() && !file.is_empty() => {
            Ok(Input { name: name.to_owned(), file: PathBuf::from(file) })
        }
        _ => Err(format!("`{text}` is not NAME=FILE.npy")),
    }
}

/// `NAME=FILE.npy[:SHAPE[:TYPE]]`. The file name ends at the last `.npy`, so that it may hold colons itself.
pub fn output(text: &str) -> Result<Output, String> {
    const ENDING: &str = ".npy";
    let wrong =
        || format!("`{text}` is not NAME=FILE.npy, NAME=FILE.npy:HEIGHT,WIDTH or NAME=FILE.npy:COUNT:u32");
    let (name, rest) = text.split_once('=').filter(|(name, _)| !name.is_empty()).ok_or_else(wrong)?;
    let end = rest.rfind(ENDING).ok_or_else(wrong)? + ENDING.len();
    let (file, suffix) = rest.split_at(end);
    let mut output = Output { name: name.to_owned(), file: PathBuf::from(file), shape: None, scalar: None };
    if suffix.is_empty() {
        return Ok(output);
    }
    let suffix = suffix.strip_prefix(':').ok_or_else(wrong)?;
    let (shape, scalar) = match suffix.split_once(':') {
        Some((shape, scalar)) => (shape, Some(scalar)),
        None => (suffix, None),
    };
    let side = |side: &str| side.parse::<u32>().ok().filter(|side| *side > 0);
    let shape: Option<Vec<u32>> = shape.split(',').map(side).collect();
    output.shape = Some(shape.ok_or_else(|| {
        format!("`{suffix}` is not a shape: whole numbers from 1 up, such as 720,1280 (height, width)")
    })?);
    output.scalar = match scalar {
        None => None,
        Some("f32") => Some(Scalar::F32),
        Some("u32") => Some(Scalar::U32),
        Some("i32") => Some(Scalar::I32),
        Some(other) => return Err(format!("`{other}` is not a type: f32, u32 or i32")),
    };
    Ok(output)
}

/// `NAME.FIELD=VALUE`.
pub fn setting(text: &str) -> Result<Setting, String> {
    match text.split_once('=') {
        Some((path, value)) if !path.is_empty() && !value.trim().is_empty() => {
            Ok(Setting { path: path.to_owned(), value: value.to_owned() })
        }
        _ => Err(format!("`{text}` is not NAME.FIELD=VALUE such as medium.extinction=0.2")),
    }
}

/// `NAME` or `NAME=VALUE`, one definition.
pub fn definition(text: &str) -> Result<Definitions, String> {
    let definitions: Definitions =
        text.parse().map_err(|error: airlight_validate::Error| error.to_string())?;
    if definitions.len() != 1 {
        return Err(format!("`{text}` is not NAME or NAME=VALUE"));
    }
    Ok(definitions)
}

/// `X`, `X,Y` or `X,Y,Z`, each at least 1.
pub fn counts(text: &str) -> Result<[u32; 3], String> {
    let wrong = || format!("`{text}` is not X, X,Y or X,Y,Z with whole numbers from 1 up");
    let mut counts = [1; 3];
    let mut parts = text.split(',');
    for (axis, count) in counts.iter_mut().enumerate() {
        let Some(part) = parts.next() else {
            return if axis == 0 { Err(wrong()) } else { Ok(counts) };
        };
        *count = part.parse().ok().filter(|count| *count > 0).ok_or_else(wrong)?;
    }
    if parts.next().is_some() { Err(wrong()) } else { Ok(counts) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_read() {
        let read = output("values=a:b.npy:1000,4:u32").unwrap();
        assert_eq!(read.name, "values");
        assert_eq!(read.file, PathBuf::from("a:b.npy"));
        assert_eq!(read.shape, Some(vec![1000, 4]));
        assert_eq!(read.scalar, Some(Scalar::U32));
        let plain = output("a=dir.npy/x.npy").unwrap();
        assert_eq!((plain.file, plain.shape, plain.scalar), (PathBuf::from("dir.npy/x.npy"), None, None));
        for wrong in [
            "",
            "a",
            "a=",
            "=x.npy",
            "a=x.png",
            "a=x.npy:",
            "a=x.npy:0",
            "a=x.npy:1,",
            "a=x.npy:-1",
            "a=x.npy:1:f64",
            "a=x.npy:1:u32:u32",
            "a=x.npyz",
            "a=x.npy:1.5",
            "a=x.npy:4294967296",
        ] {
            assert!(output(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_other_spellings_are_read_and_nonsense_is_refused() {
        assert_eq!(counts("3").unwrap(), [3, 1, 1]);
        assert_eq!(counts("3,4").unwrap(), [3, 4, 1]);
        assert_eq!(counts("3,4,5").unwrap(), [3, 4, 5]);
        for wrong in ["", "0", "1,0", "1,2,3,4", "x", "-1", "1.5", "1,,2"] {
            assert!(counts(wrong).is_err(), "{wrong}");
        }
        assert_eq!(subject("a/b").unwrap().permutation, "default");
        assert_eq!(subject("a/b:c").unwrap().permutation, "c");
        for wrong in ["", "a", "/b", "a/", "a/b:"] {
            assert!(subject(wrong).is_err(), "{wrong}");
        }
        assert_eq!(definition("A=3").unwrap().to_string(), "A=3");
        for wrong in ["", "A B", "A=x", "1A"] {
            assert!(definition(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "a", "a=", "=1"] {
            assert!(setting(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "a", "a=", "=f"] {
            assert!(input(wrong).is_err(), "{wrong}");
        }
    }
}
