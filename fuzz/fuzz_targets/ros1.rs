#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| thetahat_data::recording::fuzzing::ros1(bytes));
