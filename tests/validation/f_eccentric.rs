//! Group F, bodies whose centre of mass is not in their middle.

use core::f64::consts::{FRAC_PI_2, TAU};

use proptest::prelude::{prop, prop_assume};
use tumble::glam::{DMat3, DVec3};
use tumble::{
    ContactPoint, Coulomb, Ellipsoid, EnergyMomentum, FlatGround, MassProperties, RigidPointBody,
    Rk4, Sample, Sphere, State, StrangSplitting, UniformGravity,
};

use crate::kit::erased::Stepper;
use crate::kit::{self, Solid, directions, log_uniform, orientations};
use crate::table::{Case, figure, random};

pub(crate) const CASES: &[&Case] = &[
    &JELLETT,
    &MIRRORED_STONE,
    &ROLY_POLY,
    &EGG,
    &TOP,
    &SLEEPING_TOP,
];

const GRAVITY: f64 = 9.8;
/// m
const RADIUS: f64 = 0.1;

/// A ball of 1 kg and 0.1 m whose centre of mass lies `low` (m) under its middle, along -z of the
/// body; moments in `m r²` across the axis and about it.
fn eccentric(low: f64, across: f64, about: f64) -> Sphere {
    let moments = DVec3::new(across, across, about) * (RADIUS * RADIUS);
    Sphere::loaded(
        RADIUS,
        MassProperties {
            mass: 1.0,
            centre_of_mass: DVec3::NEG_Z * low,
            inertia: DMat3::from_diagonal(moments),
        },
    )
}

// -----------------------------------------------------------------------------------------------
// F1: Jellett's integral
// -----------------------------------------------------------------------------------------------

/// `-L · a`, with `a` from the centre of mass to the contact: whatever force acts there, its moment
/// is across `a`, and `L · a'` is 0 for a body that is symmetric about the axis on which both
/// centres lie. The contact is at `low e - r ẑ`.
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
    let state = State::at(DVec3::Z * RADIUS).with_rotation_vector(DVec3::X * lean);
    state.with_angular_momentum(state.orientation * DVec3::Z * (0.35 * RADIUS * RADIUS * rate))
}

static JELLETT: Case = Case::new(
    "F1",
    "`-L · a` stays",
    "Jellett, Theory of Friction (1872); Ueda et al., arXiv physics/0507198",
    || {
        // 100 rad/s in steps of 50 µs: Runge-Kutta rotates by 5e-3 rad a step with (5e-3)⁵/120 of
        // error, 1e5 times: 3e-9 at most; where a contact opens or closes it is of order 1 or 2,
        // but the force there is small.
        let drift = drift_of_jellett(spinning_top(0.3, 100.0), 5.0, 5e-5);
        vec![figure(
            "tippe top for 5 s: largest change, fraction of L r",
            0.0,
            drift,
            3e-9,
        )]
    },
)
.and(&[&ANY_JELLETT]);

#[test]
fn a_tippe_top_keeps_jelletts_integral_while_friction_turns_it_over() {
    JELLETT.holds();
}

random! {
    /// Thrown, bouncing, skidding: any force at the contact.
    ANY_JELLETT = new(20, "throw of an eccentric ball");
    fn an_eccentric_ball_keeps_jelletts_integral_in_any_motion(
        orientation in orientations(),
        heading in directions(),
        spin in directions(),
    ) |misses| {
        let start = State::at(DVec3::Z * 0.2)
            .with_orientation(orientation)
            .with_linear_velocity(heading * 2.0)
            .with_angular_momentum(spin * 0.1);
        // 0.1 kg m²/s over moments of 0.0035 to 0.004 kg m²: 29 rad/s; as above, for 1e4 steps of
        // 3e-3 rad.
        let drift = drift_of_jellett(start, 1.0, 1e-4);
        misses.within("change", drift, 1e-9)?;
    }
}

// -----------------------------------------------------------------------------------------------
// F4: a rattleback
// -----------------------------------------------------------------------------------------------

/// The states, a tenth of a second apart, of a stone that spins (rad/s) on its bottom: an ellipsoid
/// of 0.4 by 0.06 by 0.04 m whose mass lies askew to it by an angle.
fn rattle(askew: f64, spin: f64, seconds: f64) -> Vec<State> {
    let semi_axes = DVec3::new(0.2, 0.03, 0.02);
    let (sin, cos) = askew.sin_cos();
    let [long, broad, upright] = [2.6e-4, 8.08e-3, 8.18e-3];
    // The moments about the long and the broad axis, rotated about z.
    let inertia = DMat3::from_cols(
        DVec3::new(
            long * cos * cos + broad * sin * sin,
            (long - broad) * sin * cos,
            0.0,
        ),
        DVec3::new(
            (long - broad) * sin * cos,
            long * sin * sin + broad * cos * cos,
            0.0,
        ),
        DVec3::Z * upright,
    );
    let distribution = MassProperties {
        mass: 1.0,
        centre_of_mass: DVec3::ZERO,
        inertia,
    };
    let stepper = Stepper::new(Ellipsoid::loaded(semi_axes, distribution))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(FlatGround::level(1e6, 1e2))
        .unwrap()
        .with_friction(Coulomb {
            coefficient: 1.0,
            slip_speed: 1e-3,
        })
        .unwrap()
        .with_integrator(EnergyMomentum { time_step: 5e-4 })
        .unwrap();
    // A nudge that has a mirror image: along the plane y = 0, in which a mirror turns x-moments and
    // z-spins round.
    let mut state = State::at(DVec3::Z * (0.02 - GRAVITY / 1e6)).with_angular_momentum(DVec3::new(
        0.0,
        1e-4,
        upright * spin,
    ));
    (0..kit::whole(10.0 * seconds))
        .map(|_| {
            stepper.advance(&mut state, 0.1).unwrap();
            state
        })
        .collect()
}

/// Reversal times need the parameters of a measured stone (Garcia & Hubbard, Proc. R. Soc. Lond. A
/// 418, 165, 1988; Kondo & Nakanishi, arXiv 1704.06717), which nobody here has seen: only the sense
/// of it is held, and the mirror image, exactly.
static MIRRORED_STONE: Case = Case::new(
    "F4",
    "a mirrored stone with the mirrored spin has the mirrored motion; a stone reverses one spin \
     and not the other",
    "Walker (1896); Garcia & Hubbard, Proc. R. Soc. Lond. A 418, 165 (1988)",
    || {
        let [stone, image] =
            [(0.03, 3.0), (-0.03, -3.0)].map(|(askew, spin)| rattle(askew, spin, 3.0));
        let apart = stone.iter().zip(&image).map(|(one, other)| {
            // A reflection in y = 0 turns y-places and x- and z-moments round.
            let place = other.position * DVec3::new(1.0, -1.0, 1.0);
            let momentum = other.angular_momentum * DVec3::new(-1.0, 1.0, -1.0);
            (one.position - place).length() + (one.angular_momentum - momentum).length()
        });
        // Sums whose terms have other signs round apart, by 1e-16 in each of 6000 steps; a rattle
        // that grows makes up to e^10 of it.
        vec![figure(
            "stone and its mirror image for 3 s: largest distance",
            0.0,
            apart.fold(0.0, f64::max),
            1e-9,
        )]
    },
);

#[test]
fn a_rattleback_turns_back_from_one_sense_and_runs_as_its_mirror_image_mirrored() {
    MIRRORED_STONE.holds();
    let last = |spin: f64| {
        let path = rattle(0.03, spin, 12.0);
        path.iter()
            .map(|state| state.angular_momentum.z * spin.signum())
            .fold(f64::MAX, f64::min)
    };
    let [one, other] = [last(3.0), last(-3.0)];
    assert!(
        one.min(other) < 0.0 && one.max(other) > 0.0,
        "{one} and {other}"
    );
}

// -----------------------------------------------------------------------------------------------
// F5: a tumbler doll's swing
// -----------------------------------------------------------------------------------------------

/// Time of an oscillation (s) of a body that stands at a height on its lowest point and starts at
/// rest with a lean of `first` rad about y, from its passages upright.
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
    let mut state =
        State::at(DVec3::Z * (height - GRAVITY / 1e5)).with_rotation_vector(DVec3::Y * first);
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

/// Friction enough to roll: 30/s of slip, or 600 times the oscillation's rate.
const GRIP: Coulomb = Coulomb {
    coefficient: 1.0,
    slip_speed: GRAVITY / 3000.0,
};

const ICE: Coulomb = Coulomb {
    coefficient: 0.0,
    slip_speed: 1.0,
};

/// Period (s) of a body of 1 kg that rocks in a plane with any amplitude: with its centre of mass
/// at the height h(θ) over its lowest point, which is h'(θ) aside, the centre moves at `h' θ'` up
/// and, rolling, `h θ'` along: `(I + h'² + h²) θ'²/2 + g h = const`, on ice without h². So
/// `T = 4 ∫ √((I + h'² + h²)/(2 g (h(θ₀) - h(θ)))) dθ`, with `θ = θ₀ sin s` a smooth periodic
/// integrand, for which the midpoint rule leaves nothing.
fn period_of(height: impl Fn(f64) -> [f64; 2], inertia: f64, rolls: bool, first: f64) -> f64 {
    let parts = 400;
    let [top, _] = height(first);
    let sum: f64 = (0..parts)
        .map(|part| {
            let (sin, cos) = ((f64::from(part) + 0.5) * FRAC_PI_2 / f64::from(parts)).sin_cos();
            let [h, slope] = height(first * sin);
            let along = if rolls { h * h } else { 0.0 };
            first * cos * ((inertia + slope * slope + along) / (2.0 * GRAVITY * (top - h))).sqrt()
        })
        .sum();
    4.0 * sum * FRAC_PI_2 / f64::from(parts)
}

/// The first oscillation's time (s) of a body that starts at rest at a lean, as in `swing`, on a
/// ground so hard and with a friction so firm that it rolls at any amplitude; and what they and the
/// step may miss of it.
///
/// The ground's springs, 1e6 N/m under 1 kg, take part in the oscillation ω with the square of ω
/// over their 1000 rad/s; they give way by m g/S, which shortens the arm h, of I + h², by `2 h` of
/// that, and bends the rim's curvature by its fraction of the radius of curvature; friction of the
/// rate γ = 1e5/s slips by 1/γ of its acceleration, and takes `ω²/γ` of the energy a radian; the
/// step dt is of order 2, (ω dt)²/12.
fn first_swing(
    body: impl RigidPointBody,
    [height, curvature]: [f64; 2],
    rolls: bool,
    [first, expected]: [f64; 2],
) -> [f64; 2] {
    let (stiffness, rate, time_step) = (1e6, 1e5, 2e-4);
    // A coefficient of 10 holds at any load that an oscillation leaves.
    let friction = Coulomb {
        coefficient: if rolls { 10.0 } else { 0.0 },
        slip_speed: 10.0 * GRAVITY / rate,
    };
    let stepper = Stepper::new(body)
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(FlatGround::level(stiffness, 200.0))
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(EnergyMomentum { time_step })
        .unwrap();
    let depth = GRAVITY / stiffness;
    let mut state = State::at(DVec3::Z * (height - depth)).with_rotation_vector(DVec3::Y * first);
    let (mut passages, mut before) = (Vec::new(), (0.0, first));
    stepper
        .run(&mut state, 1.4 * expected, &mut |sample: &Sample<'_>| {
            let now = (sample.time, (sample.state.orientation * DVec3::Z).x);
            if before.1 * now.1 <= 0.0 && before.1 != 0.0 {
                passages.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
            }
            before = now;
            core::ops::ControlFlow::Continue(())
        })
        .unwrap();
    // From upright to upright in the same direction; the first quarter has the springs' own start
    // in it.
    let got = passages[2] - passages[0];
    let swing = TAU / expected;
    let share = swing * swing / stiffness
        + depth * (2.0 / height + 1.0 / curvature)
        + 10.0 * swing / rate
        + (swing * time_step).powi(2) / 12.0;
    [got, 2.0 * share * expected]
}

random! {
    /// Checks oscillations of any amplitude.
    ANY_ROLY_POLY = new(24, "tumbler doll, l of 0.1 r to 0.8 r, moment, amplitude of 0.05 to 1.5 rad: the quadrature of its energy");
    fn tumbler_dolls_of_any_kind_swing_with_any_amplitude_by_the_quadrature_of_their_energy(
        share in 0.1..0.8_f64,
        moment in 0.15..0.6_f64,
        first in log_uniform(0.05, 1.5),
        rolls in prop::bool::ANY,
    ) |misses| {
        let low = share * RADIUS;
        let height = |angle: f64| [RADIUS - low * angle.cos(), low * angle.sin()];
        let expected = period_of(height, moment * RADIUS * RADIUS, rolls, first);
        let body = eccentric(low, moment, moment.min(0.4));
        let [got, miss] = first_swing(body, [height(first)[0], RADIUS], rolls, [first, expected]);
        misses.near("period", [got, expected], miss)?;
    }
}

static ROLY_POLY: Case = Case::new(
    "F5",
    "rolling `T = 2π √((I + m (r - l)²)/(m g l))`, on ice `2π √(I/(m g l))`",
    "small oscillations, e.g. Lamb, Dynamics (1914)",
    || {
        // r = 0.1 m, l = 0.02 m, I = 0.3 m r².
        let (low, moment, first) = (0.02, 0.3, 0.05_f64);
        let inertia = moment * RADIUS * RADIUS;
        let period = |inertia: f64| TAU * (inertia / (GRAVITY * low)).sqrt();
        // The oscillation's own (first/4)², and rolling, l r/(I + ..) of it again: a few times
        // that. The slip is out of step by the square of ω/3000.
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
)
.and(&[&ANY_ROLY_POLY]);

#[test]
fn the_quadrature_of_a_swing_has_the_limit_of_small_ones() {
    let height = |angle: f64| [0.1 - 0.02 * angle.cos(), 0.02 * angle.sin()];
    for (rolls, along) in [(true, 0.08_f64.powi(2)), (false, 0.0)] {
        let small = TAU * ((3e-3 + along) / (GRAVITY * 0.02)).sqrt();
        let got = period_of(height, 3e-3, rolls, 1e-3);
        // The first amplitude's square by some.
        assert!((got / small - 1.0).abs() < 1e-6, "{got}, not {small}");
    }
}

#[test]
fn a_tumbler_doll_swings_at_the_rate_of_a_pendulum_that_rolls() {
    ROLY_POLY.holds();
}

// -----------------------------------------------------------------------------------------------
// F6: an ellipsoid's rocking
// -----------------------------------------------------------------------------------------------

random! {
    /// Checks oscillations of any amplitude. The centre of an ellipse at the lean θ is
    /// `h = √(a² sin² θ + c² cos² θ)` high, and `h' = (a² - c²) sin θ cos θ/h` aside of its lowest
    /// place, whose radius of curvature is `a² c²/h³`.
    ANY_EGG = new(24, "lens, c of 0.35 a to 0.85 a, amplitude of 0.03 to 1 rad: the quadrature of its energy");
    fn lenses_of_any_shape_rock_with_any_amplitude_by_the_quadrature_of_their_energy(
        share in 0.35..0.85_f64,
        first in log_uniform(0.03, 1.0),
        rolls in prop::bool::ANY,
    ) |misses| {
        let (a, c) = (0.1, 0.1 * share);
        let height = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let h = (a * sin).hypot(c * cos);
            [h, (a * a - c * c) * sin * cos / h]
        };
        let expected = period_of(height, (a * a + c * c) / 5.0, rolls, first);
        let [top, _] = height(first);
        let body = Ellipsoid::solid(1.0, DVec3::new(a, a, c));
        let curvature = (a * c).powi(2) / top.powi(3);
        let [got, miss] = first_swing(body, [top, curvature], rolls, [first, expected]);
        misses.near("period", [got, expected], miss)?;
    }
}

static EGG: Case = Case::new(
    "F6",
    "rolling `ω² = m g (ρ - c)/(I + m c²)`, on ice `m g (ρ - c)/I`, ρ = a²/c",
    "small oscillations of a heavy ellipsoid, Routh (1905)",
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
)
.and(&[&ANY_EGG]);

#[test]
fn an_ellipsoid_rocks_on_its_flat_side_by_the_radius_of_curvature() {
    EGG.holds();
}

// -----------------------------------------------------------------------------------------------
// F7, F8: a heavy symmetric top
// -----------------------------------------------------------------------------------------------

/// A top of 1 kg on a sharp tip `length` (m) under its centre of mass, with moments A about an axis
/// across and C about its own (kg m²).
#[derive(Clone, Copy, Debug)]
struct Top {
    length: f64,
    across: f64,
    about: f64,
}

impl Top {
    /// Springs of 1e6 N/m under 1 kg.
    const STIFFNESS: f64 = 1e6;

    fn body(&self) -> Solid {
        Solid {
            mass: 1.0,
            inertia: DMat3::from_diagonal(DVec3::new(self.across, self.across, self.about)),
            contacts: vec![ContactPoint::bare(DVec3::NEG_Z * self.length)],
        }
    }

    /// The slow rate about the vertical of a steady precession at the lean θ with the spin n about
    /// the axis, on ice, where the centre of mass stays: the weight's moment, m g l sin θ, turns
    /// the angular momentum, `C n Ω - A Ω² cos θ = m g l`.
    fn precession(&self, lean: f64, spin: f64) -> Option<f64> {
        let (moment, angular) = (GRAVITY * self.length, self.about * spin);
        let square = angular * angular - 4.0 * self.across * moment * lean.cos();
        (square > 0.0).then(|| 2.0 * moment / (angular + square.sqrt()))
    }

    /// Square of the frequency of small nutations about it: `A Ω sin² θ + C n cos θ` stays, so that
    /// `δΩ = (C n - 2 A Ω cos θ)/(A sin θ) δθ`, and `A ω² = A Ω² sin² θ + (C n - 2 A Ω cos θ)²/A`;
    /// the centre of mass moves up and down with `l sin θ θ'`, which adds `m l² sin² θ` to A on the
    /// left.
    fn nutation(&self, lean: f64, spin: f64, rate: f64) -> f64 {
        let (sin, cos) = lean.sin_cos();
        let gyroscopic = self.about * spin / self.across - 2.0 * rate * cos;
        let heave = 1.0 + (self.length * sin).powi(2) / self.across;
        ((rate * sin).powi(2) + gyroscopic * gyroscopic) / heave
    }

    fn start(&self, lean: f64, spin: f64, rate: f64) -> State {
        let depth = GRAVITY / Self::STIFFNESS;
        let state = State::at(DVec3::Z * (self.length * lean.cos() - depth))
            .with_rotation_vector(DVec3::Y * lean);
        let [down, axis] = [DVec3::X, DVec3::Z].map(|own| state.orientation * own);
        // Up in the vertical plane of the axis: body -x.
        state.with_angular_momentum(
            axis * (self.about * spin) - down * (self.across * rate * lean.sin()),
        )
    }

    /// Times (s), leans and azimuths (rad) of the axis of a top on ice.
    fn path(&self, start: State, seconds: f64, time_step: f64) -> Vec<[f64; 3]> {
        let stepper = Stepper::new(self.body())
            .unwrap()
            .with_gravity(UniformGravity::down(GRAVITY))
            .unwrap()
            .with_ground(FlatGround::level(Self::STIFFNESS, 0.0))
            .unwrap()
            .with_integrator(Rk4 { time_step })
            .unwrap();
        let (mut state, mut path) = (start, Vec::<[f64; 3]>::new());
        stepper
            .run(&mut state, seconds, &mut |sample: &Sample<'_>| {
                let axis = sample.state.orientation * DVec3::Z;
                let azimuth = axis.y.atan2(axis.x);
                let before = path.last().map_or(0.0, |last| last[2]);
                let turns = ((before - azimuth) / TAU).round() * TAU;
                path.push([sample.time, axis.z.acos(), azimuth + turns]);
                core::ops::ControlFlow::Continue(())
            })
            .unwrap();
        path
    }

    /// Rate about the vertical (rad/s) of steady precession, in half a second.
    fn measured_precession(&self, lean: f64, spin: f64, rate: f64) -> f64 {
        let path = self.path(self.start(lean, spin, rate), 0.5, Self::step(spin));
        let [first, last] = [path[0], path[path.len() - 1]];
        (last[2] - first[2]) / (last[0] - first[0])
    }

    /// Frequency (rad/s) of small nutations: from the times between passages of the steady lean,
    /// in the same direction, over some oscillations.
    fn measured_nutation(&self, lean: f64, spin: f64, rate: f64, expected: f64) -> f64 {
        let aside = Self::ASIDE;
        let (sin, cos) = lean.sin_cos();
        let faster =
            (self.about * spin - 2.0 * self.across * rate * cos) / (self.across * sin) * aside;
        let start = self.start(lean + aside, spin, rate + faster);
        let path = self.path(start, 3.6 * TAU / expected, Self::step(spin));
        let passages: Vec<f64> = path
            .windows(2)
            .filter(|pair| pair[0][1] > lean && pair[1][1] <= lean)
            .map(|pair| {
                pair[0][0]
                    + (pair[1][0] - pair[0][0]) * (pair[0][1] - lean) / (pair[0][1] - pair[1][1])
            })
            .collect();
        TAU * (passages.len() - 1) as f64 / (passages[passages.len() - 1] - passages[0])
    }

    /// First lean from the steady one, rad.
    const ASIDE: f64 = 1e-4;

    /// The springs' 1000 rad/s at 0.1 rad a step, and the spin at 0.02.
    fn step(spin: f64) -> f64 {
        f64::min(1e-4, 0.02 / spin)
    }

    /// Relative error of the rate of precession: steady motion is steady in the model too, the
    /// springs at rest. Runge-Kutta, (ω dt)⁴/120 of the spin's angle over the precession's, ω of
    /// the spin and of the nutation, C n/A; where the two rates of precession nearly meet, they
    /// answer to the spin by `C n/√(C² n² - 4 A m g l cos θ)`.
    fn miss_of_precession(&self, lean: f64, spin: f64, rate: f64) -> f64 {
        let turn = (1.0 + self.about / self.across) * spin * Self::step(spin);
        let angular = self.about * spin;
        let weight = 4.0 * self.across * GRAVITY * self.length * lean.cos();
        let answer = angular / (angular * angular - weight).sqrt();
        answer * (turn.powi(4) / 120.0 * spin / rate + 1e-9)
    }

    /// Relative error of the frequency of nutation: the springs take part with the square of ω over
    /// theirs, for the fraction that the heave has; the oscillation's own square of δ over the
    /// lean, by the mean it is taken about; three oscillations are timed by chords, `(ω dt)²/8` of
    /// a radian of them.
    fn miss_of_nutation(lean: f64, frequency: f64, spin: f64) -> f64 {
        frequency * frequency / Self::STIFFNESS
            + 10.0 * Self::ASIDE / lean.tan().min(1.0 / lean.tan()) / (3.0 * TAU)
            + (frequency * Self::step(spin)).powi(2)
    }
}

static TOP: Case = Case::new(
    "F7",
    "`C n Ω - A Ω² cos θ = m g l`; `ω² (1 + m l² sin² θ/A) = Ω² sin² θ + (C n/A - 2Ω cos θ)²`",
    "heavy top on a smooth plane, Poisson (1811); Klein & Sommerfeld, Theorie des Kreisels (1897); Routh (1905)",
    || {
        let top = Top {
            length: 0.04,
            across: 8e-4,
            about: 5e-4,
        };
        let (lean, spin) = (30.0_f64.to_radians(), 100.0);
        let rate = top.precession(lean, spin).unwrap();
        let frequency = top.nutation(lean, spin, rate).sqrt();
        vec![
            figure(
                "top on ice, 30°, n = 100 rad/s: precession, rad/s",
                rate,
                top.measured_precession(lean, spin, rate),
                top.miss_of_precession(lean, spin, rate) * rate,
            ),
            figure(
                "nutation, rad/s",
                frequency,
                top.measured_nutation(lean, spin, rate, frequency),
                Top::miss_of_nutation(lean, frequency, spin) * frequency,
            ),
        ]
    },
)
.and(&[&ANY_TOP]);

#[test]
fn a_top_on_ice_precesses_and_nods_as_poisson_says() {
    TOP.holds();
}

random! {
    ANY_TOP = new(24, "top, slender or flat, leaning by 5° to 80°, 1.05 to 5 times the least spin");
    fn tops_of_any_kind_precess_and_nod_on_ice_as_poisson_says(
        length in log_uniform(0.02, 0.2),
        across in 0.2..3.0_f64,
        ratio in 0.2..1.9_f64,
        degrees in 5.0..80.0_f64,
        excess in 1.05..5.0_f64,
    ) |misses| {
        let across = across * length * length;
        let (top, lean) = (Top { length, across, about: ratio * across }, degrees.to_radians());
        // Where the two rates of precession meet.
        let spin = excess * 2.0 * (across * GRAVITY * length * lean.cos()).sqrt() / top.about;
        prop_assume!(spin < 300.0);
        let Some(rate) = top.precession(lean, spin) else { return Ok(()) };
        let frequency = top.nutation(lean, spin, rate).sqrt();
        misses.near("precession", [top.measured_precession(lean, spin, rate), rate], top.miss_of_precession(lean, spin, rate) * rate)?;
        let got = top.measured_nutation(lean, spin, rate, frequency);
        misses.near("nutation", [got, frequency], Top::miss_of_nutation(lean, frequency, spin) * frequency)?;
    }
}

/// Largest lean over the first, 1 mrad at rest but for the spin, of an upright top: with
/// `A z'' - i C n z' - m g l z = 0` for the axis seen from above, two circles whose sum and
/// difference make `C n/√(C² n² - 4 A m g l)` of it.
fn grown(top: Top, spin: f64) -> [f64; 2] {
    let first = 1e-3;
    let square = (top.about * spin).powi(2) - 4.0 * top.across * GRAVITY * top.length;
    let beat = square.sqrt() / top.across;
    // A whole beat.
    let path = top.path(
        top.start(first, spin, 0.0),
        1.1 * TAU / beat,
        Top::step(spin),
    );
    let largest = path
        .iter()
        .fold(0.0, |largest, moment| f64::max(largest, moment[1]));
    [largest / first, top.about * spin / square.sqrt()]
}

/// Relative error of the largest lean: the lean's square, by which the weight's moment is not
/// linear, on a difference of which the weight is `4 A m g l` over what is left; and the largest
/// lean lies between two steps, up to half a step of the beat off: `(beat dt)²/8`. The springs'
/// part of the heave, the lean's square by `l²/A` of ω² over theirs, is smaller.
fn miss_of_grown(top: Top, spin: f64, grown: f64) -> f64 {
    let weight = 4.0 * top.across * GRAVITY * top.length;
    let left = (top.about * spin).powi(2) - weight;
    let beat = left.sqrt() / top.across;
    grown
        * ((1e-3 * grown).powi(2) * (1.0 + weight / left) + (beat * Top::step(spin)).powi(2) / 8.0)
}

static SLEEPING_TOP: Case = Case::new(
    "F8",
    "sleeps iff `C² n² > 4 A m g l`; leans to `C n/√(C² n² - 4 A m g l)` of the first",
    "Klein & Sommerfeld (1897); Kibble & Berkshire, Classical Mechanics (2004), (12.26)",
    || {
        let top = Top {
            length: 0.04,
            across: 8e-4,
            about: 5e-4,
        };
        let least = (4.0 * top.across * GRAVITY * top.length).sqrt() / top.about;
        [1.02, 1.1, 2.0]
            .map(|excess| {
                let [got, expected] = grown(top, excess * least);
                let miss = miss_of_grown(top, excess * least, expected);
                figure(
                    format!("{excess} of the least spin: largest lean by first"),
                    expected,
                    got,
                    miss,
                )
            })
            .to_vec()
    },
)
.and(&[&ANY_SLEEPING_TOP]);

#[test]
fn a_top_sleeps_above_its_least_spin_and_falls_over_below() {
    SLEEPING_TOP.holds();
    let top = Top {
        length: 0.04,
        across: 8e-4,
        about: 5e-4,
    };
    let least = (4.0 * top.across * GRAVITY * top.length).sqrt() / top.about;
    let path = top.path(top.start(1e-3, 0.95 * least, 0.0), 2.0, 1e-4);
    assert!(path.iter().any(|moment| moment[1] > 0.3));
}

random! {
    ANY_SLEEPING_TOP = new(24, "top, 1.01 to 3 times the least spin");
    fn tops_of_any_kind_sleep_above_their_least_spin(
        length in log_uniform(0.02, 0.2),
        across in 0.2..3.0_f64,
        ratio in 0.2..1.9_f64,
        excess in 1.01..3.0_f64,
    ) |misses| {
        let across = across * length * length;
        let top = Top { length, across, about: ratio * across };
        let spin = excess * 2.0 * (across * GRAVITY * length).sqrt() / top.about;
        prop_assume!(spin < 300.0);
        let [got, expected] = grown(top, spin);
        misses.near("largest lean by first", [got, expected], miss_of_grown(top, spin, expected))?;
    }
}
