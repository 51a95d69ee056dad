//! The target `outcome` of libFuzzer.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tumble_fuzz::outcome::run(data));
