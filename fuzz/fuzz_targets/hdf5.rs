#![no_main]

// The library behind this reader panics on some damaged files; the reader turns that into an error, which it cannot do
// where the panic's hook aborts.
libfuzzer_sys::fuzz_target!(
    init: std::panic::set_hook(Box::new(|_| {})),
    |bytes: &[u8]| thetahat_data::recording::fuzzing::hdf5(bytes)
);
