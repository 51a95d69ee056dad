//! The contract checks.

#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../limits/contract.rs"]
mod contract;
