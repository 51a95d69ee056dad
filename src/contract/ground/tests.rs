//! Integrals, and the value and the bound that a fault of known size is reported with.

use core::cell::Cell;

use super::*;
use crate::error::Rule;
use crate::{FlatGround, GroundMotion, MeanForce};
use glam::DVec3;

const EPSILON: f64 = f64::EPSILON;
const STIFFNESS: f64 = 200.0;
const RANGE: GroundRange = GroundRange {
    centre: DVec3::ZERO,
    size: 2.0,
    depth: 0.1,
    speed: 5.0,
};

/// A level spring, of which each test changes one part.
struct Given {
    surface: fn(DVec3) -> Surface,
    spring: fn(f64) -> f64,
    energy: fn(f64) -> f64,
    normal: fn(f64, f64) -> f64,
    mean: fn(f64, f64) -> f64,
    motion: Option<GroundMotion>,
    bounds: GroundBounds,
    /// Calls of `normal_force`.
    calls: Cell<u32>,
}

impl Given {
    fn spring() -> Self {
        Self {
            surface: |point| Surface {
                gap: point.z,
                normal: DVec3::Z,
            },
            spring: |depth| STIFFNESS * depth,
            energy: |depth| STIFFNESS / 2.0 * depth * depth,
            normal: |depth, _| STIFFNESS * depth,
            mean: |start, end| STIFFNESS / 2.0 * (start + end),
            motion: None,
            bounds: GroundBounds::Everywhere,
            calls: Cell::new(0),
        }
    }
}

impl SpringDamperGround for Given {
    fn surface(&self, point: DVec3) -> Surface {
        (self.surface)(point)
    }
    fn spring_force(&self, depth: f64) -> f64 {
        (self.spring)(depth)
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        (self.energy)(depth)
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        self.calls.set(self.calls.get() + 1);
        (self.normal)(depth, closing_speed)
    }
    fn mean_force(&self, start: f64, end: f64, _: f64) -> MeanForce {
        MeanForce {
            force: (self.mean)(start, end),
            slope: 0.0,
            stiffness: 0.0,
            damping: 0.0,
        }
    }
    fn motion(&self) -> Option<GroundMotion> {
        self.motion
    }
    fn bounds(&self) -> GroundBounds {
        self.bounds
    }
}

fn check(ground: &Given) -> Check<'_, f64, Given> {
    Check {
        ground,
        range: &RANGE,
    }
}

/// Asserts that a number is another one to some rounding.
fn assert_near(found: f64, expected: f64) {
    assert_to(1e-12, found, expected);
}

fn assert_to(share: f64, found: f64, expected: f64) {
    let off = (found - expected).abs();
    assert!(off <= share * expected.abs(), "{found:e}, not {expected:e}");
}

fn assert_found(found: Result<(), Violation>, requirement: Requirement) -> Violation {
    let violation = found.expect_err("a fault");
    assert_eq!(violation.requirement, requirement);
    violation
}

/// Length of the paths along which the gap is compared, m.
fn short_path() -> f64 {
    RANGE.size * EPSILON.sqrt().sqrt()
}

#[test]
fn a_gap_that_changes_too_fast_is_told_beside_what_rounding_explains() {
    let ground = Given {
        surface: |point| Surface {
            gap: 1.5 * point.z,
            normal: DVec3::Z,
        },
        ..Given::spring()
    };
    let place = DVec3::new(0.3, 0.4, 0.2);
    let violation = assert_found(
        check(&ground).gap_along(place, DVec3::Z),
        Requirement::GapAlongNormal,
    );
    assert_to(1e-9, violation.value, 0.5 * short_path());
    let Input::Displacement { from, to } = violation.input else {
        panic!("{:?}", violation.input);
    };
    assert_to(1e-9, (to - from).length(), short_path());
    assert_near(0.5 * (from + to).distance(DVec3::ZERO), place.length());
    let numbers = place.length() + RANGE.size + 1.5 * (from.z.abs() + to.z.abs());
    assert_near(violation.bound, 32.0 * EPSILON * numbers);
}

#[test]
fn where_the_normal_bends_the_gap_may_deviate_by_the_largest_difference_of_two_normals() {
    fn at_angle(angle: f64) -> DVec3 {
        DVec3::new(angle.sin(), 0.0, angle.cos())
    }
    fn bent(point: DVec3, [before, middle, after]: [f64; 3]) -> Surface {
        let angle = match point.z.total_cmp(&0.2) {
            core::cmp::Ordering::Less => before,
            core::cmp::Ordering::Equal => middle,
            core::cmp::Ordering::Greater => after,
        };
        Surface {
            gap: 1e3 * (point.z - 0.2),
            normal: at_angle(angle),
        }
    }
    let grounds: [(fn(DVec3) -> Surface, f64); 3] = [
        (|point| bent(point, [0.0, 0.1, 0.3]), 0.3),
        (|point| bent(point, [0.0, 0.5, 0.1]), 0.5),
        (|point| bent(point, [0.4, 0.6, 0.0]), 0.6),
    ];
    for (surface, largest) in grounds {
        let ground = Given {
            surface,
            ..Given::spring()
        };
        let found = check(&ground).gap_along(DVec3::Z * 0.2, DVec3::Z);
        let violation = assert_found(found, Requirement::GapAlongNormal);
        // The distance of two unit vectors, and rounding.
        let bend = 2.0 * f64::sin(largest / 2.0) * short_path();
        assert_to(1e-8, violation.bound, bend);
    }
}

#[test]
fn a_gap_beyond_the_size_of_the_region_is_not_compared() {
    let constant = |gap: fn(DVec3) -> Surface| Given {
        surface: gap,
        ..Given::spring()
    };
    let at_the_size = constant(|_| Surface {
        gap: RANGE.size,
        normal: DVec3::Z,
    });
    let beyond = constant(|_| Surface {
        gap: 1.01 * RANGE.size,
        normal: DVec3::Z,
    });
    let along = |ground: &Given| check(ground).gap_along(DVec3::ZERO, DVec3::Z);
    assert_found(along(&at_the_size), Requirement::GapAlongNormal);
    assert_eq!(along(&beyond), Ok(()));
}

#[test]
fn a_motion_through_the_surface_is_told_at_the_foot_of_the_place() {
    let normal = DVec3::new(0.6, 0.0, 0.8);
    let motion = GroundMotion {
        velocity: DVec3::new(3.0, 1.0, -2.0),
        angular_velocity: DVec3::new(0.5, 0.7, 2.0),
    };
    let slope = |motion| Given {
        surface: |point| Surface {
            gap: DVec3::new(0.6, 0.0, 0.8).dot(point) - 0.1,
            normal: DVec3::new(0.6, 0.0, 0.8),
        },
        motion: Some(motion),
        ..Given::spring()
    };
    let place = DVec3::new(0.3, -0.4, 0.9);
    let found = |ground: &Given| {
        let surface = ground.surface(place);
        check(ground).motion_along(&surface, place)
    };
    let violation = assert_found(found(&slope(motion)), Requirement::MotionAlongSurface);
    let foot = place - normal * (normal.dot(place) - 0.1);
    let across = (motion.velocity + motion.angular_velocity.cross(foot)).dot(normal);
    assert_near(violation.value, across.abs());
    let fastest = motion.velocity.length() + motion.angular_velocity.length() * foot.length();
    assert_near(violation.bound, 64.0 * EPSILON * fastest);

    let along = GroundMotion {
        velocity: DVec3::new(-0.8, 2.0, 0.6),
        angular_velocity: DVec3::ZERO,
    };
    assert_eq!(found(&slope(along)), Ok(()));
    // The check of the surface contains it.
    let everywhere = check(&slope(motion)).surface_everywhere(CheckPlan::default());
    assert_found(everywhere, Requirement::MotionAlongSurface);
}

#[test]
fn the_distance_from_a_plane_is_rounded_by_all_numbers_in_it() {
    let plane = Plane::level(-3.0);
    let ground = Given::spring();
    let place = DVec3::new(2.0, 3.0, 6.0);
    let rounding = check(&ground).rounding(&plane, place);
    assert_near(rounding, 32.0 * EPSILON * (7.0 + 3.0 + RANGE.size));
    let wrong = Given {
        bounds: GroundBounds::Plane(plane),
        ..Given::spring()
    };
    let found = check(&wrong).plane_holds_at(&plane, place);
    let violation = assert_found(found, Requirement::GroundBounds);
    assert_near(violation.value, 3.0);
    assert_near(violation.bound, rounding);
}

#[test]
fn a_damper_that_drives_is_told_by_its_power() {
    let ground = Given {
        normal: |depth, _| 3.0 * STIFFNESS * depth,
        ..Given::spring()
    };
    let found = check(&ground).law_at(0.05, -3.0);
    let violation = assert_found(found, Requirement::DamperTakes);
    // Spring and damper have 10 N and 20 N.
    assert_near(violation.value, -60.0);
    assert_near(violation.bound, -(40.0 * 3.0 * 8.0 * EPSILON));
    assert_eq!(check(&ground).law_at(0.05, 3.0), Ok(()));
}

/// Slack of a change of the energy, J, for a spring whose stored energies are `share` of the true
/// ones.
fn slack_of_energy(share: f64, from: f64, to: f64) -> f64 {
    let energy = |depth: f64| share * STIFFNESS / 2.0 * depth * depth;
    let sum = (energy(from) + energy(to)) * 256.0;
    let terms = STIFFNESS * RANGE.depth * to * 8.0;
    (sum + terms + energy(RANGE.depth) * 1024.0) * EPSILON
}

#[test]
fn an_energy_that_is_not_the_integral_of_the_force_is_told_with_the_slack_of_both() {
    let ground = Given {
        energy: |depth| 1.1 * STIFFNESS / 2.0 * depth * depth,
        ..Given::spring()
    };
    for (from, to) in [(0.03, 0.08), (0.0, 0.1), (0.05, 0.06)] {
        let found = check(&ground).energy_between(from, to);
        let violation = assert_found(found, Requirement::EnergyIsIntegral);
        let work = STIFFNESS / 2.0 * (to * to - from * from);
        assert_to(1e-9, violation.value, 0.1 * work);
        let (_, doubt) = integral(from, to, |depth| STIFFNESS * depth);
        let slack = slack_of_energy(1.1, from, to) + work * 256.0 * EPSILON + doubt;
        assert_to(1e-9, violation.bound, slack);
    }
}

#[test]
fn an_energy_that_falls_is_told_with_its_slack() {
    let ground = Given {
        energy: |depth| 0.01 - 0.05 * depth,
        ..Given::spring()
    };
    let found = check(&ground).energy_between(0.02, 0.1);
    let violation = assert_found(found, Requirement::SpringEnergyRises);
    assert_to(1e-9, violation.value, -0.05 * 0.08);
    let sum = (0.009 + 0.005) * 256.0 + STIFFNESS * 0.1 * 0.1 * 8.0 + 0.005 * 1024.0;
    assert_to(1e-9, violation.bound, -sum * EPSILON);
}

#[test]
fn the_error_that_underflow_leaves_is_the_square_of_the_rounding() {
    let ground = Given::spring();
    let largest = STIFFNESS / 2.0 * RANGE.depth * RANGE.depth;
    assert_near(check(&ground).least_energy(), largest * EPSILON * EPSILON);
    assert_near(
        check(&ground).rounding_of_energy(),
        largest * 1024.0 * EPSILON,
    );
}

#[test]
fn a_mean_force_that_stores_too_little_is_told_with_its_slack() {
    let ground = Given {
        mean: |start, end| STIFFNESS / 4.0 * (start + end),
        ..Given::spring()
    };
    let (start, end) = (0.06, 0.09);
    let found = check(&ground).mean_force_between(start, end, 1.0);
    let violation = assert_found(found, Requirement::MeanForceTakes);
    let energy = |depth: f64| STIFFNESS / 2.0 * depth * depth;
    let (before, after) = (energy(start), energy(end));
    let work = 0.5 * (after - before);
    assert_to(1e-9, violation.value, work);
    let slack = (before + after + work) * 256.0 + energy(RANGE.depth) * 1024.0;
    // What is left of a difference of numbers near 1 J.
    assert_to(1e-3, (after - before) - violation.bound, slack * EPSILON);
}

#[test]
fn a_mean_force_that_is_not_the_mean_is_told_with_five_percent_of_the_largest_force() {
    let ground = Given {
        mean: |start, end| STIFFNESS / 2.0 * (start + end) + 4.0,
        ..Given::spring()
    };
    let (start, end) = (0.03, 0.06);
    let seconds = 0.03;
    let found = check(&ground).mean_force_between(start, end, 1.0);
    let violation = assert_found(found, Requirement::MeanForceIsMean);
    assert_to(1e-9, violation.value, 4.0);
    let (_, largest) = check(&ground).mean_by_definition(start, end, seconds);
    let rounding = STIFFNESS / 2.0 * RANGE.depth * RANGE.depth * 1024.0 * EPSILON;
    assert_to(1e-3, violation.bound - 0.05 * largest, rounding / 0.03);
}

#[test]
fn a_mean_force_of_a_body_that_stays_where_no_spring_pushes_has_the_slack_of_an_underflow() {
    let ground = Given {
        spring: |depth| STIFFNESS * (depth - 0.05).max(0.0),
        energy: |depth| STIFFNESS / 2.0 * (depth - 0.05).max(0.0).powi(2),
        normal: |depth, _| STIFFNESS * (depth - 0.05).max(0.0),
        mean: |_, _| 1.0,
        ..Given::spring()
    };
    let found = check(&ground).mean_force_between(0.03, 0.03, 1.0);
    let violation = assert_found(found, Requirement::MeanForceIsMean);
    assert_near(violation.value, 1.0);
    let largest = STIFFNESS / 2.0 * 0.05 * 0.05;
    assert_to(
        1e-9,
        violation.bound,
        largest * EPSILON * EPSILON / RANGE.depth,
    );
}

#[test]
fn a_path_shorter_than_ten_thousand_roundings_of_its_depth_has_the_force_of_its_middle() {
    for (depth, share, is_short) in [
        (0.05, 0.9, true),
        (0.05, 1.1, false),
        (1e-6, 0.9, true),
        (1e-6, 1.1, false),
        (0.05, -0.9, true),
        (0.05, -1.1, false),
    ] {
        let ground = Given::spring();
        let path = share * 2.0 * depth * 1e4 * EPSILON;
        let (mean, _) = check(&ground).mean_by_definition(depth, depth + path, 1.0);
        assert_to(1e-4, mean, STIFFNESS * depth);
        assert_eq!(ground.calls.get() == 1, is_short, "{depth} {share}");
    }
}

#[test]
fn what_the_ends_of_an_integral_may_hide_is_the_deviation_from_a_line() {
    // For x² that deviation is the product of the distances of the two points of the line.
    let [near, _] = UNIT_3[0];
    for (border, width) in [(1.0, 0.5), (3.0, -0.25)] {
        let found = unseen(&mut |x: f64| x * x, border, width);
        let expected = near * 0.5 * width * width * (width * near).abs();
        assert_to(1e-6, found, expected);
    }
    assert!(unseen(&mut |x: f64| 7.0 - 3.0 * x, 1.0, 0.5) < 1e-14);
}

#[test]
fn the_integral_of_a_polynomial_of_degree_5_is_exact() {
    let (found, doubt) = integral(0.5_f64, 2.0, |x| x.powi(5));
    let exact = (2.0_f64.powi(6) - 0.5_f64.powi(6)) / 6.0;
    assert!((found - exact).abs() < 1e-14, "{found}");
    // The ends are allowed the deviation from a line over a hundredth of the path.
    assert!(doubt < 1e-3, "{doubt}");
}

#[test]
fn the_bound_of_an_integral_holds_wherever_its_function_jumps() {
    for number in 0..=1000 {
        let jump = 0.3 + f64::from(number) * 2e-3;
        let (found, bound) = integral(0.3_f64, 2.3, |x| if x > jump { 7.0 } else { 3.0 });
        let exact = 3.0 * (jump - 0.3) + 7.0 * (2.3 - jump);
        let off = (found - exact).abs();
        assert!(off <= bound + 1e-14, "at {jump}: {off} exceeds {bound}");
        // Four times the jump over a part of the coarsest partition, 2/7 long, and as much
        // again for the others.
        assert!(bound < 8.0 * 4.0 * 2.0 / 7.0, "at {jump}: {bound}");
    }
}

#[test]
fn the_mean_force_of_a_spring_is_that_of_its_path() {
    let ground = FlatGround::level(200.0, 0.0);
    let range = GroundRange {
        centre: DVec3::ZERO,
        size: 1.0,
        depth: 0.1,
        speed: 1.0,
    };
    let check = Check {
        ground: &ground,
        range: &range,
    };
    for (start, end, mean, largest) in [
        (0.0, 0.1, 10.0, 20.0),
        (0.1, 0.0, 10.0, 20.0),
        (0.04, 0.1, 14.0, 20.0),
        // A quarter of the path is deeper than 0.
        (-0.3, 0.1, 2.5, 20.0),
        (0.1, -0.3, 2.5, 20.0),
        (0.05, 0.05, 10.0, 10.0),
        // So short that the middle is the mean.
        (0.05, 0.05 + 1e-15, 10.0, 10.0),
    ] {
        let (found, most) = check.mean_by_definition(start, end, 1.0);
        assert!((found - mean).abs() < 1e-10, "{start} to {end}: {found}");
        // The outermost points of the rule are a little inside.
        assert!(most <= largest + 1e-10 && most > 0.99 * largest, "{most}");
    }
}

#[test]
fn an_invalid_range_is_told_by_its_quantity() {
    let faults: [(fn(&mut GroundRange), &str, Rule, f64); 6] = [
        (
            |range| range.centre.z = f64::INFINITY,
            "a component of the centre of the range",
            Rule::Finite,
            f64::INFINITY,
        ),
        (
            |range| range.size = 0.0,
            "size of the range",
            Rule::AboveZero,
            0.0,
        ),
        (
            |range| range.depth = -0.05,
            "depth of the range",
            Rule::AboveZero,
            -0.05,
        ),
        (
            |range| range.depth = f64::NAN,
            "depth of the range",
            Rule::Finite,
            f64::NAN,
        ),
        (
            |range| range.speed = 0.0,
            "speed of the range",
            Rule::AboveZero,
            0.0,
        ),
        (
            |range| range.speed = f64::INFINITY,
            "speed of the range",
            Rule::Finite,
            f64::INFINITY,
        ),
    ];
    let ground = FlatGround::level(STIFFNESS, 0.5);
    assert_eq!(check_ground(&ground, &RANGE, CheckPlan::default()), Ok(()));
    for (fault, quantity, rule, value) in faults {
        let mut range = RANGE;
        fault(&mut range);
        let violation = check_ground(&ground, &range, CheckPlan::default()).expect_err(quantity);
        let requirement = Requirement::Composes { quantity, rule };
        assert_eq!(violation.requirement, requirement);
        assert!(violation.value.total_cmp(&value).is_eq(), "{violation}");
        let sentence = std::format!("{violation}");
        assert!(sentence.contains(quantity), "{sentence}");
    }
}
