//! Methods with a tolerance see a contact with an edge of the ground that begins and ends within
//! one of their steps.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use crate::kit::{self, directions, log_uniform};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use tumble::glam::{DQuat, DVec3};
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AnyIntegrator, Block, BogackiShampine32, Capsule,
    Coulomb, Cuboid, DormandPrince54, EnergyMomentum, Ground, Radau5, RigidPointBody, Shape,
    Sphere, SpringDamper, State, Surface, UniformGravity,
};

/// A ridge along y: two slopes that meet at the origin.
struct Roof {
    normals: [DVec3; 2],
}

impl Shape for Roof {
    fn surface(&self, point: DVec3) -> Surface {
        let [a, b] = self.normals;
        let normal = if a.dot(point) > b.dot(point) { a } else { b };
        Surface {
            gap: normal.dot(point),
            normal,
        }
    }
}

fn bodies() -> [Box<dyn RigidPointBody>; 3] {
    [
        Box::new(Cuboid::solid(0.4, DVec3::new(0.16, 0.12, 0.07))),
        Box::new(Capsule::solid(0.2, 0.03, 0.12)),
        Box::new(Sphere::solid(0.3, 0.06)),
    ]
}

/// Position after 0.3 s.
fn end(
    body: &dyn RigidPointBody,
    shape: &dyn Shape,
    stiffness: f64,
    start: &State,
    integrator: AnyIntegrator,
) -> DVec3 {
    let law = SpringDamper {
        stiffness,
        damping: 3e-4 * stiffness,
    };
    let stepper = Stepper::builder(body)
        .gravity(UniformGravity::down(9.8))
        .ground(Ground { law, shape })
        .friction(Coulomb {
            coefficient: 0.2,
            slip_speed: 1e-3,
        })
        .integrator(integrator)
        .build()
        .unwrap();
    let mut state = *start;
    stepper.advance(&mut state, 0.3).unwrap();
    state.position
}

/// A throw at the table and the ridge.
#[derive(Debug)]
struct Throw {
    place: [f64; 2],
    velocity: [f64; 3],
    orientation: DQuat,
    spin: DVec3,
    stiffness: f64,
    slopes: [f64; 2],
}

fn throws() -> impl Strategy<Value = Throw> {
    (
        [0.0..0.25_f64, -0.08..0.08_f64],
        [-0.8..0.8_f64, -0.5..0.5_f64, -1.0..0.3_f64],
        kit::orientations(),
        (directions(), 0.0..6.0_f64),
        log_uniform(1e3, 1e4),
        [0.1..1.2_f64, 0.1..1.2_f64],
    )
        .prop_map(
            |(place, velocity, orientation, (axis, spin), stiffness, slopes)| Throw {
                place,
                velocity,
                orientation,
                spin: axis * spin,
                stiffness,
                slopes,
            },
        )
}

impl Throw {
    fn start(&self, body: &dyn RigidPointBody) -> State {
        let [x, y] = self.place;
        let height = 0.15 + body.bounding_radius();
        let spin = self.orientation.inverse() * self.spin;
        State::at(DVec3::new(x, y, height))
            .with_orientation(self.orientation)
            .with_linear_velocity(DVec3::from(self.velocity))
            .with_angular_momentum(self.orientation * (body.inertia() * spin))
    }

    fn roof(&self) -> Roof {
        let [a, b] = self.slopes;
        let normals = [
            DVec3::new(a.sin(), 0.0, a.cos()),
            DVec3::new(-b.sin(), 0.0, b.cos()),
        ];
        Roof { normals }
    }

    /// Numbers of methods that are judged, and of those that end more than a centimetre away from
    /// two runs with small fixed steps. None is judged if these differ by more than a millimetre.
    fn judged(&self, body: &dyn RigidPointBody, shape: &dyn Shape) -> [usize; 2] {
        let by = |integrator| end(body, shape, self.stiffness, &self.start(body), integrator);
        let [coarse, truth] = [2e-4, 1e-4]
            .map(|time_step| by(AnyIntegrator::EnergyMomentum(EnergyMomentum { time_step })));
        if (coarse - truth).length() > 1e-3 {
            return [0; 2];
        }
        let methods = [
            AnyIntegrator::DormandPrince54(DormandPrince54::new(1e-6)),
            AnyIntegrator::Radau5(Radau5::new(1e-6)),
            AnyIntegrator::AdaptiveNystrom(AdaptiveNystrom::new(1e-6)),
            AnyIntegrator::BogackiShampine32(BogackiShampine32::new(1e-5)),
            AnyIntegrator::AdaptiveEnergyMomentum(AdaptiveEnergyMomentum::new(1e-4)),
        ];
        let is_wrong = |method: &&AnyIntegrator| (by(**method) - truth).length() > 1e-2;
        [methods.len(), methods.iter().filter(is_wrong).count()]
    }
}

/// 120 throws of three bodies at the edge of a table and at a ridge.
///
/// Of throws of other bodies at another table, 63 of 657 ends of a cube were wrong, from a contact
/// that a step had passed over. 120 boxes then have 11, and at most 2 with a probability of 1e-3.
/// Of these throws 10 were, and 1 still is. Of other draws 3 of some 40,000 ends are more than a
/// centimetre off.
#[test]
fn a_contact_with_an_edge_within_a_step_is_seen() {
    let table = Block {
        centre: DVec3::new(-0.1, 0.0, -0.1),
        half: DVec3::new(0.2, 0.15, 0.1),
    };
    let mut runner = TestRunner::deterministic();
    let (mut judged, mut wrong) = (0, 0);
    for _ in 0..120 {
        let throw = throws().new_tree(&mut runner).unwrap().current();
        for body in bodies() {
            for shape in [&table as &dyn Shape, &throw.roof()] {
                let [methods, of_them] = throw.judged(&body, shape);
                judged += methods;
                wrong += of_them;
            }
        }
    }
    println!("{wrong} of {judged} ends are wrong");
    // Of 3600 ends, 3595 were judged.
    assert!(judged >= 3500, "{judged} ends are judged");
    assert!(wrong <= 2, "{wrong} ends are wrong");
}
