//! The thresholds of the limiter, each from both sides.

#![allow(clippy::float_cmp, reason = "what is not changed has the same bits")]

use super::*;
use crate::{
    Coin, Coulomb, FlatGround, Frictionless, Gravity, MovingGround, NoGravity, NoGround, PointMass,
    Scene, Sphere, SpringDamperGround, UniformGravity,
};
use glam::{DQuat, DVec3, Vec3};

type Coins<G = FlatGround, A = UniformGravity> = Scene<Coin, G, Coulomb, A>;

const STIFFNESS: f64 = 1000.0;
const MASS: f64 = 2.0;
const GRAVITY: f64 = 9.8;
const WEIGHT: f64 = MASS * GRAVITY;
const RADIUS: f64 = 0.5;
const FRICTION: Coulomb = Coulomb {
    coefficient: 0.3,
    slip_speed: 1e-3,
};

/// Coin of 2 kg with 120 contacts.
fn coin_on<G: SpringDamperGround, A: Gravity>(ground: G, gravity: A) -> Coins<G, A> {
    Scene::new(Coin::ring(MASS, RADIUS), ground, FRICTION, gravity).unwrap()
}

fn coin() -> Coins {
    let ground = FlatGround::level(STIFFNESS, 0.5);
    coin_on(ground, UniformGravity::down(GRAVITY))
}

/// Depth at which springs of all contacts bear this share of the weight, m.
fn depth(share: f64) -> f64 {
    share * WEIGHT / (120.0 * STIFFNESS)
}

/// Coin that lies flat on its springs, 3 m from the origin, and moves no more than a little.
fn lying() -> State {
    State::at(DVec3::new(3.0, 0.0, -depth(1.0)))
        .with_orientation(DQuat::from_rotation_y(core::f64::consts::FRAC_PI_2))
        .with_linear_velocity(DVec3::new(0.0, 0.0, 1e-20))
}

/// Coin that lies as deep as springs with this share of its weight.
fn at(share: f64) -> State {
    displaced(&lying(), DVec3::Z * (depth(1.0) - depth(share)))
}

fn displaced(state: &State, path: DVec3) -> State {
    let mut state = *state;
    state.position += path;
    state
}

fn rests<G: SpringDamperGround, A: Gravity>(scene: &Coins<G, A>, states: [&State; 2]) -> bool {
    let [before, after] = states.map(|state| Energy::of(scene, state));
    has_come_to_rest(scene, states, [&before, &after], 1e-3)
}

#[test]
fn a_coin_that_lies_on_its_springs_and_slows_down_is_at_rest() {
    let slower = lying().with_linear_velocity(DVec3::new(0.0, 0.0, 0.9e-20));
    assert!(rests(&coin(), [&lying(), &slower]));
}

#[test]
fn a_body_that_moves_by_more_than_its_numbers_resolve_is_not_at_rest() {
    let start = lying().with_linear_velocity(DVec3::ZERO);
    // Along x the position of 3 m is resolved, along y the bounding radius.
    for (axis, resolved) in [(DVec3::X, 3.0 + RADIUS), (DVec3::Y, RADIUS)] {
        for sign in [-1.0, 1.0] {
            let moved =
                |units: f64| displaced(&start, axis * (sign * units * resolved * f64::EPSILON));
            assert!(rests(&coin(), [&start, &moved(0.7)]), "{axis} {sign}");
            assert!(!rests(&coin(), [&start, &moved(1.7)]), "{axis} {sign}");
        }
    }
    let sunk = |units: f64| displaced(&start, -DVec3::Z * (units * RADIUS * f64::EPSILON));
    assert!(rests(&coin(), [&start, &sunk(0.7)]));
    assert!(!rests(&coin(), [&start, &sunk(1.7)]));
}

#[test]
fn a_body_that_turns_by_more_than_its_numbers_resolve_is_not_at_rest() {
    let start = lying().with_linear_velocity(DVec3::ZERO);
    let turned = |x: f64, z: f64| {
        let mut state = start;
        state.orientation = DQuat::from_xyzw(
            start.orientation.x + x,
            start.orientation.y,
            start.orientation.z + z,
            start.orientation.w,
        );
        state
    };
    for sign in [-1.0, 1.0] {
        let (less, more) = (0.9 * sign * f64::EPSILON, 1.1 * sign * f64::EPSILON);
        assert!(rests(&coin(), [&start, &turned(less, less)]));
        assert!(!rests(&coin(), [&start, &turned(more, 0.0)]));
        assert!(!rests(&coin(), [&start, &turned(0.0, more)]));
    }
}

#[test]
fn a_body_whose_motion_is_more_than_the_rounding_of_its_energy_is_not_at_rest() {
    let rounding = rounding_of(
        &Energy::of(&coin(), &lying()),
        &Energy::of(&coin(), &lying()),
    );
    let with_energy = |share: f64| {
        let speed = (2.0 * share * rounding / MASS).sqrt();
        lying().with_linear_velocity(DVec3::new(speed, 0.0, 0.0))
    };
    let spinning = |share: f64| {
        // L²/(2 I), with I = m r²/2 about a diameter.
        let momentum = (share * rounding * MASS * RADIUS * RADIUS).sqrt();
        lying().with_angular_momentum(DVec3::new(0.0, momentum, 0.0))
    };
    let slow = with_energy(1e-3);
    assert!(rests(&coin(), [&with_energy(0.9), &slow]));
    assert!(!rests(&coin(), [&with_energy(1.1), &slow]));
    assert!(rests(&coin(), [&spinning(0.9), &slow]));
    assert!(!rests(&coin(), [&spinning(1.1), &slow]));
}

#[test]
fn a_body_that_gains_speed_is_at_rest_only_where_rounding_explains_it() {
    let start = lying().with_linear_velocity(DVec3::ZERO);
    let scene = coin();
    let numbers = depth(1.0) + RADIUS;
    let stiffness = WEIGHT * WEIGHT / (2.0 * Energy::of(&scene, &start).springs);
    assert!((stiffness / (120.0 * STIFFNESS) - 1.0).abs() < 1e-6);
    let impulse = 1e-3 * (stiffness * numbers + WEIGHT) * 8.0 * f64::EPSILON;
    let faster = |share: f64| start.with_linear_velocity(DVec3::X * (share * impulse / MASS));
    assert!(rests(&scene, [&start, &faster(0.99)]));
    assert!(!rests(&scene, [&start, &faster(1.01)]));
    let spinning = |share: f64| {
        let momentum = share * impulse * RADIUS;
        start.with_angular_momentum(DVec3::Y * momentum)
    };
    assert!(rests(&scene, [&start, &spinning(0.99)]));
    assert!(!rests(&scene, [&start, &spinning(1.01)]));
    assert!(!rests(&scene, [&faster(2.0), &faster(2.1)]));
    // What slows down needs no such reason, as long as it was in motion.
    assert!(rests(&scene, [&faster(2.0), &faster(1.9)]));
    assert!(rests(&scene, [&faster(2.0), &faster(2.0)]));
}

/// Springs so soft that the weight compresses them by the bounding radius: the weight and the
/// stiffness times the lengths are then of one size.
#[test]
fn rounding_explains_the_speed_that_the_weight_gives_in_a_step() {
    let stiffness = WEIGHT / (120.0 * RADIUS);
    let ground = FlatGround::level(stiffness, 0.5);
    let scene = coin_on(ground, UniformGravity::down(GRAVITY));
    let mut start = lying().with_linear_velocity(DVec3::ZERO);
    start.position.z = -RADIUS;
    let impulse = 1e-3 * (120.0 * stiffness * 2.0 * RADIUS + WEIGHT) * 8.0 * f64::EPSILON;
    let faster = |share: f64| start.with_linear_velocity(DVec3::X * (share * impulse / MASS));
    assert!(rests(&scene, [&start, &faster(0.99)]));
    assert!(!rests(&scene, [&start, &faster(1.01)]));
}

#[test]
fn a_body_is_at_rest_only_where_its_contacts_support_half_of_its_weight() {
    let scene = coin();
    for (share, supported) in [(0.49, false), (0.51, true), (1.5, true), (-1.0, false)] {
        assert_eq!(is_supported(&scene, &at(share)), supported, "{share}");
        assert_eq!(
            rests(&scene, [&at(share), &at(share)]),
            supported,
            "{share}"
        );
    }
}

#[test]
fn a_body_on_a_ground_that_moves_is_not_at_rest() {
    let still = FlatGround::level(STIFFNESS, 0.5);
    let belt = MovingGround::conveyor(still, DVec3::X);
    let scene = coin_on(belt, UniformGravity::down(GRAVITY));
    assert!(!rests(&scene, [&lying(), &lying()]));
}

/// Energies of distinct sizes.
fn energies() -> [Energy; 2] {
    let before = Energy {
        translation: 4.0,
        rotation: 2.0,
        gravity: 10.0,
        springs: 1.0,
    };
    let after = Energy {
        gravity: 7.0,
        springs: -0.5,
        ..before
    };
    [before, after]
}

#[test]
fn the_rounding_of_a_sum_is_that_of_its_terms() {
    let [before, after] = energies();
    let terms = 4.0 + 2.0 + 7.0 + 0.5 + 10.0 + 1.0;
    let rounding = rounding_of(&before, &after);
    assert!((rounding / (64.0 * f64::EPSILON * terms) - 1.0).abs() < 1e-12);
    let below = Energy {
        gravity: -7.0,
        ..after
    };
    assert_eq!(rounding_of(&before, &below), rounding);
}

#[test]
fn a_step_has_no_solution_if_it_gains_a_quarter_of_what_it_can_convert() {
    let [before, after] = energies();
    for work in [-2.0, 2.0] {
        // The motion, the springs, the fall and the work of the ground.
        let convertible = 4.0 + 2.0 + 1.0 + 3.0 + 2.0;
        let with_gain = |share: f64| Energy {
            translation: 0.0,
            rotation: before.total() + work + share * convertible / 4.0 - 7.0 + 0.5,
            ..after
        };
        assert!(!is_no_solution([&before, &with_gain(0.999)], work));
        assert!(is_no_solution([&before, &with_gain(1.001)], work));
    }
    // A body that rises converts as much as one that falls.
    let risen = Energy {
        gravity: 13.0,
        ..before
    };
    let with_gain = |share: f64| Energy {
        translation: 4.0 - 3.0 + share * 10.0 / 4.0,
        ..risen
    };
    assert!(!is_no_solution([&before, &with_gain(0.999)], 0.0));
    assert!(is_no_solution([&before, &with_gain(1.001)], 0.0));
}

#[test]
fn a_body_that_its_step_has_not_lowered_falls_by_two_units_in_the_last_place() {
    let gravity = UniformGravity {
        acceleration: DVec3::new(0.0, -3.0, -4.0),
    };
    let scene = coin_on(FlatGround::level(STIFFNESS, 0.5), gravity);
    let start = State::at(DVec3::new(1.0, 2.0, 30.0));
    // Along a level of the potential.
    let end = State::at(start.position + DVec3::new(0.5, 4.0, -3.0));
    let (lower, energy) = fallen(&scene, [&start, &end], 0).unwrap();
    let path = lower.position - end.position;
    let height = gravity.acceleration.dot(end.position).abs() / 5.0;
    let along = path.dot(gravity.acceleration) / 5.0;
    assert!(
        (along / (2.0 * f64::EPSILON * height) - 1.0).abs() < 0.3,
        "{along:e}"
    );
    assert_eq!(energy, Energy::of(&scene, &lower));
    assert!(energy.gravity < Energy::of(&scene, &end).gravity);

    let moved = |last_places: f64| State::at(end.position - DVec3::Z * (last_places * 3e-15));
    // The energy shows a fall by more, and a body that rises needs no help to move.
    assert!(fallen(&scene, [&start, &moved(1.0)], 0).is_some());
    assert!(fallen(&scene, [&start, &moved(5.0)], 0).is_none());
    assert!(fallen(&scene, [&start, &moved(-1.0)], 0).is_none());
    let weightless = coin_on(FlatGround::level(STIFFNESS, 0.5), NoGravity);
    assert!(fallen(&weightless, [&start, &end], 0).is_none());
}

#[test]
fn a_body_that_touches_falls_only_where_it_is_not_supported() {
    let scene = coin();
    assert!(fallen(&scene, [&at(0.4), &at(0.4)], 120).is_some());
    assert!(fallen(&scene, [&at(0.6), &at(0.6)], 120).is_none());
    assert!(fallen(&scene, [&at(0.6), &at(0.6)], 0).is_some());
}

#[test]
fn an_end_without_gain_keeps_the_old_velocity_or_the_old_place() {
    let start = State::at(DVec3::X)
        .with_linear_velocity(DVec3::Y)
        .with_angular_momentum(DVec3::Z);
    let end = State::at(DVec3::Z)
        .with_orientation(DQuat::from_rotation_x(1.0))
        .with_linear_velocity(-DVec3::X)
        .with_angular_momentum(-DVec3::Y);
    let [coasting, turning] = without_gain(&start, &end);
    assert_eq!(coasting.position, end.position);
    assert_eq!(coasting.orientation, end.orientation);
    assert_eq!(coasting.linear_velocity, start.linear_velocity);
    assert_eq!(coasting.angular_momentum, start.angular_momentum);
    assert_eq!(turning.position, start.position);
    assert_eq!(turning.orientation, end.orientation);
    assert_eq!(turning.linear_velocity, end.linear_velocity);
    assert_eq!(turning.angular_momentum, end.angular_momentum);
}

#[test]
fn an_end_is_slowed_as_far_as_its_ceiling_asks_and_stopped_if_nothing_else_helps() {
    let scene = coin();
    let end = State::at(DVec3::Z)
        .with_linear_velocity(DVec3::new(1.0, 2.0, -2.0))
        .with_angular_momentum(DVec3::new(0.3, 0.1, 0.2));
    let after = Energy::of(&scene, &end);
    let (same, energy) = lowered(&scene, after.total(), &end, after).unwrap();
    assert!(same == end && energy == after);

    let excess = 1e-3;
    let ceiling = after.total() - excess;
    let (slowed, energy) = lowered(&scene, ceiling, &end, after).unwrap();
    // Rounding may ask for twice the excess.
    let total = energy.total();
    assert!(total <= ceiling && total > ceiling - 1.001 * excess);
    assert_eq!(energy, Energy::of(&scene, &slowed));
    assert_eq!(slowed.position, end.position);
    let factor = slowed.linear_velocity.x;
    assert!(factor < 1.0);
    let same_factor = slowed.angular_momentum - end.angular_momentum * factor;
    assert!(same_factor.length() < 1e-15);

    // All of the motion is not enough, but a body without motion is low enough.
    let potential = after.gravity + after.springs;
    let (halted, energy) = lowered(&scene, potential, &end, after).unwrap();
    assert_eq!(halted.linear_velocity, DVec3::ZERO);
    assert_eq!(halted.angular_momentum, DVec3::ZERO);
    assert_eq!(energy.total(), potential);
    assert!(lowered(&scene, potential - 1e-9, &end, after).is_none());
    assert!(lowered(&scene, f64::NEG_INFINITY, &end, after).is_none());
    assert!(lowered(&scene, f64::NAN, &end, after).is_none());
}

/// A point of 2 kg in the air that a step has moved, with this gain of energy in J.
fn held(gain: f64) -> (bool, State, Energy, Step) {
    let body = PointMass::new(MASS);
    let ground = FlatGround::level(STIFFNESS, 0.5);
    let scene = Scene::new(body, ground, FRICTION, UniformGravity::down(GRAVITY)).unwrap();
    let mut state = State::at(DVec3::Z).with_linear_velocity(DVec3::new(3.0, 0.0, 0.0));
    let mut energy = Energy::of(&scene, &state);
    let lower = State::at(DVec3::new(0.1, 0.0, 0.9));
    let speed = (2.0 / MASS * (energy.total() - WEIGHT * 0.9 + gain)).sqrt();
    let end = lower.with_linear_velocity(DVec3::new(0.6 * speed, 0.0, -0.8 * speed));
    let after = Energy::of(&scene, &end);
    let touched = Touched {
        touching: 0,
        is_lossless: false,
        work: 0.0,
    };
    let mut step = Step::new(1e-3, 1);
    let done = hold(
        &scene,
        (&mut state, &mut energy),
        (&end, &after),
        touched,
        &mut step,
    );
    assert_eq!(energy, Energy::of(&scene, &state));
    (done, state, energy, step)
}

#[test]
fn a_step_in_flight_ends_at_most_with_the_energy_of_its_start() {
    let before = WEIGHT + MASS * 4.5;
    // A loss is kept, a gain taken from the velocity and reported.
    let (done, state, energy, step) = held(-0.25);
    assert!(done && state.position.z == 0.9 && step.energy_removed == 0.0);
    assert!((energy.total() - before + 0.25).abs() < 1e-12);
    let (done, state, energy, step) = held(0.25);
    assert!(done && state.position.z == 0.9);
    assert!(energy.total() <= before && energy.total() > before - 1e-12);
    assert!((step.energy_removed - 0.25).abs() < 1e-12);
    // A gain of more than a quarter of what falls and moves is no solution.
    let convertible = MASS * 4.5 + 0.1 * WEIGHT;
    assert!(held(0.24 * convertible).0);
    let (done, state, energy, _) = held(0.26 * convertible);
    assert!(!done && state.position.z == 1.0 && energy.total() == before);
}

/// Limits a step of a scene with these ends, contacts that touch, and work of the ground in J.
fn limited<G: SpringDamperGround>(
    scene: &Coins<G>,
    [start, end]: [State; 2],
    touching: usize,
    work: f64,
) -> (bool, State, Step) {
    let (mut state, mut energy) = (start, Energy::of(scene, &start));
    let touched = Touched {
        touching,
        is_lossless: false,
        work,
    };
    let mut step = Step::new(1e-3, 1);
    step.energy_removed = 8.0;
    step.drive_work = 16.0;
    let ends = (&end, &Energy::of(scene, &end));
    let done = hold_down(scene, (&mut state, &mut energy), ends, touched, &mut step);
    assert_eq!(energy, Energy::of(scene, &state));
    (done, state, step)
}

#[test]
fn the_work_of_a_ground_that_moves_is_no_gain() {
    let belt = MovingGround::conveyor(FlatGround::level(STIFFNESS, 0.5), DVec3::X);
    let scene = coin_on(belt, UniformGravity::down(GRAVITY));
    let start = State::at(DVec3::Z).with_linear_velocity(DVec3::X);
    // 1 J more than the start, of which 0.75 J is work.
    let end = State::at(DVec3::Z).with_linear_velocity(DVec3::X * 2.0_f64.sqrt());
    let (done, state, step) = limited(&scene, [start, end], 3, 0.75);
    assert!(done && (step.energy_removed - 8.25).abs() < 1e-12);
    assert_eq!(step.drive_work, 16.75);
    assert!((Energy::of(&scene, &state).translation - 1.75).abs() < 1e-12);
    // A ground at rest does none, whatever the sum of the contacts says.
    let (_, _, step) = limited(&coin(), [start, end], 3, 0.75);
    assert_eq!(step.drive_work, 16.0);
}

/// A start of 1 m/s or less, and an end above it without motion, that has gained this many units
/// in the last place of its energy.
fn turning_point(speed: f64, units: f64) -> [State; 2] {
    let start = State::at(DVec3::Z).with_linear_velocity(DVec3::X * speed);
    let before = Energy::of(&coin(), &start).total();
    let height = before / WEIGHT * (1.0 + units * f64::EPSILON);
    [start, State::at(DVec3::Z * height)]
}

#[test]
fn a_slow_body_that_touches_stops_where_it_was() {
    let (done, state, step) = limited(&coin(), turning_point(1e-9, 8.0), 3, 0.0);
    assert!(done && state == State::at(DVec3::Z));
    assert!(step.energy_removed == 8.0 && step.drive_work == 16.0);
    // More than the rounding of its energy it may not gain.
    let [start, end] = turning_point(1e-9, 1e4);
    let (done, state, _) = limited(&coin(), [start, end], 3, 0.0);
    assert!(!done && state == start);
}

#[test]
fn at_a_turning_point_a_step_in_contact_is_refused_and_one_in_flight_keeps_the_old_place() {
    let [start, end] = turning_point(1.0, 8.0);
    let (done, state, _) = limited(&coin(), [start, end], 3, 0.0);
    assert!(!done && state == start);
    let (done, state, step) = limited(&coin(), [start, end], 0, 0.0);
    assert!(done && state == State::at(DVec3::Z));
    assert!(step.energy_removed == 8.0 && step.drive_work == 16.0);
    let [start, end] = turning_point(1.0, 1e4);
    let (done, state, _) = limited(&coin(), [start, end], 0, 0.0);
    assert!(!done && state == start);
}

#[test]
fn a_spinning_body_that_touches_is_not_slow() {
    // L²/(2 I) = 1 J, with I = m r²/2 about an axis of the body.
    let start =
        State::at(DVec3::Z).with_angular_momentum(DVec3::X * (MASS * RADIUS * RADIUS).sqrt());
    let before = Energy::of(&coin(), &start);
    assert!(before.translation == 0.0 && before.rotation > 0.4);
    let height = before.total() / WEIGHT * (1.0 + 8.0 * f64::EPSILON);
    let end = State::at(DVec3::Z * height);
    let (done, state, _) = limited(&coin(), [start, end], 3, 0.0);
    assert!(!done && state == start);
}

#[test]
fn a_body_in_flight_whose_height_has_not_changed_falls_and_keeps_its_speed() {
    let belt = MovingGround::conveyor(FlatGround::level(STIFFNESS, 0.5), DVec3::X);
    let scene = coin_on(belt, UniformGravity::down(GRAVITY));
    let start = State::at(DVec3::Z).with_linear_velocity(DVec3::X);
    let level = State::at(DVec3::new(1e-3, 0.0, 1.0));
    for work in [0.0, 0.75] {
        let speed = (1.0 + work + 4.0 * f64::EPSILON).sqrt();
        let end = level.with_linear_velocity(DVec3::X * speed);
        let (done, state, step) = limited(&scene, [start, end], 0, work);
        assert!(done && state.position.z < 1.0 && state.position.x == 1e-3);
        assert_eq!(state.linear_velocity, end.linear_velocity);
        assert!(step.energy_removed == 8.0 && step.drive_work == 16.0 + work);
    }
}

/// A gain that is too small to be taken from the speed, because the energy is that of the height.
#[test]
fn a_body_at_the_top_of_its_flight_keeps_its_place_and_takes_the_new_speed() {
    let belt = MovingGround::conveyor(FlatGround::level(STIFFNESS, 0.5), DVec3::X);
    let scene = coin_on(belt, UniformGravity::down(GRAVITY));
    let start = State::at(DVec3::Z).with_linear_velocity(DVec3::X * 1e-9);
    // The sum of the work of the ground and 16 J does not round.
    for work in [0.0, 2.0_f64.powi(-40)] {
        let height = 1.0 + work / WEIGHT + 4.0 * f64::EPSILON;
        let end = State::at(DVec3::Z * height).with_linear_velocity(DVec3::X * 0.9e-9);
        let (done, state, step) = limited(&scene, [start, end], 0, work);
        assert!(done && state == start.with_linear_velocity(end.linear_velocity));
        assert!(step.energy_removed == 8.0 && step.drive_work == 16.0 + work);
    }
}

#[test]
fn a_step_that_loses_energy_is_kept_with_the_work_of_the_ground() {
    let belt = MovingGround::conveyor(FlatGround::level(STIFFNESS, 0.5), DVec3::X);
    let scene = coin_on(belt, UniformGravity::down(GRAVITY));
    let start = State::at(DVec3::Z).with_linear_velocity(DVec3::X);
    let (mut state, mut energy) = (start, Energy::of(&scene, &start));
    let end = start.with_linear_velocity(DVec3::X * 1.1);
    let touched = Touched {
        touching: 3,
        is_lossless: false,
        work: 0.75,
    };
    let mut step = Step::new(1e-3, 1);
    step.drive_work = 16.0;
    let ends = (&end, &Energy::of(&scene, &end));
    let known = (&mut state, &mut energy);
    assert!(hold(&scene, known, ends, touched, &mut step));
    assert!(state == end && step.drive_work == 16.75);
}

/// The position is almost perpendicular to gravity: the potential energy is a small difference of
/// large terms, and rounded by more than its own last places.
#[test]
fn in_single_precision_a_flight_has_the_rounding_of_the_terms_of_its_potential_energy() {
    let gravity = UniformGravity {
        acceleration: Vec3::new(0.0, -3.0, -4.0),
    };
    let body = Sphere::<f32>::solid(2.0, 0.1);
    let scene = Scene::new(body, NoGround, Frictionless, gravity).unwrap();
    let mut state = State::at(Vec3::new(0.0, 4000.0, -3000.0)).with_linear_velocity(Vec3::X * 3.0);
    let mut energy = Energy::of(&scene, &state);
    let before = energy.total();
    let end = State::at(Vec3::new(3e-3, 4000.0 - 4000.0 * 1e-7, -3000.0))
        .with_linear_velocity(state.linear_velocity);
    let after = Energy::of(&scene, &end);
    assert!(before - after.total() > 10.0 * rounding_of(&energy, &after));
    let touched = Touched {
        touching: 0,
        is_lossless: false,
        work: 0.0,
    };
    let mut step = Step::new(1e-3, 1);
    let ends = (&end, &after);
    let known = (&mut state, &mut energy);
    assert!(hold(&scene, known, ends, touched, &mut step));
    assert!(energy.total() <= before);
    assert!(before - energy.total() < 0.1 * (before - after.total()));
}
