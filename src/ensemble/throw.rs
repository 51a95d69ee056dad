//! A toss of a body in a scene, until its face is decided.

use core::fmt::Debug;

use super::error::{EnsembleError, TossError};
use super::scene_hash::SceneHash;
use super::start::StartDistribution;
use super::toss::Toss;
use crate::force::{Force, NoForce};
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::integrator::Integrator;
use crate::observer::UntilDecided;
use crate::outcome::{Barriers, Faces, Outcome};
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;
use crate::stepper::Stepper;

/// A toss of a body in a scene: a random start, and the motion until the face is decided.
///
/// [`Barriers`](crate::Barriers) prove the face. A toss that is not decided within the given time
/// is undecided, and is counted as such.
#[derive(Debug)]
pub struct Throw<'a, B, G, F, A, I, S, R: Real = f64, E = NoForce> {
    stepper: &'a Stepper<B, G, F, A, I, R, E>,
    barriers: Barriers<'a, Scene<B, G, F, A, R, E>, R>,
    start: S,
    seconds: R,
}

impl<'a, R, B, G, F, A, I, S, E> Throw<'a, B, G, F, A, I, S, R, E>
where
    R: Real,
    B: Faces<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    S: StartDistribution<R>,
    E: Force<R>,
{
    /// Creates a toss that is followed for at most `seconds`, at least 0.
    ///
    /// # Errors
    /// Returns [`EnsembleError::NoBarriers`] if the scene has no energy barriers, and
    /// [`EnsembleError::Scene`] if a parameter of the start or the time is invalid.
    pub fn new(
        stepper: &'a Stepper<B, G, F, A, I, R, E>,
        start: S,
        seconds: R,
    ) -> Result<Self, EnsembleError> {
        start.check()?;
        crate::error::at_least_zero("time of a toss", seconds, " s")?;
        Ok(Self {
            stepper,
            barriers: stepper.barriers().ok_or(EnsembleError::NoBarriers)?,
            start,
            seconds,
        })
    }

    /// Returns the state at the start of a toss. Use it to replay a toss with an observer.
    ///
    /// It takes the first random numbers of the toss. Call [`play`](Self::play) with a
    /// [new toss](super::Ensemble::toss) of the same number afterwards, not with the same one.
    ///
    /// # Errors
    /// Returns [`TossError`] if the start distribution does.
    pub fn start(&self, toss: &mut Toss<'_>) -> Result<State<R>, TossError> {
        let scene = self.stepper.scene();
        let inertia = crate::scene::Dynamics::inertia_properties(scene);
        self.start.draw(inertia, toss)
    }

    /// Returns the time after which a toss is undecided, s.
    #[must_use]
    pub fn seconds(&self) -> R {
        self.seconds
    }

    /// Plays a toss until its face is decided, or until the time is over.
    ///
    /// # Errors
    /// Returns [`TossError`] if the start distribution does, or if a step fails.
    pub fn play(&self, toss: &mut Toss<'_>) -> Result<Outcome<B::Face>, TossError> {
        let mut state = self.start(toss)?;
        let mut decided = UntilDecided::new(self.barriers);
        self.stepper.run(&mut state, self.seconds, &mut decided)?;
        Ok(decided.outcome())
    }

    /// Returns the hash of the `Debug` texts of stepper and start, and of the time.
    ///
    /// A closure has no such text, also within a [`FrictionField`](crate::FrictionField): two
    /// functions would have the same hash. Use [`SceneHash::of_bytes`] with a description of it.
    #[must_use]
    pub fn scene_hash(&self) -> SceneHash
    where
        Stepper<B, G, F, A, I, R, E>: Debug,
        S: Debug,
    {
        SceneHash::of_debug(&(self.stepper, &self.start, self.seconds))
    }
}
