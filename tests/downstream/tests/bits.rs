//! The same input has the same bits: a battery of scenes is hashed, and the hashes are compared
//! with the stored ones.
//!
//! The stored hashes are those of every machine and every profile: `cargo test --release` compares
//! with the same file, and `.ci/targets.sh` lets other processors do so. A change of the
//! arithmetic, however small, fails here. If it is meant, store the new hashes, and let
//! `.ci/targets.sh` confirm them:
//!
//! ```text
//! UPDATE=1 cargo test --test bits
//! ```

use std::path::Path;
use std::{env, fs};

#[path = "../../bits/src/battery.rs"]
#[allow(unreachable_pub, reason = "it is the face of the crate tests/bits")]
mod battery;

#[test]
fn this_machine_has_the_stored_bits() {
    let mut hashes = String::new();
    battery::write(&mut hashes, false).unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bits/hashes.txt");
    if env::var_os("UPDATE").is_some() {
        fs::write(&file, &hashes).unwrap();
    }
    let stored = fs::read_to_string(&file).unwrap();
    assert!(
        hashes == stored,
        "the bits have changed; `UPDATE=1 cargo test --test bits` stores them if that is meant\nstored:\n{stored}now:\n{hashes}"
    );
}

#[test]
fn every_scene_of_the_battery_is_run_to_its_end_and_is_another() {
    let mut outcomes = Vec::new();
    battery::each_scene(&mut |outcome| outcomes.push(outcome)).unwrap();
    let played_by = |first: &battery::Outcome| {
        let method = (first.precision, first.integrator);
        let same = outcomes
            .iter()
            .filter(|o| (o.precision, o.integrator) == method);
        same.map(|outcome| outcome.scene).collect::<Vec<_>>()
    };
    // Each battery has rows of its own, and that of the page is the last.
    let is_page = |outcome: &battery::Outcome| outcome.integrator == "live page";
    let (page, library): (Vec<&_>, Vec<&_>) = outcomes.iter().partition(|o| is_page(o));
    let of = |wanted: &str| {
        let suffix = |o: &battery::Outcome| o.integrator.split_once(", ").map_or("", |(_, s)| s);
        let rows = library.iter().filter(|o| suffix(o) == wanted).copied();
        rows.collect::<Vec<_>>()
    };
    // Seven bodies with ten integrators, thrown and set down.
    for (battery, least) in [
        (of(""), 14),
        (of("driven"), 10),
        (of("rims"), 3),
        (page, 140),
    ] {
        let scenes = played_by(battery[0]);
        assert!(scenes.len() >= least, "{scenes:?}");
        for outcome in battery {
            assert!(!outcome.ended_early, "{outcome:?}");
            assert_eq!(played_by(outcome), scenes, "{outcome:?}");
        }
    }
    // Of one method: a closed-form flight that never begins is another method's run.
    let mut hashes: Vec<_> = outcomes
        .iter()
        .map(|o| (o.precision, o.integrator, o.hash))
        .collect();
    hashes.sort_unstable();
    hashes.dedup();
    assert_eq!(hashes.len(), outcomes.len());
}
