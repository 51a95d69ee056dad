//! Energy of the explicit integrators: it may increase by an amount that depends on the method, and
//! that decreases with the step size at the method's order. Also tests the stability limit of one
//! contact from both sides.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use crate::kit::{self, Solid, each_explicit, log_uniform, order, point_mass};
use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    ContactPoint, FlatGround, ForwardEuler, Integrator, Nystrom, Rk4, State, StrangSplitting,
    SymplecticEuler, UniformGravity,
};

/// A table on four soft springs without friction and damping, so that the energy is conserved.
///
/// It compresses them by 0.245 m and never leaves one, so the motion is smooth. Three different
/// moments, unequal legs, and oscillations of a fifth of a radian make it nonlinear.
fn table() -> (Solid, FlatGround, UniformGravity, State) {
    let leg = |x, y| ContactPoint::bare(DVec3::new(x, y, -0.1));
    let body = Solid {
        contacts: vec![
            leg(0.5, 0.4),
            leg(-0.5, 0.3),
            leg(-0.4, -0.5),
            leg(0.4, -0.3),
        ],
        ..Solid::with_moments(DVec3::new(0.1, 0.16, 0.22))
    };
    let start = State::at(DVec3::Z * -0.12)
        .with_rotation_vector(DVec3::new(0.15, 0.1, 0.0))
        .with_linear_velocity(DVec3::new(0.3, 0.0, 0.2))
        .with_angular_momentum(DVec3::new(0.02, -0.01, 0.2));
    (
        body,
        FlatGround::level(10.0, 0.0),
        UniformGravity::down(9.8),
        start,
    )
}

/// Largest distance from the first energy in two parts of a run of the table: its first tenth and
/// its last.
fn energy_error_of_the_table(integrator: impl Integrator, seconds: f64) -> [f64; 2] {
    let (body, ground, gravity, mut state) = table();
    let stepper = Stepper::new(body)
        .unwrap()
        .with_ground(ground)
        .unwrap()
        .with_gravity(gravity)
        .unwrap()
        .with_integrator(integrator)
        .unwrap();
    let first = stepper.energy(&state).total();
    let mut worst = [0.0, 0.0];
    stepper
        .run(&mut state, seconds, &mut |sample: &tumble::Sample<'_>| {
            assert_eq!(sample.touching(), 4, "the table has left a spring");
            let error = (sample.energy().total() - first).abs();
            if sample.time <= 0.1 * seconds {
                worst[0] = f64::max(worst[0], error);
            } else if sample.time >= 0.9 * seconds {
                worst[1] = f64::max(worst[1], error);
            }
            core::ops::ControlFlow::Continue(())
        })
        .unwrap();
    worst
}

#[test]
fn the_error_of_a_conserved_energy_shrinks_with_the_step_at_the_order_of_the_method() {
    // Three halvings, each of which must show the order to 0.15. The coarsest step resolves the
    // fastest oscillation (13 rad/s) by 20 steps or more. Forward Euler starts with shorter ones,
    // because it would throw the table off its springs. The energy is about 0.2 J, and its
    // rounding, 1e-15 J a step, is far below the smallest error.
    each_explicit!(0.02, |integrator, method| {
        let coarsest = if method == "ForwardEuler" { 1e-3 } else { 0.02 };
        let errors = [1.0, 0.5, 0.25, 0.125].map(|share| {
            let finer = kit::with_time_step(integrator, coarsest * share);
            let [early, late] = energy_error_of_the_table(finer, 2.0);
            f64::max(early, late)
        });
        let p = f64::from(Integrator::<f64>::order(&integrator));
        for pair in errors.windows(2) {
            let measured = order(pair[0], pair[1]);
            assert!(
                measured > p - 0.15,
                "{method}: order {measured} of {errors:?}"
            );
        }
    });
}

#[test]
fn the_energy_of_symplectic_methods_swings_and_does_not_drift() {
    // 500 s, about 500 oscillations of the table. A drift of a thousandth of the oscillation each
    // time would add up to half of it.
    for [early, late] in [
        energy_error_of_the_table(SymplecticEuler { time_step: 0.005 }, 500.0),
        energy_error_of_the_table(StrangSplitting { time_step: 0.005 }, 500.0),
    ] {
        assert!(late < 1.2 * early, "{early:e} at first, {late:e} at last");
    }
}

/// The fraction by which a bounce changes the energy depends on the phase of its touch-down, so
/// that many bounces are a random walk.
#[test]
fn a_bounce_changes_the_energy_of_symplectic_euler_by_its_phase() {
    let time_step = 1e-3;
    for turn in [0.3, 0.9, 1.6_f64] {
        let stepper = Stepper::new(tumble::PointMass::new(1.0))
            .and_then(|s| s.with_ground(FlatGround::level((turn / time_step).powi(2), 0.0)))
            .and_then(|s| s.with_integrator(SymplecticEuler { time_step }))
            .unwrap();
        let energy_after = |phase: f64| {
            let mut state = State::at(DVec3::Z * (phase * time_step + 1e-9));
            state.linear_velocity = -DVec3::Z;
            while state.linear_velocity.z < 0.0 || state.position.z < 0.0 {
                stepper.step(&mut state).unwrap();
            }
            state.linear_velocity.length_squared()
        };
        let energies = (0..100_u8).map(|part| energy_after(f64::from(part) / 100.0));
        let [least, most] = energies.fold([1.0_f64; 2], |[least, most], energy| {
            [least.min(energy), most.max(energy)]
        });
        let x = turn * turn / 4.0;
        assert!(least >= 1.0 - x - 1e-6 && most <= 1.0 / (1.0 - x) + 1e-6);
        assert!(
            least < 1.0 - x / 2.0 && most > 1.0 + x / 2.0,
            "{turn}: {least} to {most}"
        );
    }
}

#[test]
fn the_energy_of_an_undamped_contact_grows_without_end_under_forward_euler() {
    // Why it is the baseline and no more: |λ|² = 1 + (ω dt)² a step on a spring.
    let [early, late] = energy_error_of_the_table(ForwardEuler { time_step: 0.001 }, 10.0);
    assert!(late > 5.0 * early, "{early:e} at first, {late:e} at last");
}

proptest! {
    #![proptest_config(kit::cases(200))]

    /// `z' = z + v dt`, `v' = v - g dt`: the half step of the parabola is missing, and the energy
    /// of translation increases by `M g² dt²/2` in each step.
    #[test]
    fn forward_euler_gains_half_of_m_g2_dt2_in_every_step_of_flight(
        mass in log_uniform(1e-6, 1e6),
        g in log_uniform(1e-3, 1e3),
        dt in log_uniform(1e-6, 1.0),
        speed in -100.0..100.0_f64,
    ) {
        let stepper = Stepper::new(point_mass(mass)).unwrap()
            .with_gravity(UniformGravity::down(g)).unwrap()
            .with_integrator(ForwardEuler { time_step: dt }).unwrap();
        let mut state = State::default().with_linear_velocity(DVec3::new(1.0, 0.0, speed));
        let steps = 100;
        let first = stepper.energy(&state).total();
        // Rounding: a few units of the largest energy of a kind in each step.
        let mut largest = first;
        for _ in 0..steps {
            stepper.step(&mut state).unwrap();
            let energy = stepper.energy(&state);
            largest = largest.max(energy.translation).max(energy.gravity.abs());
        }
        let gain = stepper.energy(&state).total() - first;
        let expected = f64::from(steps) * mass * g * g * dt * dt / 2.0;
        let rounding = f64::from(steps) * 4.0 * f64::EPSILON * largest;
        prop_assert!((gain - expected).abs() <= rounding, "{gain:e}, not {expected:e} to {rounding:e}");
    }

    /// Semi-implicit Euler leaves `v² + ω² z² - ω² dt z v` as it is while on a spring, and meets
    /// the surface at a part f of a step. So the speed after an elastic bounce obeys
    /// `v₁² (1 - f₁(1 - f₁) (ω dt)²) = v₀² (1 - f₀(1 - f₀) (ω dt)²)` exactly, and the energies
    /// differ by at most `(ω dt)²/4`. Strang's splitting without dampers makes the same sequence,
    /// half a step apart.
    #[test]
    fn a_bounce_on_springs_changes_the_energy_by_at_most_a_quarter_of_the_step_squared(
        mass in log_uniform(1e-6, 1e6),
        stiffness in log_uniform(1.0, 1e12),
        phase in log_uniform(1e-3, 1.9),
        speed in log_uniform(1e-3, 1e3),
        part in 0.0..1.0_f64,
    ) {
        let frequency = (stiffness / mass).sqrt();
        let dt = phase / frequency;
        let ground = FlatGround::level(stiffness, 0.0);
        let start = State::at(DVec3::Z * (speed * dt * part)).with_linear_velocity(DVec3::Z * -speed);
        let bound = phase * phase / 4.0;
        // Rounding: the bounce takes π/phase steps, a few units of 1.1e-16 each.
        let rounding = 1e-15 * (1.0 + 4.0 / phase);
        let space = Stepper::new(point_mass(mass)).unwrap().with_ground(ground).unwrap();
        let semi_implicit = space.with_integrator(SymplecticEuler { time_step: dt }).unwrap();
        let strang = space.with_integrator(StrangSplitting { time_step: dt }).unwrap();
        let bounced = |step: &dyn Fn(&mut State)| {
            let mut state = start;
            // On the springs for half an oscillation, π/phase steps, and one before, one after.
            let mut turned = -phase;
            while turned < 4.0 + phase {
                step(&mut state);
                turned += phase;
            }
            state.linear_velocity.z
        };
        let speeds = [
            bounced(&|state| { semi_implicit.step(state).unwrap(); }),
            bounced(&|state| { strang.step(state).unwrap(); }),
        ];
        for after in speeds {
            prop_assert!(after > 0.0, "it has not left");
            let ratio = (after / speed).powi(2);
            prop_assert!(ratio >= (1.0 - bound) * (1.0 - rounding), "{ratio} {bound}");
            prop_assert!(ratio <= (1.0 + rounding) / (1.0 - bound), "{ratio} {bound}");
        }
    }
}

/// Growth of a small oscillation about rest in one step, on average.
///
/// The body is a single point on its spring and damper under gravity, so near to rest that it never
/// leaves the ground. The size of the oscillation is `√(z² + (v/ω)²)` from rest. Stops early if it
/// has grown a hundredfold, or decreased to rounding.
fn growth(integrator: impl Integrator, mass: f64, frequency: f64, ratio: f64) -> f64 {
    let stiffness = mass * frequency * frequency;
    let damping = 2.0 * ratio * frequency * mass;
    // Gravity such that rest is 1 m under the surface, whatever the spring.
    let stepper = Stepper::new(point_mass(mass))
        .unwrap()
        .with_ground(FlatGround::level(stiffness, damping))
        .unwrap()
        .with_gravity(UniformGravity::down(frequency * frequency))
        .unwrap()
        .with_integrator(integrator)
        .unwrap();
    // At this position and speed every mode of every method takes part.
    let swing = 1e-6;
    let mut state = State::at(DVec3::Z * (swing - 1.0))
        .with_linear_velocity(DVec3::Z * (0.3 * swing * frequency));
    let size = |state: &State| (state.position.z + 1.0).hypot(state.linear_velocity.z / frequency);
    let first = size(&state);
    let mut steps = 0;
    let mut last = first;
    while steps < 400_000 && last < 100.0 * first && last > 1e-6 * first {
        stepper.step(&mut state).unwrap();
        steps += 1;
        last = size(&state);
    }
    (last / first).powf(1.0 / f64::from(steps)) - 1.0
}

/// Checks that a method damps an oscillation at `margin` below its limit and amplifies it at
/// `margin` above.
fn stable_up_to<I: Integrator>(
    limit: f64,
    margin: f64,
    [mass, frequency, ratio]: [f64; 3],
    with_step: impl Fn(f64) -> I,
) -> Result<(), TestCaseError> {
    let below = growth(with_step(limit * (1.0 - margin)), mass, frequency, ratio);
    let above = growth(with_step(limit * (1.0 + margin)), mass, frequency, ratio);
    prop_assert!(
        below < 0.0,
        "grows by {below:e} a step below {limit:e} s, damping ratio {ratio}"
    );
    prop_assert!(
        above > 0.0,
        "shrinks by {above:e} a step above {limit:e} s, damping ratio {ratio}"
    );
    Ok(())
}

/// The damping ratio and the step beyond which Strang's splitting grows: where `|λ| = 1` for the
/// product of its three matrices, `4 - 4ζy + (4ζ² - 1) y² + ζ y³ = 0` or `ζy = 1` (determinant
/// `1 - 2ζy + 2ζ²y²` of 1), with `y = ω dt`.
fn limit_of_strang_splitting(ratio: f64) -> f64 {
    let oscillates = |y: f64| {
        4.0 - 4.0 * ratio * y + (4.0 * ratio * ratio - 1.0) * y * y + ratio * y * y * y > 0.0
    };
    let stable = |y: f64| oscillates(y) && ratio * y < 1.0;
    // The first step that is not, to 1e-6.
    (1..)
        .map(|i| f64::from(i) * 1e-6)
        .find(|&y| !stable(y))
        .unwrap()
}

proptest! {
    #![proptest_config(kit::cases(24))]

    /// `dt < damping/stiffness` while underdamped: `|λ|² = 1 - c dt + ω² dt²`.
    #[test]
    fn forward_euler_is_stable_up_to_damping_over_stiffness(
        mass in log_uniform(1e-3, 1e3), frequency in log_uniform(0.1, 1e4), ratio in 0.1..0.95_f64,
    ) {
        let limit = 2.0 * ratio / frequency;
        stable_up_to(limit, 0.03, [mass, frequency, ratio], |time_step| ForwardEuler { time_step })?;
    }

    /// `dt < 2 (√(1+ζ²) - ζ)/ω`, for every damping.
    #[test]
    fn symplectic_euler_is_stable_up_to_the_limit_that_its_documentation_states(
        mass in log_uniform(1e-3, 1e3), frequency in log_uniform(0.1, 1e4), ratio in log_uniform(0.01, 100.0),
    ) {
        let limit = 2.0 * ((1.0 + ratio * ratio).sqrt() - ratio) / frequency;
        stable_up_to(limit, 0.01, [mass, frequency, ratio], |time_step| SymplecticEuler { time_step })?;
    }

    /// The lesser of `2/ω` and `2 m/C`, which its documentation states, is never beyond the limit
    /// and close to it at both ends. Between them the limit is up to 4.57/ω, at ζ = 0.219.
    #[test]
    fn strang_splitting_is_stable_up_to_the_limit_of_its_matrix(
        mass in log_uniform(1e-3, 1e3), frequency in log_uniform(0.1, 1e4), ratio in log_uniform(0.01, 100.0),
    ) {
        let exact = limit_of_strang_splitting(ratio);
        let stated = f64::min(2.0, 1.0 / ratio);
        let close = stated > 0.97 * exact || (0.1..0.5).contains(&ratio);
        prop_assert!(stated <= exact + 1e-6 && close, "{stated} stated, {exact} exact");
        let method = StrangSplitting { time_step: 1.0 };
        let own = method.largest_stable_step(1.0, 2.0 * ratio).unwrap();
        prop_assert!((own - exact).abs() < 2e-6, "{own}, not {exact}");
        stable_up_to(exact / frequency, 0.005, [mass, frequency, ratio], |time_step| StrangSplitting { time_step })?;
    }

    /// `|1 + x + x²/2 + x³/6 + x⁴/24| < 1` on the imaginary axis up to `2√2`: `dt < 2.83/ω`.
    #[test]
    fn runge_kutta_without_dampers_is_stable_up_to_2_83_over_the_frequency(
        mass in log_uniform(1e-3, 1e3), frequency in log_uniform(0.1, 1e4),
    ) {
        stable_up_to(2.828 / frequency, 0.005, [mass, frequency, 0.0], |time_step| Rk4 { time_step })?;
    }

    /// Limit on the negative real axis up to 2.785: `dt < 2.79 m/C`, to the digits stated.
    #[test]
    fn runge_kutta_with_dampers_alone_is_stable_up_to_2_79_m_over_c(
        mass in log_uniform(1e-3, 1e3), frequency in log_uniform(0.1, 1e4), ratio in log_uniform(20.0, 60.0),
    ) {
        // The spring slows the damper's decay by 1/4ζ² of it: 6e-4 at most, within the margin.
        stable_up_to(2.785 / (2.0 * ratio * frequency), 0.003, [mass, frequency, ratio], |time_step| Rk4 { time_step })?;
    }

    /// Step size at which the spectral radius of its matrix exceeds 1: at `ω dt = 3.082` for
    /// `ζ = 0.1`, to the digits stated.
    #[test]
    fn nystroms_method_with_weak_dampers_is_stable_up_to_3_08_over_the_frequency(
        mass in log_uniform(1e-3, 1e3), frequency in log_uniform(0.1, 1e4),
    ) {
        stable_up_to(3.082 / frequency, 0.005, [mass, frequency, 0.1], |time_step| Nystrom { time_step })?;
    }

    /// Its velocities are those of a Runge-Kutta method of order 4 in four stages. All such methods
    /// have one stability function, that of `Rk4`.
    #[test]
    fn nystroms_method_with_dampers_alone_is_stable_up_to_2_79_m_over_c(
        mass in log_uniform(1e-3, 1e3), frequency in log_uniform(0.1, 1e4), ratio in log_uniform(20.0, 60.0),
    ) {
        stable_up_to(2.785 / (2.0 * ratio * frequency), 0.006, [mass, frequency, ratio], |time_step| Nystrom { time_step })?;
    }

    /// `|λ| = 1 + 2.1e-4 y⁶ - ζ y` with `y = ω dt`, to leading order: calm and wild on both sides
    /// of `ζ = 2.1e-4 y⁵`.
    #[test]
    fn nystroms_method_whips_up_a_swing_that_is_next_to_undamped(
        mass in log_uniform(1e-3, 1e3), frequency in log_uniform(0.1, 1e4), y in 0.3..0.6_f64,
    ) {
        let ratio = 2.1e-4 * y.powi(5);
        let method = Nystrom { time_step: y / frequency };
        // The next term of the series is 3 % at y = 0.6.
        let growth = [1.2, 0.8].map(|share| growth(method, mass, frequency, share * ratio));
        prop_assert!(growth[0] < 0.0 && growth[1] > 0.0, "{growth:?} at {y}");
    }
}
