//! What must hold for every input of the public interface, with inputs composed from arbitrary
//! bytes.
//!
//! Each module has a function `run` that decodes bytes, plays the input and panics if a promise is
//! broken. `.ci/fuzz.sh` lets libFuzzer search for such bytes, guided by the coverage.
//! `tests/fuzz.rs` replays the stored inputs of `tests/fuzz/corpus` without libFuzzer.

// An oracle fails by panicking.
#![allow(clippy::panic, clippy::unwrap_used, clippy::expect_used)]

pub mod contract;
pub mod driven;
pub mod input;
pub mod load;
#[path = "../../kit/once.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod once;
pub mod outcome;
pub mod parts;
pub mod scene;
pub mod session;
pub mod terrain;

/// A target: its name, and the function that plays an input.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 6] = [
    ("scene", scene::run),
    ("contract", contract::run),
    ("load", load::run),
    ("outcome", outcome::run),
    ("terrain", terrain::run),
    ("session", session::run),
];
