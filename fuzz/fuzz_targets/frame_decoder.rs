//! See [`fsct_fuzz::frame_decoder`].
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| fsct_fuzz::frame_decoder(input));
