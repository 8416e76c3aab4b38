//! Writes the JavaScript around the page's WebAssembly: `gingerbread-web-bind MODULE.wasm FOLDER`.

use std::{env, error::Error};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [module, folder] = &arguments[..] else { return Err("usage: gingerbread-web-bind MODULE.wasm FOLDER".into()) };
    Bindgen::new()
        .input_path(module)
        .web(true)?
        .typescript(false)
        .remove_name_section(true)
        .out_name("gingerbread")
        .generate(folder)?;
    Ok(())
}
