//! Group A, motion without contact: the parabola of the centre of mass and the torque-free
//! rotation.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;
use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{
    Coin, ContactPoint, ForwardEuler, InertiaProperties, Integrator, PointCloud, RigidPointBody,
    Rk4, State, StrangSplitting, SymplecticEuler, UniformGravity,
};

use crate::kit::erased::Stepper;
use crate::kit::{
    self, AnyBody, Solid, angle_between, bodies, directions, each_explicit, log_uniform, order,
    orientations, zero_or,
};
use crate::table::{Case, figure, random};

pub(crate) const CASES: &[&Case] = &[&TOSS, &WOBBLE, &ASYMMETRIC_TOP, &WING_NUT, &RING];

/// A body in free rotation, and nothing else.
fn free<I: Integrator>(body: Solid, integrator: I) -> impl Fn(&mut State, f64) {
    let stepper = Stepper::new(body)
        .unwrap()
        .with_integrator(integrator)
        .unwrap();
    move |state, seconds| stepper.advance(state, seconds).unwrap()
}

/// Angular velocity in body axes of a body with a diagonal inertia tensor.
fn body_rates(moments: DVec3, state: &State) -> DVec3 {
    (state.orientation.conjugate() * state.angular_momentum) / moments
}

// -----------------------------------------------------------------------------------------------
// A1: the centre of mass
// -----------------------------------------------------------------------------------------------

static TOSS: Case = Case::new("A1", "`u²/2g`, `2u/g`", "Galileo, Discorsi (1638)", || {
    let stepper = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_gravity(UniformGravity::down(9.8))
        .unwrap()
        .with_integrator(StrangSplitting { time_step: 1e-3 })
        .unwrap();
    let mut state = State::<f64>::default()
        .with_linear_velocity(DVec3::Z * 2.4)
        .with_angular_momentum(DVec3::new(1.0, 20.0, 0.3));
    stepper.advance(&mut state, 2.4 / 9.8).unwrap();
    let apex = state.position.z;
    stepper.advance(&mut state, 0.489_80 - 2.4 / 9.8).unwrap();
    let back = 0.489_80 + state.position.z / 2.4;
    // Half a unit of the last printed digit.
    vec![
        figure(
            "a spinning coin tossed at 2.4 m/s: apex, m",
            0.293_88,
            apex,
            5e-6,
        ),
        figure("return, s", 0.489_80, back, 5e-6),
    ]
})
.and(&[&ANY_TOSS]);

#[test]
fn a_toss_at_2_4_m_per_s_reaches_0_29388_m_and_returns_after_0_48980_s() {
    TOSS.holds();
}

random! {
    /// `x0 + v0 t - g t²/2`, whatever the body is and however it spins. Methods of order 2 and more
    /// are exact; forward Euler lags behind by `g t dt/2`, and semi-implicit Euler is as much
    /// ahead.
    ANY_TOSS = of_rounding(100, "body, spin, velocity and pull, by each explicit method");
    fn the_centre_of_mass_of_any_spinning_body_flies_along_a_parabola(
        body in bodies(),
        orientation in orientations(),
        spin in zero_or(1e-3, 1e3),
        axis in directions(),
        velocity in directions(),
        speed in zero_or(1e-3, 1e3),
        pull in directions(),
        g in zero_or(1e-2, 1e2),
        dt in log_uniform(1e-5, 0.1),
    ) |misses| {
        let gravity = UniformGravity { acceleration: pull * g };
        let velocity = velocity * speed;
        let steps = 200;
        let seconds = f64::from(steps) * dt;
        each_explicit!(dt, |integrator, method| {
            let stepper = Stepper::new(&*body).unwrap()
                .with_gravity(gravity).unwrap()
                .with_integrator(integrator).unwrap();
            let mut state = State::default().with_orientation(orientation).with_linear_velocity(velocity)
                .with_angular_momentum(body.inertia() * (axis * spin));
            for _ in 0..steps {
                stepper.step(&mut state).unwrap();
            }
            let lag = match method {
                "ForwardEuler" => dt,
                "SymplecticEuler" => -dt,
                _ => 0.0,
            };
            let expected = velocity * seconds + gravity.acceleration * (0.5 * seconds * (seconds - lag));
            let (miss, size) = ((state.position - expected).length(), speed * seconds + g * seconds * seconds);
            // Each of 200 steps rounds position and velocity, by a unit of 1.1e-16 in each of three
            // components at most; the velocity's add up to half as much again.
            let rounding = f64::from(steps) * 4e-16 * size;
            misses.within(method, miss, rounding)?;
            let faster = (state.linear_velocity - velocity - gravity.acceleration * seconds).length();
            misses.within(method, faster, f64::from(steps) * 4e-16 * (speed + g * seconds))?;
        });
    }
}

proptest! {
    #![proptest_config(kit::cases(100))]

    /// Without torque the angular momentum is the same number, bit by bit, in every method and for
    /// every body: its direction and length alike.
    #[test]
    fn angular_momentum_in_flight_does_not_change_by_a_single_bit(
        body in bodies(),
        orientation in orientations(),
        axis in directions(),
        size in zero_or(1e-9, 1e9),
        dt in log_uniform(1e-6, 1.0),
    ) {
        let momentum = axis * size;
        each_explicit!(dt, |integrator, method| {
            let stepper = Stepper::new(&*body).unwrap()
                .with_gravity(UniformGravity::down(9.8)).unwrap()
                .with_integrator(integrator).unwrap();
            let mut state = State::default().with_orientation(orientation).with_angular_momentum(momentum);
            for _ in 0..50 {
                stepper.step(&mut state).unwrap();
            }
            prop_assert_eq!(state.angular_momentum, momentum, "{}", method);
        });
    }
}

// -----------------------------------------------------------------------------------------------
// A2: the symmetric top
// -----------------------------------------------------------------------------------------------

/// A symmetric top after `seconds` (Euler; Landau & Lifshitz, Mechanics, section 33): its axis goes
/// round the angular momentum at `L/I₁`, and in the frame that goes round with it the body turns
/// about its axis at `(1/I₃ - 1/I₁) L cos θ`.
fn symmetric_top(axial: f64, transverse: f64, axis: DVec3, start: &State, seconds: f64) -> DQuat {
    let momentum = start.angular_momentum;
    let along = (start.orientation * axis).dot(momentum);
    let own = (1.0 / axial - 1.0 / transverse) * along * seconds;
    let precession = momentum.length() / transverse * seconds;
    let round = match momentum.try_normalize() {
        Some(direction) => DQuat::from_axis_angle(direction, precession),
        None => DQuat::IDENTITY,
    };
    round * start.orientation * DQuat::from_axis_angle(axis, own)
}

/// The ring of the catalogue: r = 0.5 m, M = 1 kg, its angular momentum of 1 kg m²/s 15 degrees
/// from its normal.
fn wobbling_ring() -> (Coin, State) {
    let coin = Coin::ring(1.0, 0.5);
    let lean = 15.0_f64.to_radians();
    // The normal is body x: leaned in the xz plane of the world, with the angular momentum along x.
    let state = State::default()
        .with_rotation_vector(DVec3::Y * -lean)
        .with_angular_momentum(DVec3::X);
    (coin, state)
}

static WOBBLE: Case = Case::new(
    "A2",
    "`φ' = L/I₁`, `ω₃ = L cos θ/I₃`, `φ'/|ψ'| = 2/cos θ`",
    "Euler (1765); Feynman's plate: Chao, Phys. Today 42 (1989)",
    || {
        // After one period 2π/8 s the body has rotated by -3.034545 rad about its axis (mod 2π).
        let (coin, start) = wobbling_ring();
        let period = TAU / 8.0;
        let stepper = Stepper::new(coin)
            .unwrap()
            .with_integrator(SymplecticEuler { time_step: 1e-3 })
            .unwrap();
        let axis = |state: &State| state.orientation * DVec3::X;
        // A quarter of a period: the axis has gone round the angular momentum by a right angle,
        // right-handed about x: what leaned to +z leans to -y.
        let mut state = start;
        stepper.advance(&mut state, period / 4.0).unwrap();
        let (before, after) = (axis(&start), axis(&state));
        let round = before.y.atan2(before.z) - after.y.atan2(after.z);
        assert!((round - FRAC_PI_2).abs() < 1e-12, "{round}");
        // A whole one: the axis is back, and the body is rotated about it.
        stepper.advance(&mut state, 3.0 * period / 4.0).unwrap();
        assert!((axis(&state) - axis(&start)).length() < 1e-12);
        let own = start.orientation.conjugate() * state.orientation;
        let turned = 2.0 * own.x.atan2(own.w);
        let turned = (turned + PI).rem_euclid(TAU) - PI;
        // The rate about its own axis, from the turn: a whole revolution less than none.
        let own_rate = turned / period;
        let rates = body_rates(DVec3::new(0.25, 0.125, 0.125), &start);
        // Half a unit of the last printed digit.
        vec![
            figure(
                "ring, 15°: precession, rad/s",
                8.0,
                round / (period / 4.0),
                5e-7,
            ),
            figure("spin, rad/s", 3.863_703, rates.x, 5e-7),
            figure("own rotation in a period, rad", -3.034_545, turned, 5e-7),
            figure("wobble to spin", 2.070_552, 8.0 / own_rate.abs(), 5e-7),
        ]
    },
)
.and(&[&ANY_WOBBLE]);

#[test]
fn a_wobbling_ring_precesses_by_feynmans_plate_to_the_printed_digits() {
    WOBBLE.holds();
}

random! {
    /// A symmetric body's rotation is exact at any step: one long step or a hundred short ones,
    /// thin as a disc, long as a rod, or a ball.
    ANY_WOBBLE = of_rounding(100, "disc, ball or rod, rate and step");
    fn symmetric_bodies_turn_by_the_closed_form_at_any_step(
        ratio in prop_oneof![Just(1.0), Just(2.0), log_uniform(1e-3, 2.0)],
        transverse in log_uniform(1e-6, 1e6),
        number in 0..3_usize,
        orientation in orientations(),
        direction in directions(),
        rate in zero_or(1e-3, 1e3),
        steps in 1..100_u32,
        seconds in log_uniform(1e-3, 10.0),
    ) |misses| {
        let axial = ratio * transverse;
        let mut moments = DVec3::splat(transverse);
        moments[number] = axial;
        let axis = DVec3::AXES[number];
        let start = State::default().with_orientation(orientation).with_angular_momentum(direction * (rate * transverse));
        let expected = symmetric_top(axial, transverse, axis, &start, seconds);
        // Each angle is a product of rounded numbers, and the spin's share of L a sum of three:
        // nine units of 1.1e-16 of the angle, in the test and in the library. Each step rounds the
        // turn.
        let angle = (rate * seconds) * (1.0 + (1.0 / ratio - 1.0).abs());
        let rounding = 1e-15 * (2.0 * angle + f64::from(steps) + 1.0);
        let dt = seconds / f64::from(steps);
        let body = || Solid::with_moments(moments);
        for (method, advance) in [
            ("SymplecticEuler", &free(body(), SymplecticEuler { time_step: dt }) as &dyn Fn(&mut State, f64)),
            ("StrangSplitting", &free(body(), StrangSplitting { time_step: dt })),
        ] {
            let mut state = start;
            advance(&mut state, seconds);
            let miss = angle_between(state.orientation, expected);
            misses.within(method, miss, rounding)?;
        }
    }
}

#[test]
fn the_other_methods_approach_the_closed_form_of_precession_at_their_order() {
    let (coin, start) = wobbling_ring();
    let expected = symmetric_top(0.25, 0.125, DVec3::X, &start, 1.0);
    let miss = |integrator: &dyn Fn(f64) -> State, dt: f64| {
        angle_between(integrator(dt).orientation, expected)
    };
    let forward = |time_step: f64| {
        let mut state = start;
        let stepper = Stepper::new(coin)
            .unwrap()
            .with_integrator(ForwardEuler { time_step });
        stepper.unwrap().advance(&mut state, 1.0).unwrap();
        state
    };
    let runge_kutta = |time_step: f64| {
        let mut state = start;
        let stepper = Stepper::new(coin)
            .unwrap()
            .with_integrator(Rk4 { time_step });
        stepper.unwrap().advance(&mut state, 1.0).unwrap();
        state
    };
    for steps in [200.0, 400.0, 800.0_f64] {
        let dt = 1.0 / steps;
        let first = order(miss(&forward, dt), miss(&forward, dt / 2.0));
        assert!((first - 1.0).abs() < 0.1, "order {first} of forward Euler");
        let fourth = order(miss(&runge_kutta, dt), miss(&runge_kutta, dt / 2.0));
        assert!(fourth > 3.9, "order {fourth} of Runge-Kutta");
    }
}

/// Largest turn from the closed form after 10³, 10⁴, 10⁵ and 10⁶ turns, with the number of steps
/// taken.
///
/// The angular momentum has length 1 to the last place and the moments are 1/4 and 1/8, so that a
/// step of 1/16 s rotates by 1/2 rad, a product of dyadic numbers: the closed form knows the angle
/// after n steps, n/2 rad, to its last place.
fn phase_errors(moments: DVec3) -> [(f64, f64); 4] {
    let dt = 1.0 / 16.0;
    let stepper = Stepper::new(Solid::with_moments(moments))
        .unwrap()
        .with_integrator(SymplecticEuler { time_step: dt })
        .unwrap();
    let start = State::default().with_angular_momentum(DVec3::new(0.6, 0.0, 0.8));
    let mut state = start;
    let mut steps = 0_u32;
    [1e3, 1e4, 1e5, 1e6].map(|turns| {
        while f64::from(steps) * 0.5 < turns * TAU {
            stepper.step(&mut state).unwrap();
            steps += 1;
        }
        let expected = symmetric_top(
            moments.x,
            moments.y,
            DVec3::X,
            &start,
            f64::from(steps) * dt,
        );
        (f64::from(steps), angle_between(state.orientation, expected))
    })
}

#[test]
fn a_million_turns_of_a_ball_add_up_no_more_than_the_rounding_of_each_step() {
    // In each step the rotation's angle, its sine and cosine and the product round: some 4e-16 rad
    // if all went in the same direction. Measured: 6.2e-17 rad a step, in proportion to the number
    // of steps to 1 % from a thousand revolutions to a million.
    for (steps, miss) in phase_errors(DVec3::splat(0.125)) {
        assert!(miss < 4e-16 * steps, "{miss:e} rad off after {steps} steps");
    }
}

#[test]
fn a_million_turns_of_a_coin_leave_its_phase_right_to_a_ten_thousandth_of_a_radian() {
    // In each step, as of the ball; besides, rounding tilts the axis against the angular momentum a
    // little, and a tilted axis has another rate: a tilt of e rad a step is e n²/2 times the coin's
    // own 1/8 rad a step after n steps. Measured: e = 4e-19 (a 300th of a unit of the last place,
    // with the sign of the bias that rounding has on this path), 4e-6 rad after a million
    // revolutions. (Where each step scaled a quaternion whose length was 1 already, e was three to
    // five times that.)
    for (steps, miss) in phase_errors(DVec3::new(0.25, 0.125, 0.125)) {
        let allowed = 4e-16 * steps + 3e-18 * steps * steps / 16.0;
        assert!(
            miss < allowed,
            "{miss:e} rad off after {steps} steps, {allowed:e} allowed"
        );
    }
}

// -----------------------------------------------------------------------------------------------
// A3, A4: three different moments
// -----------------------------------------------------------------------------------------------

/// Jacobi's sn, cn and dn of `u` for the parameter `m` in 0 ... 1, and the quarter period K(m), by
/// the arithmetic-geometric mean (Abramowitz & Stegun 16.4, 17.6).
fn jacobi(u: f64, m: f64) -> ([f64; 3], f64) {
    let (mut a, mut b, mut c) = (vec![1.0], (1.0 - m).sqrt(), vec![m.sqrt()]);
    while c[c.len() - 1].abs() > 1e-17 && a.len() < 40 {
        let last = a[a.len() - 1];
        a.push(0.5 * (last + b));
        c.push(0.5 * (last - b));
        b = (last * b).sqrt();
    }
    let n = a.len() - 1;
    let mut angle = a[n] * u * f64::powi(2.0, i32::try_from(n).unwrap());
    for i in (1..=n).rev() {
        angle = 0.5 * (angle + (c[i] / a[i] * angle.sin()).asin());
    }
    let (sn, cn) = angle.sin_cos();
    ([sn, cn, (1.0 - m * sn * sn).sqrt()], FRAC_PI_2 / a[n])
}

/// An asymmetric top, `I₁ < I₂ < I₃`, that starts in the plane of its first and third axis (Landau
/// & Lifshitz, Mechanics, section 37).
struct AsymmetricTop {
    moments: DVec3,
    start: DVec3,
    /// 1/s: what turns time into the argument of Jacobi's functions.
    rate: f64,
    parameter: f64,
    /// True if the body rotates about its third axis (`L² > 2 E I₂`), or else about its first.
    about_third: bool,
}

impl AsymmetricTop {
    fn new(moments: DVec3, start: DVec3) -> Self {
        assert!(moments.x < moments.y && moments.y < moments.z && start.y == 0.0);
        let twice_energy = (moments * start * start).element_sum();
        let momentum = (moments * start).length_squared();
        let about_third = momentum > twice_energy * moments.y;
        // The first and the third axis change places in the other case.
        let [i1, i2, i3] = if about_third {
            moments.to_array()
        } else {
            [moments.z, moments.y, moments.x]
        };
        let rate = ((i3 - i2) * (momentum - twice_energy * i1) / (i1 * i2 * i3)).sqrt();
        let parameter = (i2 - i1) * (twice_energy * i3 - momentum)
            / ((i3 - i2) * (momentum - twice_energy * i1));
        Self {
            moments,
            start,
            rate,
            parameter,
            about_third,
        }
    }

    /// Time after which the angular velocity is the same again, in body axes, s.
    fn period(&self) -> f64 {
        4.0 * jacobi(0.0, self.parameter).1 / self.rate
    }

    /// Angular velocity in body axes, rad/s.
    fn rates_after(&self, seconds: f64) -> DVec3 {
        let ([sn, cn, dn], _) = jacobi(self.rate * seconds, self.parameter);
        let [first, third] = if self.about_third { [cn, dn] } else { [dn, cn] };
        let DVec3 {
            x: i1,
            y: i2,
            z: i3,
        } = self.moments;
        // The second one's amplitude from Euler's equation at the start: I₂ ω₂' = (I₃ - I₁) ω₃ ω₁.
        let second = (i3 - i1) * self.start.z * self.start.x / (i2 * self.rate);
        DVec3::new(self.start.x * first, second * sn, self.start.z * third)
    }

    fn state(&self) -> State {
        State::default().with_angular_momentum(self.moments * self.start)
    }

    fn body(&self) -> Solid {
        Solid::with_moments(self.moments)
    }
}

/// The box of the catalogue, 0.1 by 0.2 by 0.3 m, 1 kg, longest side along x.
const BOX: DVec3 = DVec3::new(1.0 / 240.0, 1.0 / 120.0, 13.0 / 1200.0);

#[test]
fn the_closed_form_of_the_asymmetric_top_has_the_printed_numbers() {
    // Case A3: rate 3.4641016, m 0.02564103, T = 1.825597025, ω(T/8) = (0.70480714, 0.81914337,
    // 4.96763584). Half a unit of the last place printed.
    let top = AsymmetricTop::new(BOX, DVec3::new(1.0, 0.0, 5.0));
    assert!((top.rate - 3.464_101_6).abs() < 5e-8);
    assert!((top.parameter - 0.025_641_03).abs() < 5e-9);
    assert!((top.period() - 1.825_597_025).abs() < 5e-10);
    let expected = DVec3::new(0.704_807_14, 0.819_143_37, 4.967_635_84);
    assert!(
        (top.rates_after(top.period() / 8.0) - expected)
            .abs()
            .max_element()
            < 5e-9
    );
}

static ASYMMETRIC_TOP: Case = Case::new(
    "A3",
    "Jacobi's `cn, sn, dn`",
    "Landau & Lifshitz, Mechanics, section 37",
    || {
        let top = AsymmetricTop::new(BOX, DVec3::new(1.0, 0.0, 5.0));
        let advance = free(
            top.body(),
            Rk4 {
                time_step: top.period() / 8000.0,
            },
        );
        let mut state = top.state();
        advance(&mut state, 1.825_597_025 / 8.0);
        let rates = body_rates(BOX, &state);
        for eighth in 2..=24 {
            advance(&mut state, top.period() / 8.0);
            let expected = top.rates_after(top.period() / 8.0 * f64::from(eighth));
            let miss = (body_rates(BOX, &state) - expected).length();
            // The steps are exact to rounding. The printed period is right to 5e-10 s, an eighth of
            // that at up to 17 rad/s².
            assert!(miss < 1.1e-9, "{miss:e} rad/s off after {eighth} eighths");
        }
        // Half a unit of the last printed digit, and the printed period's.
        vec![
            figure(
                "box, an eighth of a period: ω₁, rad/s",
                0.704_807_14,
                rates.x,
                6e-9,
            ),
            figure("ω₂, rad/s", 0.819_143_37, rates.y, 6e-9),
            figure("ω₃, rad/s", 4.967_635_84, rates.z, 6e-9),
        ]
    },
)
.and(&[&ANY_ASYMMETRIC_TOP]);

#[test]
fn an_asymmetric_box_turns_by_jacobis_functions() {
    ASYMMETRIC_TOP.holds();
}

#[test]
fn the_free_turn_of_an_asymmetric_body_does_not_depend_on_the_step() {
    let start = AsymmetricTop::new(BOX, DVec3::new(1.0, 0.0, 5.0))
        .state()
        .with_rotation_vector(DVec3::new(0.3, 0.2, -0.5));
    let turned = |advance: &dyn Fn(&mut State, f64)| {
        let mut state = start;
        advance(&mut state, 1.0);
        state.orientation
    };
    let body = || Solid::with_moments(BOX);
    // A step of 1 s is 5 radians.
    let whole = turned(&free(body(), StrangSplitting { time_step: 1.0 }));
    for time_step in [0.25, 0.02, 0.01, 0.005] {
        for off in [
            turned(&free(body(), StrangSplitting { time_step })),
            // Of order 1 in contact; in flight it takes the same turn.
            turned(&free(body(), SymplecticEuler { time_step })),
        ]
        .map(|end| angle_between(whole, end))
        {
            // At most 400 roundings, most of which change the rest of the rotation by 5 times
            // themselves.
            assert!(off < 1e-13, "{off:e} rad at {time_step} s");
        }
    }
}

random! {
    /// Boxes of any sides and both kinds of turn, about the shortest and about the longest side.
    ANY_ASYMMETRIC_TOP = new(60, "three moments, both kinds of rotation");
    fn asymmetric_bodies_of_all_kinds_turn_by_jacobis_functions(
        middle in 0.05..0.95_f64,
        thickness in 0.0..0.9_f64,
        tilt in 0.05..1.5_f64,
        size in log_uniform(1e-6, 1e6),
        rate in log_uniform(1e-3, 1e3),
        part in 0.0..1.0_f64,
    ) |misses| {
        // From a rod (I₁ = 0 would be one) to a plate (I₃ = I₁ + I₂).
        let first = 0.1 + thickness * 0.4;
        let second = first + middle * (1.0 - first);
        let third = (second + 0.02).max(f64::min(1.0, first + second));
        prop_assume!(third < first + second);
        let moments = DVec3::new(first, second, third) * size;
        let start = DVec3::new(tilt.cos(), 0.0, tilt.sin()) * rate;
        let top = AsymmetricTop::new(moments, start);
        // Beside the separatrix the period is infinite and rounding is amplified beyond measure:
        // test A4 goes there.
        prop_assume!(top.parameter < 0.99);
        let seconds = top.period() * part;
        let advance = free(top.body(), Rk4 { time_step: 1e-3 / rate });
        let mut state = top.state();
        advance(&mut state, seconds);
        let miss = (body_rates(moments, &state) - top.rates_after(seconds)).length() / rate;
        // The steps are exact to rounding: 1e5 steps of 1e-16, times the moments' ratio (5 at most)
        // a few times over. Measured: 1e-12.
        misses.within("rates", miss, 1e-10)?;
    }
}

/// Times at which the second rate changes sign, s, by interpolation between steps.
fn flips(integrator: impl Integrator, start: DVec3, seconds: f64) -> Vec<f64> {
    let stepper = Stepper::new(Solid::with_moments(BOX))
        .unwrap()
        .with_integrator(integrator)
        .unwrap();
    let mut state = State::default().with_angular_momentum(BOX * start);
    let mut found = Vec::new();
    let mut before = (0.0, start.y);
    stepper
        .run(&mut state, seconds, &mut |sample: &tumble::Sample<'_>| {
            let now = (sample.time, body_rates(BOX, sample.state).y);
            if before.1 * now.1 < 0.0 {
                found.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
            }
            before = now;
            core::ops::ControlFlow::Continue(())
        })
        .unwrap();
    found
}

static WING_NUT: Case = Case::new(
    "A4",
    "`2K(m)/rate`",
    "Dzhanibekov; Landau & Lifshitz, Mechanics, section 37",
    || {
        // The box rotates about its middle axis, ω = (0.005, 5, 0) rad/s.
        let start = DVec3::new(0.005, 5.0, 0.0);
        let found = flips(Rk4 { time_step: 1e-3 }, start, 31.0);
        assert_eq!(found.len(), 5);
        // Printed to 5e-7 s. A relative energy error e moves a flip by about e (ω/ω₁)²/2 /growth
        // rate: roundings of 3e4 steps, of a million times that; measured 1e-7 s.
        let allowed = 1.6e-6;
        let intervals = (found[4] - found[0]) / 4.0;
        vec![
            figure(
                "box about its middle axis: first flip, s",
                3.393_201,
                found[0],
                allowed,
            ),
            figure("from flip to flip, s", 6.786_403, intervals, allowed),
        ]
    },
);

#[test]
fn a_wing_nut_flips_at_the_times_of_dzhanibekov() {
    WING_NUT.holds();
}

#[test]
fn the_flips_of_the_free_turn_are_dzhanibekovs_at_any_step() {
    // The time of a flip is interpolated by a chord: 1e-6 s for steps of 20 ms.
    let start = DVec3::new(0.005, 5.0, 0.0);
    for time_step in [0.02, 0.01, 0.005] {
        let found = flips(StrangSplitting { time_step }, start, 4.0)[0];
        let off = (found - 3.393_201_3).abs();
        assert!(off < 2e-6, "{off:e} s at {time_step} s");
    }
}

#[test]
fn a_body_turns_steadily_about_its_longest_and_its_shortest_side_and_not_about_the_middle_one() {
    // The tennis racket theorem (Ashbaugh, Chicone & Cushman 1991): a lean of a thousandth of a
    // radian stays one, or becomes half a revolution.
    let largest_lean = |axis: DVec3| {
        let stepper = Stepper::new(Solid::with_moments(BOX)).unwrap();
        let slightly = DVec3::new(1.0, 1.0, 1.0) * 0.005;
        let mut state =
            State::<f64>::default().with_angular_momentum(BOX * (axis * 5.0 + slightly));
        let fixed = state.angular_momentum.normalize();
        let mut lean: f64 = 0.0;
        for _ in 0..20_000 {
            stepper.step(&mut state).unwrap();
            lean = lean.max((state.orientation * axis).angle_between(fixed));
        }
        lean
    };
    // On an ellipse about a stable axis a lean grows by the ratio of its half axes at most:
    // √(I₃(I₃-I₁)/(I₂(I₂-I₁)))-like numbers below 3 for this box.
    assert!(largest_lean(DVec3::X) < 0.01);
    assert!(largest_lean(DVec3::Z) < 0.01);
    assert!(largest_lean(DVec3::Y) > 3.0);
}

#[test]
fn the_energy_of_an_asymmetric_free_turn_stays_for_a_million_steps() {
    // Steps of 1/20 rad: 10,000 revolutions. A step has two turns. A random walk of the roundings
    // of two million turns is 1400 units long. Three times that is allowed.
    let stepper = Stepper::new(Solid::with_moments(BOX))
        .unwrap()
        .with_integrator(StrangSplitting { time_step: 0.01 })
        .unwrap();
    let mut state = AsymmetricTop::new(BOX, DVec3::new(3.0, 0.0, 4.0)).state();
    let first = stepper.energy(&state).rotation;
    let mut worst: f64 = 0.0;
    for _ in 0..1_000_000 {
        stepper.step(&mut state).unwrap();
        worst = worst.max((stepper.energy(&state).rotation / first - 1.0).abs());
    }
    assert!(worst < 4200.0 * f64::EPSILON, "{worst:e}");
}

// -----------------------------------------------------------------------------------------------
// A6: invariants; metamorphic tests
// -----------------------------------------------------------------------------------------------

static RING: Case = Case::new(
    "A6",
    "`M r² diag(1, 1/2, 1/2)`",
    "the sum of cos² over a regular polygon",
    || {
        let storage = [ContactPoint::default(); 3];
        let triangle = Coin::ring_with_storage(storage, 1.0, 0.5);
        let places = [0, 1, 2].map(|i| triangle.contacts()[i].position);
        let cloud = PointCloud::<f64, _>::new(places, [1.0 / 3.0; 3]).unwrap();
        let inertia: DMat3 = cloud.inertia();
        // Three sums of three terms.
        let rounding = 1e-15;
        vec![
            figure(
                "three points: axial, kg m²",
                0.25,
                inertia.x_axis.x,
                rounding,
            ),
            figure("transverse, kg m²", 0.125, inertia.y_axis.y, rounding),
        ]
    },
)
.and(&[&OTHER_AXES]);

#[test]
fn three_points_have_the_moments_of_a_ring() {
    RING.holds();
}

#[test]
fn equal_points_on_a_circle_have_the_moments_of_a_ring_for_any_number_from_three() {
    // M r² diag(1, 1/2, 1/2) exactly, says the sum of cos² over a regular polygon; here by the
    // points, to the rounding of up to 200 terms, summed by Kahan: 4 units.
    for count in 3..=200 {
        let ring = Coin::ring_with_storage(vec![ContactPoint::default(); count], 1.0, 0.5);
        let masses = vec![1.0 / count as f64; count];
        let cloud = PointCloud::with_storage(ring.contacts().to_vec(), &masses).unwrap();
        let expected = DMat3::from_diagonal(DVec3::new(0.25, 0.125, 0.125));
        assert_eq!(ring.inertia(), expected);
        let miss = (cloud.inertia() - expected)
            .to_cols_array()
            .into_iter()
            .fold(0.0, |worst, entry| f64::max(worst, entry.abs()));
        assert!(miss < 4.0 * f64::EPSILON, "{count} points: {miss:e}");
        assert!(cloud.centre_of_mass().length() < 4.0 * f64::EPSILON);
    }
}

#[test]
fn a_coin_of_three_points_flies_like_one_of_a_hundred_and_twenty() {
    // The same moments, so the same bits.
    let (coin, start) = wobbling_ring();
    let coarse = Coin::ring_with_storage([ContactPoint::default(); 3], 1.0, 0.5);
    let (mut a, mut b) = (start, start);
    Stepper::new(coin).unwrap().advance(&mut a, 1.0).unwrap();
    Stepper::new(coarse).unwrap().advance(&mut b, 1.0).unwrap();
    assert_eq!(a, b);
}

random! {
    /// Checks that equal points in other body axes have a full inertia tensor instead of a diagonal
    /// one, and fly along the same paths.
    OTHER_AXES = of_rounding(100, "body in other body axes");
    fn a_body_in_other_body_axes_moves_through_the_same_places(
        body in bodies(),
        other_axes in orientations(),
        orientation in orientations(),
        axis in directions(),
        spin in log_uniform(1e-2, 1e2),
    ) |misses| {
        let straight = Solid { mass: body.mass(), inertia: body.inertia(), contacts: body.contacts().to_vec() };
        let turned = in_axes(&body, other_axes);
        let momentum = body.inertia() * (axis * spin);
        prop_assume!(momentum.length() > 0.0);
        let dt = 0.01 / spin;
        // The body may come to rotate about an axis of a lesser moment, by so many radians for one
        // that was asked for; and the tensor in other axes is rounded as its largest moment is, a
        // greater share of the least.
        let properties = InertiaProperties::new(body.mass(), body.inertia()).unwrap();
        let radians = (momentum.length() * properties.largest_inverse_moment() / spin).max(1.0);
        each_explicit!(dt, |integrator, method| {
            let mut a = State::default().with_orientation(orientation).with_angular_momentum(momentum);
            let mut b = a.with_orientation(orientation * other_axes);
            let (first, second) = (
                Stepper::new(&straight).unwrap().with_integrator(integrator).unwrap(),
                Stepper::new(&turned).unwrap().with_integrator(integrator).unwrap(),
            );
            for _ in 0..100 {
                first.step(&mut a).unwrap();
                second.step(&mut b).unwrap();
            }
            let bounding_radius = body.bounding_radius();
            for (p, q) in straight.contacts.iter().zip(&turned.contacts) {
                let miss = a.world_point(p.position).distance(b.world_point(q.position));
                // 100 steps of a few roundings, and the tensor's own, a radian. Measured: 1e-14 in
                // a body of equal moments.
                misses.within(method, miss, 1e-13 * bounding_radius * radians)?;
            }
        });
    }
}

/// Body described in axes that are rotated by `axes`.
fn in_axes(body: &AnyBody, axes: DQuat) -> Solid {
    let to_new = DMat3::from_quat(axes.conjugate());
    let inertia = to_new * body.inertia() * to_new.transpose();
    Solid {
        mass: body.mass(),
        inertia: (inertia + inertia.transpose()) * 0.5,
        contacts: (body.contacts().iter())
            .map(|contact| ContactPoint::bare(to_new * contact.position))
            .collect(),
    }
}
