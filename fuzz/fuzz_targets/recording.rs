//! `recording` of `tests/fuzz`, with the inputs of libFuzzer.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| coapt_fuzz_cases::recording(bytes));
