//! Advance of a session. Whole steps of a body at rest are counted and not taken.

use super::Stepper;
use super::clock::{Clock, End, check_duration};
use crate::body::RigidPointBody;
use crate::error::StepError;
use crate::force::Force;
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::integrator::{Integrator, Step};
use crate::real::{Quaternion, Real, Vector};
use crate::state::State;

impl<R, B, G, F, A, I, E> Stepper<B, G, F, A, I, R, E>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
{
    /// Advances a state like [`advance`](Self::advance), with the caller's workspace and a new
    /// clock. After an error, the clock holds the time and the counts up to that error.
    ///
    /// `rests` is true if a whole step is known to leave the state unchanged. It is updated.
    #[inline]
    pub(crate) fn advance_with(
        &self,
        (state, rests): (&mut State<R>, &mut bool),
        seconds: R,
        workspace: &mut I::Workspace,
        clock: &mut Clock<R>,
    ) -> Result<(), StepError> {
        check_duration(seconds)?;
        let start = *state;
        for in_strides in [true, false] {
            (*state, *clock) = (start, Clock::new());
            let of_run = (self.end_at(seconds), in_strides);
            let skipped = self.steps_until(of_run, (&mut *state, &mut *rests), workspace, clock)?;
            if skipped == Skipped::Right {
                break;
            }
        }
        Ok(())
    }

    /// Takes the steps of a run. If `in_strides`, many steps at rest are counted at once.
    #[inline]
    fn steps_until(
        &self,
        (end, in_strides): (End<R>, bool),
        (state, rests): (&mut State<R>, &mut bool),
        workspace: &mut I::Workspace,
        clock: &mut Clock<R>,
    ) -> Result<Skipped, StepError> {
        end.check_first_step::<I>(clock)?;
        let mut skipped = Skipped::Right;
        while !end.is_reached(clock) {
            let limit = end.limit(clock);
            if let Some(length) = self.whole_step_at_rest(*rests, limit) {
                end.check_steps(clock)?;
                if in_strides && clock.skip(&end, length) {
                    if clock.steps <= MOST_COUNTED {
                        skipped = Skipped::TooMuch;
                    }
                } else {
                    clock.tick(&Step::new(length, 0))?;
                }
                continue;
            }
            let before = *state;
            let step = self.move_on_from(&before, state, limit, workspace);
            let step = step.map_err(|error| error.at(clock.time.to_f64()))?;
            clock.tick_from(&before, state, &step)?;
            let has_moved = self.learn(&before, state, &step, rests);
            end.check_next_steps::<I>(&step, clock)?;
            if skipped == Skipped::TooMuch && has_moved {
                return Ok(skipped);
            }
        }
        Ok(Skipped::Right)
    }

    /// Returns the size of a whole step that fits within `limit` and is known to leave the state
    /// unchanged, s.
    #[inline]
    pub(crate) fn whole_step_at_rest(&self, rests: bool, limit: R) -> Option<R> {
        if !rests {
            return None;
        }
        self.integrator.fixed_step().filter(|&own| own <= limit)
    }

    /// Updates the knowledge about rest after a step. Returns true if the step has changed the
    /// state.
    ///
    /// A step of a fixed size is a function of scene and state alone, so it leaves an unchanged
    /// state unchanged again. With a method that can span several steps, a body that touches
    /// nothing does not rest in whole steps. It may be in a flight too short to move it, which a
    /// longer step would span.
    #[inline]
    pub(crate) fn learn(
        &self,
        before: &State<R>,
        after: &State<R>,
        step: &Step<R>,
        rests: &mut bool,
    ) -> bool {
        if !has_bits_of(after, before) {
            *rests = false;
            return true;
        }
        let is_whole = self.integrator.fixed_step() == Some(step.elapsed);
        // The work of a drive is reported step by step.
        let is_whole = is_whole && step.drive_work == R::ZERO;
        *rests |= is_whole && (!I::SPANS_STEPS || self.touching(after) > 0);
        false
    }
}

/// Number of steps at rest that are counted again one by one, where that is needed. They take
/// seconds. More steps would seem to hang, and a rounding of the last step size is accepted.
const MOST_COUNTED: u64 = 1 << 30;

/// Whether counting many steps at rest at once was valid in a run.
///
/// The clock then differs by rounding from one that counts single steps, and so does the size of a
/// shorter last step. If the body moves in that shorter step, although it rests in whole steps, the
/// exact size is needed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Skipped {
    Right,
    TooMuch,
}

/// Returns true if two states are equal in each bit. 0 and -0 differ.
#[inline]
pub(crate) fn has_bits_of<R: Real>(state: &State<R>, other: &State<R>) -> bool {
    // A body that moves differs here mostly.
    state.position.x().has_bits_of(other.position.x()) && has_other_bits_of(state, other)
}

/// Returns true if two states are equal in each bit of the numbers after the first one.
#[inline(never)]
fn has_other_bits_of<R: Real>(state: &State<R>, other: &State<R>) -> bool {
    let same = |(a, b): (R::Vec3, R::Vec3)| {
        a.x().has_bits_of(b.x()) && a.y().has_bits_of(b.y()) && a.z().has_bits_of(b.z())
    };
    let vectors = [
        (state.position, other.position),
        (state.linear_velocity, other.linear_velocity),
        (state.angular_momentum, other.angular_momentum),
    ];
    let [p, q] = [state.orientation.xyzw(), other.orientation.xyzw()];
    vectors.into_iter().all(same) && p.into_iter().zip(q).all(|(a, b)| a.has_bits_of(b))
}
