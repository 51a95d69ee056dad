//! Ratios of the speed of two programs that run alternately, which a busy machine can still
//! measure.
//!
//! Prints the ns a step of both programs (of the fastest repetition) and their ratio: the median
//! over the repetitions, with its quartiles. The first rows compare with the loop of the coin
//! report.
//!
//! # Cost of a step
//!
//! `instructions.txt` has the number of instructions of a step. `callgrind --dump-instr=yes` on the
//! bench `instructions` shows its parts. For the coin with 120 points that stands upright on four
//! of them, these parts of a step of `SymplecticEuler` are, the largest first:
//!
//! - *Body,* as in flight: the rotation matrix, the angular velocity, the rotation by two
//!   quaternion products, two normalisations, the finite check, and the state from and to memory.
//!   Most of the instructions are moves, because operations of SSE2 overwrite an operand, and a
//!   state with its matrix does not fit into 16 registers.
//! - *Contacts that touch,* in pairs, one in each lane: arm, velocity, force and torque. The torque
//!   could also follow from sums of force times position in the body. With a few contacts this
//!   saves nothing, because the velocity for each metre along three axes and the torque at the end
//!   cost as much as several arms, and go through memory.
//! - *Search for the arc:* the z components of the body's axes, and the heights of the points on
//!   both sides of the two ends of the previous arc.
//!
//! At rest all contacts are computed in lanes, 24 at a time, two in a register. Half of their time
//! is the root and the division, which one unit computes for all. This is the lower limit for any
//! program with the law of the coin report.
//!
//! What limits the time of a step:
//!
//! - *Memory:* the state, the scene and the visited points are in the first cache.
//! - *Branches:* the branch at the end of the arc is mispredicted when the number of touching
//!   points changes. The others depend on the phase only.
//! - *Order:* roots and divisions wait for all previous operations, so they are computed for all
//!   contacts before the first sum. A load of two numbers that were stored separately waits until
//!   both stores have ended. Instruction counts alone are therefore misleading.

// A benchmark that fails ends with a panic.
#![allow(clippy::unwrap_used)]

#[path = "../tests/common/report_loop.rs"]
mod report_loop;
mod scenes;

use core::hint::black_box;
use std::time::Instant;

use report_loop::{ReportLoop, ReportTrial};
use scenes::{Advance, Phase, Ring, STEPS, TIME_STEP, ring, round, stepper, trial_1};
use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{
    ContactPoint, EnergyMomentum, ForwardEuler, FreeRotation, InertiaProperties, Nystrom,
    RigidPointBody, Rk4, Rotation, SlidingFriction, Sphere, SpringDamperGround, State, Stepper,
    StrangSplitting, SymplecticEuler, body::ContactRange,
};

const EULER: SymplecticEuler = SymplecticEuler {
    time_step: TIME_STEP,
};

fn main() {
    // `cargo test --all-targets` starts it without `--bench`, to check that it runs.
    let turns = if std::env::args().any(|argument| argument == "--bench") {
        101
    } else {
        1
    };
    println!(
        "{:<66} {:>10} {:>10}   ratio (quartiles)",
        "a against b", "a, ns", "b, ns"
    );
    against_the_report(turns);
    against_by_hand(turns);
    against_a_users_body(turns);
    against_a_users_sphere(turns);
    against_dyn(turns);
    against_a_round_rim(turns);
    of_the_phases(turns);
    against_composed_steps(turns.min(11));
    whole_trial_1(turns);
}

/// Compares a flight of 10 s of a body with three different moments by the closed form and by
/// composed steps. These are 1600 triple jumps of order 4 (Yoshida 1990).
fn against_composed_steps(turns: usize) {
    let inertia = DMat3::from_diagonal(DVec3::new(1.0, 1.6, 2.3));
    let body = InertiaProperties::new(1.0, inertia).unwrap();
    let start = Rotation::from_rotation_vector(DVec3::new(0.2, -0.4, 0.7));
    let (momentum, seconds, parts) = (DVec3::new(0.02, 3.2, 0.05), 10.0, 1600);
    let whole = move |flights| {
        for _ in 0..flights {
            let rotation = FreeRotation::new(&body, start, black_box(momentum));
            black_box(rotation.rotation_at(seconds));
        }
    };
    let composed = move |flights| {
        let outer = 1.0 / (2.0 - 2.0_f64.cbrt());
        let part = seconds / f64::from(parts);
        for _ in 0..flights {
            let mut turned = start;
            for _ in 0..parts {
                for share in [outer, 1.0 - 2.0 * outer, outer] {
                    let (axes, momentum) = (turned.axes(), black_box(momentum));
                    turned = body.turn_freely(turned, &axes, momentum, part * share);
                }
            }
            black_box(turned);
        }
    };
    let rotation = FreeRotation::new(&body, start, momentum);
    // The path of the orientation, from its parts.
    let orientation = |part: i32| {
        let time = seconds * f64::from(part) / f64::from(parts);
        rotation.rotation_at(time).to_quat()
    };
    let angle: f64 = (0..parts)
        .map(|part| orientation(part).angle_between(orientation(part + 1)))
        .sum();
    let name = format!("a flight of {angle:.1} rad, three moments: closed form, composed");
    row(&name, turns, whole, composed);
    let again = move |times| {
        for _ in 0..times {
            black_box(rotation.rotation_at(black_box(seconds)));
        }
    };
    row(
        "another time of the same flight, against the flight",
        turns,
        again,
        whole,
    );
}

/// Compares a round rim with 120 points: in the upright phase of trial 1, and rolling upright at
/// 4 rad/s, where friction reverses twice on the arc.
fn against_a_round_rim(turns: usize) {
    let rolls = State::at(DVec3::Z * 0.4999)
        .with_linear_velocity(-DVec3::Y * 2.0)
        .with_angular_momentum(DVec3::X);
    let starts = [("upright", Phase::Upright.state()), ("rolling", rolls)];
    let time_step = TIME_STEP;
    for (phase, start) in starts {
        let of = |integrator, a: &mut dyn FnMut(u32), b: &mut dyn FnMut(u32)| {
            let name = format!("{integrator}, a round rim against 120 points, {phase}");
            row(&name, turns, a, b);
        };
        macro_rules! by {
            ($integrator:ident) => {
                of(
                    stringify!($integrator),
                    &mut from(stepper(round(), $integrator { time_step }), start),
                    &mut from(stepper(ring(120), $integrator { time_step }), start),
                )
            };
        }
        by!(SymplecticEuler);
        by!(StrangSplitting);
        by!(Rk4);
        by!(Nystrom);
        by!(EnergyMomentum);
    }
}

/// Compares two programs. Each is called with the number of steps to take.
fn row(name: &str, turns: usize, mut a: impl FnMut(u32), mut b: impl FnMut(u32)) {
    let nanoseconds = |program: &mut dyn FnMut(u32)| {
        let start = Instant::now();
        program(STEPS);
        start.elapsed().as_secs_f64() * 1e9 / f64::from(STEPS)
    };
    let mut pairs = Vec::with_capacity(turns);
    for _ in 0..turns {
        pairs.push((nanoseconds(&mut a), nanoseconds(&mut b)));
    }
    let of = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        [1, 2, 3].map(|quarter| values[values.len() * quarter / 4])
    };
    let fastest = |value: fn(&(f64, f64)) -> f64| pairs.iter().map(value).fold(f64::MAX, f64::min);
    let (first, second) = (fastest(|pair| pair.0), fastest(|pair| pair.1));
    let [low, ratio, high] = of(Vec::from_iter(pairs.iter().map(|(a, b)| a / b)));
    println!("{name:<66} {first:>10.1} {second:>10.1}   {ratio:.3} ({low:.3} to {high:.3})");
}

/// Returns a program for [`row`] that takes steps from the start of a phase.
fn program<S: Advance>(stepper: S, phase: Phase) -> impl FnMut(u32) {
    from(stepper, phase.state())
}

/// Returns a program for [`row`] that takes steps from a state.
fn from<S: Advance>(stepper: S, start: State) -> impl FnMut(u32) {
    move |steps| {
        black_box(scenes::steps(&stepper, black_box(&start), steps));
    }
}

/// Returns the loop of the coin report from the start of trial 1, which is the upright phase.
fn report() -> impl FnMut(u32) {
    let start = ReportLoop::new(ReportTrial::numbered(1).unwrap());
    move |steps| {
        let mut report = start.clone();
        for _ in 0..steps {
            report.step();
        }
        black_box(report);
    }
}

fn against_the_report(turns: usize) {
    let upright = Phase::Upright;
    let time_step = TIME_STEP;
    let name = |integrator: &str| format!("{integrator} against the report's loop, upright");
    let forward = stepper(ring(120), ForwardEuler { time_step });
    row(
        &name("ForwardEuler"),
        turns,
        program(forward, upright),
        report(),
    );
    let euler = stepper(ring(120), EULER);
    row(
        &name("SymplecticEuler"),
        turns,
        program(euler, upright),
        report(),
    );
    let strang = stepper(ring(120), StrangSplitting { time_step });
    row(
        &name("StrangSplitting"),
        turns,
        program(strang, upright),
        report(),
    );
    let rk4 = stepper(ring(120), Rk4 { time_step });
    row(&name("Rk4"), turns, program(rk4, upright), report());
    let energy_momentum = stepper(ring(120), EnergyMomentum { time_step });
    row(
        &name("EnergyMomentum"),
        turns,
        program(energy_momentum, upright),
        report(),
    );
}

fn against_by_hand(turns: usize) {
    for phase in [Phase::Flight, Phase::Upright, Phase::Tumbling] {
        let name = format!("generic core against plain f64 by hand, {}", phase.name());
        let (core, by_hand) = (stepper(ring(120), EULER), ByHand { coin: ring(120) });
        row(&name, turns, program(core, phase), program(by_hand, phase));
    }
}

fn against_a_users_body(turns: usize) {
    for phase in [Phase::Flight, Phase::Upright, Phase::Rest] {
        let name = format!("a user's ring against the built-in, {}", phase.name());
        let (user, built_in) = (
            stepper(UserRing { ring: ring(120) }, EULER),
            stepper(ring(120), EULER),
        );
        row(&name, turns, program(user, phase), program(built_in, phase));
    }
}

/// Compares the sphere of the guide with the built-in one: it slides, then rolls.
fn against_a_users_sphere(turns: usize) {
    let start = State::at(DVec3::Z * 0.49).with_linear_velocity(DVec3::X);
    let energy_momentum = EnergyMomentum {
        time_step: TIME_STEP,
    };
    let name = |integrator: &str| format!("a user's sphere against the built-in, {integrator}");
    row(
        &name("SymplecticEuler"),
        turns,
        from(stepper(UserSphere::default(), EULER), start),
        from(stepper(Sphere::solid(1.0, 0.5), EULER), start),
    );
    row(
        &name("EnergyMomentum"),
        turns,
        from(stepper(UserSphere::default(), energy_momentum), start),
        from(stepper(Sphere::solid(1.0, 0.5), energy_momentum), start),
    );
}

fn against_dyn(turns: usize) {
    let (coin, ground, friction) = (ring(120), scenes::ground(120), trial_1().friction());
    let body: &dyn RigidPointBody = &coin;
    let ground: &dyn SpringDamperGround = &ground;
    let friction: &dyn SlidingFriction = &friction;
    let stepper_of_dyn = || {
        Stepper::new(body)
            .and_then(|stepper| stepper.with_ground(ground))
            .and_then(|stepper| stepper.with_friction(friction))
            .and_then(|stepper| stepper.with_gravity(trial_1().gravity()))
            .and_then(|stepper| stepper.with_integrator(EULER))
            .unwrap()
    };
    for phase in [Phase::Flight, Phase::Upright, Phase::Rest] {
        let name = format!(
            "body, ground, friction by &dyn against static, {}",
            phase.name()
        );
        let fixed = stepper(ring(120), EULER);
        row(
            &name,
            turns,
            program(stepper_of_dyn(), phase),
            program(fixed, phase),
        );
    }
}

fn of_the_phases(turns: usize) {
    let of = |points, phase| program(stepper(ring(points), EULER), phase);
    let (upright, flight, rest) = (Phase::Upright, Phase::Flight, Phase::Rest);
    row(
        "flight against upright",
        turns,
        of(120, flight),
        of(120, upright),
    );
    row(
        "1200 points against 120, flight",
        turns,
        of(1200, flight),
        of(120, flight),
    );
    row(
        "1200 points against 120, upright",
        turns,
        of(1200, upright),
        of(120, upright),
    );
    row(
        "at rest against upright",
        turns,
        of(120, rest),
        of(120, upright),
    );
}

/// Compares trial 1 by the report's loop and by the library, with the step size of the coin report.
///
/// One run lasts until the coin lies flat, at about 30 s. The other lasts to the end of the
/// report's run at 160 s, with all 120 points on the ground for the last 130 s.
fn whole_trial_1(turns: usize) {
    for seconds in [30, 160] {
        let steps = if turns > 1 { seconds * 10_000 } else { 1000 };
        println!("\ntrial 1 for {seconds} s at a step of {TIME_STEP} s");
        let report = spent(|| report()(steps));
        println!("{:<20} {report:>8.3} s", "the report's loop");
        let library = |name: &str, program: &mut dyn FnMut(u32)| {
            let time = spent(|| program(steps));
            println!("{name:<20} {time:>8.3} s   {:.3} of it", time / report);
        };
        let time_step = TIME_STEP;
        let forward = stepper(ring(120), ForwardEuler { time_step });
        library("ForwardEuler", &mut program(forward, Phase::Upright));
        let euler = stepper(ring(120), EULER);
        library("SymplecticEuler", &mut program(euler, Phase::Upright));
    }
}

/// Processor time of a program, s, if Linux provides it, otherwise wall-clock time.
fn spent(program: impl FnOnce()) -> f64 {
    let on_processor = || {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        let nanoseconds: f64 = text.split(' ').next()?.parse().ok()?;
        Some(nanoseconds * 1e-9)
    };
    let (start, clock) = (on_processor(), Instant::now());
    program();
    match (start, on_processor()) {
        (Some(start), Some(end)) => end - start,
        _ => clock.elapsed().as_secs_f64(),
    }
}

/// A ball of 1 kg and 0.5 m as a user's own type, as in the README.
struct UserSphere {
    contact: [ContactPoint; 1],
}

impl Default for UserSphere {
    fn default() -> Self {
        Self {
            contact: [ContactPoint {
                position: DVec3::ZERO,
                radius: 0.5,
            }],
        }
    }
}

impl RigidPointBody for UserSphere {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(DVec3::splat(0.1))
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.contact
    }
}

/// The ring as a user's own type, with the same search for its arc.
struct UserRing {
    ring: Ring,
}

impl RigidPointBody for UserRing {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(DVec3::new(0.25, 0.125, 0.125))
    }
    fn contacts(&self) -> &[ContactPoint] {
        self.ring.contacts()
    }
    fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
        self.ring.contacts_below(normal, offset)
    }
    fn contacts_below_near(&self, normal: DVec3, offset: f64, near: ContactRange) -> ContactRange {
        self.ring.contacts_below_near(normal, offset, near)
    }
}

/// `SymplecticEuler` of the coin in plain f64, as a user would write it who needs nothing else.
///
/// It has the same model and the same arc, with the library's vectors but without its traits.
struct ByHand {
    coin: Ring,
}

impl Advance for ByHand {
    #[inline]
    fn advance(&self, start: &State, steps: u32) -> State {
        let (mut state, mut near) = (*start, ContactRange::NONE);
        for _ in 0..steps {
            self.step(&mut state, &mut near);
        }
        state
    }
}

impl ByHand {
    #[inline]
    fn step(&self, state: &mut State, near: &mut ContactRange) {
        let (dt, gravity) = (TIME_STEP, DVec3::new(0.0, 0.0, -9.8));
        let (stiffness, damping, coefficient, slip_speed) = (1000.0, 0.5, 0.3, 1e-10);
        let (across, about) = (1.0 / 0.125, 1.0 / 0.25 - 1.0 / 0.125);
        let orientation = state.orientation.normalize();
        let axes = DMat3::from_quat(orientation);
        let axis = axes.x_axis;
        let spin =
            state.angular_momentum * across + axis * (about * axis.dot(state.angular_momentum));

        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        if state.position.z < 0.5 {
            let upwards = DVec3::new(axes.x_axis.z, axes.y_axis.z, axes.z_axis.z);
            *near = (self.coin).contacts_below_near(upwards, -state.position.z, *near);
            for point in near.parts(self.coin.contacts()).into_iter().flatten() {
                let arm = axes * point.position;
                let depth = -(state.position.z + arm.z);
                if depth > 0.0 {
                    let velocity = state.linear_velocity + spin.cross(arm);
                    let normal_force = (stiffness * depth - damping * velocity.z).max(0.0);
                    let slip = velocity.with_z(0.0);
                    let rub = -coefficient * normal_force / (slip.length() + slip_speed);
                    let push = (slip * rub).with_z(normal_force);
                    force += push;
                    torque += arm.cross(push);
                }
            }
        }

        state.linear_velocity += (force + gravity) * dt;
        state.angular_momentum += torque * dt;
        state.position += state.linear_velocity * dt;
        let own = about * axis.dot(state.angular_momentum) * dt;
        state.orientation = (turn(state.angular_momentum * (across * dt))
            * (orientation * turn(DVec3::X * own)))
        .normalize();
    }
}

/// Rotation by a small rotation vector.
fn turn(vector: DVec3) -> DQuat {
    let half = vector * 0.5;
    let (sin, cos) = half.length().sin_cos();
    let sinc = if sin == 0.0 { 1.0 } else { sin / half.length() };
    DQuat::from_xyzw(half.x * sinc, half.y * sinc, half.z * sinc, cos)
}
