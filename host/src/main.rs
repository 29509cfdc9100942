// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command `airlight`.

use std::process::ExitCode;

fn main() -> ExitCode {
    airlight::command::main()
}
