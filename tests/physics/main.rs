//! What a body does in a scene that a user would compose: closed forms, conserved quantities,
//! orders of convergence, and the coin report. What each part adds to a scene is in `tests/parts`.
//! Scenes at their extremes and invalid input are in `tests/limits`, the literature is in
//! `tests/validation`.
//!
//! A file holds one subject. `cargo test --test physics flight::` runs those of `flight.rs`.

#[path = "../common/mod.rs"]
mod common;
#[path = "../kit/mod.rs"]
mod kit;

// What holds for each integrator.
mod audit;
mod certificate;
mod elastic_bounces;
mod energy;
mod events;
mod flight;
mod force_stability;
mod free_rotation;
mod free_steps;
mod ground_edges;
mod growth;
mod limiter;
mod long_steps;
mod lowest_point;
mod many_contacts;
mod many_states;
mod once;
mod outcome;
mod passing_contacts;
mod rigidity;
mod stable_step;
mod step_at_rest;
mod stick_on_slopes;
mod symmetry;
mod time;
mod turning_points;
mod until_rest;
mod walls;

// How accurate they are.
mod adaptive;
mod adaptive_energy_momentum;
mod adaptive_nystrom;
mod energy_momentum;
mod error_estimate;
mod oblique_impacts;
mod radau;
mod truth;
mod work_precision;

// The coin report, and the further study that it names.
mod report;
mod report_loop;
mod tennis;
