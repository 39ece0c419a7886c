//! Every input of the fuzz corpus once, without a fuzzer.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../../fuzz/src/lib.rs"]
mod fuzz;

use std::fs;
use std::path::Path;

fn every_input(target: &str, body: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target);
    let mut inputs = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        // Shown when the body panics.
        println!("{}", path.display());
        body(&fs::read(path).unwrap());
        inputs += 1;
    }
    assert!(inputs > 20, "{inputs} inputs");
}

#[test]
fn frame_decoder() {
    every_input("frame_decoder", fuzz::frame_decoder);
}

#[test]
fn session() {
    every_input("session", fuzz::session);
}
