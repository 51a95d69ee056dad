//! What the contract checks ask, and how small a fault of each kind they find.
//!
//! A seed that has found a fault finds it again on every machine, so the inputs of a check are
//! stored as a hash. The smallest fault that is found states the tolerance of each requirement.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::cell::Cell;

use tumble::body::ContactRange;
use tumble::contract::{
    CheckPlan, ForceRange, FrictionRange, GroundRange, Requirement, Violation, check_body,
    check_force, check_friction, check_ground,
};
use tumble::force::{ForcePower, Wrench};
use tumble::glam::{DMat3, DVec3};
use tumble::{
    ContactPoint, Coulomb, FlatGround, Force, FrictionJacobian, GroundBounds, GroundMotion,
    MeanForce, Motion, Plane, PointCloud, RigidPointBody, SlidingFriction, SpringDamperGround,
    Surface,
};

const PLAN: CheckPlan = CheckPlan { seed: 7, cases: 40 };

/// What is wrong, in proportion to a size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    None,
    Normal,
    Gap,
    Bounds,
    Material,
    SpringForce,
    SpringEnergy,
    Damper,
    Mean,
    MeanAbove,
    Drive,
    OutOfSurface,
    WithoutSlip,
    WithoutLoad,
    ByPlace,
    Coefficient,
    ForceDrives,
    PowerStated,
    Jump,
    Reach,
    Below,
}

/// A body, a ground, a friction law and an applied force that record what they are asked.
struct Part {
    fault: Fault,
    size: f64,
    body: PointCloud<f64, [ContactPoint; 4]>,
    asked: Cell<u64>,
}

impl Part {
    fn new(fault: Fault, size: f64) -> Self {
        let place = |x, y, z| ContactPoint::bare(DVec3::new(x, y, z));
        let places = [
            place(0.3, 0.1, -0.2),
            place(-0.4, 0.2, 0.1),
            place(0.1, -0.5, 0.3),
            place(-0.2, 0.1, -0.6),
        ];
        let body = PointCloud::with_storage(places, &[0.2, 0.4, 0.1, 0.3]).unwrap();
        let asked = Cell::new(0xcbf2_9ce4_8422_2325);
        Self {
            fault,
            size,
            body,
            asked,
        }
    }

    /// The size if this is the fault, else 0.
    fn off(&self, fault: Fault) -> f64 {
        if self.fault == fault { self.size } else { 0.0 }
    }

    /// Takes the input into the hash (Fowler, Noll and Vo).
    fn ask(&self, input: &[f64]) {
        let bytes = input.iter().flat_map(|number| number.to_le_bytes());
        let hash = bytes.fold(self.asked.get(), |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        self.asked.set(hash);
    }

    /// The friction law, which drives if it is wrong by more than its coefficient.
    fn law(&self) -> Coulomb {
        Coulomb {
            coefficient: 0.3 - self.off(Fault::Drive),
            slip_speed: 1e-3,
        }
    }
}

impl SpringDamperGround for Part {
    fn surface(&self, point: DVec3) -> Surface {
        self.ask(&point.to_array());
        Surface {
            gap: point.z * (1.0 + self.off(Fault::Gap)),
            normal: DVec3::Z * (1.0 + self.off(Fault::Normal)),
        }
    }
    fn spring_force(&self, depth: f64) -> f64 {
        self.ask(&[depth]);
        1e3 * depth * (1.0 + self.off(Fault::SpringForce))
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        self.ask(&[depth]);
        5e2 * depth * depth * (1.0 + self.off(Fault::SpringEnergy))
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        self.ask(&[depth, closing_speed]);
        let spring = 1e3 * depth * (1.0 + self.off(Fault::SpringForce));
        (spring * (1.0 - self.off(Fault::Damper)) + 2.0 * closing_speed).max(0.0)
    }
    fn mean_force(&self, start: f64, end: f64, seconds: f64) -> MeanForce {
        self.ask(&[start, end, seconds]);
        let mean = FlatGround::level(1e3, 2.0).mean_force(start, end, seconds);
        let above = if start <= 0.0 && end <= 0.0 { 1.0 } else { 0.0 };
        MeanForce {
            force: mean.force * (1.0 + self.off(Fault::Mean)) + above * self.off(Fault::MeanAbove),
            ..mean
        }
    }
    fn bounds(&self) -> GroundBounds {
        GroundBounds::Below(Plane::level(-self.off(Fault::Bounds)))
    }
    fn motion(&self) -> Option<GroundMotion> {
        let rising = self.off(Fault::Material);
        Some(GroundMotion::translation(DVec3::new(1.0, 0.5, rising)))
    }
}

impl SlidingFriction for Part {
    fn force(&self, load: f64, slip: DVec3) -> DVec3 {
        self.ask(&slip.to_array());
        self.ask(&[load]);
        self.law().force(load, slip)
            + DVec3::Z * (load * self.off(Fault::OutOfSurface))
            + DVec3::X * (load * self.off(Fault::WithoutSlip))
            - slip * self.off(Fault::WithoutLoad)
    }
    fn force_at(&self, position: DVec3, load: f64, slip: DVec3) -> DVec3 {
        self.ask(&position.to_array());
        self.force(load, slip) * (1.0 + position.x * self.off(Fault::ByPlace))
    }
    fn jacobian(&self, load: f64, slip: DVec3) -> FrictionJacobian {
        self.ask(&slip.to_array());
        let right = self.law().jacobian(load, slip);
        FrictionJacobian {
            coefficient: right.coefficient * (1.0 + self.off(Fault::Coefficient)),
            ..right
        }
    }
}

impl Force for Part {
    fn wrench(&self, motion: &Motion) -> Wrench {
        for vector in [
            motion.position,
            motion.axes.to_world(DVec3::X),
            motion.linear_velocity,
            motion.angular_velocity,
        ] {
            self.ask(&vector.to_array());
        }
        let jump = if motion.linear_velocity.x > 0.0 {
            self.off(Fault::Jump)
        } else {
            0.0
        };
        let drag = 0.2 * (1.0 - jump) - self.off(Fault::ForceDrives);
        Wrench {
            force: motion.linear_velocity * -drag,
            torque: motion.angular_velocity * -0.1,
        }
    }
    fn is_passive(&self) -> bool {
        true
    }
    fn power(&self, motion: &Motion) -> ForcePower {
        let power = self.wrench(motion).power(motion);
        ForcePower {
            drag: power * (1.0 + self.off(Fault::PowerStated)),
            drive: 0.0,
        }
    }
}

impl RigidPointBody for Part {
    fn mass(&self) -> f64 {
        self.body.mass()
    }
    fn inertia(&self) -> DMat3 {
        self.body.inertia()
    }
    fn contacts(&self) -> &[ContactPoint] {
        self.body.contacts()
    }
    fn bounding_radius(&self) -> f64 {
        self.body.bounding_radius() * (1.0 - self.off(Fault::Reach))
    }
    fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
        self.ask(&normal.to_array());
        self.ask(&[offset]);
        let below = offset - self.off(Fault::Below);
        let lowest = |contact: &ContactPoint| contact.position.dot(normal) <= below;
        match self.body.contacts().iter().position(lowest) {
            Some(first) => ContactRange {
                first,
                count: self.body.contacts().len() - first,
            },
            None => ContactRange::NONE,
        }
    }
}

fn of_ground(part: &Part) -> Result<(), Violation> {
    let range = GroundRange {
        centre: DVec3::new(0.2, -0.1, 0.0),
        size: 1.0,
        depth: 0.05,
        speed: 5.0,
    };
    check_ground(part, &range, PLAN)
}

fn of_friction(part: &Part) -> Result<(), Violation> {
    let range = FrictionRange {
        centre: DVec3::new(0.2, -0.1, 0.0),
        size: 1.0,
        normal: DVec3::Z,
        normal_force: 1e3,
        slip: 10.0,
    };
    check_friction(part, &range, PLAN)
}

fn of_force(part: &Part) -> Result<(), Violation> {
    let range = ForceRange {
        centre: DVec3::new(0.2, -0.1, 0.3),
        size: 1.0,
        speed: 20.0,
        angular_speed: 50.0,
    };
    check_force(part, &range, PLAN)
}

fn of_body(part: &Part) -> Result<(), Violation> {
    check_body(part, PLAN)
}

/// Smallest size that is tried. A requirement without a tolerance finds it.
const ANY: f64 = 8.68e-19;

type Check = fn(&Part) -> Result<(), Violation>;

#[test]
fn a_seed_asks_for_the_same_numbers_on_every_machine() {
    let stored: [(Check, u64); 4] = [
        (of_ground, 0x7daf_b882_7f1b_2ba8),
        (of_friction, 0xd8ad_ed34_0efc_d1ad),
        (of_force, 0x7d65_d422_4b64_87e5),
        (of_body, 0x572b_98fa_57ec_9775),
    ];
    let asked = stored.map(|(check, _)| {
        let part = Part::new(Fault::None, 0.0);
        check(&part).unwrap();
        part.asked.get()
    });
    assert_eq!(asked, stored.map(|(_, hash)| hash), "{asked:#x?}");
}

/// Smallest size of a fault that a check finds, to a thousandth of it, and the requirement that is
/// then broken.
///
/// A ground and a force are wrong in proportion to their values, a body relative to its bounding
/// radius. A damper of 2 N s/m outweighs a fault of the springs down to `2·5e-9/50`, at the
/// smallest speed and the largest depth. A coefficient of 0.3 and a drag of 0.2 drive beyond
/// themselves, and a jump by half of the largest force is no longer continuous.
fn smallest(check: Check, fault: Fault) -> (f64, Option<Requirement>) {
    let broken = |exponent: f64| {
        let found = check(&Part::new(fault, exponent.exp2()));
        found.err().map(|violation| violation.requirement)
    };
    let (mut passes, mut fails) = (ANY.log2(), 0.0);
    while fails - passes > 1e-3 {
        let middle = 0.5 * (passes + fails);
        if broken(middle).is_some() {
            fails = middle;
        } else {
            passes = middle;
        }
    }
    (fails.exp2(), broken(fails))
}

#[test]
fn the_smallest_fault_that_is_found_is_a_small_one() {
    use Requirement::*;
    let stored: [(Check, Fault, Requirement, f64); 20] = [
        (of_ground, Fault::Normal, UnitNormal, 7.22e-15),
        (of_ground, Fault::Gap, GapAlongNormal, 6.78e-11),
        (of_ground, Fault::Bounds, GroundBounds, 8.28e-15),
        (of_ground, Fault::Material, MotionAlongSurface, 1.59e-14),
        (of_ground, Fault::SpringForce, EnergyIsIntegral, 3.45e-13),
        (of_ground, Fault::SpringEnergy, EnergyIsIntegral, 3.46e-13),
        (of_ground, Fault::Damper, DamperTakes, 2e-10),
        (of_ground, Fault::Mean, MeanForceTakes, 3.52e-9),
        (of_ground, Fault::MeanAbove, MeanForceAbove, ANY),
        (of_friction, Fault::Drive, Opposes, 0.3),
        (of_friction, Fault::OutOfSurface, InSurface, ANY),
        (of_friction, Fault::WithoutSlip, NoSlipNoForce, ANY),
        (of_friction, Fault::WithoutLoad, NoLoadNoForce, ANY),
        (of_friction, Fault::ByPlace, SameEverywhere, 7.51e-17),
        (of_friction, Fault::Coefficient, JacobianFits, 2.98e-8),
        (of_force, Fault::ForceDrives, PassiveTakes, 0.2),
        (of_force, Fault::PowerStated, PowerFits, 3.44e-15),
        (of_force, Fault::Jump, Continuous, 0.5),
        (of_body, Fault::Reach, Reach, 1.83e-15),
        (of_body, Fault::Below, ContactsBelow, 2.74e-15),
    ];
    let mut wrong = String::new();
    for (check, fault, requirement, size) in stored {
        let (found, broken) = smallest(check, fault);
        if broken != Some(requirement) || (found / size - 1.0).abs() > 1e-2 {
            wrong += &format!("{fault:?}: {broken:?} at {found:e}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
