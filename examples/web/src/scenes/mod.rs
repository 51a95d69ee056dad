//! The scenes of the page: its bodies, integrators and parameters, and a battery of all of them.
//!
//! `tests/bits` has this folder as a module, too: it stores the hash of the battery, and hashes its
//! own runs in the same way. So nothing in it imports from the page.

pub mod battery;
pub mod bodies;
pub mod error;
pub mod hash;
pub mod method;
pub mod parameters;

/// Returns a number as a small whole number, if it is one.
#[must_use]
pub fn whole(number: f64) -> Option<u32> {
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
