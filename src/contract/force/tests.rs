//! The value and the bound that a fault of known size is reported with.

use core::cell::Cell;

use super::*;
use crate::error::Rule;
use crate::force::{ForcePower, Wrench};
use crate::rotation::Rotation;
use glam::DVec3;

const RANGE: ForceRange = ForceRange {
    centre: DVec3::ZERO,
    size: 1.0,
    speed: 5.0,
    angular_speed: 30.0,
};
const VELOCITY: DVec3 = DVec3::new(3.0, -4.0, 12.0);
const SPIN: DVec3 = DVec3::new(2.0, 6.0, -9.0);

/// A force of which each test gives the parts.
struct Given {
    wrench: fn(&Motion) -> Wrench,
    power: fn(&Motion) -> ForcePower,
    is_passive: bool,
    acts: fn(u32) -> bool,
    /// Number of calls of the constant part, of the wrench and of `acts` so far.
    calls: [Cell<u32>; 3],
    constant: fn(u32) -> Option<DVec3>,
    /// Force and torque that are added at each call but the first.
    later: Wrench,
}

impl Given {
    fn none() -> Self {
        Self {
            wrench: |_| Wrench::ZERO,
            power: |_| power(0.0, 0.0),
            is_passive: false,
            acts: |_| true,
            calls: Default::default(),
            constant: |_| None,
            later: Wrench::ZERO,
        }
    }
}

impl Force for Given {
    fn wrench(&self, motion: &Motion) -> Wrench {
        let before = self.calls[1].replace(self.calls[1].get() + 1);
        let wrench = (self.wrench)(motion);
        if before == 0 {
            wrench
        } else {
            wrench.plus(&self.later, 1.0)
        }
    }
    fn is_passive(&self) -> bool {
        self.is_passive
    }
    fn constant_force(&self) -> Option<DVec3> {
        let before = self.calls[0].replace(self.calls[0].get() + 1);
        (self.constant)(before)
    }
    fn power(&self, motion: &Motion) -> ForcePower {
        (self.power)(motion)
    }
    fn acts(&self) -> bool {
        let before = self.calls[2].replace(self.calls[2].get() + 1);
        (self.acts)(before)
    }
}

fn power(drag: f64, drive: f64) -> ForcePower {
    ForcePower { drag, drive }
}

fn moving() -> Motion {
    Motion {
        position: DVec3::ZERO,
        axes: Rotation::IDENTITY.axes(),
        linear_velocity: VELOCITY,
        angular_velocity: SPIN,
    }
}

fn check(force: &Given) -> Check<'_, f64, Given> {
    Check::of(force, &RANGE)
}

fn assert_found(found: Result<(), Violation>, requirement: Requirement, [value, bound]: [f64; 2]) {
    let violation = found.expect_err("a fault");
    assert_eq!(violation.requirement, requirement);
    for (found, expected) in [(violation.value, value), (violation.bound, bound)] {
        let off = (found - expected).abs();
        assert!(off <= 1e-12 * expected.abs(), "{found:e}, not {expected:e}");
    }
}

/// Rounding of a power of a force of 2 N at 13 m/s and a torque of 3 N m at 11 rad/s.
const ROUNDING: f64 = (2.0 * 13.0 + 3.0 * 11.0) * 16.0 * f64::EPSILON;

fn along(motion: &Motion, [force, torque]: [f64; 2]) -> Wrench {
    Wrench {
        force: motion.linear_velocity * (force / 13.0),
        torque: motion.angular_velocity * (torque / 11.0),
    }
}

#[test]
fn a_passive_force_that_works_is_told_by_its_power() {
    let force = Given {
        wrench: |motion| along(motion, [2.0, -3.0]),
        power: |_| power(-7.0, 0.0),
        is_passive: true,
        ..Given::none()
    };
    assert_eq!(check(&force).power(&moving()), Ok(()));
    let force = Given {
        wrench: |motion| along(motion, [-2.0, 3.0]),
        ..force
    };
    let found = check(&force).power(&moving());
    assert_found(found, Requirement::PassiveTakes, [7.0, ROUNDING]);
    let force = Given {
        wrench: |motion| along(motion, [-2.0, -3.0]),
        power: |_| power(-60.0, 1.0),
        ..force
    };
    let found = check(&force).power(&moving());
    assert_found(found, Requirement::PassiveTakes, [1.0, 0.0]);
}

#[test]
fn a_drag_that_drives_and_a_sum_that_is_not_the_power_are_told_with_the_rounding() {
    let force = Given {
        wrench: |motion| along(motion, [2.0, 3.0]),
        power: |_| power(4.0, 55.0),
        ..Given::none()
    };
    let found = check(&force).power(&moving());
    assert_found(found, Requirement::PassiveTakes, [4.0, ROUNDING]);
    let force = Given {
        power: |_| power(-4.0, 58.0),
        ..force
    };
    let found = check(&force).power(&moving());
    assert_found(found, Requirement::PowerFits, [5.0, ROUNDING]);
    let force = Given {
        power: |_| power(-4.0, 63.0),
        ..force
    };
    assert_eq!(check(&force).power(&moving()), Ok(()));
}

#[test]
fn force_and_torque_count_where_a_force_does_not_act_or_changes() {
    let force = Given {
        wrench: |motion| along(motion, [2.0, 3.0]),
        acts: |_| false,
        ..Given::none()
    };
    let found = check(&force).motion(&moving());
    assert_found(found, Requirement::ActsOrZero, [5.0, 0.0]);
    for (later, change) in [
        (
            Wrench {
                force: DVec3::X,
                torque: DVec3::Y * 2.0,
            },
            3.0,
        ),
        (
            Wrench {
                force: DVec3::X,
                torque: DVec3::ZERO,
            },
            1.0,
        ),
        (
            Wrench {
                force: DVec3::ZERO,
                torque: DVec3::Y * 2.0,
            },
            2.0,
        ),
    ] {
        let force = Given {
            later,
            ..Given::none()
        };
        let found = check(&force).motion(&moving());
        assert_found(found, Requirement::SameBits, [change, 0.0]);
    }
}

#[test]
fn a_constant_part_that_changes_is_found() {
    let force = Given {
        constant: |call| Some(DVec3::X * f64::from(call)),
        ..Given::none()
    };
    assert_found(check(&force).constant(), Requirement::SameBits, [1.0, 0.0]);
    let force = Given {
        constant: |call| (call == 0).then_some(DVec3::ZERO),
        ..Given::none()
    };
    assert_found(check(&force).constant(), Requirement::SameBits, [1.0, 0.0]);
    let force = Given {
        constant: |_| Some(DVec3::X),
        ..Given::none()
    };
    assert_eq!(check(&force).constant(), Ok(()));
}

#[test]
fn a_constant_part_or_an_acts_that_changes_late_is_found() {
    let late = Given {
        constant: |call| Some(DVec3::X * if call < 50 { 1.0 } else { 2.0 }),
        ..Given::none()
    };
    let idle = Given {
        acts: |call| call < 50,
        ..Given::none()
    };
    let alternating = Given {
        acts: |call| call % 2 == 0,
        ..Given::none()
    };
    for force in [late, idle, alternating] {
        let found = check_force(&force, &RANGE, CheckPlan::default());
        assert_found(found, Requirement::SameBits, [1.0, 0.0]);
    }
    let same = Given {
        constant: |_| Some(DVec3::X),
        ..Given::none()
    };
    assert_eq!(check_force(&same, &RANGE, CheckPlan::default()), Ok(()));
}

#[test]
fn the_largest_number_of_cases_does_not_overflow() {
    let broken = Given {
        wrench: |_| Wrench::of_force(DVec3::NAN),
        ..Given::none()
    };
    let plan = CheckPlan {
        seed: 0,
        cases: u32::MAX,
    };
    let violation = check_force(&broken, &RANGE, plan).expect_err("a force that is NaN");
    assert_eq!(violation.requirement, Requirement::Finite);
}

#[test]
fn an_invalid_range_is_told_by_its_quantity_and_a_range_of_one_motion_passes() {
    let change = |change: fn(&mut ForceRange)| {
        let mut range = RANGE;
        change(&mut range);
        check_force(&Given::none(), &range, CheckPlan::default())
    };
    let faults: [(fn(&mut ForceRange), &str, Rule); 5] = [
        (
            |range| range.centre.y = f64::NAN,
            "a component of the centre of the range",
            Rule::Finite,
        ),
        (
            |range| range.size = -1.0,
            "size of the range",
            Rule::AtLeastZero,
        ),
        (
            |range| range.size = f64::INFINITY,
            "size of the range",
            Rule::Finite,
        ),
        (
            |range| range.speed = -1.0,
            "speed of the range",
            Rule::AtLeastZero,
        ),
        (
            |range| range.angular_speed = f64::NAN,
            "angular speed of the range",
            Rule::Finite,
        ),
    ];
    for (fault, quantity, rule) in faults {
        let violation = change(fault).expect_err(quantity);
        let requirement = Requirement::Composes { quantity, rule };
        assert_eq!(violation.requirement, requirement);
    }
    let still = |range: &mut ForceRange| {
        (range.size, range.speed, range.angular_speed) = (0.0, 0.0, 0.0);
    };
    assert_eq!(change(still), Ok(()));
}

#[test]
fn the_velocities_are_changed_by_a_share_of_the_range() {
    let axis = DVec3::new(1.0, -1.0, 0.5) * (3.0 * f64::EPSILON.sqrt());
    let change = |found: Result<(), Violation>, requirement| {
        let violation = found.expect_err("a jump");
        assert_eq!(violation.requirement, requirement);
        violation.value
    };
    let force = Given {
        wrench: |motion| Wrench {
            force: motion.linear_velocity,
            torque: DVec3::ZERO,
        },
        ..Given::none()
    };
    let found = change(check(&force).continuous(&moving()), Requirement::Continuous);
    assert!((found / (axis * RANGE.speed).length() - 1.0).abs() < 1e-6);
    let force = Given {
        wrench: |motion| Wrench {
            force: DVec3::ZERO,
            torque: motion.angular_velocity,
        },
        ..force
    };
    let found = change(check(&force).continuous(&moving()), Requirement::Continuous);
    assert!((found / (axis * RANGE.angular_speed).length() - 1.0).abs() < 1e-6);
}

#[test]
fn a_jump_of_more_than_half_of_the_largest_force_or_torque_is_found() {
    // The first of the two values that are compared has no addition.
    let jump = |[force, torque]: [f64; 2]| {
        let later = Wrench {
            force: DVec3::X * force,
            torque: DVec3::Y * torque,
        };
        let force = Given {
            later,
            ..Given::none()
        };
        let largest = [4.0, 10.0];
        let check = Check {
            largest,
            ..check(&force)
        };
        check.continuous(&moving())
    };
    assert_eq!(jump([1.9, 4.9]), Ok(()));
    assert_found(jump([2.5, 4.9]), Requirement::Continuous, [2.5, 2.0]);
    assert_found(jump([1.9, 5.5]), Requirement::Continuous, [5.5, 5.0]);
}

#[test]
fn the_random_motions_differ_from_each_other_for_any_seed() {
    for seed in [0, 1, 1 << 20, u64::MAX] {
        let plan = CheckPlan { seed, cases: 20 };
        let velocity = |index| motion(&RANGE, plan, MOTIONS + index).linear_velocity;
        for index in 1..20 {
            let earlier = (0..index).map(velocity);
            assert!(earlier.into_iter().all(|other| other != velocity(index)));
        }
    }
}
