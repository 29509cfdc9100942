// SPDX-License-Identifier: MIT OR Apache-2.0
//! Airlight's shaders and the competitors', mutated where that is asked for: `AIRLIGHT_MUTATE` reaches the
//! competitors' own passes too, as `baselines/passes/NAME.wgsl`.

use crate::gpu;
use airlight::Shaders;
use airlight_tests::baselines::{PASSES, SYSTEM};
use std::sync::OnceLock;

/// The shaders under test.
pub fn shaders() -> &'static Shaders {
    static SHADERS: OnceLock<Shaders> = OnceLock::new();
    SHADERS.get_or_init(|| {
        let mutation = std::env::var("AIRLIGHT_MUTATE").unwrap_or_default();
        let parts: Vec<&str> = mutation.split('|').collect();
        let library = PASSES.iter().fold(gpu::shaders().library().clone(), |library, pass| {
            let mut text = pass.text.to_owned();
            if let [file, old, new] = parts[..]
                && file == format!("{SYSTEM}/passes/{}.wgsl", pass.name)
            {
                assert!(text.contains(old), "{file} has no `{old}`");
                text = text.replace(old, new);
            }
            library.with_pass(SYSTEM, pass.name, &text)
        });
        Shaders::from_library(library)
    })
}
