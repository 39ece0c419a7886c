//! See [`capture::capture`].
#![no_main]

#[path = "../src/capture.rs"]
mod capture;

libfuzzer_sys::fuzz_target!(|input: &[u8]| capture::capture(input));
