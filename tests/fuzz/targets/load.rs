//! The target `load` of libFuzzer.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tumble_fuzz::load::run(data));
