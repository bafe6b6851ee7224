//! `thetahat-bindgen MODULE.wasm FOLDER`: two modules for a page, and the JavaScript that calls them.
//!
//! The module was compiled for threads. In `FOLDER/threads` is the one whose instances share a memory, which a browser gives to pages
//! that are served with certain headers alone; in `FOLDER` the same code with a memory of its own.

use std::{env, error::Error, path::Path};

use walrus::{Module, ModuleConfig};
use wasm_bindgen_cli_support::Bindgen;

const NAME: &str = "thetahat_web";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = env::args_os().skip(1).collect();
    let [module, folder] = arguments.as_slice() else {
        return Err("usage: thetahat-bindgen MODULE.wasm FOLDER".into());
    };
    let folder = Path::new(folder);
    // Atomic instructions on a memory that is not shared are valid in browsers, but not to the strict reader.
    let read = || ModuleConfig::new().strict_validate(false).parse_file(module);
    write(read()?, &folder.join("threads"))?;
    let mut own = read()?;
    own.memories.iter_mut().for_each(|memory| memory.shared = false);
    write(own, folder)
}

fn write(module: Module, folder: &Path) -> Result<(), Box<dyn Error>> {
    Ok(Bindgen::new().input_module(NAME, module).web(true)?.typescript(true).out_name(NAME).generate(folder)?)
}
