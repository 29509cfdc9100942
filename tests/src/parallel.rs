// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rows of work over the machine's cores.

use std::sync::atomic::{AtomicUsize, Ordering};

/// `work(0)` to `work(rows - 1)` over at least two threads, results in order. Each call is
/// independent of the others, so the result does not depend on the number of threads.
///
/// # Panics
/// If `work` does.
#[must_use]
pub fn rows<T: Send>(rows: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(2, usize::from).max(2);
    let next = AtomicUsize::new(0);
    let mut results: Vec<(usize, T)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.min(rows))
            .map(|_| {
                scope.spawn(|| {
                    let mut done = Vec::new();
                    loop {
                        let row = next.fetch_add(1, Ordering::Relaxed);
                        if row >= rows {
                            return done;
                        }
                        done.push((row, work(row)));
                    }
                })
            })
            .collect();
        workers
            .into_iter()
            .flat_map(|worker| match worker.join() {
                Ok(done) => done,
                Err(panic) => std::panic::resume_unwind(panic),
            })
            .collect()
    });
    results.sort_unstable_by_key(|&(row, _)| row);
    results.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn rows_come_in_order() {
        let squares = super::rows(1000, |row| row * row);
        assert!(squares.iter().enumerate().all(|(row, &square)| square == row * row));
        assert!(super::rows(0, |row| row).is_empty());
    }
}
