//! Prints the battery's hashes: with the standard library where there is one, else by what each
//! bare target has.
#![cfg_attr(any(target_os = "none", target_os = "unknown"), no_std, no_main)]

#[cfg(all(target_os = "none", target_arch = "arm"))]
mod cortex_m;
#[cfg(all(
    target_os = "none",
    any(target_arch = "aarch64", target_arch = "riscv32")
))]
mod user_mode;
#[cfg(target_os = "unknown")]
mod wasm;

#[cfg(all(target_os = "none", target_arch = "arm"))]
use cortex_m::{Out, exit};
#[cfg(all(
    target_os = "none",
    any(target_arch = "aarch64", target_arch = "riscv32")
))]
use user_mode::{Out, exit};

#[cfg(not(any(target_os = "none", target_os = "unknown")))]
fn main() {
    let mut text = String::new();
    let written = tumble_bits::battery::write(&mut text, cfg!(feature = "scenes"));
    print!("{text}");
    assert_eq!(written, Ok(()), "a scene cannot be composed");
}

/// Called by the start-up code of a bare target.
#[cfg(target_os = "none")]
fn main() -> ! {
    match tumble_bits::battery::write(&mut Out, cfg!(feature = "scenes")) {
        Ok(()) => exit(0),
        Err(_) => exit(1),
    }
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    use core::fmt::Write;

    let _ = writeln!(Out, "{info}");
    exit(2)
}
