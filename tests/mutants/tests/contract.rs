//! The contract checks.

#[path = "../../limits/contract.rs"]
mod contract;
