//! Watching a run: what is called after each step, and what it can ask.

mod every;
mod ledger;

pub use every::Every;
pub use ledger::Ledger;

use core::ops::ControlFlow;

use crate::energy::{Dissipation, Energy};
use crate::real::Real;
use crate::scene::{Dynamics, Load, LowestPoint};
use crate::state::State;

/// Something that watches a run.
///
/// Closures are observers, and so are pairs of observers and `()`, which watches nothing and costs nothing.
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
pub trait Observer<R: Real = f64> {
    /// Called with the state at the start of a run and after each step. `Break` ends the run.
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()>;
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

/// Both watch; either may end the run, and both see its last sample.
impl<R: Real, A: Observer<R>, B: Observer<R>> Observer<R> for (A, B) {
    #[inline]
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        let first = self.0.observe(sample);
        let second = self.1.observe(sample);
        if first.is_break() { first } else { second }
    }
}

/// A moment of a run. Whatever costs something is computed when it is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a, R: Real = f64> {
    /// Since the start of the run, s.
    pub time: R,
    /// Number of steps since the start of the run.
    pub step: u64,
    /// The state now.
    pub state: &'a State<R>,
    /// The scene, for questions about this state or any other.
    pub scene: &'a dyn Probe<R>,
}

impl<R: Real> Sample<'_, R> {
    /// Energy by kind, J.
    #[must_use]
    pub fn energy(&self) -> Energy<R> {
        self.scene.energy(self.state)
    }

    /// Power of what takes energy away, by cause, W.
    #[must_use]
    pub fn dissipation(&self) -> Dissipation<R> {
        self.scene.dissipation(self.state)
    }

    /// The lowest point of the body.
    #[must_use]
    pub fn lowest_point(&self) -> Option<LowestPoint<R>> {
        self.scene.lowest_point(self.state)
    }

    /// How many contacts touch the ground.
    #[must_use]
    pub fn touching(&self) -> usize {
        self.scene.touching(self.state)
    }
}

/// The questions that a scene answers about a state, whatever its parts are.
pub trait Probe<R: Real = f64> {
    /// Energy by kind, J.
    fn energy(&self, state: &State<R>) -> Energy<R>;
    /// Power of what takes energy away, by cause, W.
    fn dissipation(&self, state: &State<R>) -> Dissipation<R>;
    /// Force and torque of the contacts.
    fn load(&self, state: &State<R>) -> Load<R>;
    /// Acceleration of the centre of mass by contacts and gravity, m/s².
    fn acceleration(&self, state: &State<R>) -> R::Vec3;
    /// rad/s, world axes.
    fn angular_velocity(&self, state: &State<R>) -> R::Vec3;
    /// The lowest point of the body.
    fn lowest_point(&self, state: &State<R>) -> Option<LowestPoint<R>>;
    /// How many contacts touch the ground.
    fn touching(&self, state: &State<R>) -> usize;
}

impl<R: Real, D: Dynamics<R>> Probe<R> for D {
    fn energy(&self, state: &State<R>) -> Energy<R> {
        Energy::of(self, state)
    }
    fn dissipation(&self, state: &State<R>) -> Dissipation<R> {
        Dissipation::of(self, state)
    }
    fn load(&self, state: &State<R>) -> Load<R> {
        Dynamics::load(self, &self.motion(state))
    }
    fn acceleration(&self, state: &State<R>) -> R::Vec3 {
        let load = Dynamics::load(self, &self.motion(state));
        load.force * self.mass_properties().inverse_mass() + self.gravity()
    }
    fn angular_velocity(&self, state: &State<R>) -> R::Vec3 {
        self.motion(state).angular_velocity
    }
    fn lowest_point(&self, state: &State<R>) -> Option<LowestPoint<R>> {
        Dynamics::lowest_point(self, state)
    }
    fn touching(&self, state: &State<R>) -> usize {
        Dynamics::touching(self, state)
    }
}

impl<R: Real> core::fmt::Debug for dyn Probe<R> + '_ {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("scene")
    }
}
