// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ctrl-C: the first time what there is is kept and written, the second time the program ends.

use crate::command::CommandError;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of a program that a signal ended.
const INTERRUPTED: i32 = 130;

/// Whether the person at the keyboard wants to stop.
#[derive(Clone, Default)]
pub struct Cancel {
    asked: Arc<AtomicBool>,
}

impl Cancel {
    /// Listens to Ctrl-C from now on.
    ///
    /// # Errors
    /// A failure where the system takes no handler.
    pub fn listening() -> Result<Self, CommandError> {
        let cancel = Self::default();
        let asked = Arc::clone(&cancel.asked);
        let heard = move || {
            if asked.swap(true, Ordering::Relaxed) {
                std::process::exit(INTERRUPTED);
            }
        };
        ctrlc::set_handler(heard)
            .map_err(|error| CommandError::failure(format!("Ctrl-C cannot be heard: {error}")))?;
        Ok(cancel)
    }

    /// Whether it was asked for.
    pub fn asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }
}
