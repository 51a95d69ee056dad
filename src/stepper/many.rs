//! Many states of one scene, advanced together.

use super::Stepper;
use super::clock::{Clock, End, check_duration};
use crate::body::RigidPointBody;
use crate::contact::LANES;
use crate::error::StateError;
use crate::force::Force;
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::integrator::{Integrator, Lanes, Step, step_length};
use crate::real::Real;
use crate::scene::{Alarm, ScreenedScene, amplifies_errors};
use crate::state::State;

/// Number of steps after which lanes are tested. A state that is not finite stays so, and the flag
/// of a failed test stays set. So a test of each step would find no more.
const STEPS_TO_A_TEST: u32 = 32;

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
    /// Advances each of many states by `seconds`, with the bits of
    /// [`advance`](Self::advance).
    ///
    /// Eight states at a time are stepped in the lanes of the processor's vectors. They take some
    /// kilobytes of the stack. Give the compiler the vectors of your processor, for example by
    /// `RUSTFLAGS="-C target-cpu=native"`. They change no bit.
    ///
    /// | part | in lanes |
    /// |---|---|
    /// | integrator | [`SymplecticEuler`], [`StrangSplitting`], [`Rk4`], [`Nystrom`]; not others |
    /// | ground, body | contacts of radius 0 on a level plane at rest; others state by state |
    /// | contact law, friction law | any, also your own, whose values are tested as in one step |
    /// | moments of inertia | three equal ones, or two equal and a larger one (else one by one) |
    /// | applied force | state by state |
    ///
    /// With another integrator, one state is advanced after the other. `Nystrom` tests in lanes for
    /// touch-downs, and corrects them state by state. In your own law, write `f64::max` or a choice
    /// of two values in place of a branch: then the compiler finds the lanes.
    ///
    /// [`SymplecticEuler`]: crate::SymplecticEuler
    /// [`StrangSplitting`]: crate::StrangSplitting
    /// [`Rk4`]: crate::Rk4
    /// [`Nystrom`]: crate::Nystrom
    ///
    /// [`guide::modelling`](crate::guide::modelling#many-states-at-once) has the cost of a step,
    /// and what different states in one group cost.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{Coin, Coulomb, FlatGround, State, Stepper, StrangSplitting, UniformGravity};
    ///
    /// let stepper = Stepper::builder(Coin::ring(1.0, 0.5)) // kg, m
    ///     .gravity(UniformGravity::down(9.8)) // m/s²
    ///     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m, for each point
    ///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 }) // -, m/s
    ///     .integrator(StrangSplitting { time_step: 1e-3 }) // s
    ///     .build()?;
    /// // Coins that lean a little more each.
    /// let start = |i: u32| {
    ///     let lean = DVec3::Y * (0.1 + 0.01 * f64::from(i)); // rad
    ///     State::at(DVec3::Z * 0.5).with_rotation_vector(lean)
    /// };
    /// let mut coins: Vec<State> = (0..100).map(start).collect();
    /// stepper.advance_many(&mut coins, 0.5)?; // s
    ///
    /// let mut alone = start(42);
    /// stepper.advance(&mut alone, 0.5)?;
    /// assert_eq!(coins[42], alone);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`StateError`] with the first state whose run fails, and the error of
    /// [`advance`](Self::advance). That state is the one after its last successful step. All other
    /// states are advanced to the end. A call without states has no error, whatever the duration.
    pub fn advance_many(&self, states: &mut [State<R>], seconds: R) -> Result<(), StateError> {
        let mut first = Ok(());
        for (group, states) in states.chunks_mut(LANES).enumerate() {
            let start = self.advance_in_lanes(states, seconds);
            // What is left to do: nothing, or the whole run, or the steps from the one that failed.
            for (i, state) in states.iter_mut().enumerate() {
                let (mut workspace, mut clock) = (I::Workspace::default(), start);
                let run = self.run_with(state, seconds, &mut (), &mut workspace, &mut clock);
                if let (Err(error), Ok(())) = (run, first) {
                    let index = group * LANES + i;
                    first = Err(StateError { index, error });
                }
            }
        }
        first
    }

    /// Advances a group of states in lanes as long as nothing fails. Returns the time that it has
    /// covered.
    fn advance_in_lanes(&self, states: &mut [State<R>], seconds: R) -> Clock<R> {
        let mut clock = Clock::new();
        let end = self.end_at(seconds);
        let is_valid = check_duration(seconds).is_ok() && end.check_steps(&clock).is_ok();
        let has_lanes = I::HAS_LANES && !amplifies_errors(&self.scene);
        // A few states cost as much one after the other.
        if !has_lanes || !is_valid || states.len() <= LANES / 2 {
            return clock;
        }
        let mut lanes = Lanes::of(states);
        while !end.is_reached(&clock) {
            let Some(next) = self.tested(&mut lanes, &end, clock) else {
                break;
            };
            clock = next;
            for (state, after) in states.iter_mut().zip(lanes.states()) {
                *state = after;
            }
        }
        clock
    }

    /// Takes some steps in lanes. Returns the time after them, or `None` if a step failed.
    fn tested(&self, lanes: &mut Lanes<R>, end: &End<R>, mut clock: Clock<R>) -> Option<Clock<R>> {
        let alarm = Alarm::default();
        let screened = ScreenedScene::of(&self.scene, &alarm);
        for _ in 0..STEPS_TO_A_TEST {
            if end.is_reached(&clock) {
                break;
            }
            let seconds = step_length(end.time_step?, end.limit(&clock));
            if self.scene.is_trusted() {
                self.integrator.step_in_lanes(&self.scene, lanes, seconds);
            } else {
                self.integrator.step_in_lanes(&screened, lanes, seconds);
            }
            clock.tick(&Step::new(seconds, 0)).ok()?;
        }
        (lanes.are_finite() && !alarm.is_raised()).then_some(clock)
    }
}
