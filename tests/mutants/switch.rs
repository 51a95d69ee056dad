//! Selects one mutant, or records which are reached; added to a copy of the source by
//! `.ci/mutants.py`.

use std::fs::OpenOptions;
use std::io::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::{env, format};

/// Value of [`ACTIVE`] until the environment is read.
const UNKNOWN: u32 = u32::MAX;
/// Value of [`ACTIVE`] in a run that records what is reached.
const TRACED: u32 = u32::MAX - 1;

static ACTIVE: AtomicU32 = AtomicU32::new(UNKNOWN);
/// One bit for each mutant that has been reached.
static REACHED: [AtomicU32; 4096] = [const { AtomicU32::new(0) }; 4096];
static RECORD: Mutex<()> = Mutex::new(());

/// Returns true if the mutant `id` is the selected one.
#[inline]
pub(crate) fn mutant(id: u32) -> bool {
    let active = ACTIVE.load(Relaxed);
    if active < TRACED {
        active == id
    } else {
        start_or_trace(id)
    }
}

#[cold]
fn start_or_trace(id: u32) -> bool {
    let trace = env::var_os("TUMBLE_MUTANT_TRACE");
    let Some(path) = trace else {
        let wanted = env::var("TUMBLE_MUTANT").ok();
        let wanted = wanted.and_then(|id| id.parse().ok()).unwrap_or(0);
        ACTIVE.store(wanted, Relaxed);
        return wanted == id;
    };
    ACTIVE.store(TRACED, Relaxed);
    let bit = 1 << (id % 32);
    if REACHED[id as usize / 32].fetch_or(bit, Relaxed) & bit == 0 {
        let guard = RECORD.lock();
        let file = OpenOptions::new().create(true).append(true).open(path);
        let line = format!("{id}\n");
        let written = file.and_then(|mut file| file.write_all(line.as_bytes()));
        drop(guard);
        assert!(written.is_ok(), "the record of reached mutants");
    }
    false
}
