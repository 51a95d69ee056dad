//! A coin of 120 points on a microcontroller, without operating system, allocator or panic: it is
//! thrown, and bounces and tumbles for two seconds.
//!
//! Each program in `src/bin` is this scene with one integrator in one precision, and nothing else.
//! Its size is therefore that of such a scene. It prints the states, the energies and a hash of all
//! bits, and then the cost of the run. On a computer with an operating system, it prints the same
//! without the cost.
#![no_std]
#![deny(unsafe_code)]

pub mod board;
mod many_tosses;
mod report;

pub use many_tosses::many_tosses;
pub use report::Number;
use report::{Hash, line, print, print_count};

use tumble::real::Vector;
use tumble::{
    Coin, ContactPoint, Coulomb, FlatGround, Integrator, SceneError, State, StepError, Stepper,
    UniformGravity,
};

/// Memory of a toss outside of the stack: the rim of the coin, and the workspace of the integrator.
#[derive(Debug)]
pub struct Memory<R: Number, W> {
    rim: [ContactPoint<R>; 120],
    workspace: W,
}

impl<R: Number, W> Memory<R, W> {
    /// Creates memory for a coin and this workspace.
    pub const fn new(workspace: W) -> Self {
        Self {
            rim: [ContactPoint {
                position: R::Vec3::ZERO,
                radius: R::ZERO,
            }; 120],
            workspace,
        }
    }
}

/// Reason for the early end of a toss. It does not occur here. A device would handle it.
#[derive(Clone, Copy, Debug)]
pub enum Fault {
    /// A parameter is invalid.
    Scene(SceneError),
    /// A step failed.
    Step(StepError),
}

/// Number of steps, of 1 ms each.
const STEPS: u32 = 2000;
const STEPS_A_LINE: u32 = 200;

/// Cost of a toss.
#[derive(Clone, Copy, Debug, Default)]
pub struct Account {
    flight: board::Cost,
    contact: board::Cost,
}

impl Account {
    /// Takes a step of a coin that touches the ground, or flies, and adds its clocks.
    fn time<T>(&mut self, clock: &mut board::Clock, touches: bool, step: impl FnOnce() -> T) -> T {
        clock.start();
        let stepped = step();
        let clocks = clock.stop();
        if touches {
            &mut self.contact
        } else {
            &mut self.flight
        }
        .add(clocks);
        stepped
    }
}

/// Tosses the coin for 2 s, and prints its motion.
///
/// # Errors
///
/// Does not occur with these parameters.
pub fn toss<R: Number, I: Integrator<R>>(
    memory: &mut Memory<R, I::Workspace>,
    integrator: I,
    clock: &mut board::Clock,
) -> Result<Account, Fault> {
    let stepper = compose(&mut memory.rim, integrator).map_err(Fault::Scene)?;
    let real = R::from_f64;
    let start = State::<R>::at(R::Vec3::new(R::ZERO, R::ZERO, R::ONE))
        .with_angular_momentum(R::Vec3::new(real(0.3), R::ONE, real(0.2)));
    let mut session = stepper.session_in(&mut memory.workspace, start);
    let mut hash = Hash::new();
    let mut account = Account::default();

    print("     time/ms         x/m         y/m         z/m    energy/J\n");
    for step in 0..STEPS {
        if step % STEPS_A_LINE == 0 {
            line(step, session.state(), session.energy().total());
        }
        let touches = stepper.touching(session.state()) > 0;
        account
            .time(clock, touches, || session.step())
            .map_err(Fault::Step)?;
        hash.state(session.state());
    }
    line(STEPS, session.state(), session.energy().total());
    hash.print();
    #[cfg(feature = "control")]
    control(&memory.rim);
    Ok(account)
}

/// Code that the checks of the image must find: an unchecked index, and arithmetic in f64.
#[cfg(feature = "control")]
fn control<R: Number>(rim: &[ContactPoint<R>]) {
    let count = core::hint::black_box(rim.len());
    print_count(
        "control ",
        (rim[count / 2].position.y().to_f64() * 3.0) as u32,
    );
}

type Toss<'a, R, I> =
    Stepper<Coin<R, &'a mut [ContactPoint<R>]>, FlatGround<R>, Coulomb<R>, UniformGravity<R>, I, R>;

/// Composes the scene of the README.
fn compose<R: Number, I: Integrator<R>>(
    rim: &mut [ContactPoint<R>; 120],
    integrator: I,
) -> Result<Toss<'_, R, I>, SceneError> {
    let real = R::from_f64;
    Stepper::builder(Coin::ring_with_storage(rim.as_mut_slice(), R::ONE, R::HALF)) // kg, m
        .gravity(UniformGravity::down(real(9.8))) // m/s²
        .ground(FlatGround::level(real(1000.0), R::HALF)) // N/m and N s/m, for each point
        .friction(Coulomb {
            coefficient: real(0.3),
            slip_speed: real(1e-3), // m/s
        })
        .integrator(integrator)
        .build()
}

/// Prints the cost of the run, if it can be measured. `fixed` is the size of the memory outside of
/// the stack.
pub fn print_account(account: &Account, fixed: usize) {
    if let Some(stack) = board::stack_used() {
        print_count("clocks a step in flight  ", account.flight.mean());
        print_count("clocks a step in contact ", account.contact.mean());
        print_count("clocks, longest step     ", account.contact.longest());
        print_count("bytes of stack           ", stack);
        print_count("bytes of static memory   ", fixed as u32);
    }
}

/// Defines a program that tosses the coin:
/// `firmware!(toss, f32, EnergyMomentum, EnergyMomentumWorkspace::new())`.
#[macro_export]
macro_rules! firmware {
    ($run:ident, $real:ident, $integrator:ident, $workspace:expr) => {
        type Memory =
            $crate::Memory<$real, <$integrator<$real> as tumble::Integrator<$real>>::Workspace>;

        fn program(memory: &'static mut Memory) -> i32 {
            let mut clock = $crate::board::Clock::new();
            let time_step = 1e-3; // s
            match $crate::$run(memory, $integrator { time_step }, &mut clock) {
                Ok(account) => {
                    $crate::print_account(&account, core::mem::size_of::<Memory>());
                    0
                }
                Err(_) => 1,
            }
        }

        $crate::program!(program, Memory, $crate::Memory::new($workspace));
    };
}
