// SPDX-License-Identifier: MIT OR Apache-2.0
//! Subjects on a few threads: with stacks for what compilers nest, and a limit to what one may take.

use super::{
    Finding, Severity, panic_text,
    unit::{self, Context, Subject},
};
use crate::Location;
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};

/// Bytes of a stack on which text is parsed; compilers recurse with what the text nests.
pub(crate) const STACK: usize = 256 << 20;

/// How long one subject may take: far more than any takes on a loaded machine.
pub(super) const PATIENCE: Duration = Duration::from_secs(300);

/// Runs something with a large stack; none where no thread can be had or it panicked.
pub(crate) fn on_large_stack<T: Send>(work: impl FnOnce() -> T + Send) -> Option<T> {
    thread::scope(|scope| {
        thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work).ok()?.join().ok()
    })
}

enum Message {
    Begun(usize),
    Done(usize, Vec<Finding>),
}

/// Every subject; findings in the order of the subjects.
pub(super) fn run_all(subjects: Vec<Subject>, context: Context, patience: Duration) -> Vec<Vec<Finding>> {
    let check = move |index: usize, subject: &Subject| unit::check(&context, subject, index);
    let files: Vec<Location> = subjects.iter().map(|subject| Location::file(subject.name())).collect();
    supervise(subjects, files, patience, check)
}

fn supervise<S: Send + Sync + 'static>(
    subjects: Vec<S>,
    places: Vec<Location>,
    patience: Duration,
    check: impl Fn(usize, &S) -> Vec<Finding> + Send + Sync + 'static,
) -> Vec<Vec<Finding>> {
    let count = subjects.len();
    let shared = Arc::new((subjects, check, AtomicUsize::new(0)));
    let (sender, receiver) = channel();
    let threads = thread::available_parallelism().map_or(2, usize::from).min(8);
    let start = || {
        let (shared, sender) = (Arc::clone(&shared), sender.clone());
        let work = move || work(&shared.0, &shared.1, &shared.2, &sender);
        thread::Builder::new().stack_size(STACK).spawn(work).is_ok()
    };
    let started = (0..threads).filter(|_| start()).count();
    let mut results = vec![None; count];
    if started > 0 {
        collect(&receiver, &mut results, &places, patience, start);
    }
    let missing = |place: Location| {
        let message = "no thread could be had to check it on".to_owned();
        vec![Finding::new(Severity::Error, place, "internal", message)]
    };
    results.into_iter().zip(places).map(|(found, place)| found.unwrap_or_else(|| missing(place))).collect()
}

fn work<S>(
    subjects: &[S],
    check: &(impl Fn(usize, &S) -> Vec<Finding> + ?Sized),
    next: &AtomicUsize,
    sender: &Sender<Message>,
) {
    loop {
        let index = next.fetch_add(1, Ordering::Relaxed);
        let Some(subject) = subjects.get(index) else { break };
        if sender.send(Message::Begun(index)).is_err() {
            break;
        }
        let found = catch_unwind(AssertUnwindSafe(|| check(index, subject))).unwrap_or_else(|panic| {
            let message = format!("the check panicked: {}", panic_text(panic.as_ref()));
            vec![Finding::new(Severity::Error, Location::file(""), "internal", message)]
        });
        if sender.send(Message::Done(index, found)).is_err() {
            break;
        }
    }
}

/// Waits for every subject. One that takes too long is given up: its thread cannot be stopped and
/// is left behind, and another takes its place.
fn collect(
    receiver: &Receiver<Message>,
    results: &mut [Option<Vec<Finding>>],
    places: &[Location],
    patience: Duration,
    start: impl Fn() -> bool,
) {
    let mut running: Vec<(usize, Instant)> = Vec::new();
    let mut left = results.len();
    while left > 0 {
        match receiver.recv_timeout(patience.min(Duration::from_millis(500))) {
            Ok(Message::Begun(index)) => running.push((index, Instant::now())),
            Ok(Message::Done(index, mut found)) => {
                running.retain(|(other, _)| *other != index);
                if results[index].is_none() {
                    for finding in found.iter_mut().filter(|finding| finding.check == "internal") {
                        finding.file = places[index].file.clone();
                    }
                    results[index] = Some(found);
                    left -= 1;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        let late: Vec<usize> =
            running.iter().filter(|(_, since)| since.elapsed() > patience).map(|(index, _)| *index).collect();
        for index in late {
            running.retain(|(other, _)| *other != index);
            let message = format!("gave up after {} s", patience.as_secs_f32());
            let place = places[index].clone();
            results[index] = Some(vec![Finding::new(Severity::Error, place, "internal", message)]);
            left -= 1;
            start();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_and_a_hang_are_findings_and_the_rest_goes_on() {
        let subjects: Vec<u32> = (0..40).collect();
        let places = subjects.iter().map(|subject| Location::file(subject.to_string())).collect();
        let check = |_: usize, subject: &u32| match subject {
            3 => panic!("on purpose"),
            5 | 6 => loop {
                thread::sleep(Duration::from_secs(1));
            },
            _ => Vec::new(),
        };
        let found = supervise(subjects, places, Duration::from_millis(300), check);
        let findings: Vec<Finding> = found.into_iter().flatten().collect();
        let files: Vec<&str> = findings.iter().map(|finding| finding.file.as_str()).collect();
        assert_eq!(files, ["3", "5", "6"], "{findings:?}");
        assert!(findings[0].message.contains("on purpose"));
        assert!(findings[1].message.contains("gave up"));
    }

    #[test]
    fn a_large_stack_is_large() {
        fn deep(levels: u32) -> u64 {
            let room = std::hint::black_box([u64::from(levels); 128]);
            if levels == 0 { 0 } else { room[3].min(1) + deep(levels - 1) }
        }
        assert_eq!(on_large_stack(|| deep(50_000)), Some(50_000));
    }
}
