//! Replays the inputs that the fuzzer has stored in `tests/fuzz/corpus`, and some random ones.
//!
//! `.ci/fuzz.sh` searches for more of them. The files of the corpus are bytes, which
//! `tests/fuzz/src` decodes. One that fails is played alone by
//!
//! ```text
//! INPUT=tests/fuzz/corpus/scene/… cargo test --test fuzz scene
//! ```

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::{env, fs};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

#[path = "fuzz/src/lib.rs"]
#[allow(
    dead_code,
    unreachable_pub,
    missing_debug_implementations,
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    clippy::std_instead_of_core,
    reason = "it is the face of the crate tests/fuzz, a program that fails by panicking"
)]
mod fuzz;

/// Stored inputs of a target, or the one that `INPUT` names, in the order of their names.
fn files(target: &str) -> Vec<PathBuf> {
    if let Some(file) = env::var_os("INPUT") {
        return vec![file.into()];
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus");
    let entries = fs::read_dir(folder.join(target)).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Plays the stored inputs of a target, and a hundred random ones.
fn replay(target: &str) {
    let (_, run) = (fuzz::TARGETS.iter())
        .find(|(name, _)| *name == target)
        .unwrap();
    let files = files(target);
    assert!(!files.is_empty(), "no stored input of {target}");
    for file in &files {
        println!("{}", file.display());
        run(&fs::read(file).unwrap());
    }
    let mut random = ChaCha8Rng::seed_from_u64(0);
    for _ in 0..100 {
        let mut data = [0; 256];
        random.fill_bytes(&mut data);
        run(&data);
    }
}

#[test]
fn scenes_of_any_parts_keep_the_promises_of_a_step() {
    replay("scene");
}

#[test]
fn spoilt_parts_are_checked_and_stepped_without_a_panic() {
    replay("contract");
}

#[test]
fn any_text_loads_as_a_valid_value_or_is_refused() {
    replay("load");
}

#[test]
fn decided_outcomes_and_merged_results_are_final() {
    replay("outcome");
}

#[test]
fn any_height_field_keeps_the_promises_of_a_step() {
    replay("terrain");
}

#[test]
fn a_resumed_session_has_the_bits_of_one_that_was_not_saved() {
    replay("session");
}

#[test]
fn the_corpus_is_small() {
    let sizes = fuzz::TARGETS.iter().flat_map(|(target, _)| files(target));
    let bytes: u64 = sizes.map(|file| fs::metadata(file).unwrap().len()).sum();
    assert!(bytes < 300_000, "the corpus has {bytes} bytes");
}
