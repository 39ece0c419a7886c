//! The client in C: its own checks, watched by the sanitizers and by valgrind, and the promises of its first lines.

use fsct_c::{CLIENT, DEVICE, Kind, MASTER, build};
use std::process::Command;

/// Sources of the client's own checks.
const CHECKS: &[&str] = &["test_client.c", "fsct_client.c"];
/// What stops a program at the first access or calculation that is not sound.
const SANITIZED: &[&str] = &["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

fn passes(mut command: Command) {
    let output = command.output().expect("it can be started");
    let told = [output.stdout, output.stderr].concat();
    assert!(output.status.success(), "{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&told));
}

#[test]
fn the_client_keeps_to_the_page_and_to_its_memory() {
    let Some(checks) = build(Kind::Program, CHECKS, SANITIZED) else { return };
    passes(Command::new(checks));
}

#[test]
fn valgrind_finds_nothing_either() {
    let Some(checks) = build(Kind::Program, CHECKS, &["-g"]) else { return };
    let mut command = Command::new("valgrind");
    command.args(["--error-exitcode=9", "--quiet", "--leak-check=full"]).arg(checks);
    if fsct_c::there("valgrind") {
        passes(command);
    }
}

#[test]
fn everything_compiles_as_c_and_every_header_as_cpp() {
    for sources in [CLIENT, DEVICE, MASTER] {
        let Some(_) = build(Kind::Library, sources, &["-Wshadow", "-Wconversion"]) else { return };
    }
    if !fsct_c::there("c++") {
        return;
    }
    for header in ["fsct_dut.h", "fsct_client.h", "fs_crc.h", "fs_device.h", "fs_master.h"] {
        let mut command = Command::new("c++");
        command.current_dir(env!("CARGO_MANIFEST_DIR"));
        command.args(["-std=c++11", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only", "-x", "c++", header]);
        passes(command);
    }
}

#[test]
fn the_client_is_short_and_needs_nobody() {
    let text = |name: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        std::fs::read_to_string(path).expect("it is there")
    };
    let client = [text("fsct_client.h"), text("fsct_client.c")];
    let lines: usize = client.iter().map(|text| text.lines().count()).sum();
    assert!(lines < 500, "the client has {lines} lines");
    for word in ["malloc", "calloc", "realloc", "free(", "<stdio.h>", "<unistd.h>", "<stdlib.h>"] {
        assert!(client.iter().all(|text| !text.contains(word)), "the client uses {word}");
    }
}
