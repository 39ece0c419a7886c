//! See [`fsct_fuzz::session`].
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| fsct_fuzz::session(input));
