//! `tumble` for a page in a browser: blocks of numbers, and functions that the page calls.
//!
//! The module imports nothing and allocates nothing. A function returns 0, or 1 with the reason as
//! a text.
#![cfg_attr(target_family = "wasm", no_std)]

pub mod exports;
pub mod memory;
pub mod run;
pub mod scenes;
pub mod tosses;

#[cfg(target_family = "wasm")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
