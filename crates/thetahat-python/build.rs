//! What a module that Python loads is linked with: on macOS, symbols that are found as it is loaded.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
