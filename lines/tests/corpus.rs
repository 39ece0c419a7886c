//! Every input of the fuzz corpus once, without a fuzzer.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../../fuzz/src/capture.rs"]
mod fuzz;

use std::fs;
use std::path::Path;

#[test]
fn capture() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/capture");
    let mut inputs = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        // Shown when the body panics.
        println!("{}", path.display());
        fuzz::capture(&fs::read(path).unwrap());
        inputs += 1;
    }
    assert!(inputs > 10, "{inputs} inputs");
}
