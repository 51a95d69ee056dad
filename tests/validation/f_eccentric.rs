//! Group F, bodies whose centre of mass is not in their middle.

use core::f64::consts::TAU;

use proptest::prelude::*;
use tumble::glam::{DMat3, DVec3};
use tumble::{
    Coulomb, Ellipsoid, FlatGround, MassDistribution, RigidPointBody, Rk4, Sample, Sphere, State,
    Stepper, StrangSplitting, UniformGravity,
};

use crate::kit::{self, directions, orientations};
use crate::table::{Case, figure};

pub(crate) const CASES: &[&Case] = &[&JELLETT, &ROLY_POLY, &EGG];

const GRAVITY: f64 = 9.8;
/// m
const RADIUS: f64 = 0.1;

/// A ball of 1 kg and 0.1 m whose centre of mass lies `low` (m) under its middle, along -z of the body; moments in `m r²` across the axis and about it.
fn eccentric(low: f64, across: f64, about: f64) -> Sphere {
    let moments = DVec3::new(across, across, about) * (RADIUS * RADIUS);
    Sphere::loaded(
        RADIUS,
        MassDistribution {
            mass: 1.0,
            centre_of_mass: DVec3::NEG_Z * low,
            inertia: DMat3::from_diagonal(moments),
        },
    )
}

// ---------------------------------------------------------------------------------------------------------------------
// F1: Jellett's integral
// ---------------------------------------------------------------------------------------------------------------------

/// `-L · a`, with `a` from the centre of mass to the contact: whatever force acts there, its moment is across `a`, and `L · a'` is 0 for a body that is symmetric about the axis on which
/// both centres lie. The contact is at `low e - r ẑ`.
fn jellett(low: f64, state: &State) -> f64 {
    let arm = state.orientation * DVec3::Z * low - DVec3::Z * RADIUS;
    -state.angular_momentum.dot(arm)
}

/// Largest change of Jellett's integral in a run of a tippe top, in parts of `|L| r`.
fn drift_of_jellett(start: State, seconds: f64, time_step: f64) -> f64 {
    let low = 0.02;
    let stepper = Stepper::new(eccentric(low, 0.4, 0.35))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(FlatGround::level(2e3, 5.0))
        .unwrap()
        .with_friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-2,
        })
        .unwrap()
        .with_integrator(Rk4 { time_step })
        .unwrap();
    let mut state = start;
    let (first, size) = (
        jellett(low, &state),
        state.angular_momentum.length() * RADIUS,
    );
    let mut worst: f64 = 0.0;
    stepper
        .run(&mut state, seconds, &mut |sample: &Sample<'_>| {
            worst = worst.max((jellett(low, sample.state) - first).abs() / size);
            core::ops::ControlFlow::Continue(())
        })
        .unwrap();
    worst
}

fn spinning_top(lean: f64, rate: f64) -> State {
    let state = State::at(DVec3::Z * RADIUS).turned_by(DVec3::X * lean);
    state.with_angular_momentum(state.orientation * DVec3::Z * (0.35 * RADIUS * RADIUS * rate))
}

static JELLETT: Case = Case::new(
    "F1",
    "`-L · a` stays",
    "Jellett, Theory of Friction (1872); Ueda et al., arXiv physics/0507198",
    || {
        // 100 rad/s in steps of 50 µs: Runge-Kutta turns by 5e-3 rad a step with (5e-3)⁵/120 of error, 1e5 times: 3e-9 at most; where a contact opens or closes it is of order 1 or 2, but
        // the force there is small.
        let drift = drift_of_jellett(spinning_top(0.3, 100.0), 5.0, 5e-5);
        vec![figure(
            "tippe top for 5 s: largest change, share of L r",
            0.0,
            drift,
            3e-9,
        )]
    },
);

#[test]
fn a_tippe_top_keeps_jelletts_integral_while_friction_turns_it_over() {
    JELLETT.holds();
}

proptest! {
    #![proptest_config(kit::cases(20))]

    /// Thrown, bouncing, skidding: any force at the contact.
    #[test]
    fn an_eccentric_ball_keeps_jelletts_integral_in_any_motion(
        orientation in orientations(),
        heading in directions(),
        spin in directions(),
    ) {
        let start = State::at(DVec3::Z * 0.2)
            .with_orientation(orientation)
            .with_linear_velocity(heading * 2.0)
            .with_angular_momentum(spin * 0.1);
        // 0.1 kg m²/s over moments of 0.0035 to 0.004 kg m²: 29 rad/s; as above, for 1e4 steps of 3e-3 rad.
        let drift = drift_of_jellett(start, 1.0, 1e-4);
        prop_assert!(drift < 1e-9, "{drift:e}");
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// F5: a tumbler doll's swing
// ---------------------------------------------------------------------------------------------------------------------

/// Time of a swing (s) of a body that stands at a height on its lowest place and starts at rest with a lean of `first` rad about y, from its passages upright.
fn swing(body: impl RigidPointBody, height: f64, friction: Coulomb, first: f64) -> f64 {
    let stepper = Stepper::new(body)
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(FlatGround::level(1e5, 0.0))
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(StrangSplitting { time_step: 1e-4 })
        .unwrap();
    let mut state = State::at(DVec3::Z * (height - GRAVITY / 1e5)).turned_by(DVec3::Y * first);
    let (mut passages, mut before) = (Vec::new(), (0.0, first));
    stepper
        .run(&mut state, 4.0, &mut |sample: &Sample<'_>| {
            let now = (sample.time, (sample.state.orientation * DVec3::Z).x);
            if before.1 > 0.0 && now.1 <= 0.0 {
                passages.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
            }
            before = now;
            core::ops::ControlFlow::Continue(())
        })
        .unwrap();
    let swings = passages.len() - 1;
    (passages[swings] - passages[0]) / swings as f64
}

fn swing_of_doll(low: f64, moment: f64, friction: Coulomb, first: f64) -> f64 {
    let body = eccentric(low, moment, 0.4);
    swing(body, RADIUS - low * first.cos(), friction, first)
}

/// Friction enough to roll: 30/s of slip, or 600 times the swing's rate.
const GRIP: Coulomb = Coulomb {
    coefficient: 1.0,
    slip_speed: GRAVITY / 3000.0,
};

const ICE: Coulomb = Coulomb {
    coefficient: 0.0,
    slip_speed: 1.0,
};

static ROLY_POLY: Case = Case::new(
    "F5",
    "rolling `T = 2π √((I + m (r - l)²)/(m g l))`, on ice `2π √(I/(m g l))`",
    "small swings, e.g. Lamb, Dynamics (1914)",
    || {
        // r = 0.1 m, l = 0.02 m, I = 0.3 m r².
        let (low, moment, first) = (0.02, 0.3, 0.05_f64);
        let inertia = moment * RADIUS * RADIUS;
        let period = |inertia: f64| TAU * (inertia / (GRAVITY * low)).sqrt();
        // The swing's own (first/4)², and rolling, l r/(I + ..) of it again: a few times that. The slip is out of step by the square of ω/3000.
        let share = 4.0 * (first / 4.0).powi(2);
        let [rolling, sliding] = [period(inertia + (RADIUS - low).powi(2)), period(inertia)];
        vec![
            figure(
                "tumbler doll, rolling: period, s",
                rolling,
                swing_of_doll(low, moment, GRIP, first),
                share * rolling,
            ),
            figure(
                "on ice: period, s",
                sliding,
                swing_of_doll(low, moment, ICE, first),
                share * sliding,
            ),
        ]
    },
);

#[test]
fn a_tumbler_doll_swings_at_the_rate_of_a_pendulum_that_rolls() {
    ROLY_POLY.holds();
}

// ---------------------------------------------------------------------------------------------------------------------
// F6: an ellipsoid's rocking
// ---------------------------------------------------------------------------------------------------------------------

static EGG: Case = Case::new(
    "F6",
    "rolling `ω² = m g (ρ - c)/(I + m c²)`, on ice `m g (ρ - c)/I`, ρ = a²/c",
    "small swings of a heavy ellipsoid, Routh (1905)",
    || {
        let (a, c, first) = (0.1_f64, 0.06, 0.03_f64);
        let inertia = (a * a + c * c) / 5.0;
        let period = |inertia: f64| TAU * (inertia / (GRAVITY * (a * a / c - c))).sqrt();
        let height = (a * first.sin()).hypot(c * first.cos());
        let rock = |friction| {
            let body = Ellipsoid::solid(1.0, DVec3::new(a, a, c));
            swing(body, height, friction, first)
        };
        let [rolling, sliding] = [period(inertia + c * c), period(inertia)];
        // Not quite linear: the lean's square by some of the radii's ratio, (a/c)² = 2.8.
        let share = 2.8 * first * first;
        vec![
            figure(
                "lens of 0.2 by 0.12 m, rolling: period, s",
                rolling,
                rock(GRIP),
                share * rolling,
            ),
            figure("on ice: period, s", sliding, rock(ICE), share * sliding),
        ]
    },
);

#[test]
fn an_ellipsoid_rocks_on_its_flat_side_by_the_radius_of_curvature() {
    EGG.holds();
}
