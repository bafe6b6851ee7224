#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| thetahat::recording::fuzzing::db3(bytes));
