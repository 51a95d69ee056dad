//! Constants of the step size control that were chosen, and not derived.
//!
//! All are numbers without a unit: fractions, factors and counts. They were chosen on trials 1, 3,
//! 5 and 8 of the coin report, where the error after a second is to be about one tolerance, from
//! 1e-3 to 1e-9 m. The other trials and the tosses test the choice. These commands measure it:
//!
//! - `cargo test --release --test physics adaptive:: -- --nocapture` prints the errors in
//!   tolerances, in the trials of the choice and in the others.
//! - `cargo test --release --test physics radau:: -- --nocapture` does so for `Radau5`.
//! - `cargo bench --bench work_precision -- --robust` prints the largest tolerance for an error,
//!   and its cost, on eight trials and eight tosses.
//!
//! Half and twice each value were compared on the eight trials, at tolerances from 1e-3 to 1e-7 m,
//! for [`SAFETY`] 0.8 and 1.1 times its value.
//! A constant is marked as *not sensitive* if the mean error changed by less than an eighth (with
//! `Radau5` by less than a fifth), and the number of force evaluations by less than a twentieth.
//!
//! The fraction of the pair's own estimate that counts is in the file of the pair
//! ([`Pair::trust`](super::Pair::trust)).

// Contacts that begin or cease to push: `touch`.

/// Fraction of the velocity error of a contact that counts.
///
/// More costs smaller steps at touch-downs, and less gives larger errors after them. The errors
/// have either sign, and contacts remove most of the effect of a wrong impulse of one of them. Such
/// an error of the velocity would cause a certain displacement in a second. Of that displacement
/// 5 % remain in trial 3 of the coin report, where the coin sticks. 20 to 100 % remain in trial 8,
/// where it slides and falls over.
pub(super) const ERROR_WEIGHT: f64 = 1.0 / 3.0;
/// Number of discontinuities that a step may contain if each has the largest error that does not
/// make the step end there. More makes more steps end at discontinuities. *Not sensitive.*
pub(super) const UNTREATED: f64 = 4.0;
/// Factor by which a discontinuity is located more accurately than its part of the tolerance
/// requires. More leaves less error in the step, and less needs fewer evaluations.
pub(super) const LOCATION: f64 = 2.0;
/// Fraction of a step by which its stages may be ahead of the path. Those of Dormand and Prince
/// extrapolate far. More evaluates contacts that no stage has met, and less overlooks a force. *Not
/// sensitive.*
pub(super) const STAGES_AHEAD: f64 = 0.5;
/// Smallest part of a step up to a discontinuity, as a fraction of the step. An error near the
/// start may be due to the path, and a shorter step shows whether it is. More costs attempts if it
/// is not, and less if it is. *Not sensitive.*
pub(super) const SHORTEST_PART: f64 = 0.02;
/// Number of contacts at both ends of a step whose evaluation is more expensive than another
/// attempt. It affects only steps that are rejected in any case. *Not sensitive.*
pub(super) const MANY_CONTACTS: usize = 48;
/// Resolution of the part of a step beyond a discontinuity, as a fraction of it. Less costs
/// bisections, and more overlooks a force that acts in this part only. *Not sensitive.*
pub(super) const REST_RESOLUTION: f64 = 1.0 / 16.0;

/// Number of parts in which a force with a bend is integrated. The error of the integral is that
/// of the part with the bend, a 64th of that of the step. Not compared: the law of the trials is
/// linear.
pub(super) const FORCE_PARTS: u32 = 8;
/// Fraction of the allowed error up to which a difference of quadratures is that of a smooth law.
/// Not compared, as above.
pub(super) const SMOOTH: f64 = 1.0 / 16.0;

// Contacts whose slip reverses: `slip`.

/// Factor for a reversal that a step may miss, compared with a change in proportion to the time. It
/// applies to the change of friction around the smallest slip. A step sums a steady change well, so
/// that less costs evaluations and more overlooks reversals.
pub(super) const SUDDEN: f64 = 2.0;
/// Fraction of the step, on both sides of the smallest slip, in which that change is evaluated.
/// *Not sensitive.*
pub(super) const REVERSAL: f64 = 1.0 / 16.0;
/// Number of parts of a step in which a friction law that varies over the ground is integrated.
/// More costs evaluations, and locates a jump of the law more accurately. Not compared: friction is
/// the same everywhere in the trials.
pub(super) const FRICTION_PARTS: u32 = 8;

// Step size control: `control`.

/// Fraction of the step size that the error would just allow. More causes more rejected steps, each
/// of which costs as much as an accepted one. Less causes smaller steps.
pub(super) const SAFETY: f64 = 0.9;
/// Fraction of the tolerance that one step may use, so that the error after a second of contact is
/// about equal to the tolerance. It scales the tolerance, and changes no cost for an error.
pub(super) const TOLERANCE_SHARE: f64 = 0.65;
/// Largest factor from a step size to the next one. More reaches long steps in flight sooner, and
/// causes more rejected steps after a small error by chance. *Not sensitive.*
pub(super) const LARGEST_GROWTH: f64 = 5.0;
/// Smallest factor from a rejected step size to the next one. Less reaches the size after a sudden
/// change sooner, and causes smaller steps than needed if the large error was one by chance. *Not
/// sensitive.*
pub(super) const SMALLEST_FACTOR: f64 = 0.1;
/// Largest number of attempted steps to a discontinuity within one step. Each is shorter than the
/// one before. More costs attempts at steps that are too long for another reason as well. *Not
/// sensitive.*
pub(super) const STEPS_TO_DISCONTINUITIES: u32 = 8;
/// Error, relative to the allowed one, that stands for equations without a solution. With the root
/// of order 4 the step is halved. *Not sensitive.*
pub(super) const UNSOLVED_ERROR: f64 = 16.0;
