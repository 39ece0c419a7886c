//! Builds C for tests, with the compiler that a person would use.
//!
//! Where there is no compiler, a test that needs one says so on standard error and passes by; with the variable `CI` set it
//! fails instead. Everything is built as the strictest user would: C99, all warnings, and each one an error.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

/// How the C in this repository is compiled.
pub const FLAGS: [&str; 5] = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"];

/// Sources of the client for streams.
pub const CLIENT: &[&str] = &["fsct_client.c", "main.c"];
/// Sources of the example FS-Device.
pub const DEVICE: &[&str] = &["device_dut.c", "fs_crc.c", "fs_device*.c"];
/// Sources of the example FS-Master.
pub const MASTER: &[&str] = &["master_dut.c", "fs_crc.c", "fs_master*.c"];

/// What to make of sources.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A program.
    Program,
    /// A shared library.
    Library,
}

/// Whether there is a program, such as the compiler `cc`. If not, the test that asks says so.
///
/// # Panics
/// With the variable `CI` set, when there is none: a check that is meant to be made must not be passed over there.
pub fn there(program: &str) -> bool {
    let there = Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        assert!(std::env::var_os("CI").is_none(), "there is no `{program}`, and CI is to have it");
        // Not by a macro: those are kept back while a test passes.
        let _ = writeln!(std::io::stderr(), "NOT TESTED: there is no `{program}` on this machine");
    }
    there
}

/// Compiles sources of this folder, `*` for any text, or of absolute paths, with these options beside [`FLAGS`]; built once a
/// process. `None` when there is no compiler.
///
/// # Panics
/// When the compiler refuses, with what it says.
pub fn build(kind: Kind, sources: &[&str], options: &[&str]) -> Option<PathBuf> {
    static BUILT: Mutex<BTreeMap<String, PathBuf>> = Mutex::new(BTreeMap::new());
    if !there("cc") {
        return None;
    }
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let place = format!("{}-{}", std::process::id(), built.len());
    let path = built.entry(format!("{kind:?} {sources:?} {options:?}")).or_insert_with(|| {
        let path = folder().join(place);
        let mut command = Command::new("cc");
        command.current_dir(env!("CARGO_MANIFEST_DIR")).args(FLAGS).args(["-O1", "-I."]);
        if kind == Kind::Library {
            command.args(["-shared", "-fPIC", "-fvisibility=hidden"]);
        }
        command.args(options).arg("-o").arg(&path).args(sources.iter().flat_map(|source| matching(source)));
        let output = command.output().expect("the compiler was there a moment ago");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        path
    });
    Some(path.clone())
}

/// What a program prints whose source is `text`. `None` when there is no compiler.
///
/// # Panics
/// When it cannot be built or fails.
pub fn output_of(text: &str) -> Option<String> {
    let source = folder().join(format!("{}.c", std::process::id()));
    std::fs::write(&source, text).expect("the folder of the build is there");
    let program = build(Kind::Program, &[&source.display().to_string()], &[])?;
    let output = Command::new(program).output().expect("it has just been built");
    assert!(output.status.success(), "the program failed");
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The files of this folder that a name stands for.
fn matching(name: &str) -> Vec<PathBuf> {
    let Some((begin, end)) = name.split_once('*') else { return vec![PathBuf::from(name)] };
    let entries = Path::new(env!("CARGO_MANIFEST_DIR")).read_dir().into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut files: Vec<_> =
        names.filter(|name| name.starts_with(begin) && name.ends_with(end)).map(PathBuf::from).collect();
    files.sort();
    files
}

/// Where to build: beside the test programs, so that cleaning them cleans this.
fn folder() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    let folder = program.parent().unwrap_or(Path::new(".")).join("c");
    std::fs::create_dir_all(&folder).expect("the folder of the test programs can be written");
    folder
}
