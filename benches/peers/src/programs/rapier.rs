//! rapier in both precisions: the same code for the two crates.

use super::{End, Program, Watch};
use tumble::State;
use tumble::glam::{DMat3, DQuat, DVec3};

use crate::scene::{Scene, Shape};

/// Settings of rapier's contact solver, besides the step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Tuning {
    /// Defaults of rapier: 60 steps a second.
    Default,
    /// Coulomb's friction, fast rotation, no sleep, no speed limit, no reuse of old contacts, no
    /// motion clamping, and the following settings.
    Careful {
        /// Step size, s.
        time_step: f64,
        /// Number of iterations, each of which is a substep.
        iterations: usize,
        /// Contact frequency, Hz. The damping ratio is rapier's default.
        contact_frequency: f64,
        /// Applies friction also in the pass that corrects penetration.
        friction_in_both_passes: bool,
    },
}

impl Tuning {
    /// Settings that a careful user would try at one step size. The best of them is the tuned
    /// rapier.
    pub(crate) fn all(time_step: f64, scene: &Scene) -> Vec<Self> {
        let mut all = Vec::new();
        // rapier's default is 60 Hz. The other frequencies are as high as the step resolves. In
        // flight only the number of iterations can be tuned.
        let own = 60.0 / scene.scale.1;
        let (frequencies, passes) = match scene.shape != Shape::Free {
            true => (
                vec![own, 0.03 / time_step, 0.3 / time_step],
                vec![false, true],
            ),
            false => (vec![own], vec![false]),
        };
        for iterations in [1, 4, 16] {
            for &contact_frequency in &frequencies {
                for &friction_in_both_passes in &passes {
                    all.push(Self::Careful {
                        time_step,
                        iterations,
                        contact_frequency,
                        friction_in_both_passes,
                    });
                }
            }
        }
        all
    }

    fn settings(self) -> String {
        match self {
            Self::Default => "as it comes".into(),
            Self::Careful {
                time_step,
                iterations,
                contact_frequency,
                friction_in_both_passes,
            } => format!(
                "{time_step:.0e} s, {iterations} it., {contact_frequency:.0} Hz{}",
                if friction_in_both_passes {
                    ", both"
                } else {
                    ""
                }
            ),
        }
    }
}

/// One version of rapier on one scene. `F` is its number type.
pub(crate) struct Rapier<F> {
    work: Work,
    tuning: Tuning,
    number: core::marker::PhantomData<F>,
}

impl<F> Rapier<F> {
    pub(crate) fn new(scene: &Scene, tuning: Tuning) -> Self {
        Self {
            work: Work::of(scene, tuning),
            tuning,
            number: core::marker::PhantomData,
        }
    }
}

/// A scene in the units that rapier uses.
///
/// With default settings these are m, s, kg. Tuned, they scale the numbers of the scene to about 1,
/// because rapier's friction has no effect on a coin of 1 mm in metres.
struct Work {
    length: f64,
    time: f64,
    /// Mass in kg of one unit of mass.
    unit_mass: f64,
    mass: f64,
    /// Principal moments.
    inertia: DVec3,
    gravity: f64,
    coefficient: f64,
    restitution: f64,
    shape: Shape,
    start: State,
    seconds: f64,
}

impl Work {
    fn of(scene: &Scene, tuning: Tuning) -> Self {
        let law = &scene.law;
        let (length, time, mass) = match tuning {
            Tuning::Default => (1.0, 1.0, 1.0),
            Tuning::Careful { .. } => (scene.scale.0, scene.scale.1, law.mass),
        };
        let start = scene.rigid.start;
        let mut work = Self {
            length,
            time,
            unit_mass: mass,
            mass: law.mass / mass,
            inertia: law.inertia / (mass * length * length),
            gravity: law.gravity * time * time / length,
            coefficient: law.coefficient,
            restitution: scene.restitution,
            shape: match scene.shape {
                Shape::Free => Shape::Free,
                Shape::Ball(radius) => Shape::Ball(radius / length),
                // It has no body that touches at one point of a rim.
                Shape::Coin(radius) | Shape::Hoop(radius) => Shape::Coin(radius / length),
            },
            start: State {
                position: start.position / length,
                linear_velocity: start.linear_velocity * (time / length),
                orientation: start.orientation.normalize(),
                angular_momentum: start.angular_momentum * (time / (mass * length * length)),
            },
            seconds: scene.seconds / time,
        };
        work.start.position.z += work.raised(start.orientation);
        work
    }

    /// Height by which the coin lies higher than a ring, because it has a thickness.
    fn raised(&self, orientation: DQuat) -> f64 {
        match self.shape {
            Shape::Coin(radius) => radius * HALF_THICKNESS * (orientation * DVec3::X).z.abs(),
            _ => 0.0,
        }
    }

    /// Angular velocity at the start, world axes.
    fn spin(&self) -> DVec3 {
        let axes = DMat3::from_quat(self.start.orientation);
        axes * ((axes.transpose() * self.start.angular_momentum) / self.inertia)
    }

    /// Converts a state of rapier to SI units, without the height due to the thickness.
    fn state(&self, position: DVec3, velocity: DVec3, orientation: DQuat, spin: DVec3) -> State {
        let orientation = orientation.normalize();
        let axes = DMat3::from_quat(orientation);
        let momentum = axes * (self.inertia * (axes.transpose() * spin));
        State {
            position: (position - DVec3::Z * self.raised(orientation)) * self.length,
            linear_velocity: velocity * (self.length / self.time),
            orientation,
            angular_momentum: momentum * (self.unit_mass * self.length * self.length / self.time),
        }
    }
}

/// Half the thickness of the coin, in radii. rapier has no ring.
const HALF_THICKNESS: f64 = 3e-3;

/// Number of corners of the tuned coin.
///
/// It has the least error on circle and trials together. The alternatives were prisms with 60 to
/// 1920 sides and half thicknesses of 1e-4 to 1e-2 radii, rings of small balls, and rapier's own
/// cylinder. The cylinder touches with two points of one line, and is 0.4 m off after 1 s on the
/// circle.
const SIDES: u32 = 240;

/// Corners of a coin as a prism, body axes.
fn prism(radius: f64) -> Vec<DVec3> {
    let half = radius * HALF_THICKNESS;
    let corner = |k: u32| {
        let (sin, cos) = (core::f64::consts::TAU * f64::from(k) / f64::from(SIDES)).sin_cos();
        [-half, half].map(|x| DVec3::new(x, radius * cos, radius * sin))
    };
    (0..SIDES).flat_map(corner).collect()
}

macro_rules! rapier {
    ($module:ident, $engine:ident, $number:ty, $name:literal) => {
        mod $module {
            use super::{End, HALF_THICKNESS, Program, Rapier, Tuning, Watch, Work, prism};
            use crate::scene::Shape as Body;
            use cpu_time::ThreadTime;
            use tumble::State;
            use tumble::glam::{DQuat, DVec3};
            use $engine::prelude::*;

            impl Program for Rapier<$number> {
                fn name(&self) -> String {
                    let how = match self.tuning {
                        Tuning::Default => "default",
                        Tuning::Careful { .. } => "tuned",
                    };
                    format!("{} {how}", $name)
                }

                fn settings(&self) -> String {
                    self.tuning.settings()
                }

                fn is_rigid(&self) -> bool {
                    true
                }

                fn run(&self, mut watch: Option<Watch<'_>>) -> Result<End, String> {
                    let clock = ThreadTime::now();
                    let mut world = world(&self.work, self.tuning);
                    let body = insert(&mut world, &self.work, self.tuning);
                    let preparation = clock.elapsed().as_secs_f64();
                    let whole = f64::from(world.integration_parameters.dt);
                    let steps = (self.work.seconds / whole * (1.0 - 1e-6)).ceil();
                    // The last step takes the remaining time, so that the run ends at the time of
                    // the known result.
                    let rest = self.work.seconds - whole * (steps - 1.0);
                    for step in 0..steps as u64 {
                        if let Some(watch) = &mut watch {
                            watch(&state(&world.bodies[body], &self.work));
                        }
                        if step + 1 == steps as u64 {
                            world.integration_parameters.dt = rest as $number;
                        }
                        world.step();
                    }
                    let state = state(&world.bodies[body], &self.work);
                    if let Some(watch) = &mut watch {
                        watch(&state);
                    }
                    if state.not_finite().is_some() {
                        return Err("diverged".into());
                    }
                    Ok(End {
                        state,
                        steps: steps as u64,
                        preparation,
                    })
                }
            }

            fn vector(v: DVec3) -> Vector {
                Vector::new(v.x as $number, v.y as $number, v.z as $number)
            }

            fn double(v: Vector) -> DVec3 {
                DVec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
            }

            fn world(work: &Work, tuning: Tuning) -> PhysicsWorld {
                let mut world = PhysicsWorld {
                    gravity: vector(DVec3::Z * -work.gravity),
                    ..PhysicsWorld::default()
                };
                let parameters = &mut world.integration_parameters;
                if let Tuning::Careful {
                    time_step,
                    iterations,
                    contact_frequency,
                    friction_in_both_passes,
                } = tuning
                {
                    parameters.dt = (time_step / work.time) as $number;
                    parameters.num_solver_iterations = iterations;
                    parameters.friction_model = FrictionModel::Coulomb;
                    parameters.friction_in_bias_pass = friction_in_both_passes;
                    let softness = &mut parameters.static_contact_softness;
                    softness.natural_frequency = (contact_frequency * work.time) as $number;
                    parameters.normalized_max_linear_velocity = <$number>::MAX;
                    parameters.max_ccd_substeps = 0;
                    parameters.contact_recycling = false;
                    parameters.normalized_prediction_distance = 1e-3;
                }
                world
            }

            /// Inserts the body with its collider, and a half-space if the body can touch one.
            fn insert(world: &mut PhysicsWorld, work: &Work, tuning: Tuning) -> RigidBodyHandle {
                let (mass, inertia) = (work.mass as $number, vector(work.inertia));
                let properties = MassProperties::new(vector(DVec3::ZERO), mass, inertia);
                let tuned = tuning != Tuning::Default;
                let mut body = RigidBodyBuilder::dynamic()
                    .additional_mass_properties(properties)
                    .gyroscopic_forces_enabled(true)
                    .can_sleep(!tuned)
                    .allow_fast_rotation(tuned)
                    .linvel(vector(work.start.linear_velocity))
                    .angvel(vector(work.spin()))
                    .build();
                let [x, y, z, w] = work.start.orientation.to_array().map(|c| c as $number);
                let rotation = Rotation::from_xyzw(x, y, z, w);
                body.set_position(
                    Pose::from_parts(vector(work.start.position), rotation),
                    true,
                );
                let surface = |collider: ColliderBuilder| {
                    collider
                        .density(0.0)
                        .friction(work.coefficient as $number)
                        .restitution(work.restitution as $number)
                };
                let collider = match work.shape {
                    Body::Free => return world.insert_body(body),
                    Body::Ball(radius) => ColliderBuilder::ball(radius as $number),
                    Body::Coin(radius) if tuned => hull(radius),
                    Body::Coin(radius) | Body::Hoop(radius) => cylinder(radius),
                };
                let half_space = SharedShape::halfspace(vector(DVec3::Z));
                world.insert_collider(surface(ColliderBuilder::new(half_space)), None);
                world.insert(body, surface(collider)).0
            }

            fn hull(radius: f64) -> ColliderBuilder {
                let corners: Vec<Vector> = prism(radius).into_iter().map(vector).collect();
                ColliderBuilder::convex_hull(&corners).expect("a prism is a convex hull")
            }

            /// Cylinder with its axis along x, as for a coin. The axis of rapier's cylinder is y.
            fn cylinder(radius: f64) -> ColliderBuilder {
                let turn = vector(DVec3::Z * core::f64::consts::FRAC_PI_2);
                let half = (radius * HALF_THICKNESS) as $number;
                ColliderBuilder::cylinder(half, radius as $number).rotation(turn)
            }

            fn state(body: &RigidBody, work: &Work) -> State {
                let [x, y, z, w] = body.rotation().to_array().map(f64::from);
                let (position, velocity) = (double(body.translation()), double(body.linvel()));
                work.state(
                    position,
                    velocity,
                    DQuat::from_xyzw(x, y, z, w),
                    double(body.angvel()),
                )
            }
        }
    };
}

rapier!(single, rapier3d, f32, "rapier3d");
rapier!(double, rapier3d_f64, f64, "rapier3d-f64");
