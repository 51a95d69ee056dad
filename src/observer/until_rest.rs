//! Observation until a body is at rest.

use core::ops::ControlFlow;

use super::{Observer, Sample};
use crate::body::RigidPointBody;
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};
use crate::state::State;

/// Ends a run when the body is at rest: when no point of it has moved farther than a distance
/// within a time.
///
/// A single state does not suffice, because a body is also slow in the middle of a bounce, or when
/// a rocking coin reverses. So the observer stores the pose at which the body last moved. It
/// compares poses, so its cost is very small. A step of whole revolutions ends at the pose at which
/// it began, so a body that rotates by more than a radian in a step is not at rest.
///
/// One observer may be used for successive runs, as in a game frame by frame. It then continues
/// counting. It restarts if the state was changed between two runs: a body that is pushed wakes up.
/// A run of a body at rest ends before its first step.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coulomb, Cuboid, FlatGround, State, Stepper, UniformGravity, UntilRest};
///
/// let stepper = Stepper::builder(Cuboid::cube(0.005, 0.016).rounded(0.0015)) // kg, m, m
///     .gravity(UniformGravity::down(9.81))
///     .ground(FlatGround::level(4000.0, 1.2))
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 })
///     .build()?;
/// let mut state = stepper.with_angular_velocity(State::at(DVec3::Z * 0.2), DVec3::new(20.0, 35.0, 5.0)); // m, rad/s
/// // At most a tenth of a millimetre in a quarter of a second.
/// let mut rest = UntilRest::new(stepper.body(), 1e-4, 0.25)?;
/// let seconds = stepper.run(&mut state, 60.0, &mut rest)?;
/// assert!(rest.is_reached() && seconds < 5.0);
/// println!("{:?} after {seconds:.2} s", stepper.body().face_up(&state));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// *Limits:* only the poses at the ends of steps are compared. A body that creeps, as every body
/// does on a slope, counts as at rest if it creeps by less than `distance` in the time. So does a
/// body that stands on an edge. At the top of its path a thrown body stays within `distance` of a
/// pose for up to `(1 + √2) √(2 distance/g)`, which is 11 ms for 1e-4 m on earth. `seconds` must be
/// longer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UntilRest<R: Real = f64> {
    bounding_radius: R,
    distance: R,
    seconds: R,
    /// Pose at which the body last moved, and its last sample.
    seen: Option<Seen<R>>,
    /// Time since the body last moved, s.
    still: R,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen<R: Real> {
    moved: State<R>,
    last: State<R>,
    /// Time of the last sample, s since the start of its run.
    time: R,
}

impl<R: Real> UntilRest<R> {
    /// Creates an observer that waits until no point of `body` has moved by more than `distance`
    /// (m) for `seconds`.
    ///
    /// For a body of some centimetres, 1e-4 m in a quarter of a second is too slow to see.
    ///
    /// # Errors
    /// Returns [`SceneError`] if `distance` is below 0, if `seconds` is not above 0, or if one of
    /// them or the bounding radius of the body is not finite. The error names the quantity, the
    /// rule and the value.
    pub fn new<B: RigidPointBody<R> + ?Sized>(
        body: &B,
        distance: R,
        seconds: R,
    ) -> Result<Self, SceneError> {
        error::at_least_zero("distance of a body at rest", distance, " m")?;
        error::above_zero("time of a body at rest", seconds, " s")?;
        error::at_least_zero("bounding radius of the body", body.bounding_radius(), " m")?;
        Ok(Self {
            bounding_radius: body.bounding_radius(),
            distance,
            seconds,
            seen: None,
            still: R::ZERO,
        })
    }

    /// Returns true if the body is at rest.
    #[must_use]
    pub fn is_reached(&self) -> bool {
        self.seen.is_some() && self.still >= self.seconds
    }

    /// Returns true if the body has stayed within `distance` from `seen` to now, `elapsed` seconds
    /// after the last sample.
    fn stays(&self, seen: &Seen<R>, now: &State<R>, elapsed: R) -> bool {
        let shift = (now.position - seen.moved.position).length();
        // A rotation by φ moves a point at the distance r along a chord of 2 r sin(φ/2).
        let turn = now.rotation().after(seen.moved.rotation().inverse());
        let chord = R::TWO * self.bounding_radius * turn.sine_of_half();
        // A long step in flight may end at the height at which it began.
        let way = now.linear_velocity.length() * elapsed;
        shift + chord <= self.distance && way <= self.distance
    }

    /// Returns true if the body rotates by more than a radian in `elapsed` seconds. A step of a
    /// whole revolution ends at the pose at which it began.
    fn spins(sample: &Sample<'_, R>, elapsed: R) -> bool {
        elapsed > R::ZERO && sample.rates().angular_velocity.length() * elapsed > R::ONE
    }
}

impl<R: Real> Observer<R> for UntilRest<R> {
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        let (now, time) = (*sample.state, sample.time);
        let begins = sample.step == 0;
        let before = self.seen.filter(|seen| !begins || seen.last == now);
        let elapsed = before
            .filter(|_| !begins)
            .map_or(R::ZERO, |seen| time - seen.time);
        let stays =
            before.filter(|seen| self.stays(seen, &now, elapsed) && !Self::spins(sample, elapsed));
        self.still = stays.map_or(R::ZERO, |_| self.still + elapsed);
        self.seen = Some(Seen {
            moved: stays.map_or(now, |seen| seen.moved),
            last: now,
            time,
        });
        if self.is_reached() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}
