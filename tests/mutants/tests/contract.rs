//! The contract checks.

#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../limits/contract.rs"]
mod contract;
#[path = "../../limits/contract_inputs.rs"]
mod contract_inputs;
#[path = "../../limits/contract_reach.rs"]
mod contract_reach;
