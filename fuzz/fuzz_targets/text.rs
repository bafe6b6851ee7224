#![no_main]

// Text of other tools: what init sees in a file, with each choice of the dialect that a user can state; the first byte chooses.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| thetahat_data::recording::fuzzing::text(bytes));
