//! A million steps of tosses with random starts. Each step is tested.

use crate::report::{Hash, print_count};
use crate::{Account, Fault, Memory, board, compose};
use oorandom::Rand32;
use tumble::f32::{Integrator, State};
use tumble::glam::Vec3;
use tumble::real::Quaternion;

const TOSSES: u32 = 50;
const STEPS_A_TOSS: u32 = 20_000;
const TOSSES_A_PART: u32 = 10;
const SEED: u64 = 1;

/// Tosses the coin from 50 random starts for 20 s each. After every 10 tosses it prints what
/// [`Counts`] has, and a hash of the bits of all states.
///
/// # Errors
///
/// Does not occur with these parameters.
pub fn many_tosses<I: Integrator<f32>>(
    memory: &mut Memory<f32, I::Workspace>,
    integrator: I,
    clock: &mut board::Clock,
) -> Result<Account, Fault> {
    let stepper = compose(&mut memory.rim, integrator).map_err(Fault::Scene)?;
    let mut random = Rand32::new(SEED);
    let (mut counts, mut hash) = (Counts::default(), Hash::new());
    let mut account = Account::default();

    for toss in 1..=TOSSES {
        let mut session = stepper.session_in(&mut memory.workspace, start(&mut random));
        let mut is_still = false;
        for _ in 0..STEPS_A_TOSS {
            let (before, energy) = (*session.state(), session.energy().total());
            let touches = stepper.touching(&before) > 0;
            account
                .time(clock, touches, || session.step())
                .map_err(Fault::Step)?;
            let state = session.state();
            is_still = *state == before;
            counts.add(state, session.energy().total() > energy);
            hash.state(state);
        }
        counts.at_rest += u32::from(is_still);
        if toss % TOSSES_A_PART == 0 {
            counts.print();
            hash.print();
        }
    }
    Ok(account)
}

/// What is counted over all tosses.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    steps: u32,
    /// Steps that increased the computed energy.
    increases: u32,
    /// Steps to a number that is not finite, or to an orientation that is no unit quaternion.
    invalid: u32,
    /// Tosses whose last step left all bits as they were.
    at_rest: u32,
}

impl Counts {
    fn add(&mut self, state: &State, increases: bool) {
        let lengths = state.orientation.xyzw().map(|x| x * x);
        let is_unit = (lengths.iter().sum::<f32>() - 1.0).abs() <= 8.0 * f32::EPSILON;
        self.steps += 1;
        self.increases += u32::from(increases);
        self.invalid += u32::from(!(is_unit && state.not_finite().is_none()));
    }

    fn print(&self) {
        print_count("steps           ", self.steps);
        print_count("energy increases", self.increases);
        print_count("invalid states  ", self.invalid);
        print_count("tosses at rest  ", self.at_rest);
    }
}

/// A coin 1 to 2 m above the ground, in any orientation, with up to 2 m/s and 1 kg m²/s along each
/// axis.
fn start(random: &mut Rand32) -> State {
    let mut vector = |size: f32| {
        let mut number = || size * (2.0 * random.rand_float() - 1.0);
        Vec3::new(number(), number(), number())
    };
    let height = Vec3::new(0.0, 0.0, 1.5);
    State::at(height + vector(0.5))
        .with_rotation_vector(vector(2.0))
        .with_linear_velocity(vector(2.0))
        .with_angular_momentum(vector(1.0))
}
