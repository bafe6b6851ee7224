//! `thetahat-bindgen MODULE.wasm FOLDER`: the module for a page, and the JavaScript that calls it.

use std::{env, error::Error, path::PathBuf};

use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args_os().skip(1).map(PathBuf::from);
    let (Some(module), Some(folder)) = (arguments.next(), arguments.next()) else {
        return Err("usage: thetahat-bindgen MODULE.wasm FOLDER".into());
    };
    Ok(Bindgen::new().input_path(module).web(true)?.typescript(true).out_name("thetahat_web").generate(folder)?)
}
