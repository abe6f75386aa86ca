#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| relume_fuzz::emitters_json(bytes));
