//! `tumble` for a page in a browser: blocks of numbers, and functions that the page calls.
//!
//! The module imports nothing and allocates nothing. A function returns 0, or 1 with the reason as
//! a text.
#![cfg_attr(target_family = "wasm", no_std)]

// Not as a crate of its own, which would compile all rows.
#[cfg(target_family = "wasm")]
#[path = "../../../tests/bits/src/battery.rs"]
#[allow(
    dead_code,
    unreachable_pub,
    missing_docs,
    reason = "the page computes one row of it"
)]
mod battery;
pub mod bodies;
pub mod error;
pub mod exports;
pub mod memory;
pub mod method;
pub mod run;
pub mod scene;
pub mod tosses;

/// Returns a number as a small whole number, if it is one.
fn whole(number: f64) -> Option<u32> {
    let is_whole = (0.0..1e6).contains(&number);
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the number is between 0 and a million, and is compared with the result"
    )]
    let value = number as u32;
    #[allow(clippy::float_cmp, reason = "a whole number is exact")]
    (is_whole && f64::from(value) == number).then_some(value)
}

#[cfg(target_family = "wasm")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
