// SPDX-License-Identifier: MIT OR Apache-2.0
//! Folders in every state.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::check;
use std::{fs, path::Path};

const LEAF: &str = "#define_import_path airlight::core::leaf\n/// One.\nfn one() -> f32 { return 1.0; }\n";
const FAR: &str = "#define_import_path airlight::far::away\n#import airlight::core::leaf::one\n/// Two.\nfn two() -> f32 { return 2.0 * one(); }\n";
const PASS: &str = "#ifdef TWICE\n#import airlight::far::away::two\n#endif\n@group(#{GROUP}) @binding(0) var<storage, read_write> x: f32;\n\
    @compute @workgroup_size(1)\nfn main() {\n#ifdef TWICE\n    x = two();\n#else\n    x = 1.0;\n#endif\n}\n";
const OTHER: &str = "@group(#{GROUP}) @binding(0) var<storage, read_write> x: f32;\n\
    @compute @workgroup_size(1) fn main() { x = 3.0; }\n";

fn library() -> Library {
    Library::from_text(
        &[("core/leaf.wgsl", LEAF), ("far/away.wgsl", FAR)],
        &[("core/passes/p.wgsl", PASS), ("core/passes/other.wgsl", OTHER)],
        &[("core", "p\n+ default:\n+ twice: TWICE\n+ thrice: TWICE THRICE=3u\nother\n+ default:\n")],
    )
}

fn vendor(folder: &Path, passes: &[&str], form: Form, force: bool) -> Result<Installed, Problem> {
    let requests: Vec<Request> = passes.iter().copied().map(Request::from).collect();
    let files = package(&library(), &requests, form)?;
    install(folder, &Lock::new(&requests, form, &files), &files, force)
}

/// Files with their states, those that are current left out.
fn states(folder: &Path) -> Vec<(String, State, bool)> {
    let (_, files) = verify(folder, &library()).unwrap();
    let wrong = files.into_iter().filter(|status| !status.is_current());
    wrong.map(|status| (status.file, status.state, status.outdated)).collect()
}

fn folder(passes: &[&str], form: Form) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    vendor(folder.path(), passes, form, false).unwrap();
    assert_eq!(states(folder.path()), []);
    folder
}

#[test]
fn sources_are_a_library_of_their_own() {
    let folder = folder(&["core/p:twice"], Form::NagaOil);
    let copy = Library::from_directory(folder.path()).unwrap();
    let paths: Vec<_> = copy.modules().iter().map(|module| module.path.as_str()).collect();
    assert_eq!(paths, ["airlight::core::leaf", "airlight::far::away"]);
    let names: Vec<_> = copy.permutations("core/p").unwrap().iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["default", "twice"]);
    assert!(copy.pass("core/other").is_err());
    for name in names {
        let definitions = library().permutation("core/p", name).unwrap().definitions.clone();
        assert_eq!(copy.permutation("core/p", name).unwrap().definitions, definitions);
        let composed = copy.compose("core/p", &definitions).unwrap().reflect();
        assert_eq!(composed, library().compose("core/p", &definitions).unwrap().reflect());
    }
    let report = check::run(&copy, &check::Options::default()).unwrap();
    assert!(
        report.findings.iter().all(|finding| finding.check == "expected-failures"),
        "{:?}",
        report.findings
    );
    for (licence, text) in airlight_wgsl::LICENCES {
        assert_eq!(fs::read_to_string(folder.path().join(licence)).unwrap(), text);
    }
    // Of a pass without a permutation, all.
    let all = package(&library(), &["core/p".into()], Form::NagaOil).unwrap();
    assert!(all["core/permutations"].contains("+ thrice: THRICE=3u TWICE\n"), "{}", all["core/permutations"]);
}

#[test]
fn flat_files_are_those_of_flatten() {
    let folder = folder(&["core/p:twice", "core/other"], Form::Flat);
    let names: Vec<_> = crate::files_below(folder.path(), "wgsl").unwrap().into_iter().collect();
    assert_eq!(names, ["core/other.wgsl", "core/p.twice.wgsl"]);
    let text = fs::read_to_string(folder.path().join("core/p.twice.wgsl")).unwrap();
    assert_eq!(text, flat::text(&library(), "core/p", "twice").unwrap());
}

#[test]
fn every_state_is_told() {
    let folder = folder(&["core/p"], Form::NagaOil);
    let at = |file: &str| folder.path().join(file);
    fs::write(at("core/leaf.wgsl"), "changed").unwrap();
    fs::remove_file(at("far/away.wgsl")).unwrap();
    fs::write(at("far/mine.wgsl"), "mine").unwrap();
    fs::write(at("notes.txt"), "not a shader").unwrap();
    let expected = [
        ("core/leaf.wgsl", State::Changed, false),
        ("far/away.wgsl", State::Missing, false),
        ("far/mine.wgsl", State::Extra, false),
    ];
    assert_eq!(states(folder.path()), expected.map(|(file, state, old)| (file.to_owned(), state, old)));
    let finding = verify(folder.path(), &library()).unwrap().1[0].finding(folder.path());
    assert_eq!(finding, None);
}

#[test]
fn outdated_files_are_told() {
    let folder = folder(&["core/p"], Form::NagaOil);
    let newer = Library::from_text(
        &[
            ("core/leaf.wgsl", &LEAF.replace("1.0", "1.5")),
            ("far/away.wgsl", FAR),
            ("far/more.wgsl", "#define_import_path airlight::far::more\n"),
        ],
        &[("core/passes/p.wgsl", &format!("#import airlight::far::more\n{PASS}"))],
        &[("core", "p\n+ default:\n+ twice: TWICE\n+ thrice: TWICE THRICE=3u\n")],
    );
    let (_, files) = verify(folder.path(), &newer).unwrap();
    let of = |name: &str| {
        let status = files.iter().find(|status| status.file == name).unwrap();
        (status.state, status.outdated)
    };
    assert_eq!(of("core/leaf.wgsl"), (State::Unmodified, true));
    assert_eq!(of("core/passes/p.wgsl"), (State::Unmodified, true));
    assert_eq!(of("far/more.wgsl"), (State::New, true));
    assert_eq!(of("far/away.wgsl"), (State::Unmodified, false));
    // Of a pass that is gone, everything is.
    let without = Library::from_text(&[], &[("core/passes/other.wgsl", OTHER)], &[]);
    assert!(verify(folder.path(), &without).unwrap().1.iter().all(|status| status.outdated));
}

#[test]
fn what_others_wrote_is_not_lost() {
    let folder = folder(&["core/p"], Form::NagaOil);
    let leaf = folder.path().join("core/leaf.wgsl");
    fs::write(&leaf, "changed").unwrap();
    fs::write(folder.path().join("core/passes/other.wgsl"), "mine").unwrap();
    let before = fs::read_to_string(folder.path().join(LOCK_FILE)).unwrap();
    let error =
        vendor(folder.path(), &["core/p", "core/other"], Form::NagaOil, false).unwrap_err().to_string();
    assert!(error.contains("core/leaf.wgsl was changed locally"), "{error}");
    assert!(error.contains("core/passes/other.wgsl was not written by vendor"), "{error}");
    assert_eq!(fs::read_to_string(&leaf).unwrap(), "changed");
    assert_eq!(fs::read_to_string(folder.path().join(LOCK_FILE)).unwrap(), before);
    vendor(folder.path(), &["core/p", "core/other"], Form::NagaOil, true).unwrap();
    assert_eq!(states(folder.path()), []);
    assert_eq!(fs::read_to_string(&leaf).unwrap(), LEAF);
}

#[test]
fn what_is_no_longer_needed_goes_unless_changed() {
    let folder = folder(&["core/p", "core/other"], Form::NagaOil);
    let kept = folder.path().join("core/leaf.wgsl");
    fs::write(&kept, "changed").unwrap();
    let done = vendor(folder.path(), &["core/other"], Form::NagaOil, false).unwrap();
    assert_eq!(done.removed, ["core/passes/p.wgsl", "far/away.wgsl"]);
    assert_eq!(done.kept, ["core/leaf.wgsl"]);
    assert!(!folder.path().join("far").exists() && folder.path().join("core/passes").exists());
    assert_eq!(states(folder.path()), [("core/leaf.wgsl".to_owned(), State::Extra, false)]);
    // A second time there is nothing to do.
    let again = vendor(folder.path(), &["core/other"], Form::NagaOil, false).unwrap();
    assert_eq!((again.written.len(), again.removed.len()), (0, 0));
    let entries = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(entries.into_iter().all(|name| !name.to_string_lossy().starts_with(".airlight")));
}

#[test]
fn all_is_written_or_nothing() {
    let folder = folder(&["core/other"], Form::NagaOil);
    let lock = fs::read(folder.path().join(LOCK_FILE)).unwrap();
    // A file where a folder has to be.
    fs::write(folder.path().join("far"), "in the way").unwrap();
    assert!(vendor(folder.path(), &["core/p"], Form::NagaOil, true).is_err());
    // The same where writing has begun.
    let texts = [("core/passes/other.wgsl", "new"), ("core/new.wgsl", "new"), ("far/away.wgsl", "new")];
    assert!(install::replace(folder.path(), &texts, &["core/permutations".to_owned()]).is_err());
    assert_eq!(states(folder.path()), []);
    assert_eq!(fs::read(folder.path().join(LOCK_FILE)).unwrap(), lock);
    assert!(!folder.path().join("core/passes/p.wgsl").exists());
    assert!(folder.path().join("core/passes/other.wgsl").exists());
}

#[test]
fn unknown_names_list_the_known_ones() {
    let error = package(&library(), &["core/none".into()], Form::Flat).unwrap_err().to_string();
    assert!(error.contains("core/p, core/other"), "{error}");
    let error = package(&library(), &["core/p:none".into()], Form::Flat).unwrap_err().to_string();
    assert!(error.contains("twice"), "{error}");
}

#[test]
fn a_lock_file_that_is_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(verify(folder.path(), &library()), Err(Problem::NoLock(_))));
    let outside = folder.path().join("kept.wgsl");
    fs::write(&outside, "kept").unwrap();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    let lock = |files: &str| {
        let sum = lock::sum(b"kept");
        format!(
            "{{\"format\":1,\"version\":\"0.1.0\",\"form\":\"flat\",\"passes\":[\"core/other\"],\"files\":{{\"{files}\":\"{sum}\"}}}}"
        )
    };
    let paths = [
        "../kept.wgsl",
        "/kept.wgsl",
        "a/../../kept.wgsl",
        "..\\\\kept.wgsl",
        "C:/kept.wgsl",
        "",
        "./kept.wgsl",
        "a//b",
        "airlight.lock.json",
    ];
    let broken = [
        "".to_owned(),
        "{".to_owned(),
        "[]".to_owned(),
        lock("a").replace("\"format\":1", "\"format\":2"),
        lock("a").replace("flat", "round"),
    ];
    for text in paths.map(lock).into_iter().chain(broken) {
        fs::write(inner.join(LOCK_FILE), &text).unwrap();
        assert!(matches!(verify(&inner, &library()), Err(Problem::BrokenLock { .. })), "{text}");
        let error = vendor(&inner, &["core/other"], Form::Flat, false).unwrap_err();
        assert!(matches!(error, Problem::BrokenLock { .. }), "{text}: {error}");
        vendor(&inner, &["core/other"], Form::Flat, true).unwrap();
        assert_eq!(fs::read_to_string(&outside).unwrap(), "kept", "{text}");
        fs::remove_dir_all(inner.join("core")).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn a_link_does_not_lead_out_of_the_folder() {
    let [folder, elsewhere] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    std::os::unix::fs::symlink(elsewhere.path(), folder.path().join("core")).unwrap();
    let error = vendor(folder.path(), &["core/other"], Form::Flat, true).unwrap_err().to_string();
    assert!(error.contains("symbolic link"), "{error}");
    assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 0);
}
