//! A fixed battery of scenes whose result bits are hashed. Every machine that follows IEEE 754 must
//! find the hashes of `hashes.txt`.
//!
//! `tests/downstream/tests/bits.rs` compares this machine's, `.ci/targets.sh` those of others.
#![no_std]

pub mod battery;
