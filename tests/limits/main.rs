//! What holds for every input: extremes of every parameter, all parts with one another, invalid
//! input and parts that break their contract. Ordinary scenes are in `tests/parts` and
//! `tests/physics`.
//!
//! A file holds one subject. `cargo test --test limits bad_input::` runs those of `bad_input.rs`.

#[path = "../common/mod.rs"]
mod common;
#[path = "../kit/mod.rs"]
mod kit;

mod bad_input;
mod combinations;
mod contract;
mod contract_inputs;
mod contract_reach;
mod diagnosis;
mod driven;
mod extremes;
mod extremes_table;
mod first_version;
mod held;
mod long;
mod long_rigid;
mod patterns;
