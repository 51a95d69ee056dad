//! Passes the memory map and the linker script of the start-up crate to the linker, for targets
//! without an operating system.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    // The script of cortex-m-rt includes the map.
    let (map, scripts) = match env::var("CARGO_CFG_TARGET_ARCH")?.as_str() {
        "arm" => ("memory_cortex_m.x", ["link.x"].as_slice()),
        _ => ("memory_riscv.x", ["memory.x", "link.x"].as_slice()),
    };
    let folder = env::var("OUT_DIR")?;
    fs::copy(map, Path::new(&folder).join("memory.x"))?;
    println!("cargo:rerun-if-changed={map}");
    println!("cargo:rustc-link-search={folder}");
    for script in scripts {
        println!("cargo:rustc-link-arg-bins=-T{script}");
    }
    Ok(())
}
