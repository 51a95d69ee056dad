//! Ensembles of any number of tosses, whose counts depend on seed and range only (feature
//! `ensemble`).
//!
//! A toss has a number, and takes its random numbers from the stream with this number. It is a
//! function of the seed and its number. An ensemble plays the tosses of a range on all threads, and
//! counts their outcomes by whole numbers in a [`Tally`]. Therefore a result depends on the range
//! only. It does not depend on threads, machines, parts and interruptions.
//!
//! A thousand tosses of a coin:
//!
//! ```no_run
//! use tumble::ensemble::{Ensemble, RandomSpin, RandomStart, Throw};
//! use tumble::{Coulomb, FlatGround, SolidCoin, Stepper, UniformGravity};
//!
//! let stepper = Stepper::builder(SolidCoin::new(0.006, 0.012, 0.002)) // kg, m, m
//!     .gravity(UniformGravity::down(9.81)) // m/s²
//!     .ground(FlatGround::level(2000.0, 0.2)) // N/m and N s/m, for each point
//!     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 }) // -, m/s
//!     .build()?;
//! let start = RandomStart::at_height(0.1) // m
//!     .with_spin(RandomSpin::Isotropic { rate: (20.0..=40.0).into() }); // rad/s
//! let throw = Throw::new(&stepper, start, 10.0)?; // s
//! let ensemble = Ensemble::new(1, throw.scene_hash());
//! println!("{}", ensemble.run(0..1000, |toss| throw.play(toss))?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`guide::outcomes`](crate::guide::outcomes) has an example with a body of your own.
//!
//! # What a toss is
//!
//! [`Ensemble::run`] takes a closure from a [`Toss`] to its [`Outcome`]. [`Throw::play`] is such a
//! closure for a [`Stepper`](crate::Stepper) and a [`StartDistribution`]. Any other closure is
//! suitable. Its result must depend on the toss only: on its number, on its random numbers, and on
//! constants. The label of an outcome is any type with an order, such as a face or a pair of faces.
//!
//! | end of a toss | counted as |
//! |---|---|
//! | `Ok(Outcome::Decided(label))` | its label |
//! | `Ok(Outcome::Undecided)` | undecided |
//! | `Err(error)` | the error's [kind](TossError::kind) |
//! | a panic | panic, if panics unwind; the message is printed as usual |
//!
//! Every toss is counted exactly once. The lowest toss numbers of each end are kept
//! ([`Count::first`]). [`Ensemble::toss`] gives such a toss again, for a replay.
//!
//! # Parts
//!
//! Run parts of a range anywhere, save each [`Tally`] by serde (feature `serde`), and
//! [merge](Tally::merge) them in any order. Tosses that are in both parts, another seed and another
//! [`SceneHash`] are refused. [`Tally::gaps`] lists what is missing. `examples/tosses` does so with
//! one file for each part.
//!
//! # Errors of a result
//!
//! - *Sampling:* [`wilson`], [`Tally::interval`].
//! - *Undecided tosses:* [`Tally::bounds`].
//! - *Wrong labels,* because the motion is chaotic: [`Ensemble::compare`] with a shorter step.

mod error;
mod histogram;
mod interval;
mod pair;
mod ranges;
mod scene_hash;
mod start;
mod stop;
mod tally;
mod throw;
mod toss;
mod uniform;

pub use error::{EnsembleError, TossError};
pub use histogram::Histogram;
pub use interval::wilson;
pub use pair::Pair;
pub use scene_hash::SceneHash;
pub use start::{RandomOrientation, RandomSpin, RandomStart, Sampling, StartDistribution};
pub use stop::{Progress, Stop};
pub use tally::{Count, Tally};
pub use throw::Throw;
pub use toss::Toss;
pub use uniform::Uniform;

use alloc::boxed::Box;
use alloc::string::String;
use alloc::vec::Vec;
use core::any::Any;
use core::mem;
use core::ops::Range;
use core::panic::AssertUnwindSafe;
use std::panic::catch_unwind;
use std::time::Instant;

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use crate::outcome::Outcome;
use tally::{Ending, Played};

/// Tosses that are numbered from 0, with a seed and a scene hash. See the [module](self).
///
/// Tosses are played in blocks, in increasing order. The ends of the blocks are multiples of the
/// [block size](Self::with_block). The tosses of a block are shared by all threads of the present
/// `rayon` pool: use `ThreadPool::install` to choose their number. Progress is reported and
/// [`Stop`] rules are evaluated after each block. The memory is that of a block.
#[derive(Clone, Debug)]
pub struct Ensemble {
    seed: u64,
    scene: SceneHash,
    block: u32,
    histograms: Vec<(String, Histogram)>,
}

/// Tosses in a block. A part of the threads is idle at the end of a block, for as long as one toss
/// takes: a long block costs less, and a short one reports more often.
const BLOCK: u32 = 1024;

/// Most tosses that a thread takes at once. A few, because tosses differ in length.
const AT_ONCE: usize = 4;

impl Ensemble {
    /// Creates an ensemble from a seed and the hash of all that changes an outcome.
    #[must_use]
    pub fn new(seed: u64, scene: SceneHash) -> Self {
        Self {
            seed,
            scene,
            block: BLOCK,
            histograms: Vec::new(),
        }
    }

    /// Returns the ensemble with a block size, instead of 1024 tosses. A size of 0 counts as 1.
    ///
    /// It changes no count, except through the moment at which a [`Stop`] rule is evaluated.
    #[must_use]
    pub fn with_block(self, tosses: u32) -> Self {
        Self {
            block: tosses.max(1),
            ..self
        }
    }

    /// Returns the ensemble with a histogram of an observable. [`Toss::record`] adds its values.
    ///
    /// Only the bins of `histogram` are used. A tally begins with counts of 0, so that it has the
    /// values of its own tosses only.
    ///
    /// # Errors
    /// Returns [`EnsembleError::RepeatedName`] if there is a histogram of this name.
    pub fn with_histogram(
        mut self,
        name: &str,
        histogram: Histogram,
    ) -> Result<Self, EnsembleError> {
        let name = String::from(name);
        if self.histograms.iter().any(|(own, _)| *own == name) {
            return Err(EnsembleError::RepeatedName { name });
        }
        // Counts of the histogram would be in each part, and a merge would add them for each.
        self.histograms.push((name, histogram.emptied()));
        Ok(self)
    }

    /// Returns the seed.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the scene hash.
    #[must_use]
    pub fn scene(&self) -> SceneHash {
        self.scene
    }

    pub(crate) fn histograms(&self) -> &[(String, Histogram)] {
        &self.histograms
    }

    /// Returns a toss by its number, with a new stream. Use it to replay a toss.
    #[must_use]
    pub fn toss(&self, number: u64) -> Toss<'_> {
        Toss::new(self, number)
    }

    /// Plays all tosses of a range and counts their outcomes.
    ///
    /// # Errors
    /// Returns [`EnsembleError::BadRange`] if the range ends before its start.
    pub fn run<L, P>(&self, tosses: Range<u64>, play: P) -> Result<Tally<L>, EnsembleError>
    where
        L: Ord + Send,
        P: Fn(&mut Toss<'_>) -> Result<Outcome<L>, TossError> + Sync,
    {
        self.run_until(tosses, &Stop::at_end(), |_| {}, play)
    }

    /// Plays the tosses of a range until a rule ends the run, and reports the progress after each
    /// block.
    ///
    /// # Errors
    /// Returns [`EnsembleError::BadRange`] if the range ends before its start.
    pub fn run_until<L, P>(
        &self,
        tosses: Range<u64>,
        stop: &Stop<L>,
        mut report: impl FnMut(&Progress<'_, L>),
        play: P,
    ) -> Result<Tally<L>, EnsembleError>
    where
        L: Ord + Send,
        P: Fn(&mut Toss<'_>) -> Result<Outcome<L>, TossError> + Sync,
    {
        let Range { start, end } = tosses;
        if end < start {
            return Err(EnsembleError::BadRange { start, end });
        }
        let clock = Instant::now();
        let mut tally = Tally::new(self.seed, self.scene, &self.histograms);
        let mut next = start;
        while next < end {
            let block = next..self.end_of_block(next).min(end);
            next = block.end;
            tally.add(block.clone(), self.play_block(block, &play));
            let progress = Progress {
                tally: &tally,
                done: next - start,
                total: end - start,
                elapsed: clock.elapsed(),
            };
            report(&progress);
            if stop.is_reached(&progress) {
                break;
            }
        }
        Ok(tally)
    }

    /// Plays the tosses of a range by two methods, and counts the pairs of outcomes.
    ///
    /// Use it on a sample of the tosses to estimate how many labels are wrong:
    /// [`label_error`](Tally::label_error). Observables are recorded by the coarse method only.
    ///
    /// Both methods take the random numbers of the toss from the start of its stream. A pair of
    /// which only one is decided counts as changed. The counts have the hash of this ensemble, so
    /// those of different fine methods merge without an error.
    ///
    /// # Errors
    /// Returns [`EnsembleError::BadRange`] if the range ends before its start.
    pub fn compare<L, P, Q>(
        &self,
        tosses: Range<u64>,
        coarse: P,
        fine: Q,
    ) -> Result<Tally<Pair<L>>, EnsembleError>
    where
        L: Ord + Send,
        P: Fn(&mut Toss<'_>) -> Result<Outcome<L>, TossError> + Sync,
        Q: Fn(&mut Toss<'_>) -> Result<Outcome<L>, TossError> + Sync,
    {
        self.run(tosses, |toss| {
            let coarse = coarse(toss)?;
            let fine = fine(&mut self.toss(toss.number()))?;
            Ok(Outcome::Decided(Pair { coarse, fine }))
        })
    }

    /// First multiple of the block size above a toss number.
    fn end_of_block(&self, toss: u64) -> u64 {
        let size = u64::from(self.block);
        (toss / size).saturating_add(1).saturating_mul(size)
    }

    /// The tosses of a block, in order.
    fn play_block<L, P>(&self, block: Range<u64>, play: &P) -> Vec<Played<L>>
    where
        L: Send,
        P: Fn(&mut Toss<'_>) -> Result<Outcome<L>, TossError> + Sync,
    {
        // A block has at most 2³² tosses, and this range of `usize` has an exact length.
        let count = usize::try_from(block.end - block.start).unwrap_or(usize::MAX);
        (0..count)
            .into_par_iter()
            .with_max_len(AT_ONCE)
            .map(|at| self.play_toss(block.start + at as u64, play))
            .collect()
    }

    fn play_toss<L, P>(&self, number: u64, play: &P) -> Played<L>
    where
        P: Fn(&mut Toss<'_>) -> Result<Outcome<L>, TossError>,
    {
        let mut toss = self.toss(number);
        // What a panic leaves half done is dropped with the toss.
        let ended = catch_unwind(AssertUnwindSafe(|| play(&mut toss)));
        let (ending, records) = match ended {
            Ok(Ok(outcome)) => (Ending::Outcome(outcome), toss.records),
            Ok(Err(error)) => (Ending::Error(error.kind()), Vec::new()),
            Err(payload) => {
                discard(payload);
                (Ending::Panic, Vec::new())
            }
        };
        Played { ending, records }
    }
}

/// Drops the payload of a panic. A panic of its `Drop` would end the whole run, and is caught.
fn discard(payload: Box<dyn Any + Send>) {
    let dropped = catch_unwind(AssertUnwindSafe(|| drop(payload)));
    if let Err(next) = dropped {
        // The `Drop` of this payload may panic too, and so on without an end. It is not called.
        mem::forget(next);
    }
}
