//! Invalid input, its errors and their words.

#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../limits/bad_input.rs"]
mod bad_input;
#[path = "../../limits/patterns.rs"]
mod patterns;
