// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where the fields of a buffer lie, and numbers written into them.

use super::spelling::Scalar;
use airlight_validate::{Member, StructLayout};

/// A type of WGSL that host and shader share.
#[derive(Clone, Copy, Debug)]
pub enum Type<'a> {
    /// A scalar, vector or matrix; `rows` numbers a column.
    Value { scalar: Scalar, columns: u32, rows: u32 },
    /// An array; no count where the buffer decides.
    Array { element: &'a str, count: Option<u32> },
    /// A struct.
    Struct(&'a StructLayout),
    /// Something else.
    Other,
}

impl<'a> Type<'a> {
    /// Reads a type as reflection spells it.
    pub fn new(spelled: &'a str, structs: &'a [StructLayout]) -> Self {
        if let Some(layout) = structs.iter().find(|layout| layout.name == spelled) {
            return Self::Struct(layout);
        }
        if let Some(scalar) = scalar(spelled) {
            return Self::Value { scalar, columns: 1, rows: 1 };
        }
        let Some((outer, inner)) = spelled.strip_suffix('>').and_then(|text| text.split_once('<')) else {
            return Self::Other;
        };
        let value =
            |columns, rows| scalar(inner).map_or(Self::Other, |scalar| Self::Value { scalar, columns, rows });
        let digit = |text: &str| text.parse::<u32>().ok().filter(|size| (2..=4).contains(size));
        match outer {
            "atomic" => value(1, 1),
            "array" => {
                // A count follows the last comma, unless that comma belongs to an array inside.
                let counted =
                    inner.rsplit_once(", ").and_then(|(element, count)| Some((element, count.parse().ok()?)));
                match counted {
                    Some((element, count)) => Self::Array { element, count: Some(count) },
                    None => Self::Array { element: inner, count: None },
                }
            }
            _ => {
                let vector = outer.strip_prefix("vec").and_then(digit).map(|rows| (1, rows));
                let matrix = || {
                    let (columns, rows) = outer.strip_prefix("mat")?.split_once('x')?;
                    Some((digit(columns)?, digit(rows)?))
                };
                vector.or_else(matrix).map_or(Self::Other, |(columns, rows)| value(columns, rows))
            }
        }
    }

    /// Bytes from one element to the next in a storage array of this type.
    pub fn stride(self, structs: &[StructLayout]) -> u64 {
        match self {
            Self::Value { columns: 1, rows, .. } => [4, 4, 8, 16, 16][rows as usize % 5],
            Self::Value { columns, rows, .. } => u64::from(columns * column_words(rows) * 4),
            Self::Array { element, count } => {
                Type::new(element, structs).stride(structs) * u64::from(count.unwrap_or(1))
            }
            Self::Struct(layout) => u64::from(layout.size.next_multiple_of(layout.align.max(1))),
            Self::Other => 4,
        }
    }

    /// The type of all its words, where they agree; reserved members do not count.
    pub fn scalar(self, structs: &[StructLayout]) -> Option<Scalar> {
        match self {
            Self::Value { scalar, .. } => Some(scalar),
            Self::Array { element, .. } => Type::new(element, structs).scalar(structs),
            Self::Struct(layout) => {
                let mut found = None;
                for member in layout.members.iter().filter(|member| !reserved(member)) {
                    let scalar = Type::new(&member.ty, structs).scalar(structs)?;
                    if *found.get_or_insert(scalar) != scalar {
                        return None;
                    }
                }
                found
            }
            Self::Other => None,
        }
    }

    /// Bytes before the elements of a trailing array without a count, and bytes of one of them.
    pub fn open_end(self, structs: &[StructLayout]) -> Option<(u64, u64)> {
        match self {
            Self::Array { element, count: None } => Some((0, Type::new(element, structs).stride(structs))),
            Self::Struct(layout) => {
                let last = layout.members.last()?;
                let (_, stride) = Type::new(&last.ty, structs).open_end(structs)?;
                Some((u64::from(last.offset), last.stride.map_or(stride, u64::from)))
            }
            _ => None,
        }
    }
}

fn scalar(spelled: &str) -> Option<Scalar> {
    match spelled {
        "f32" => Some(Scalar::F32),
        "u32" => Some(Scalar::U32),
        "i32" => Some(Scalar::I32),
        _ => None,
    }
}

fn column_words(rows: u32) -> u32 {
    if rows == 2 { 2 } else { 4 }
}

fn reserved(member: &Member) -> bool {
    member.name.starts_with("reserved")
}

/// The fields of a struct in one phrase.
pub fn field_list(layout: &StructLayout) -> String {
    let fields: Vec<_> = layout
        .members
        .iter()
        .filter(|member| !reserved(member))
        .map(|member| format!("{} ({})", member.name, member.ty))
        .collect();
    fields.join(", ")
}

/// Writes `value` into the field at `path` of a buffer that holds a `ty`. `path`: `a.b[2]`, empty for the whole.
pub fn set(
    bytes: &mut [u8],
    ty: &str,
    path: &str,
    value: &str,
    structs: &[StructLayout],
) -> Result<(), String> {
    let (spelled, offset) = find(ty, path, structs)?;
    let (scalar, columns, rows) = match Type::new(&spelled, structs) {
        Type::Value { scalar, columns, rows } => (scalar, columns, rows),
        Type::Struct(layout) => {
            return Err(format!("{spelled} is a struct; name one of its fields: {}", field_list(layout)));
        }
        Type::Array { .. } => return Err(format!("{spelled} is an array; name an element, such as [0]")),
        Type::Other => return Err(format!("{spelled} cannot be set")),
    };
    let numbers: Vec<&str> = value.split(',').map(str::trim).collect();
    if numbers.len() as u32 != columns * rows {
        let (given, wanted) = (numbers.len(), columns * rows);
        return Err(format!(
            "`{value}` is {given} number{}; {spelled} takes {wanted}",
            if given == 1 { "" } else { "s" }
        ));
    }
    let stride = if columns == 1 { rows } else { column_words(rows) };
    for (index, number) in (0..).zip(numbers) {
        let word = word(scalar, number)?;
        let at = offset as usize + 4 * (index / rows * stride + index % rows) as usize;
        let place = bytes.get_mut(at..at + 4).ok_or_else(|| format!("{spelled} lies outside the buffer"))?;
        place.copy_from_slice(&word);
    }
    Ok(())
}

/// The type and the offset of the field at `path`.
fn find(ty: &str, path: &str, structs: &[StructLayout]) -> Result<(String, u64), String> {
    let mut spelled = ty.to_owned();
    let mut offset = 0;
    let mut stride = None;
    for part in path.split('.').filter(|_| !path.is_empty()) {
        let (name, indices) = part.find('[').map_or((part, ""), |at| part.split_at(at));
        if !name.is_empty() || indices.is_empty() {
            let Type::Struct(layout) = Type::new(&spelled, structs) else {
                return Err(format!("{spelled} is no struct and has no field `{name}`"));
            };
            let member = layout.members.iter().find(|member| member.name == name);
            let member = member
                .ok_or_else(|| format!("{spelled} has no field `{name}`; it has {}", field_list(layout)))?;
            offset += u64::from(member.offset);
            stride = member.stride.map(u64::from);
            spelled = member.ty.clone();
        }
        for index in indices.split_terminator(']') {
            let index: Option<u32> = index.strip_prefix('[').and_then(|index| index.parse().ok());
            let index = index.ok_or_else(|| format!("`{part}` is not a field or field[INDEX]"))?;
            let Type::Array { element, count } = Type::new(&spelled, structs) else {
                return Err(format!("{spelled} is no array and has no element {index}"));
            };
            if count.is_none_or(|count| index >= count) {
                return Err(format!("{spelled} has no element {index}"));
            }
            let step = stride.take().unwrap_or_else(|| Type::new(element, structs).stride(structs));
            offset += u64::from(index) * step;
            spelled = element.to_owned();
        }
    }
    Ok((spelled, offset))
}

fn word(scalar: Scalar, number: &str) -> Result<[u8; 4], String> {
    match scalar {
        Scalar::F32 => super::super::parse::number(number).map(f32::to_le_bytes),
        Scalar::U32 => number
            .parse::<u32>()
            .map(u32::to_le_bytes)
            .map_err(|_| format!("`{number}` is not a whole number from 0 to {}", u32::MAX)),
        Scalar::I32 => number
            .parse::<i32>()
            .map(i32::to_le_bytes)
            .map_err(|_| format!("`{number}` is not a whole number from {} to {}", i32::MIN, i32::MAX)),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn member(name: &str, ty: &str, offset: u32, stride: Option<u32>) -> Member {
        Member { name: name.to_owned(), ty: ty.to_owned(), offset, size: 0, stride }
    }

    /// struct Inner { a: vec2<f32>, n: u32 }
    /// struct Outer { m: mat3x2<f32>, i: i32, inner: array<Inner, 2>, rest: array<vec3<f32>> }
    fn structs() -> Vec<StructLayout> {
        let inner = [member("a", "vec2<f32>", 0, None), member("n", "u32", 8, None)];
        let outer = [
            member("m", "mat3x2<f32>", 0, None),
            member("i", "i32", 24, None),
            member("inner", "array<Inner, 2>", 32, Some(16)),
            member("rest", "array<vec3<f32>>", 64, Some(16)),
        ];
        let layout = |name: &str, size, members: &[Member]| StructLayout {
            name: name.to_owned(),
            size,
            align: 8,
            members: members.to_vec(),
        };
        vec![layout("Inner", 16, &inner), layout("Outer", 80, &outer)]
    }

    #[test]
    fn numbers_land_where_the_layout_says() {
        let structs = structs();
        let mut bytes = vec![0; 80];
        let mut put = |path: &str, value: &str| set(&mut bytes, "Outer", path, value, &structs).unwrap();
        put("m", "1,2,3,4,5,6");
        put("i", "-7");
        put("inner[1].a", "8, 9");
        put("inner[0].n", "10");
        let words: Vec<[u8; 4]> = bytes.chunks_exact(4).map(|word| word.try_into().unwrap()).collect();
        for (index, expected) in [(0, 1.0), (1, 2.0), (5, 6.0), (12, 8.0), (13, 9.0)] {
            assert_eq!(f32::from_le_bytes(words[index]), expected, "word {index}");
        }
        assert_eq!(i32::from_le_bytes(words[6]), -7);
        assert_eq!(u32::from_le_bytes(words[10]), 10);
        assert_eq!(words.iter().filter(|word| **word != [0; 4]).count(), 10);
    }

    #[test]
    fn columns_of_three_are_padded_to_four() {
        let mut bytes = vec![0; 48];
        set(&mut bytes, "mat3x3<f32>", "", "1,2,3,4,5,6,7,8,9", &[]).unwrap();
        assert_eq!(bytes[12..16], [0; 4]);
        assert_eq!(bytes[16..20], 4f32.to_le_bytes());
        assert_eq!(bytes[40..44], 9f32.to_le_bytes());
    }

    #[test]
    fn strides_and_open_ends() {
        let structs = structs();
        let stride = |ty| Type::new(ty, &structs).stride(&structs);
        assert_eq!(
            [
                "u32",
                "atomic<u32>",
                "vec2<f32>",
                "vec3<f32>",
                "vec4<u32>",
                "mat4x4<f32>",
                "mat2x3<f32>",
                "Inner"
            ]
            .map(stride),
            [4, 4, 8, 16, 16, 64, 32, 16]
        );
        let open = |ty| Type::new(ty, &structs).open_end(&structs);
        assert_eq!(open("array<vec4<f32>>"), Some((0, 16)));
        assert_eq!(open("array<array<u32, 3>>"), Some((0, 12)));
        assert_eq!(open("Outer"), Some((64, 16)));
        assert_eq!(open("Inner"), None);
        assert_eq!(open("array<f32, 4>"), None);
        assert_eq!(Type::new("array<atomic<u32>>", &structs).scalar(&structs), Some(Scalar::U32));
        assert_eq!(Type::new("Inner", &structs).scalar(&structs), None);
    }

    #[test]
    fn wrong_paths_and_numbers_are_explained() {
        let structs = structs();
        let mut bytes = vec![0; 80];
        for (path, value, part) in [
            ("x", "1", "it has m (mat3x2<f32>), i (i32)"),
            ("inner", "1", "is an array"),
            ("inner[2].n", "1", "no element 2"),
            ("inner[0]", "1", "is a struct"),
            ("inner[a].n", "1", "`inner[a]`"),
            ("i.x", "1", "i32 is no struct"),
            ("i[0]", "1", "i32 is no array"),
            ("i", "1.5", "`1.5` is not a whole number"),
            ("inner[0].n", "-1", "`-1` is not a whole number"),
            ("inner[0].a", "1", "takes 2"),
            ("inner[0].a", "1,nan", "`nan` is not a finite number"),
            ("inner[0].a", "1,1e40", "`1e40` is not a finite number"),
        ] {
            let error = set(&mut bytes, "Outer", path, value, &structs).unwrap_err();
            assert!(error.contains(part), "{path}={value}: {error}");
        }
    }
}
