//! The model against results that nobody here made: closed forms and printed numbers of the
//! literature, one file a group of cases.
//!
//! A [`Case`](table::Case) has printed numbers and computes them; its [`Random`](table::Random)
//! versions hold the formula for parameters of any size. All numbers together, and how near the
//! random ones came to their tolerances, are the table of the documentation's chapter
//! `guide::validation`, and this suite fails where the table is not what it gets:
//!
//! ```text
//! UPDATE=1 cargo test --test validation
//! ```

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

#[path = "../kit/mod.rs"]
mod kit;
mod scenes;
mod table;

mod a_free_motion;
mod b_normal_contact;
mod c_friction;
mod d_rolling;
mod e_rocking;
mod f_eccentric;
mod g_ball_bounce;
mod h_coin_toss;
mod i_terrain;

use table::{Case, TABLE};

/// Every case, in the table's order.
fn cases() -> impl Iterator<Item = &'static Case> {
    [
        a_free_motion::CASES,
        b_normal_contact::CASES,
        c_friction::CASES,
        d_rolling::CASES,
        e_rocking::CASES,
        f_eccentric::CASES,
        g_ball_bounce::CASES,
        h_coin_toss::CASES,
        i_terrain::CASES,
    ]
    .into_iter()
    .flatten()
    .copied()
}

#[test]
fn the_table_in_the_documentation_is_what_the_suite_gets() {
    if kit::asks_for_other_draws() {
        return;
    }
    let rows: String = cases().map(Case::rows).collect();
    TABLE.has(&rows);
}
