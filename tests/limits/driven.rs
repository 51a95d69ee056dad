//! The sweep of `extremes.rs` over scenes with applied forces, ground that moves and friction that
//! varies over the ground, one at a time and all at once, and over scenes among walls.
//!
//! Without a drive the energy never increases. With a drive, the energy minus its stated work never
//! increases.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::extremes::{
    BodyKind, Case, EVERYDAY, EVERYDAY_SINGLE, FrictionKind, GroundKind, Laws, Ranges, SINGLE,
    SolidKind, Tally, WIDE, cases, in_air, sweep_over, vector, vectors,
};
use crate::kit::{log_uniform, zero_or};
use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::real::Vector;
use tumble::{
    Block, ConstantForce, Coulomb, Force, FrictionField, FrictionPatch, Ground, GroundBounds,
    GroundMotion, Motion, MovingGround, Plane, Real, Region, SlidingFriction, SmoothCoulomb,
    SpringDamper, SpringDamperGround, WithResistance, Wrench,
};

// -----------------------------------------------------------------------------------------------
// Parts
// -----------------------------------------------------------------------------------------------

/// Forces besides those of the air: a constant force, and a drive of a user.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    /// Constant force over mass, m/s².
    constant: DVec3,
    drive: Option<Drive>,
}

/// Strengths of an [`Engine`].
#[derive(Clone, Copy, Debug)]
struct Drive {
    /// Thrust over mass, m/s².
    thrust: f64,
    /// Stiffness of the tether times the square of the time step, over mass.
    tether: f64,
    /// Angular speed that the motor maintains, rad/s.
    rate: f64,
    /// Drag of the motor times the time step, over mass and square of the size.
    motor: f64,
}

/// A drive of a user: a thruster along the z axis of the body, a spring to the origin, and a motor
/// that maintains an angular speed about the vertical axis.
#[derive(Debug)]
struct Engine<R> {
    /// N.
    thrust: R,
    /// N/m.
    stiffness: R,
    /// rad/s.
    rate: R,
    /// N m s.
    drag: R,
}

impl<R: Real> Force<R> for Engine<R> {
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let up = R::Vec3::new(R::ZERO, R::ZERO, R::ONE);
        Wrench {
            force: motion.axes.to_world(up) * self.thrust - motion.position * self.stiffness,
            torque: (up * self.rate - motion.angular_velocity) * self.drag,
        }
    }
    fn is_passive(&self) -> bool {
        false
    }
}

impl Pull {
    /// The force of the air and these forces.
    pub(super) fn with<R: Real>(self, air: Box<dyn Force<R>>, case: &Case) -> Box<dyn Force<R>> {
        let constant = ConstantForce {
            force: vector::<R>(self.constant * case.mass),
        };
        let Some(drive) = self.drive else {
            return Box::new((constant, air));
        };
        let per_step = case.mass / case.time_step;
        let engine = Engine {
            thrust: R::from_f64(drive.thrust * case.mass),
            stiffness: R::from_f64(drive.tether * per_step / case.time_step),
            rate: R::from_f64(drive.rate),
            drag: R::from_f64(drive.motor * per_step * case.size * case.size),
        };
        Box::new((constant, engine, air))
    }

    /// Returns true if the forces do work that is not that of a potential.
    pub(super) fn is_driven(&self) -> bool {
        self.drive.is_some()
    }
}

/// Motion of a ground's material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Belt {
    /// Velocity, of which the part along the ground counts, m/s.
    velocity: DVec3,
    /// Angular velocity about the normal, rad/s.
    rate: f64,
    /// Position on the axis of that rotation, m.
    centre: DVec3,
}

impl Belt {
    /// The ground with this motion, as far as its surface stays where it is: on a plane any motion
    /// along it, on waves along their crests, in a bowl the rotation about its axis.
    pub(super) fn under<R: Real>(
        &self,
        ground: Box<dyn SpringDamperGround<R>>,
        kind: GroundKind,
    ) -> Box<dyn SpringDamperGround<R>> {
        let rate = R::from_f64(self.rate);
        let along_y = R::Vec3::new(R::ZERO, R::from_f64(self.velocity.y), R::ZERO);
        let motion = match (kind, ground.bounds()) {
            (_, GroundBounds::Plane(plane)) => {
                let n = plane.normal;
                let along = |v: R::Vec3| v - n * v.dot(n);
                // The second projection removes the rounding of the first.
                let velocity = along(along(vector::<R>(self.velocity)));
                let turn = GroundMotion::rotation(vector::<R>(self.centre), n * rate);
                GroundMotion {
                    velocity: velocity + along(along(turn.velocity)),
                    ..turn
                }
            }
            (GroundKind::Waves, _) => GroundMotion::translation(along_y),
            (GroundKind::Bowl, _) => {
                let up = R::Vec3::new(R::ZERO, R::ZERO, rate);
                GroundMotion::rotation(R::Vec3::ZERO, up)
            }
            _ => return ground,
        };
        Box::new(MovingGround { ground, motion })
    }
}

/// How the coefficient of friction varies over the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    pattern: Pattern,
    /// m.
    length: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Pattern {
    /// Stripes without friction.
    Stripes,
    /// From a tenth of the coefficient to nearly twice as much.
    Smooth,
    /// A patch of a law of its own.
    Patch,
}

impl Places {
    /// The law of a scene, with this variation.
    pub(super) fn friction<R: Real>(&self, case: &Case) -> Box<dyn SlidingFriction<R>> {
        let coefficient = R::from_f64(case.coefficient);
        let slip_speed = R::from_f64(case.slip_speed);
        let (length, pattern) = (R::from_f64(self.length), self.pattern);
        if pattern == Pattern::Patch {
            return self.patch(case);
        }
        let at = move |position: R::Vec3| {
            let (sin, _) = (position.x() / length).sin_cos();
            let (_, cos) = (position.y() / length).sin_cos();
            let factor = match pattern {
                Pattern::Stripes if sin > R::ZERO => R::ZERO,
                Pattern::Smooth => R::ONE + R::from_f64(0.9) * sin * cos,
                _ => R::ONE,
            };
            coefficient * factor
        };
        let coulomb = move |position: R::Vec3| Coulomb {
            coefficient: at(position),
            slip_speed,
        };
        match case.friction {
            FrictionKind::Smooth => {
                let law = move |position: R::Vec3| SmoothCoulomb {
                    coefficient: at(position),
                    slip_speed,
                };
                Box::new(FrictionField::new(law))
            }
            FrictionKind::Resisting => {
                let size = R::from_f64(case.size);
                let law = move |position: R::Vec3| WithResistance {
                    friction: coulomb(position),
                    rolling: at(position) * size * R::from_f64(0.01),
                    spinning: at(position) * size * R::from_f64(0.1),
                    turn_speed: slip_speed,
                };
                Box::new(FrictionField::new(law))
            }
            _ => Box::new(FrictionField::new(coulomb)),
        }
    }

    fn patch<R: Real>(&self, case: &Case) -> Box<dyn SlidingFriction<R>> {
        Box::new(FrictionPatch {
            outside: case.uniform_friction::<R>(),
            inside: Coulomb {
                coefficient: R::from_f64(case.coefficient * 0.3),
                slip_speed: R::from_f64(case.slip_speed),
            },
            region: Region::Ball {
                centre: R::Vec3::new(R::from_f64(self.length), R::ZERO, R::ZERO),
                radius: R::from_f64(self.length),
            },
        })
    }
}

/// Planes and a block beside the ground, in sizes of the body.
#[derive(Clone, Debug)]
pub(super) struct Walls {
    /// Direction from which each wall keeps the body away, and its distance from the origin.
    planes: Vec<(DVec3, f64)>,
    block: (DVec3, DVec3),
}

impl Walls {
    /// The ground with these walls. They have springs and dampers like those of the case.
    pub(super) fn beside<R: Real>(
        &self,
        ground: Box<dyn SpringDamperGround<R>>,
        case: &Case,
    ) -> Box<dyn SpringDamperGround<R>> {
        let law = SpringDamper {
            stiffness: R::from_f64(case.stiffness),
            damping: R::from_f64(case.damping),
        };
        let walls: Vec<_> = (self.planes.iter())
            .map(|&(normal, distance)| Ground {
                law,
                shape: Plane::through(
                    vector::<R>(normal * (-distance * case.size)),
                    vector::<R>(normal),
                ),
            })
            .collect();
        let (centre, half) = self.block;
        let block = Ground {
            law,
            shape: Block {
                centre: vector::<R>(centre * case.size),
                half: vector::<R>(half * case.size),
            },
        };
        Box::new((ground, walls.into_boxed_slice(), block))
    }
}

// -----------------------------------------------------------------------------------------------
// Scenes
// -----------------------------------------------------------------------------------------------

fn pulls(ranges: Ranges) -> impl Strategy<Value = Pull> {
    let most = (ranges.speed / ranges.time_step.1).max(1.0);
    let drive = (
        zero_or(most * 1e-9, most),
        zero_or(1e-9, 1.0),
        zero_or(ranges.spin * 1e-9, ranges.spin),
        zero_or(1e-9, 1e3),
    );
    let drive = drive.prop_map(|(thrust, tether, rate, motor)| Drive {
        thrust,
        tether,
        rate,
        motor,
    });
    let constant = vectors(1e-3, 1e3);
    (constant, prop::option::of(drive)).prop_map(|(constant, drive)| Pull { constant, drive })
}

fn belts(ranges: Ranges) -> impl Strategy<Value = Belt> {
    let velocity = vectors(ranges.speed * 1e-10, ranges.speed);
    let rate = zero_or(ranges.spin * 1e-9, ranges.spin);
    let centre = vectors(ranges.size.0, ranges.size.1);
    (velocity, rate, any::<bool>(), centre).prop_map(|(velocity, rate, is_reverse, centre)| Belt {
        velocity,
        rate: if is_reverse { -rate } else { rate },
        centre,
    })
}

fn places() -> impl Strategy<Value = (Pattern, f64)> {
    let patterns = vec![Pattern::Stripes, Pattern::Smooth, Pattern::Patch];
    // In sizes of the body.
    (prop::sample::select(patterns), log_uniform(1e-2, 1e2))
}

fn walls() -> impl Strategy<Value = Walls> {
    let plane = (vectors(0.1, 1.0), log_uniform(1e-2, 1e2)).prop_map(|(normal, distance)| {
        let normal = normal.try_normalize().unwrap_or(DVec3::X);
        (normal, distance)
    });
    let half = prop::array::uniform3(log_uniform(0.1, 10.0)).prop_map(DVec3::from_array);
    let planes = prop::collection::vec(plane, 0..5);
    (planes, (vectors(0.1, 10.0), half)).prop_map(|(planes, block)| Walls { planes, block })
}

/// Which of the parts a scene has.
#[derive(Clone, Copy, Debug)]
struct Roles {
    pull: bool,
    belt: bool,
    places: bool,
}

const PULL: Roles = Roles {
    pull: true,
    belt: false,
    places: false,
};
const BELT: Roles = Roles {
    pull: false,
    belt: true,
    places: false,
};
const PLACES: Roles = Roles {
    pull: false,
    belt: false,
    places: true,
};

/// One of the parts, or any of them.
fn roles() -> impl Strategy<Value = Roles> {
    let any = (any::<bool>(), any::<bool>(), any::<bool>());
    let any = any.prop_map(|(pull, belt, places)| Roles { pull, belt, places });
    prop_oneof![1 => Just(PULL), 1 => Just(BELT), 1 => Just(PLACES), 2 => any]
}

/// Solids as well as the bodies of the sweep.
fn solids() -> impl Strategy<Value = Option<BodyKind>> {
    use SolidKind::{Coin, Cone, Disc, Egg, Hull, LoadedSphere, RoundDie, ThickDisc};
    let kinds = vec![
        Coin,
        LoadedSphere,
        RoundDie,
        Cone,
        Hull,
        Egg,
        Disc,
        Disc,
        ThickDisc,
    ];
    let solid = prop::sample::select(kinds).prop_map(|kind| Some(BodyKind::Solid(kind)));
    prop_oneof![2 => Just(None), 1 => solid]
}

/// The scenes with these parts.
fn with_roles(
    ranges: Ranges,
    scenes: impl Strategy<Value = Case>,
    roles: impl Strategy<Value = Roles>,
) -> impl Strategy<Value = Case> {
    let parts = (pulls(ranges), belts(ranges), places());
    (scenes, roles, parts, solids()).prop_map(|(case, roles, (pull, belt, places), solid)| {
        let (pattern, length) = places;
        let length = length * case.size;
        Case {
            body: solid.unwrap_or(case.body),
            pull: roles.pull.then_some(pull),
            belt: roles.belt.then_some(belt),
            places: roles.places.then_some(Places { pattern, length }),
            ..case
        }
    })
}

/// Grounds on which material can move along a curved surface.
fn curved(ranges: Ranges) -> impl Strategy<Value = Case> {
    (cases(ranges, Laws::Terrain), any::<bool>()).prop_map(|(case, is_bowl)| {
        if is_bowl {
            Case {
                ground: GroundKind::Bowl,
                // Far from its bottom a bowl is steeper than any wall.
                position: DVec3::Z * case.position.z,
                ..case
            }
        } else {
            case
        }
    })
}

/// Runs a fraction of the sweep over scenes with any of the parts. Each of them must act in a part
/// of the steps.
fn sweep_with_roles<R: Real>(name: &str, ranges: Ranges, laws: Laws, share: f64) {
    let scenes = with_roles(ranges, cases(ranges, laws), roles());
    all_act(&sweep_over::<R>(name, scenes, share));
}

/// The scenes among walls.
fn walled(ranges: Ranges, laws: Laws) -> impl Strategy<Value = Case> {
    (cases(ranges, laws), solids(), walls()).prop_map(|(case, solid, walls)| Case {
        body: solid.unwrap_or(case.body),
        walls: Some(walls),
        ..case
    })
}

/// Each part is in at least a tenth of the steps, and a drive does work in a tenth.
fn all_act(tally: &Tally) {
    let steps = tally.all();
    for (role, count) in tally.roles().filter(|(role, _)| !role.contains("surfaces")) {
        assert!(count * 10 > steps, "{role}: {count} of {steps} steps");
    }
}

#[test]
fn every_step_with_forces_belts_and_patches_keeps_its_promises() {
    sweep_with_roles::<f64>("roles in the workshop, f64", EVERYDAY, Laws::Report, 0.04);
    sweep_with_roles::<f64>(
        "roles, all built-in laws, f64",
        EVERYDAY,
        Laws::BuiltIn,
        0.04,
    );
    sweep_with_roles::<f64>("roles, a user's laws, f64", EVERYDAY, Laws::Users, 0.02);
    sweep_with_roles::<f32>("roles, f32", EVERYDAY_SINGLE, Laws::BuiltIn, 0.03);
}

#[test]
fn every_step_with_forces_belts_and_patches_keeps_its_promises_at_the_extremes() {
    sweep_with_roles::<f64>("roles at the extremes, f64", WIDE, Laws::Report, 0.03);
    sweep_with_roles::<f64>(
        "extremes, all built-in laws, f64",
        WIDE,
        Laws::BuiltIn,
        0.03,
    );
    sweep_with_roles::<f32>("roles at the extremes, f32", SINGLE, Laws::BuiltIn, 0.03);
}

#[test]
fn every_step_on_curved_ground_that_moves_keeps_its_promises() {
    let scenes = with_roles(EVERYDAY, curved(EVERYDAY), roles());
    all_act(&sweep_over::<f64>("curved ground, f64", scenes, 0.02));
    let scenes = with_roles(EVERYDAY_SINGLE, curved(EVERYDAY_SINGLE), roles());
    all_act(&sweep_over::<f32>("curved ground, f32", scenes, 0.01));
}

#[test]
fn every_step_in_air_on_a_belt_keeps_its_promises() {
    let scenes = with_roles(EVERYDAY, in_air(EVERYDAY, 100.0), roles());
    all_act(&sweep_over::<f64>("air and belts, f64", scenes, 0.03));
    let scenes = with_roles(EVERYDAY_SINGLE, in_air(EVERYDAY_SINGLE, 100.0), roles());
    all_act(&sweep_over::<f32>("air and belts, f32", scenes, 0.02));
}

#[test]
fn every_step_among_walls_keeps_its_promises() {
    let of = |ranges, laws| walled(ranges, laws);
    sweep_over::<f64>("walls, f64", of(EVERYDAY, Laws::BuiltIn), 0.04);
    sweep_over::<f64>(
        "walls on curved ground, f64",
        of(EVERYDAY, Laws::Terrain),
        0.02,
    );
    sweep_over::<f32>("walls, f32", of(EVERYDAY_SINGLE, Laws::BuiltIn), 0.03);
}
