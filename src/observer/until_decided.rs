//! Observation until the outcome is decided.

use core::ops::ControlFlow;

use super::{Observer, Sample};
use crate::outcome::{Barriers, Faces, Outcome};
use crate::real::Real;
use crate::scene::Dynamics;

/// Ends a run when the face on which the body stays is [decided](Barriers).
///
/// Use it to count faces: the rest of the motion, in which the body rocks and slides until it lies
/// still, is not computed. Use it in a pair with [`UntilRest`](crate::UntilRest) where a body may
/// also stop undecided, such as a coin on its edge. The scene of the run must be that of the
/// barriers.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coulomb, Cuboid, FlatGround, State, Stepper, UniformGravity, UntilDecided};
///
/// let stepper = Stepper::builder(Cuboid::cube(0.005, 0.016).rounded(0.0015)) // kg, m, m
///     .gravity(UniformGravity::down(9.81))
///     .ground(FlatGround::level(4000.0, 1.2))
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 })
///     .build()?;
/// let spin = DVec3::new(20.0, 35.0, 5.0); // rad/s
/// let state = stepper.with_angular_velocity(State::at(DVec3::Z * 0.2), spin); // m
/// let mut decided = UntilDecided::new(stepper.barriers().ok_or("no level ground")?);
/// let mut session = stepper.session(state);
/// let seconds = session.run(60.0, &mut decided)?;
/// let face = decided.face().ok_or("not decided")?;
/// session.advance(2.0)?; // to rest, on the same face
/// assert_eq!(stepper.body().face_up(session.state()), Some(face));
/// println!("{} pips, decided after {seconds:.2} s", face.pips());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct UntilDecided<'a, D: Dynamics<R>, R: Real = f64>
where
    D::Body: Faces<R>,
{
    barriers: Barriers<'a, D, R>,
    outcome: Outcome<<D::Body as Faces<R>>::Face>,
}

impl<'a, R, D> UntilDecided<'a, D, R>
where
    R: Real,
    D: Dynamics<R>,
    D::Body: Faces<R>,
{
    /// Creates an observer from the barriers of a scene.
    #[must_use]
    pub fn new(barriers: Barriers<'a, D, R>) -> Self {
        Self {
            barriers,
            outcome: Outcome::Undecided,
        }
    }

    /// Returns the outcome at the last sample.
    #[must_use]
    pub fn outcome(&self) -> Outcome<<D::Body as Faces<R>>::Face> {
        self.outcome
    }

    /// Returns the face that is [decided](Barriers::outcome), or `None` if it is undecided. For
    /// coins and cuboids it is the face that points up at rest.
    #[must_use]
    pub fn face(&self) -> Option<<D::Body as Faces<R>>::Face> {
        match self.outcome {
            Outcome::Decided(face) => Some(face),
            Outcome::Undecided => None,
        }
    }
}

impl<R, D> Observer<R> for UntilDecided<'_, D, R>
where
    R: Real,
    D: Dynamics<R>,
    D::Body: Faces<R>,
{
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        self.outcome = self.barriers.outcome(sample.state);
        match self.outcome {
            Outcome::Decided(_) => ControlFlow::Break(()),
            Outcome::Undecided => ControlFlow::Continue(()),
        }
    }
}
