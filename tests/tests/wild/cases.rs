// SPDX-License-Identifier: MIT OR Apache-2.0
//! The cases of a permutation, and what is held in each.

use crate::gpu::{gpu, wgsl};
use crate::passes::Pipelines;
use crate::resources::{Resources, Written};
use crate::structs::Word;
use crate::values::Content;
use airlight::Shaders;
use airlight::validate::{Composed, Library, naga};
use std::sync::OnceLock;
use std::time::Duration;

/// Of the permutation that most use. The driver compiles anew for nearly every case.
const DEFAULT_CASES: [Content; 4] = [Content::Finite, Content::NonFinite, Content::Rough, Content::Extreme];
/// Of each of the others.
const OTHER_CASES: [Content; 2] = [Content::NonFinite, Content::Rough];
/// The longest submission. An idle machine of two cores takes at most a tenth.
const LONGEST: Duration = Duration::from_secs(30);

/// What ran, for the last line.
#[derive(Default)]
struct Tally {
    permutations: usize,
    cases: usize,
    slowest: (Duration, String),
    failures: Vec<String>,
}

/// The shaders as they lie in the folder, so that a change needs no build; or a mutation of them.
pub fn shaders() -> &'static Shaders {
    static SHADERS: OnceLock<Shaders> = OnceLock::new();
    SHADERS.get_or_init(|| match std::env::var("AIRLIGHT_MUTATE") {
        Ok(_) => Shaders::from_library(Library::from_directory(crate::gpu::copy_of_wgsl().path()).unwrap()),
        Err(_) => Shaders::from_library(Library::from_directory(&wgsl()).unwrap()),
    })
}

/// Holds all passes of a system to what `main.rs` says.
pub fn hold(system: &str) {
    let only = std::env::var("AIRLIGHT_WILD").unwrap_or_default();
    let only: Vec<&str> = only.split(':').collect();
    let matches =
        |index: usize, name: &str| only.get(index).is_none_or(|wanted| wanted.is_empty() || *wanted == name);
    let mut tally = Tally::default();
    for pass in shaders().library().passes() {
        if pass.name.split('/').next() != Some(system) || !pass.name.contains(only[0]) {
            continue;
        }
        for permutation in shaders().library().permutations(&pass.name).unwrap() {
            if matches(1, &permutation.name) {
                let composed = shaders().compose_with(&pass.name, &permutation.definitions).unwrap();
                hold_permutation(
                    &composed,
                    &permutation.name,
                    |case| matches(2, &case.to_string()),
                    &mut tally,
                );
            }
        }
    }
    let answers = airlight::Buffer::of_floats(gpu(), &[1.5]).read_floats(gpu()).unwrap();
    assert_eq!(answers[0], 1.5, "the device answers no more");
    println!(
        "{system}: {} permutations, {} cases; slowest submission {:?} of {}",
        tally.permutations, tally.cases, tally.slowest.0, tally.slowest.1
    );
    let shown: Vec<_> = tally.failures.iter().take(60).cloned().collect();
    assert!(shown.is_empty(), "{} failures:\n{}", tally.failures.len(), shown.join("\n"));
}

fn hold_permutation(
    composed: &Composed,
    permutation: &str,
    wanted: impl Fn(usize) -> bool,
    tally: &mut Tally,
) {
    let label = format!("{}:{permutation}", composed.pass);
    let forms = [composed, &flat_file(composed, permutation)].map(Pipelines::new);
    let [own, flat] = match forms {
        [Ok(own), Ok(flat)] => [own, flat],
        [Err(error), _] | [_, Err(error)] => return tally.failures.push(format!("{label}: {error}")),
    };
    tally.permutations += 1;
    let reflection = composed.reflect();
    let kinds = if permutation == "default" { &DEFAULT_CASES[..] } else { &OTHER_CASES[..] };
    let rounds: usize = std::env::var("AIRLIGHT_WILD_ROUNDS").map_or(1, |rounds| rounds.parse().unwrap());
    let cases = kinds.iter().copied().cycle().take(kinds.len() * rounds).enumerate();
    for (number, content) in cases.filter(|(number, _)| wanted(*number)) {
        let case = format!("{label}:{number} ({content:?})");
        let seed = seed(&case);
        // Where anything goes, the forms may differ in what a NaN becomes.
        let forms = if content.is_sane() { &[&own, &flat][..] } else { &[&own] };
        let mut ran = Vec::new();
        for pipelines in forms {
            let resources = Resources::new(&composed.pass, &reflection, content, seed);
            match pipelines.run(&resources, content, seed, &case) {
                Ok(run) => ran.push((run, resources)),
                Err(error) => tally.failures.push(format!("{case}: {error}\n  {}", resources.described())),
            }
        }
        tally.cases += 1;
        let Some((first, resources)) = ran.first() else { continue };
        for (run, _) in &ran {
            if run.took > tally.slowest.0 {
                tally.slowest = (run.took, case.clone());
            }
            if run.took > LONGEST {
                tally.failures.push(format!("{case} took {:?}\n  {}", run.took, resources.described()));
            }
        }
        let mut wrong = Vec::new();
        if content.is_sane() {
            wrong.extend(first.written.iter().filter_map(not_finite));
        }
        for (second, _) in &ran[1..] {
            wrong.extend(
                first.written.iter().zip(&second.written).filter_map(|(own, flat)| difference(own, flat)),
            );
        }
        if !wrong.is_empty() {
            let wrong = wrong.join("; ");
            tally.failures.push(format!("{case}: {wrong}\n  {}", resources.described()));
        }
    }
}

/// The flat file of a permutation, parsed.
fn flat_file(composed: &Composed, permutation: &str) -> Composed {
    let file =
        airlight_wgsl::FLAT.iter().find(|flat| flat.pass == composed.pass && flat.permutation == permutation);
    let text = file.unwrap().source;
    let module = naga::front::wgsl::parse_str(text).unwrap();
    let capabilities = airlight::validate::core_capabilities();
    let info =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities).validate(&module);
    Composed {
        pass: format!("{} (flat)", composed.pass),
        file: composed.file.clone(),
        definitions: composed.definitions.clone(),
        info: info.unwrap(),
        module,
    }
}

/// FNV-1a.
fn seed(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn kind(written: &Written, index: usize) -> Word {
    *written.kinds.get(index).or(written.kinds.last()).unwrap_or(&Word::Whole)
}

/// Where two forms differ; two NaNs are alike.
fn difference(own: &Written, flat: &Written) -> Option<String> {
    let nan = |word: u32| f32::from_bits(word).is_nan();
    let unlike = |&index: &usize| {
        let (a, b) = (own.words[index], flat.words[index]);
        a != b && !(kind(own, index) == Word::Float && nan(a) && nan(b))
    };
    let count = (0..own.words.len()).filter(unlike).count();
    let first = (0..own.words.len()).find(unlike)?;
    let (a, b) = (own.words[first], flat.words[first]);
    let shown = |word: u32| format!("{word:#x} = {:e}", f32::from_bits(word));
    Some(format!(
        "`{}`[{first}], and {count} in all of {}: composed {}, flat {}",
        own.name,
        own.words.len(),
        shown(a),
        shown(b)
    ))
}

fn not_finite(written: &Written) -> Option<String> {
    let wild = |&index: &usize| {
        kind(written, index) == Word::Float && !f32::from_bits(written.words[index]).is_finite()
    };
    let count = (0..written.words.len()).filter(wild).count();
    let first = (0..written.words.len()).find(wild)?;
    let value = f32::from_bits(written.words[first]);
    Some(format!("`{}`[{first}] is {value}, as are {count} in all of {}", written.name, written.words.len()))
}
