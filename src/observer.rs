//! Observers of a run: functions that are called after each step, and the quantities that they can
//! compute.

mod every;
mod ledger;
mod timed;
mod until_decided;
mod until_rest;

pub use every::Every;
pub use ledger::Ledger;
pub use timed::Timed;
pub use until_decided::UntilDecided;
pub use until_rest::UntilRest;

use core::ops::ControlFlow;

use crate::contact::LowestPoint;
use crate::energy::{Dissipation, Energy, EnergyRates};
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, Rates};
use crate::state::State;

/// Observer of a run.
///
/// Closures are observers, and so are pairs of observers. `()` is an observer that does nothing and
/// costs nothing. A run also accepts `&mut dyn Observer`. A pair holds its observers by value:
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, FlatGround, Ledger, State, Stepper, UniformGravity, UntilRest};
///
/// let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
///     .gravity(UniformGravity::down(9.8))
///     .ground(FlatGround::level(1e3, 2.0))
///     .build()?;
/// let mut both = (Ledger::new(), UntilRest::new(stepper.body(), 1e-3, 0.1)?);
/// let mut state = State::at(DVec3::Z).with_rotation_vector(DVec3::Y * 1.2);
/// let seconds = stepper.run(&mut state, 100.0, &mut both)?;
/// let (ledger, rest) = both;
/// assert!(rest.is_reached());
/// println!("lies after {seconds:.1} s; the dampers took {:.3} J", -ledger.work().damper);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A closure receives each sample and may end the run:
///
/// ```
/// use core::ops::ControlFlow;
/// use tumble::glam::DVec3;
/// use tumble::{Coin, Sample, State, Stepper, UniformGravity};
///
/// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?.with_gravity(UniformGravity::down(9.8))?;
/// let mut state = State::at(DVec3::Z);
/// // Stop at the first sample with the centre below z = 0.
/// stepper.run(&mut state, 10.0, &mut |sample: &Sample<'_>| {
///     if sample.state.position.z < 0.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
/// })?;
/// assert!(state.position.z < 0.0 && state.position.z > -0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an observer: it does not implement `Observer<{R}>`",
    label = "this should be an observer",
    note = "a pair owns its observers: create it by `let mut both = (ledger, rest)`, and end it by `let (ledger, rest) = both`",
    note = "implement `observe`, or write a closure `|sample: &Sample<'_>| ControlFlow::Continue(())`; the precision `{R}` of scene and observer must be the same"
)]
pub trait Observer<R: Real = f64> {
    /// Receives the state at the start of a run and after each step. `Break` ends the run.
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()>;

    /// Returns the next time at which the observer requests a sample, s since the start of the run.
    /// Default: `None`.
    ///
    /// Requested samples are in addition to those after each step. The times must increase: in one
    /// step, an observer receives no more samples after a time that does not. A time before the
    /// start of the step is not sampled, and an infinite one is never reached. Of two observers in
    /// a pair the earlier time counts, so that one with a past time keeps the other from its
    /// samples.
    #[inline]
    fn requested_time(&self) -> Option<R> {
        None
    }

    /// Returns the interval of the requested times, s, if they are equally spaced. Default: `None`.
    ///
    /// A run with too short an interval is rejected at once, with
    /// [`TooManySamples`](crate::StepError::TooManySamples).
    #[inline]
    fn interval(&self) -> Option<R> {
        None
    }

    /// Receives the state at a [requested time](Self::requested_time). The observer must then
    /// request a later time.
    ///
    /// The sample does not affect the run. `Break` ends the run after the step that contains this
    /// time: [`observe`](Self::observe) still receives the state there, which is the last one.
    #[inline]
    fn observe_requested(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        let _ = sample;
        ControlFlow::Continue(())
    }
}

impl<R: Real> Observer<R> for () {
    #[inline]
    fn observe(&mut self, _sample: &Sample<'_, R>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<R: Real, F: FnMut(&Sample<'_, R>) -> ControlFlow<()>> Observer<R> for F {
    #[inline]
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        self(sample)
    }
}

/// Calls both observers. Either may end the run, and both receive its last sample.
impl<R: Real, A: Observer<R>, B: Observer<R>> Observer<R> for (A, B) {
    #[inline]
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        let first = self.0.observe(sample);
        let second = self.1.observe(sample);
        if first.is_break() { first } else { second }
    }

    #[inline]
    fn requested_time(&self) -> Option<R> {
        smaller(self.0.requested_time(), self.1.requested_time())
    }

    #[inline]
    fn interval(&self) -> Option<R> {
        smaller(self.0.interval(), self.1.interval())
    }

    fn observe_requested(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        let mut flow = ControlFlow::Continue(());
        if self.0.requested_time() == Some(sample.time) {
            flow = self.0.observe_requested(sample);
        }
        if self.1.requested_time() == Some(sample.time) {
            let second = self.1.observe_requested(sample);
            flow = if flow.is_break() { flow } else { second };
        }
        flow
    }
}

/// Smaller of two numbers, if both exist, otherwise the existing one.
#[inline]
fn smaller<R: Real>(first: Option<R>, second: Option<R>) -> Option<R> {
    match (first, second) {
        (Some(first), Some(second)) => Some(first.at_most(second)),
        (first, second) => first.or(second),
    }
}

/// Sample of a run at one time. Derived quantities are computed only when their method is called.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a, R: Real = f64> {
    /// Time since the start of the run, s. For an event: since that of the session.
    pub time: R,
    /// Number of steps since the start of the run.
    ///
    /// At a [requested time](Observer::requested_time) within a step, that step is included. For an
    /// event, the steps count from the start of the session, without the step that is searched.
    pub step: u64,
    /// Number of evaluations of the contacts' forces, counted like the steps.
    pub evaluations: u64,
    /// Number of rejected attempts of an adaptive method.
    pub rejected: u64,
    /// Current state.
    pub state: &'a State<R>,
    /// Scene, to evaluate quantities of this state or any other.
    pub scene: &'a dyn SceneQuery<R>,
}

impl<R: Real> Sample<'_, R> {
    /// Energy by kind, J.
    #[must_use]
    pub fn energy(&self) -> Energy<R> {
        self.scene.energy(self.state)
    }

    /// Power on the body by cause, W: negative where it dissipates.
    #[must_use]
    pub fn dissipation(&self) -> Dissipation<R> {
        self.scene.dissipation(self.state)
    }

    /// Acceleration (m/s²), torque about the centre of mass (N m) and angular velocity (rad/s),
    /// world axes.
    #[must_use]
    pub fn rates(&self) -> Rates<R> {
        self.scene.rates(self.state)
    }

    /// Lowest point of the body, or `None` for a body without contacts and rims.
    #[must_use]
    pub fn lowest_point(&self) -> Option<LowestPoint<R>> {
        self.scene.lowest_point(self.state)
    }

    /// Number of contacts that touch the ground, as [`Stepper::touching`](crate::Stepper::touching)
    /// counts them.
    #[must_use]
    pub fn touching(&self) -> usize {
        self.scene.touching(self.state)
    }
}

/// Quantities that a scene computes from a state, for any types of its parts.
///
/// Every [`Dynamics`] implements it, so the scene of a stepper or a sample can be queried.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, SceneQuery, State, Stepper, UniformGravity};
///
/// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?.with_gravity(UniformGravity::down(9.8))?;
/// let state = State::at(DVec3::Z);
/// assert_eq!(stepper.scene().rates(&state).acceleration, DVec3::new(0.0, 0.0, -9.8));
/// # Ok::<(), tumble::SceneError>(())
/// ```
pub trait SceneQuery<R: Real = f64> {
    /// Energy by kind, J.
    fn energy(&self, state: &State<R>) -> Energy<R>;
    /// Power on the body by cause, W: negative where it dissipates.
    fn dissipation(&self, state: &State<R>) -> Dissipation<R>;
    /// Acceleration (m/s²), torque about the centre of mass (N m) and angular velocity (rad/s),
    /// world axes.
    fn rates(&self, state: &State<R>) -> Rates<R>;
    /// Energy, dissipation and rates of a state, computed in one pass over its contacts.
    fn account(&self, state: &State<R>) -> EnergyRates<R>;
    /// Lowest point of the body, or `None` for a body without contacts and rims.
    fn lowest_point(&self, state: &State<R>) -> Option<LowestPoint<R>>;
    /// Number of contacts that touch the ground, as [`Stepper::touching`](crate::Stepper::touching)
    /// counts them.
    fn touching(&self, state: &State<R>) -> usize;
    /// Distance of two poses in bounding radii of the body: that of the centres of mass, plus twice
    /// the sine of half the angle between the orientations.
    ///
    /// It is not finite for a body without extension.
    fn separation(&self, a: &State<R>, b: &State<R>) -> R;
}

impl<R: Real, D: Dynamics<R>> SceneQuery<R> for D {
    fn energy(&self, state: &State<R>) -> Energy<R> {
        Energy::of(self, state)
    }
    fn dissipation(&self, state: &State<R>) -> Dissipation<R> {
        Dissipation::of(self, state)
    }
    fn rates(&self, state: &State<R>) -> Rates<R> {
        // Computed from the same sums, so that an account and its parts agree to the last bit.
        self.account(state).rates
    }
    fn account(&self, state: &State<R>) -> EnergyRates<R> {
        EnergyRates::of(self, state)
    }
    fn lowest_point(&self, state: &State<R>) -> Option<LowestPoint<R>> {
        self.contact_model().lowest_point(&self.motion(state))
    }
    fn touching(&self, state: &State<R>) -> usize {
        let mut count = 0;
        self.visit_contacts(&self.motion(state), |_| count += 1);
        count
    }
    fn separation(&self, a: &State<R>, b: &State<R>) -> R {
        let between = a.rotation().after(b.rotation().inverse());
        let shift = (a.position - b.position).length() / self.bounding_radius();
        shift + between.sine_of_half() * R::TWO
    }
}

impl<R: Real> core::fmt::Debug for dyn SceneQuery<R> + '_ {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("scene")
    }
}

#[cfg(test)]
mod tests {
    // The imports of a user: no two of these traits may have a method of the same name.
    use crate::*;
    use core::cell::Cell;
    use glam::DVec3;

    /// Level ground that counts the evaluations of its surface: one for each contact in each visit.
    struct Counting(Cell<u32>);

    impl SpringDamperGround for Counting {
        fn surface(&self, point: DVec3) -> Surface {
            self.0.set(self.0.get() + 1);
            Surface {
                gap: point.z,
                normal: DVec3::Z,
            }
        }
        fn spring_force(&self, depth: f64) -> f64 {
            1000.0 * depth
        }
        fn spring_energy(&self, depth: f64) -> f64 {
            500.0 * depth * depth
        }
        fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
            (1000.0 * depth + closing_speed).max(0.0)
        }
    }

    #[test]
    fn a_ledger_evaluates_the_contacts_seven_times_in_a_smooth_step() {
        let ground = Counting(Cell::new(0));
        let stepper = Stepper::new(Coin::ring(1.0, 0.5))
            .unwrap()
            .with_ground(&ground)
            .unwrap()
            .with_integrator(SymplecticEuler { time_step: 1e-3 })
            .unwrap();
        let mut ledger = Ledger::new();
        let visits_of = |steps: f64, observer: &mut dyn FnMut(&Sample<'_>)| {
            ground.0.set(0);
            let mut state = State::at(DVec3::Z * 0.49);
            let mut watch = |sample: &Sample<'_>| {
                observer(sample);
                core::ops::ControlFlow::Continue(())
            };
            stepper.run(&mut state, steps * 1e-3, &mut watch).unwrap();
            ground.0.get() / 120
        };
        let unwatched = visits_of(10.0, &mut |_| {});
        let watched = visits_of(10.0, &mut |sample| {
            let _ = ledger.observe(sample);
        });
        // The first sample, then the end of each step and the six further stages of the motion from
        // its start.
        assert_eq!(watched - unwatched, 1 + 7 * 10);
    }

    #[test]
    fn an_account_agrees_with_its_parts_asked_alone() {
        let trial = Trial::report(1).unwrap();
        let stepper = trial.stepper(Rk4 { time_step: 1e-3 }).unwrap();
        let (mut state, scene) = (trial.state(), stepper.scene());
        for _ in 0..200 {
            stepper.advance(&mut state, 0.01).unwrap();
            let account = scene.account(&state);
            assert_eq!(account.energy, scene.energy(&state));
            assert_eq!(account.dissipation, scene.dissipation(&state));
            assert_eq!(account.rates, scene.rates(&state));
            // An integrator's load is the same sum in another order: at most 8 contacts, of some 20
            // N with an arm of 0.5 m, in 6 products and sums each.
            let load = scene.load(&scene.motion(&state));
            let rounding = 8.0 * 6.0 * 20.0 * 0.5 * f64::EPSILON;
            let apart: DVec3 = account.rates.torque - load.torque;
            assert!(apart.length() < rounding, "{apart}");
            assert_eq!(scene.touching(&state), load.touching);
        }
    }

    #[test]
    fn a_free_body_that_rests_has_no_rates_but_gravity() {
        let stepper = Stepper::new(Coin::ring(2.0, 0.5))
            .unwrap()
            .with_gravity(UniformGravity::down(9.8))
            .unwrap();
        let rates = stepper.scene().rates(&State::default());
        assert_eq!(rates.acceleration, DVec3::new(0.0, 0.0, -9.8));
        assert_eq!(rates.torque, DVec3::ZERO);
        assert_eq!(rates.angular_velocity, DVec3::ZERO);
    }

    #[test]
    fn the_separation_of_two_poses_counts_radii_and_rotation() {
        let stepper = Stepper::new(Coin::ring(1.0, 0.5)).unwrap();
        let (scene, here) = (stepper.scene(), State::at(DVec3::Z));
        let there = State::at(DVec3::new(0.3, 0.0, 1.4))
            .with_rotation_vector(DVec3::Y * core::f64::consts::FRAC_PI_3);
        assert!((scene.separation(&here, &there) - 2.0).abs() < 1e-15);
        assert_eq!(scene.separation(&there, &there).to_bits(), 0);
    }

    #[test]
    fn the_lowest_point_of_a_coin_that_slides_upright_slips_at_its_speed() {
        let coin = Coin::ring(1.0, 0.5);
        let stepper = Stepper::new(coin).unwrap();
        let stepper = stepper.with_ground(FlatGround::level(1.0, 0.0)).unwrap();
        let state = State::at(DVec3::Z).with_linear_velocity(DVec3::new(1.0, 2.0, -3.0));
        let slip = stepper.slip_velocity(&state).unwrap();
        assert_eq!(slip, DVec3::new(1.0, 2.0, 0.0));
    }
}
