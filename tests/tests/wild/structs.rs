// SPDX-License-Identifier: MIT OR Apache-2.0
//! The contents of uniform and storage buffers from their reflected types.
//!
//! Sane contents follow the names of members: matrices come with their inverses, directions are unit vectors of one
//! frame, counts and sizes are small.

use crate::gpu::{Random, host_camera};
use crate::values::{Content, extreme_float, extreme_word};
use airlight::validate::{Reflection, StructLayout};
use glam::{EulerRot, Mat3, Mat4, Quat, Vec3};

/// What a 32-bit word of a buffer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// `f32`
    Float,
    /// `u32` or `i32`
    Whole,
    /// Nothing.
    Padding,
}

/// The type as a list of words, for one element where it is an array without a length.
pub fn words(reflection: &Reflection, ty: &str) -> Vec<Word> {
    if let Some((base, count)) = array(ty) {
        let element = words(reflection, base);
        return element.repeat(count.unwrap_or(1));
    }
    if let Some(inner) = ty.strip_prefix("atomic<") {
        return words(reflection, inner.trim_end_matches('>'));
    }
    if let Some((rows, columns)) = matrix(ty) {
        let column = if rows == 3 { 4 } else { rows };
        return vec![Word::Float; column * columns];
    }
    let scalar = |ty: &str| if ty == "f32" { Word::Float } else { Word::Whole };
    if let Some(rest) = ty.strip_prefix("vec") {
        let count = usize::from(rest.as_bytes()[0] - b'0');
        return vec![scalar(rest[2..].trim_end_matches('>')); count];
    }
    let Some(layout) = reflection.layout(ty) else { return vec![scalar(ty)] };
    let mut all = vec![Word::Padding; layout.size as usize / 4];
    for member in &layout.members {
        let inner = member_words(reflection, &member.ty, member.stride);
        let begin = member.offset as usize / 4;
        let end = (begin + inner.len()).min(all.len());
        all[begin..end].copy_from_slice(&inner[..end - begin]);
    }
    all
}

fn member_words(reflection: &Reflection, ty: &str, stride: Option<u32>) -> Vec<Word> {
    match (array(ty), stride) {
        (Some((base, count)), Some(stride)) => {
            let mut element = words(reflection, base);
            element.resize(stride as usize / 4, Word::Padding);
            element.repeat(count.unwrap_or(1))
        }
        _ => words(reflection, ty),
    }
}

/// Words from one element to the next of an array of a type.
fn stride(reflection: &Reflection, base: &str) -> usize {
    let size = words(reflection, base).len();
    if base.starts_with("vec3") { 4 } else { size }
}

/// What an array is of, and how many where that is written.
pub fn array(ty: &str) -> Option<(&str, Option<usize>)> {
    let inside = ty.strip_prefix("array<")?.strip_suffix('>')?;
    // Commas of an inner type stand before its closing bracket.
    match inside.rsplit_once(", ").and_then(|(base, count)| Some((base, count.parse().ok()?))) {
        Some((base, count)) => Some((base, Some(count))),
        None => Some((inside, None)),
    }
}

fn matrix(ty: &str) -> Option<(usize, usize)> {
    let (columns, rows) = ty.strip_prefix("mat")?.split_once('<')?.0.split_once('x')?;
    Some((rows.parse().ok()?, columns.parse().ok()?))
}

/// The contents of a buffer of a type, and what each word of it holds. `elements`: of an array without a length.
pub fn contents(
    reflection: &Reflection,
    (ty, name): (&str, &str),
    elements: usize,
    content: Content,
    random: &mut Random,
) -> (Vec<u32>, Vec<Word>) {
    let mut values = Vec::new();
    let mut kinds = Vec::new();
    let (base, count) = match array(ty) {
        Some((base, count)) => (base, count.unwrap_or(elements)),
        None => (ty, 1),
    };
    let one = words(reflection, base);
    for _ in 0..count {
        let mut element = one.iter().map(|word| plain(*word, name, random)).collect::<Vec<_>>();
        if let Some(layout) = reflection.layout(base) {
            fill_struct(layout, &mut element, random);
        }
        for (value, word) in element.iter_mut().zip(&one) {
            if random.unit() < content.extreme_share() {
                *value = match word {
                    Word::Float => extreme_float(random).to_bits(),
                    Word::Whole => extreme_word(random),
                    Word::Padding => 0,
                };
            }
        }
        values.extend_from_slice(&element);
        kinds.extend_from_slice(&one);
        if count > 1 {
            values.resize(kinds.len().next_multiple_of(stride(reflection, base)), 0);
            kinds.resize(values.len(), Word::Padding);
        }
    }
    (values, kinds)
}

/// A word outside of any struct.
fn plain(word: Word, name: &str, random: &mut Random) -> u32 {
    match word {
        Word::Float => (random.between(-1.0, 1.0) as f32).to_bits(),
        Word::Whole if name == "keys" => random.bits(),
        Word::Whole => random.below(8) as u32,
        Word::Padding => 0,
    }
}

fn fill_struct(layout: &StructLayout, element: &mut [u32], random: &mut Random) {
    let forward = random.below(2) as f32;
    let viewport = [random.below(33) as f32 + 1.0, random.below(33) as f32 + 1.0];
    let mut frame = rotation(random).to_cols_array_2d().map(Vec3::from).into_iter().cycle();
    for member in &layout.members {
        let begin = member.offset as usize / 4;
        let end = begin + member.size as usize / 4;
        let Some(words) = element.get_mut(begin..end) else { continue };
        let mut set = |values: &[f32]| {
            for (word, value) in words.iter_mut().zip(values.iter().cycle()) {
                *word = value.to_bits();
            }
        };
        let name = member.name.as_str();
        match (name, member.ty.as_str()) {
            (_, ty) if ty.contains("mat4x4") => set(&matrix_of(name, random).to_cols_array()),
            (_, ty) if name.starts_with("reserved") => words.fill(u32::from(ty.is_empty())),
            ("near_depth", _) => set(&[1.0 - forward]),
            ("far_depth", _) => set(&[forward]),
            ("sign", _) => set(&[random.below(2) as f32 * 2.0 - 1.0]),
            ("wraps", _) => set(&[random.below(2) as f32]),
            ("viewport" | "picture_size", _) => set(&viewport),
            ("size", "vec2<f32>") => set(&viewport),
            ("g", _) => set(&[random.between(-0.9, 0.9) as f32]),
            ("rows", "f32") => set(&[random.below(32) as f32 + 1.0]),
            (
                "light" | "axis_a" | "axis_b" | "ray_light" | "ray_a" | "ray_b" | "direction" | "along"
                | "across" | "away" | "normal" | "axis",
                "vec3<f32>",
            ) => set(&frame.next().unwrap_or(Vec3::Y).to_array()),
            ("spot_cosines", _) => set(&[0.9, 0.5]),
            ("eye" | "origin" | "position" | "point", _) => {
                for word in words {
                    *word = (random.between(-3.0, 3.0) as f32).to_bits();
                }
            }
            ("seed" | "frame" | "hash", "u32") => words[0] = random.bits(),
            ("shift", _) => words[0] = 4 * random.below(8) as u32,
            (
                "projection" | "local" | "parity" | "begins" | "ends" | "front_to_back" | "turn" | "mode",
                "u32",
            ) => {
                words[0] = random.below(2) as u32;
            }
            ("kind" | "phase" | "blend", "u32") => words[0] = random.below(3) as u32,
            (_, ty) if ty.contains("f32") => {
                let high = if name.contains("albedo") || name.contains("cosine") { 1.0 } else { 2.0 };
                for word in words {
                    *word = (random.between(0.05, high) as f32).to_bits();
                }
            }
            (_, ty) => {
                let least = usize::from(ty.starts_with("vec") || name != "first");
                for word in words {
                    *word = (least + random.below(9)) as u32;
                }
            }
        }
    }
    invert_partners(layout, element);
    if layout.name == "Camera" {
        let camera = random.camera(f64::from(viewport[0] / viewport[1]));
        let camera = host_camera(&camera, viewport.map(|side| side as u32));
        let mut bytes = encase::UniformBuffer::new(Vec::<u8>::new());
        bytes.write(&camera).expect("a growing vector takes all");
        for (word, bytes) in element.iter_mut().zip(bytes.into_inner().chunks_exact(4)) {
            *word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        }
    }
}

fn rotation(random: &mut Random) -> Mat3 {
    let [a, b, c] = [0; 3].map(|_| random.between(-3.0, 3.0) as f32);
    Mat3::from_euler(EulerRot::XYZ, a, b, c)
}

/// A view-projection where a name speaks of clip space, else an affine map.
fn matrix_of(name: &str, random: &mut Random) -> Mat4 {
    if name.contains("clip") {
        return host_camera(&random.camera(1.0), [1, 1]).clip_from_world;
    }
    let scale = Vec3::from([0; 3].map(|_| random.magnitude(0.3, 3.0) as f32));
    let shift = Vec3::from([0; 3].map(|_| random.between(-1.0, 1.0) as f32));
    Mat4::from_scale_rotation_translation(scale, Quat::from_mat3(&rotation(random)), shift)
}

/// Makes `b_from_a` the inverse of `a_from_b` where a struct has both.
fn invert_partners(layout: &StructLayout, element: &mut [u32]) {
    for (index, member) in layout.members.iter().enumerate() {
        let Some((to, from)) = member.name.split_once("_from_") else { continue };
        let partner = format!("{from}_from_{to}");
        let Some(later) = layout.members[index..].iter().find(|member| member.name == partner) else {
            continue;
        };
        for matrix in 0..member.size as usize / 64 {
            let (a, b) = (member.offset as usize / 4 + 16 * matrix, later.offset as usize / 4 + 16 * matrix);
            let columns: [f32; 16] = std::array::from_fn(|k| f32::from_bits(element[a + k]));
            let inverse = Mat4::from_cols_array(&columns).inverse().to_cols_array();
            for (word, value) in element[b..b + 16].iter_mut().zip(inverse) {
                *word = value.to_bits();
            }
        }
    }
}
