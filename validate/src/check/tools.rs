// SPDX-License-Identifier: MIT OR Apache-2.0
//! Compilers and validators that are programs of their own.

use crate::check::Severity;
use std::{
    ffi::OsStr,
    fmt, fs, io,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

/// A program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Tool {
    /// Chrome's WGSL compiler.
    #[value(name = "tint")]
    Tint,
    /// The validator of SPIR-V.
    #[value(name = "spirv-val")]
    SpirvVal,
    /// The reference compiler of GLSL.
    #[value(name = "glslangValidator")]
    Glslang,
    /// The DirectX Shader Compiler.
    #[value(name = "dxc")]
    Dxc,
}

impl Tool {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Tint, Self::SpirvVal, Self::Glslang, Self::Dxc];

    /// The program's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tint => "tint",
            Self::SpirvVal => "spirv-val",
            Self::Glslang => "glslangValidator",
            Self::Dxc => "dxc",
        }
    }

    /// How to get it.
    pub(crate) fn remedy(self) -> &'static str {
        match self {
            Self::Tint => "build `tint_cmd_tint_cmd` of https://dawn.googlesource.com/dawn",
            Self::SpirvVal => "install Debian's `spirv-tools` or the Vulkan SDK",
            Self::Glslang => "install Debian's `glslang-tools` or the Vulkan SDK",
            Self::Dxc => "run `scripts/dxc.sh`, or install the Vulkan SDK",
        }
    }
}

impl fmt::Display for Tool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Where a program is, by the folders of a path variable.
pub(crate) fn find(tool: Tool, path: Option<&OsStr>) -> Option<PathBuf> {
    let name = format!("{tool}{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(path?).map(|folder| folder.join(&name)).find(|file| file.is_file())
}

/// What Tint says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Diagnostic {
    pub severity: Severity,
    pub message: String,
    pub line: Option<u32>,
    /// In bytes, from 1.
    pub column: Option<u32>,
}

impl Diagnostic {
    /// The lint that it belongs to.
    pub fn check(&self) -> &'static str {
        match self.message.contains("uniform control flow") {
            true => "uniformity",
            false => Tool::Tint.name(),
        }
    }
}

fn failed(message: String) -> Vec<Diagnostic> {
    vec![Diagnostic { severity: Severity::Error, message, line: None, column: None }]
}

/// Errors and warnings of Tint about a WGSL file.
pub(crate) fn tint(program: &Path, text: &str, file: &Path) -> Vec<Diagnostic> {
    // Writing WGSL again needs no writer that a build of Tint may lack.
    let output_file = file.with_extension("out");
    let output_name = output_file.to_string_lossy();
    let arguments = ["--format", "wgsl", "--output-name", &*output_name, "--diagnostics-format", "json"];
    let output = match run(program, &arguments, text.as_bytes(), file) {
        Ok(output) => output,
        Err(message) => return failed(message),
    };
    let said =
        format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let diagnostics = diagnostics(&said);
    let has_error = diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error);
    if !output.status.success() && !has_error {
        return failed(format!("tint failed: {}", said.trim()));
    }
    diagnostics
}

/// Reads `[{"severity", "message", "range": {"start": {"line"}}}]`; notes explain what precedes.
fn diagnostics(text: &str) -> Vec<Diagnostic> {
    let json = text.find('[').and_then(|start| {
        serde_json::Deserializer::from_str(&text[start..]).into_iter::<serde_json::Value>().next()?.ok()
    });
    let mut diagnostics: Vec<Diagnostic> = Vec::new();
    for entry in json.iter().filter_map(serde_json::Value::as_array).flatten() {
        let message = entry["message"].as_str().unwrap_or_default();
        let severity = match entry["severity"].as_str() {
            Some("note") => {
                if let Some(last) = diagnostics.last_mut() {
                    last.message = format!("{}; {message}", last.message);
                }
                continue;
            }
            Some("warning") => Severity::Warning,
            _ => Severity::Error,
        };
        let start = |part: &str| {
            let number = entry["range"]["start"][part].as_u64();
            number.and_then(|number| u32::try_from(number).ok()).filter(|&number| number > 0)
        };
        let (line, column) = (start("line"), start("column"));
        diagnostics.push(Diagnostic { severity, message: message.to_owned(), line, column });
    }
    diagnostics
}

/// Validates SPIR-V for Vulkan 1.1.
pub(crate) fn spirv_val(program: &Path, words: &[u32], file: &Path) -> Result<(), String> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    judged(program, run(program, &["--target-env", "vulkan1.1"], &bytes, file)?, file)
}

/// Compiles GLSL; the stage is the file's extension.
pub(crate) fn glslang(program: &Path, text: &str, file: &Path) -> Result<(), String> {
    judged(program, run(program, &[], text.as_bytes(), file)?, file)
}

/// Compiles HLSL for shader model 6.0; `stage` is `vs`, `ps` or `cs`.
pub(crate) fn dxc(
    program: &Path,
    (text, entry_point): (&str, &str),
    stage: &str,
    file: &Path,
) -> Result<(), String> {
    let profile = format!("{stage}_6_0");
    let arguments = ["-T", &profile, "-E", entry_point, "-HV", "2018"];
    judged(program, run(program, &arguments, text.as_bytes(), file)?, file)
}

fn judged(program: &Path, output: Output, file: &Path) -> Result<(), String> {
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    let path = file.display().to_string();
    let lines: Vec<&str> =
        said.lines().map(str::trim).filter(|line| !line.is_empty() && *line != path).collect();
    let name = program.file_stem().unwrap_or_default().to_string_lossy();
    let said = lines.join(" | ").replace(&format!("{path}:"), "").replace(&path, "");
    Err(format!("{name}: {}", said.trim()))
}

/// How long a program may take.
const PATIENCE: Duration = Duration::from_secs(60);

fn run(program: &Path, arguments: &[&str], content: &[u8], file: &Path) -> Result<Output, String> {
    fs::write(file, content).map_err(|error| format!("cannot write {}: {error}", file.display()))?;
    run_within(PATIENCE, program, arguments, file)
}

/// Runs a program that must end; what it says comes back as its output, errors among it.
fn run_within(patience: Duration, program: &Path, arguments: &[&str], file: &Path) -> Result<Output, String> {
    let said = file.with_extension("said");
    let failed = |error: io::Error| format!("cannot run {}: {error}", program.display());
    let log = fs::File::create(&said).map_err(failed)?;
    let mut child = Command::new(program)
        .args(arguments)
        .arg(file)
        .stdin(Stdio::null())
        .stdout(log.try_clone().map_err(failed)?)
        .stderr(log)
        .spawn()
        .map_err(failed)?;
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            break status;
        }
        if start.elapsed() > patience {
            // It may have ended meanwhile.
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("{} gave no answer within {} s", program.display(), patience.as_secs()));
        }
        thread::sleep(Duration::from_millis(2));
    };
    let stdout = fs::read(&said).map_err(failed)?;
    Ok(Output { status, stdout, stderr: Vec::new() })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_program_is_found_on_the_path_only() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(format!("tint{}", std::env::consts::EXE_SUFFIX));
        assert_eq!(find(Tool::Tint, Some(folder.path().as_os_str())), None);
        fs::write(&file, "").unwrap();
        assert_eq!(find(Tool::Tint, Some(folder.path().as_os_str())), Some(file));
        assert_eq!(find(Tool::Tint, None), None);
    }

    #[test]
    fn diagnostics_are_read() {
        let text = r#"x [{"severity":"error","message":"a","range":{"start":{"line":3,"column":7}}},
            {"severity":"note","message":"b","range":{"start":{"line":1}}},
            {"severity":"warning","message":"c"}]"#;
        let expected = [
            Diagnostic { severity: Severity::Error, message: "a; b".into(), line: Some(3), column: Some(7) },
            Diagnostic { severity: Severity::Warning, message: "c".into(), line: None, column: None },
        ];
        assert_eq!(diagnostics(text), expected);
        assert_eq!(diagnostics(""), []);
    }

    #[test]
    fn a_program_that_does_not_end_is_stopped() {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let mut programs = std::env::split_paths(&path).map(|folder| folder.join("tail"));
        let Some(tail) = programs.find(|file| file.is_file()) else { return };
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("followed");
        fs::write(&file, "").unwrap();
        let error = run_within(Duration::from_millis(50), &tail, &["-f"], &file).unwrap_err();
        assert!(error.contains("no answer"), "{error}");
    }
}
