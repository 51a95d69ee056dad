//! Torque-free rotation in closed form, against integrations of 30 digits, conserved quantities and
//! elementary cases.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]
// A test in single precision rounds its inputs, and a test program has the standard library.
#![allow(clippy::cast_possible_truncation, clippy::std_instead_of_alloc)]

use crate::kit::{cases, log_uniform};
use proptest::prelude::*;
use tumble::glam::{DMat3, DQuat, DVec3, Mat3};
use tumble::{FreeRotation, InertiaProperties, Rotation};

/// Row of `tests/data/free_rotation.csv`, which `tests/data/free_rotation.py` makes.
struct Row {
    kind: String,
    moments: DVec3,
    start: Rotation,
    momentum: DVec3,
    time: f64,
    /// `2 T I₂/|L|² - 1`.
    distance: f64,
    end: DQuat,
}

fn rows() -> Vec<Row> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/free_rotation.csv");
    let mut reader = csv::Reader::from_path(file).unwrap();
    reader
        .records()
        .map(|record| {
            let record = record.unwrap();
            let n = |i: usize| record[i].parse::<f64>().unwrap();
            let vector = |i| DVec3::new(n(i), n(i + 1), n(i + 2));
            let quat = |i| DQuat::from_xyzw(n(i + 1), n(i + 2), n(i + 3), n(i));
            let start = Rotation::from_quat(quat(4));
            assert_eq!(
                start.to_quat(),
                quat(4),
                "the start is stored as it is used"
            );
            Row {
                kind: record[0].into(),
                moments: vector(1),
                start,
                momentum: vector(8),
                time: n(11),
                distance: n(12),
                end: quat(14),
            }
        })
        .collect()
}

fn body(moments: DVec3) -> InertiaProperties {
    InertiaProperties::new(1.0, DMat3::from_diagonal(moments)).unwrap()
}

/// Angle of the rotation between two orientations, rad.
fn apart(a: DQuat, b: DQuat) -> f64 {
    2.0 * (a * b.conjugate()).xyz().length()
}

/// Bound of the error, rad. The direction of the angular momentum and the angle about it have some
/// roundings each. On a path next to the separatrix the rounding of the phase is multiplied by the
/// quarter period over π/2, which is 11 for a distance of 1e-12.
const ROUNDING: f64 = 20.0 * f64::EPSILON;

#[test]
fn a_thousand_revolutions_agree_with_integrations_of_thirty_digits() {
    let mut kinds = std::collections::BTreeMap::<String, (u32, f64)>::new();
    for row in rows() {
        let rotation = FreeRotation::new(&body(row.moments), row.start, row.momentum);
        let off = apart(rotation.rotation_at(row.time).to_quat(), row.end);
        let (moments, distance, time) = (row.moments, row.distance, row.time);
        assert!(
            off < ROUNDING,
            "{}, {moments}, distance {distance:e}, {time} s: {off:e} rad",
            row.kind
        );
        // One step of any method of flight is the same rotation.
        let (mass, axes) = (body(row.moments), row.start.axes());
        let step = mass.turn_freely(row.start, &axes, row.momentum, row.time);
        let off_step = apart(step.to_quat(), row.end);
        assert!(
            off_step < ROUNDING,
            "a step, {}, {moments}, distance {distance:e}, {time} s: {off_step:e} rad",
            row.kind
        );
        let (count, worst) = kinds.entry(row.kind).or_default();
        (*count, *worst) = (*count + 1, worst.max(off));
    }
    for (kind, (count, worst)) in &kinds {
        println!("{kind}: {count} rotations, largest error {worst:.1e} rad");
    }
    let count = |kind: &str| kinds[kind].0;
    assert!(
        count("generic") >= 15 && count("separatrix") >= 24,
        "{kinds:?}"
    );
    assert!(
        count("nearly equal") >= 14 && count("narrow") >= 10,
        "{kinds:?}"
    );
    assert!(count("axis") >= 6, "{kinds:?}");
}

#[test]
fn single_precision_keeps_its_digits_for_a_thousand_revolutions() {
    for row in rows() {
        let moments = row.moments.as_vec3();
        let (start, momentum) = (row.start.to_quat().as_quat(), row.momentum.as_vec3());
        let (start, time) = (tumble::f32::Rotation::from_quat(start), row.time as f32);
        let mass = InertiaProperties::<f32>::new(1.0, Mat3::from_diagonal(moments)).unwrap();
        let single = FreeRotation::new(&mass, start, momentum).rotation_at(time);
        let step = mass.turn_freely(start, &start.axes(), momentum, time);
        let single_body = mass;
        // The same numbers in double precision.
        let exact = Rotation::from_quat(start.to_quat().as_dquat());
        let mass = body(moments.as_dvec3());
        let double = FreeRotation::new(&mass, exact, momentum.as_dvec3()).rotation_at(time.into());
        let off = apart(single.to_quat().as_dquat(), double.to_quat());
        // The numbers of twice the width have a rounding of EPSILON²/4. The constants have some of
        // them, and the distance from the separatrix has a relative error of as much over itself.
        let axes = exact.axes();
        let [l, w] = [
            momentum.as_dvec3(),
            mass.angular_velocity(&axes, momentum.as_dvec3()),
        ];
        let mut sorted = moments.as_dvec3().to_array();
        sorted.sort_by(f64::total_cmp);
        let distance = (l.dot(w) * sorted[1] / l.length_squared() - 1.0)
            .abs()
            .max(1e-12);
        let angle = w.length() * f64::from(time);
        let single = f64::from(f32::EPSILON);
        let bound = 20.0 * single + 4.0 * single * single * angle / distance;
        assert!(
            off < bound,
            "{}, {moments}, {distance:e}: {off:e}, {bound:e}",
            row.kind
        );
        // The angles of two equal moments are rounded once.
        let is_wide = single_body.is_asymmetric();
        let off_step = apart(step.to_quat().as_dquat(), double.to_quat());
        assert!(
            off_step < bound || !is_wide,
            "a step, {}, {moments}, {distance:e}: {off_step:e}, {bound:e}",
            row.kind
        );
    }
}

proptest! {
    #![proptest_config(cases(4000))]

    /// The error of the numbers of twice the width, which matters in `f32` after as many radians as
    /// it has digits. The same numbers in `f64` are the reference.
    #[test]
    fn near_the_separatrix_the_error_grows_with_the_time_as_stated(
        squares in [0.1..1.0_f64, 0.1..1.0, 0.1..1.0],
        share in 0.05..1.0_f64,
        middle in -1.0..1.0_f64,
        nearness in log_uniform(1e-10, 1e-2),
        is_outside in any::<bool>(),
        revolutions in log_uniform(0.3, 8e4),
    ) {
        let [a, b, c] = squares;
        let mut moments = [b + c, a + c, a + b];
        moments.sort_by(f64::total_cmp);
        let moments = DVec3::from_array(moments).as_vec3();
        let exact = moments.as_dvec3();
        // On the separatrix, `l₁² (I₂/I₁ - 1) = l₃² (1 - I₂/I₃)`.
        let ratio = (exact.y / exact.x - 1.0) / (1.0 - exact.y / exact.z);
        prop_assume!(ratio.is_finite());
        let off = if is_outside { nearness } else { -nearness };
        let momentum = DVec3::new(share, middle, share * ratio.sqrt() * (1.0 + off)).as_vec3();
        let l = momentum.as_dvec3();
        let spin = l / exact;
        let difference = l * spin * (exact.y - exact);
        let distance = (difference.element_sum() / l.length_squared()).abs();
        let time = (revolutions * core::f64::consts::TAU / spin.length()) as f32;
        let single = InertiaProperties::<f32>::new(1.0, Mat3::from_diagonal(moments)).unwrap();
        let single = FreeRotation::new(&single, Rotation::IDENTITY, momentum).rotation_at(time);
        let double = FreeRotation::new(&body(exact), Rotation::IDENTITY, l);
        let double = double.rotation_at(time.into());
        let off = apart(single.to_quat().as_dquat(), double.to_quat());
        let unit = f64::from(f32::EPSILON);
        let grown = unit * unit / distance * spin.length() * f64::from(time);
        let near = 25.0 * unit + grown;
        prop_assert!(off < near, "{off:e} rad at {distance:e}, {grown:e}");
        if distance > 1e-3 {
            prop_assert!(off < 15.0 * unit, "{off:e} rad at {distance:e}");
        }
    }
}

/// Start and momentum without a pattern.
fn start() -> (Rotation, DVec3) {
    let start = Rotation::from_rotation_vector(DVec3::new(0.4, -1.1, 0.6));
    (start, DVec3::new(0.35, -0.5, 0.8))
}

#[test]
fn three_moments_tend_to_two_equal_ones_without_a_step() {
    let (start, momentum) = start();
    let time = 4000.0;
    // A rate changes by the relative difference of the moments.
    let angle = momentum.length() * time;
    for exponent in 2..=16 {
        let d = 10.0_f64.powi(-exponent);
        for (limit, near) in [
            (DVec3::new(1.0, 1.0, 1.7), DVec3::new(1.0, 1.0 + d, 1.7)),
            (DVec3::new(1.0, 1.0, 0.6), DVec3::new(1.0 + d, 1.0, 0.6)),
            (DVec3::ONE, DVec3::new(1.0 + 2.0 * d, 1.0 + d, 1.0)),
        ] {
            let end = |moments| {
                let rotation = FreeRotation::new(&body(moments), start, momentum);
                rotation.rotation_at(time).to_quat()
            };
            let off = apart(end(limit), end(near));
            assert!(off < 2.0 * d * angle + ROUNDING, "{near}: {off:e}");
        }
    }
}

#[test]
fn two_equal_moments_and_one_turn_by_the_elementary_form() {
    let (start, momentum) = start();
    for moments in [
        DVec3::new(1.0, 1.0, 1.7),
        DVec3::new(2.0, 0.6, 2.0),
        DVec3::splat(1.3),
        // A rod does not rotate about itself, and a point not at all.
        DVec3::new(0.0, 1.4, 1.4),
        DVec3::ZERO,
    ] {
        let mass = body(moments);
        let rotation = FreeRotation::new(&mass, start, momentum);
        for time in [0.0, 0.3, -2.0, 40.0] {
            let expected = mass.turn_freely(start, &start.axes(), momentum, time);
            let off = apart(rotation.rotation_at(time).to_quat(), expected.to_quat());
            // The expected angles are rounded.
            let bound = ROUNDING + 4.0 * f64::EPSILON * momentum.length() * time.abs() / 0.6;
            assert!(off < bound, "{moments}, {time} s: {off:e}");
        }
    }
}

prop_compose! {
    /// Bodies of any ratios of the moments, with nearly equal ones, flat ones and rods. They rotate
    /// about any axis, next to the separatrix, or next to a principal axis: moments, angular
    /// velocity in principal axes, and start.
    fn tops()(
        kind in 0_usize..4,
        about in 0_usize..5,
        parts in prop::array::uniform3(0.01..1.0_f64),
        near in prop::array::uniform2(log_uniform(1e-5, 0.1)),
        lean in log_uniform(1e-8, 0.1),
        spin in prop::array::uniform3(-1.0..1.0_f64),
        turn in prop::array::uniform3(-2.0..2.0_f64),
    ) -> (DVec3, DVec3, DQuat) {
        let [x, y, z] = match kind {
            0 => parts,
            1 => [parts[0], parts[0] * (1.0 + near[0]), parts[1]],
            2 => [near[0], near[1], 1.0],
            _ => [1e-4, 1e-4 * (1.1 + parts[0]), 1.0],
        };
        let moments = DVec3::new(y + z, z + x, x + y);
        let mut spin = DVec3::from(spin);
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| moments[i].total_cmp(&moments[j]));
        let [low, middle, high] = order;
        if let Some(axis) = DVec3::AXES.get(about) {
            spin = *axis + spin * lean;
        } else if about == 3 {
            // 2 T I₂ = |L|², but for the lean.
            spin[low] = ((moments[high] - moments[middle]) * moments[high]).sqrt();
            spin[high] = ((moments[middle] - moments[low]) * moments[low]).sqrt() * (1.0 + lean);
        }
        (moments, spin.normalize(), DQuat::from_scaled_axis(turn.into()))
    }
}

/// Rate `λ` of Jacobi's functions, rad/s.
fn rate(moments: DVec3, spin: DVec3) -> f64 {
    let (l, j) = (moments * spin, 1.0 / moments);
    let rates = [j.z - j.y, j.x - j.z, j.y - j.x];
    let squares = (0..3).map(|i| {
        let (next, third) = ((i + 1) % 3, (i + 2) % 3);
        let (a, b, c) = (rates[i], rates[next], rates[third]);
        let sum = c.abs() * (b.abs() * l[i] * l[i] + a.abs() * l[next] * l[next]);
        if a * b < 0.0 { sum } else { 0.0 }
    });
    squares.fold(0.0, f64::max).sqrt()
}

proptest! {
    #![proptest_config(cases(2000))]

    /// The series and the closed form agree on both sides of the time at which one takes over from
    /// the other: at `x = 2 λ t` of 1/2 in f64, and of 1.2 in f32.
    #[test]
    fn a_step_is_continuous_where_the_closed_form_takes_over(
        (moments, spin, turn) in tops(),
        x in prop::sample::select(vec![0.3, 0.4999, 0.5001, 1.1999, 1.2001, 3.0]),
    ) {
        let single = InertiaProperties::<f32>::new(1.0, Mat3::from_diagonal(moments.as_vec3()));
        let single = single.unwrap();
        prop_assume!(single.is_asymmetric());
        let moments = single.moments().as_dvec3();
        let mass = body(moments);
        let time = (x / (2.0 * rate(moments, spin))) as f32;
        let momentum = (turn * (moments * spin)).as_vec3();
        let start = tumble::f32::Rotation::from_quat(turn.as_quat());
        let single = single.turn_freely(start, &start.axes(), momentum, time);
        // The same numbers in double precision.
        let (start, momentum) = (start.to_quat().as_dquat(), momentum.as_dvec3());
        let (start, time) = (Rotation::from_quat(start), f64::from(time));
        let step = mass.turn_freely(start, &start.axes(), momentum, time).to_quat();
        let exact = FreeRotation::new(&mass, start, momentum).rotation_at(time).to_quat();
        // The product of momentum, inverse moment and time has some roundings, which are those of
        // the angle.
        let angle = 1.0 + momentum.length() * time / moments.min_element();
        for (off, epsilon) in [
            (apart(step, exact), f64::EPSILON),
            (apart(single.to_quat().as_dquat(), exact), f64::from(f32::EPSILON)),
        ] {
            let bound = 40.0 * epsilon * angle;
            prop_assert!(off < bound, "{moments}, {spin}, x = {x}: {off:e}, {bound:e}");
        }
    }

    /// A long step has the bits of the closed form.
    #[test]
    fn a_long_step_is_the_closed_form(
        (moments, spin, turn) in tops(),
        radians in log_uniform(0.7, 1e5),
        is_backward: bool,
    ) {
        let (mass, momentum) = (body(moments), turn * (moments * spin));
        let start = Rotation::from_quat(turn);
        let time = radians / rate(moments, spin) * if is_backward { -1.0 } else { 1.0 };
        let step = mass.turn_freely(start, &start.axes(), momentum, time);
        let exact = FreeRotation::new(&mass, start, momentum).rotation_at(time);
        prop_assert_eq!(step, exact);
    }
}

#[test]
fn a_rotation_about_a_principal_axis_is_steady_for_any_time() {
    // All numbers are exact, so that the angle is a whole number of radians: 0.25 rad/s.
    let moments = DVec3::new(1.0, 2.0, 2.5);
    for order in [
        moments,
        DVec3::new(2.5, 1.0, 2.0),
        DVec3::new(2.0, 2.5, 1.0),
    ] {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            for sign in [1.0, -1.0] {
                let velocity = axis * (0.25 * sign);
                let rotation =
                    FreeRotation::new(&body(order), Rotation::IDENTITY, order * velocity);
                for radians in [1.0, 700.0, 6283.0, -6283.0, 1e6, 1e12] {
                    let end = rotation.rotation_at(4.0 * radians).to_quat();
                    let expected = DQuat::from_scaled_axis(axis * (sign * radians));
                    // glam halves the angle in one rounding, and has the sine of std.
                    let off = apart(end, expected);
                    assert!(off < ROUNDING, "{order}, {axis}, {radians} rad: {off:e}");
                }
            }
        }
    }
}

#[test]
fn on_the_separatrix_the_body_approaches_its_middle_axis_once() {
    // L_a² (I_b/I_a - 1) = L_c² (1 - I_b/I_c) in exact numbers.
    let moments = DVec3::new(4.0, 5.0, 5.625);
    let momentum = DVec3::new(2.0, 1.5, 3.0);
    let mass = body(moments);
    let rotation = FreeRotation::new(&mass, Rotation::IDENTITY, momentum);
    // L_b = |L| tanh u, with the rate of u from Euler's equation for L_b.
    let rate = momentum.x * momentum.z * (1.0 / moments.x - 1.0 / moments.z)
        / momentum.length()
        / (1.0 - momentum.y * momentum.y / momentum.length_squared());
    let start = (momentum.y / momentum.length()).atanh();
    for time in [-1e6, -300.0, -40.0, -1.0, 0.0, 2.0, 35.0, 200.0, 1e6] {
        let end = rotation.rotation_at(time);
        let in_body = end.axes().to_body(momentum);
        let u: f64 = start + rate * time;
        let expected = DVec3::new(
            momentum.x / start.cosh().recip() * u.cosh().recip(),
            momentum.length() * u.tanh(),
            momentum.z / start.cosh().recip() * u.cosh().recip(),
        );
        // u is some 10 where the momentum still differs from its limit.
        let off = (in_body - expected).length() / momentum.length();
        assert!(off < 10.0 * ROUNDING, "{time} s: {off:e}");
    }
    // It follows the equation: steps of Strang's method, extrapolated.
    let off = apart(
        rotation.rotation_at(10.0).to_quat(),
        by_steps(&mass, Rotation::IDENTITY, momentum, 10.0),
    );
    assert!(off < 1e-10, "{off:e}");
}

/// Orientation after a time by Strang's composition in 100 000 and 200 000 steps, extrapolated. The
/// remainder is of order 4 in steps of 1e-4 rad, below the rounding of so many steps.
fn by_steps(mass: &InertiaProperties, start: Rotation, momentum: DVec3, time: f64) -> DQuat {
    let fine = |steps: u32| {
        let mut turned = start;
        for _ in 0..steps {
            turned = mass.turn_freely(turned, &turned.axes(), momentum, time / f64::from(steps));
        }
        turned.to_quat()
    };
    let (coarse, twice) = (fine(100_000), fine(200_000));
    (twice + (twice - coarse) * (1.0 / 3.0)).normalize()
}

#[test]
fn a_tilted_tensor_turns_like_the_composed_steps() {
    let (start, momentum) = start();
    let tilt = DMat3::from_quat(DQuat::from_scaled_axis(DVec3::new(0.7, 0.2, -1.3)));
    let inertia = tilt * DMat3::from_diagonal(DVec3::new(1.0, 1.4, 2.1)) * tilt.transpose();
    let mass = InertiaProperties::new(1.0, (inertia + inertia.transpose()) * 0.5).unwrap();
    let end = FreeRotation::new(&mass, start, momentum).rotation_at(10.0);
    let off = apart(end.to_quat(), by_steps(&mass, start, momentum, 10.0));
    assert!(off < 1e-11, "{off:e}");
}

#[test]
fn units_that_are_powers_of_two_change_no_bit() {
    let (start, momentum) = start();
    let moments = DVec3::new(1.0, 1.6, 2.3);
    let end = |scale: f64, size: f64, time: f64| {
        FreeRotation::new(&body(moments * size), start, momentum * scale).rotation_at(time)
    };
    let expected = end(1.0, 1.0, 77.7);
    for exponent in [-900, -300, 40, 300, 900] {
        let scale = 2.0_f64.powi(exponent);
        assert_eq!(
            end(scale, 1.0, 77.7 / scale),
            expected,
            "momentum {scale:e}"
        );
        assert_eq!(end(scale, scale, 77.7), expected, "both {scale:e}");
    }
}

#[test]
fn what_is_not_finite_has_no_orientation() {
    let (start, momentum) = start();
    let mass = body(DVec3::new(1.0, 1.6, 2.3));
    let finite =
        |rotation: FreeRotation, time: f64| rotation.rotation_at(time).to_quat().is_finite();
    assert!(!finite(
        FreeRotation::new(&mass, start, momentum * f64::NAN),
        1.0
    ));
    assert!(!finite(
        FreeRotation::new(&mass, start, momentum * f64::INFINITY),
        1.0
    ));
    assert!(!finite(FreeRotation::new(&mass, start, momentum), f64::NAN));
    assert!(!finite(
        FreeRotation::new(&mass, start, momentum),
        f64::INFINITY
    ));
    // At rest, and with any number that is finite.
    assert!(finite(
        FreeRotation::new(&mass, start, DVec3::ZERO),
        f64::MAX
    ));
    assert!(finite(FreeRotation::new(&mass, start, momentum), f64::MAX));
}

proptest! {
    #![proptest_config(cases(300))]

    /// The direction of the momentum in the body stays on its path, for any body and time.
    #[test]
    fn energy_and_momentum_hold_to_rounding(
        squares in prop::array::uniform3(-4.0..0.0_f64),
        momentum in prop::array::uniform3(-1.0..1.0_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
        time in -1e6..1e6_f64,
    ) {
        // Moments of masses on the axes, which no rule of moments excludes.
        let [x, y, z] = squares.map(|exponent| 10.0_f64.powf(exponent));
        let moments = DVec3::new(y + z, z + x, x + y);
        let momentum = DVec3::from(momentum);
        let start = Rotation::from_rotation_vector(DVec3::from(turn));
        let mass = body(moments);
        let end = FreeRotation::new(&mass, start, momentum).rotation_at(time);
        prop_assert!((end.length_squared() - 1.0).abs() < 4.0 * f64::EPSILON);
        let [before, after] = [start, end].map(|q| mass.rotational_energy(&q.axes(), momentum));
        // Components along the axes have some roundings of the whole.
        let size = momentum.length_squared() / moments.min_element();
        let bound = 20.0 * f64::EPSILON * (size * before).sqrt().max(f64::EPSILON * size);
        prop_assert!((after - before).abs() < bound, "{before:e} to {after:e}");
    }

    /// A rotation goes on from any of its orientations.
    #[test]
    fn the_rest_of_a_rotation_is_a_rotation(
        squares in prop::array::uniform3(0.1..1.0_f64),
        momentum in prop::array::uniform3(-1.0..1.0_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
        first in -4096_i32..4096,
        second in -4096_i32..4096,
    ) {
        let [x, y, z] = squares;
        let moments = DVec3::new(y + z, z + x, x + y);
        let momentum = DVec3::from(momentum);
        let start = Rotation::from_rotation_vector(DVec3::from(turn));
        let mass = body(moments);
        let [first, second] = [first, second].map(|time| f64::from(time) / 64.0);
        let whole = FreeRotation::new(&mass, start, momentum);
        let middle = whole.rotation_at(first);
        let rest = FreeRotation::new(&mass, middle, momentum).rotation_at(second);
        let off = apart(whole.rotation_at(first + second).to_quat(), rest.to_quat());
        // The middle is rounded. This shifts the phase and changes the rates, by the rounding over
        // the distance from the separatrix.
        let velocity = mass.angular_velocity(&start.axes(), momentum);
        let mut sorted = moments.to_array();
        sorted.sort_by(f64::total_cmp);
        let distance = velocity.dot(momentum) * sorted[1] / momentum.length_squared() - 1.0;
        let angle = momentum.length() / sorted[0] * second.abs();
        prop_assert!(off < ROUNDING * (1.0 + angle) / distance.abs().min(1.0), "{off:e}");
    }
}
