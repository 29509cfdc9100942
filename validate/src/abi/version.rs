// SPDX-License-Identifier: MIT OR Apache-2.0
//! Semantic versions, as far as a breaking change asks for them.

/// Whether going from `old` to `new` allows a breaking change. What is no version allows none.
pub(super) fn allows_breaking(old: &str, new: &str) -> bool {
    match (parse(old), parse(new)) {
        (Some([0, old_minor]), Some([0, new_minor])) => new_minor > old_minor,
        (Some([old, _]), Some([new, _])) => new > old,
        _ => false,
    }
}

/// Major and minor of `major.minor.patch`, with or without what follows `-` or `+`.
fn parse(version: &str) -> Option<[u64; 2]> {
    let core = version.split(['-', '+']).next()?;
    let mut numbers = core.split('.').map(str::parse);
    let (Some(Ok(major)), Some(Ok(minor)), Some(Ok::<u64, _>(_)), None) =
        (numbers.next(), numbers.next(), numbers.next(), numbers.next())
    else {
        return None;
    };
    Some([major, minor])
}

#[cfg(test)]
mod tests {
    use super::allows_breaking;

    #[test]
    fn only_a_greater_leading_number_does() {
        for (old, new) in
            [("0.1.0", "0.2.0"), ("0.9.3", "1.0.0"), ("1.2.3", "2.0.0-rc.1"), ("0.1.0", "1.0.0")]
        {
            assert!(allows_breaking(old, new), "{old} {new}");
            assert!(!allows_breaking(new, old), "{new} {old}");
        }
        for (old, new) in [
            ("0.1.0", "0.1.1"),
            ("1.2.0", "1.3.0"),
            ("", "1.0.0"),
            ("1.0.0", ""),
            ("0.1", "0.2"),
            ("1.0.0", "two"),
        ] {
            assert!(!allows_breaking(old, new), "{old} {new}");
        }
    }
}
