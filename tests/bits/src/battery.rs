//! The scenes and their hashes: every integrator, every built-in law and every kind of body, in both precisions.
//!
//! A hash takes in all bits of the state after each step, and of what is computed from it: energy, works, lowest point.

use core::fmt;
use core::ops::ControlFlow;

use tumble::real::{Matrix, Quaternion, Vector};
use tumble::{
    AnisotropicCoulomb, Coin, Cone, ContactPoint, Coulomb, Cuboid, EnergyMomentum, FlatGround,
    ForwardEuler, Frictionless, Gravity, Ground, HuntCrossley, Integrator, Ledger, LimitedDamper,
    MassDistribution, NoGravity, NoGround, Plane, PointCloud, Real, RigidPointBody, Rk4, Rotation,
    Sample, SceneError, SlidingFriction, SmoothCoulomb, SolidCoin, Sphere, SpringDamperGround,
    State, Stepper, StrangSplitting, Stribeck, SymplecticEuler, Trial, UniformGravity, Viscous,
};

/// What a scene has come to.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    pub precision: &'static str,
    pub integrator: &'static str,
    pub scene: &'static str,
    /// Of all bits.
    pub hash: u64,
    /// Whether an error ended the run, which none should.
    pub ended_early: bool,
}

/// Writes a line for each precision and integrator: `f64 EnergyMomentum 0123456789abcdef`; with `scenes`, one for each scene too.
pub fn write(out: &mut dyn fmt::Write, scenes: bool) -> fmt::Result {
    let mut line: Option<(Outcome, Hash)> = None;
    let mut result = Ok(());
    let mut end = |line: Option<(Outcome, Hash)>, out: &mut dyn fmt::Write| {
        if let Some((outcome, Hash(hash))) = line {
            let Outcome {
                precision,
                integrator,
                ..
            } = outcome;
            result = result.and_then(|()| writeln!(out, "{precision} {integrator} {hash:016x}"));
        }
    };
    let visited = each_scene(&mut |outcome| {
        match &mut line {
            Some((first, hash))
                if (first.precision, first.integrator)
                    == (outcome.precision, outcome.integrator) =>
            {
                hash.word(outcome.hash);
            }
            _ => {
                let mut hash = Hash::new();
                hash.word(outcome.hash);
                end(line.replace((outcome, hash)), out);
            }
        }
        if scenes {
            let Outcome { scene, hash, .. } = outcome;
            let early = if outcome.ended_early { " (early)" } else { "" };
            // An error of `out` shows in the next line as well.
            let _ = writeln!(out, "  {scene} {hash:016x}{early}");
        }
    });
    end(line, out);
    visited.map_err(|_| fmt::Error).and(result)
}

/// Runs all scenes, in one order.
///
/// # Errors
/// If a scene cannot be composed, which is a fault of the battery.
pub fn each_scene(see: &mut dyn FnMut(Outcome)) -> Result<(), SceneError> {
    macro_rules! all {
        ($($real:ident: $($integrator:ident)*;)*) => {$($(
            scenes::<$real, _>(
                |time_step| $integrator { time_step },
                &mut |scene, (hash, ended_early)| see(Outcome {
                    precision: stringify!($real),
                    integrator: stringify!($integrator),
                    scene,
                    hash,
                    ended_early,
                }),
            )?;
        )*)*};
    }
    all! {
        f32: ForwardEuler SymplecticEuler StrangSplitting Rk4 EnergyMomentum;
        f64: ForwardEuler SymplecticEuler StrangSplitting Rk4 EnergyMomentum;
    }
    Ok(())
}

/// A number's bits.
trait Bits: Real {
    fn bits(self) -> u64;
}

impl Bits for f32 {
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
}

impl Bits for f64 {
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

/// FNV-1a.
#[derive(Clone, Copy, Debug)]
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Any NaN is one: IEEE 754 leaves its sign and payload open.
    fn number<R: Bits>(&mut self, number: R) {
        let is_nan = number.partial_cmp(&number).is_none();
        self.word(if is_nan { u64::MAX } else { number.bits() });
    }

    fn vector<R: Bits>(&mut self, vector: R::Vec3) {
        for number in [vector.x(), vector.y(), vector.z()] {
            self.number(number);
        }
    }

    fn state<R: Bits>(&mut self, state: &State<R>) {
        self.vector::<R>(state.position);
        self.vector::<R>(state.linear_velocity);
        for number in state.orientation.xyzw() {
            self.number(number);
        }
        self.vector::<R>(state.angular_momentum);
    }
}

/// A smooth ball: one contact with a radius. The only part that is not built in, since no built-in body is one.
struct Ball<R: Real> {
    mass: R,
    moment: R,
    contact: [ContactPoint<R>; 1],
}

impl<R: Real> RigidPointBody<R> for Ball<R> {
    fn mass(&self) -> R {
        self.mass
    }
    fn inertia(&self) -> R::Mat3 {
        R::Mat3::from_diagonal(R::Vec3::new(self.moment, self.moment, self.moment))
    }
    fn contacts(&self) -> &[ContactPoint<R>] {
        &self.contact
    }
}

fn real<R: Real>(value: f64) -> R {
    R::from_f64(value)
}

fn vector<R: Real>(x: f64, y: f64, z: f64) -> R::Vec3 {
    R::Vec3::new(real(x), real(y), real(z))
}

/// At a place, with a velocity, a turn (as a rotation vector) and an angular momentum.
fn start<R: Real>([at, moves, turned, spins]: [[f64; 3]; 4]) -> State<R> {
    let vector = |[x, y, z]: [f64; 3]| vector::<R>(x, y, z);
    State::<R>::at(vector(at))
        .with_linear_velocity(vector(moves))
        .turned_by(vector(turned))
        .with_angular_momentum(vector(spins))
}

/// Points with x, y, z, radius and mass.
fn cloud<R: Real, const N: usize>(
    points: [[f64; 5]; N],
) -> Result<PointCloud<R, [ContactPoint<R>; N]>, SceneError> {
    let places = points.map(|[x, y, z, radius, _]| ContactPoint {
        position: vector::<R>(x, y, z),
        radius: real(radius),
    });
    PointCloud::in_storage(places, &points.map(|[.., mass]| real(mass)))
}

/// The hash of a run of so many time steps and a bit, so that the last step is a short one; and whether an error ended it.
fn follow<R: Bits, I: Integrator<R>>(
    stepper: &Stepper<
        R,
        impl RigidPointBody<R>,
        impl SpringDamperGround<R>,
        impl SlidingFriction<R>,
        impl Gravity<R>,
        I,
    >,
    mut state: State<R>,
    seconds: f64,
) -> (u64, bool) {
    let mut hash = Hash::new();
    let fold = |sample: &Sample<'_, R>| {
        hash.number(sample.time);
        hash.state(sample.state);
        if sample.step % 16 == 0 {
            hash.number(sample.energy().total());
            hash.number(sample.dissipation().total());
            if let Some(lowest) = sample.lowest_point() {
                hash.number(lowest.gap);
                hash.vector::<R>(lowest.slip);
            }
        }
        ControlFlow::Continue(())
    };
    let mut observers = (Ledger::new(), fold);
    let end = stepper.run(&mut state, real(seconds), &mut observers);
    let residue = observers.0.residue();
    hash.number(residue);
    hash.state(&state);
    (hash.0, end.is_err())
}

/// All scenes with one integrator, which is made from its time step (s).
fn scenes<R: Bits, I: Integrator<R>>(
    method: impl Fn(R) -> I,
    see: &mut dyn FnMut(&'static str, (u64, bool)),
) -> Result<(), SceneError> {
    let by = || method(real(1e-3));
    let gravity = UniformGravity::<R>::down(real(9.8));
    let slope = Plane::<R>::through(vector::<R>(0.1, -0.2, 0.05), vector::<R>(0.2, -0.1, 1.0));
    let coulomb = Coulomb::<R> {
        coefficient: real(0.3),
        slip_speed: real(1e-3),
    };
    let smooth = SmoothCoulomb::<R> {
        coefficient: real(0.4),
        slip_speed: real(1e-2),
    };
    let lopsided = cloud::<R, 5>([
        [0.31, 0.02, -0.11, 0.0, 0.4],
        [-0.17, 0.23, 0.05, 0.0, 0.3],
        [0.04, -0.29, 0.13, 0.0, 0.7],
        [-0.08, -0.06, 0.27, 0.0, 0.2],
        [0.11, 0.14, -0.21, 0.0, 0.5],
    ])?;
    let mass = real::<R>(1.0);
    let coin = Coin::<R>::ring(mass, real(0.5));

    // The report's own trials: a ring that rolls upright, one that spins, and their steep friction.
    for (name, number) in [("coin rolls", 1), ("coin spins", 6), ("coin leans", 7)] {
        if let Some(trial) = Trial::<R>::report(number) {
            see(name, follow(&trial.stepper(by())?, trial.state(), 0.3003));
        }
    }

    let thrown = start::<R>([
        [0.0, 0.0, 0.6],
        [0.7, -0.4, -0.5],
        [0.5, 0.9, -0.3],
        [0.2, 0.5, -0.3],
    ]);
    let stepper = Stepper::new(&coin)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(3000.0), real(4.0)).on(slope))?
        .with_friction(coulomb)?
        .with_integrator(by())?;
    see("coin tumbles", follow(&stepper, thrown, 0.5003));

    // All 120 points in touch.
    let lying = start::<R>([
        [0.0, 0.0, -2e-4],
        [0.8, 0.1, 0.0],
        [0.01, core::f64::consts::FRAC_PI_2, 0.0],
        [0.0, 0.02, 0.6],
    ]);
    let stepper = Stepper::new(&coin)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(200.0), real(1.0)))?
        .with_friction(smooth)?
        .with_integrator(by())?;
    see("coin lies", follow(&stepper, lying, 0.1003));

    let stepper = Stepper::new(&lopsided)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(4000.0), real(6.0)).on(slope))?
        .with_friction(smooth)?
        .with_integrator(by())?;
    see("cloud on a slope", follow(&stepper, thrown, 0.5003));

    let stepper = Stepper::new(&lopsided)?.with_integrator(by())?;
    see("cloud in empty space", follow(&stepper, thrown, 0.2003));

    let stepper = Stepper::new(&coin)?
        .with_gravity(gravity)?
        .with_ground(NoGround)?
        .with_friction(coulomb)?
        .with_integrator(by())?;
    see("coin in flight", follow(&stepper, thrown, 0.2003));

    let rod = cloud::<R, 3>([
        [-0.3, 0.0, 0.0, 0.0, 0.5],
        [0.1, 0.0, 0.0, 0.0, 0.2],
        [0.4, 0.0, 0.0, 0.0, 0.3],
    ])?;
    let stepper = Stepper::new(&rod)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(2000.0), real(3.0)))?
        .with_friction(coulomb)?
        .with_integrator(by())?;
    let falling = start::<R>([
        [0.0, 0.0, 0.3],
        [0.2, 0.6, 0.0],
        [0.0, 0.8, 0.1],
        [0.0, 0.02, 0.03],
    ]);
    see("rod", follow(&stepper, falling, 0.5003));

    let point = cloud::<R, 1>([[0.0, 0.0, 0.0, 0.0, 0.7]])?;
    let stepper = Stepper::new(&point)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(1500.0), real(2.0)).on(slope))?
        .with_friction(coulomb)?
        .with_integrator(by())?;
    see("point on a slope", follow(&stepper, thrown, 0.5003));

    // A slip speed whose square is below f32's normal numbers, on a body that comes to slide slowly.
    let slow = start::<R>([[0.0, 0.0, -4e-3], [0.02, -0.01, 0.0], [0.0; 3], [0.0; 3]]);
    let stepper = Stepper::new(&point)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(1500.0), real(20.0)))?
        .with_friction(SmoothCoulomb {
            coefficient: real(0.2),
            slip_speed: real(1e-21),
        })?
        .with_integrator(by())?;
    see("point comes to rest", follow(&stepper, slow, 0.3003));

    // Corners with a radius.
    let mut corners = [[0.0; 5]; 8];
    for (i, [x, y, z, radius, mass]) in corners.iter_mut().enumerate() {
        let side = |bit: usize| if i & bit == 0 { -0.2 } else { 0.2 };
        (*x, *y, *z, *radius, *mass) = (side(1), side(2), side(4), 0.03, 0.125);
    }
    let die = cloud::<R, 8>(corners)?;
    let stepper = Stepper::new(&die)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(2500.0), real(3.0)))?
        .with_friction(Frictionless)?
        .with_integrator(by())?;
    see("die without friction", follow(&stepper, thrown, 0.5003));

    let ball = Ball {
        mass,
        moment: real(0.036),
        contact: [ContactPoint {
            position: R::Vec3::ZERO,
            radius: real(0.3),
        }],
    };
    let stepper = Stepper::new(ball)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(2000.0), real(5.0)).on(slope))?
        .with_friction(smooth)?
        .with_integrator(by())?;
    see("ball on a slope", follow(&stepper, thrown, 0.5003));

    let law = LimitedDamper {
        stiffness: real(3000.0),
        damping: real(40.0),
    };
    let stepper = Stepper::new(&lopsided)?
        .with_gravity(gravity)?
        .with_ground(Ground { law, shape: slope })?
        .with_friction(coulomb)?
        .with_integrator(by())?;
    see("limited damper", follow(&stepper, thrown, 0.5003));

    for (name, exponent) in [("Hertz", 1.5), ("power of the depth", 1.3)] {
        let law = HuntCrossley {
            stiffness: real(20000.0),
            exponent: real(exponent),
            damping: real(0.2),
        };
        let stepper = Stepper::new(&lopsided)?
            .with_gravity(gravity)?
            .with_ground(Ground { law, shape: slope })?
            .with_friction(smooth)?
            .with_integrator(by())?;
        see(name, follow(&stepper, thrown, 0.5003));
    }

    let stribeck = Stribeck::<R> {
        static_coefficient: real(0.5),
        kinetic_coefficient: real(0.3),
        stribeck_speed: real(0.05),
        viscous: real(0.01),
        slip_speed: real(1e-3),
    };
    let (grain, coefficients) = (vector::<R>(0.6, 0.8, 0.0), [real(0.5), real(0.2)]);
    let anisotropic = AnisotropicCoulomb::<R>::on(slope.normal, grain, coefficients, real(1e-3));
    let viscous = Viscous::<R> {
        coefficient: real(0.4),
    };
    let frictions: [(&'static str, &dyn SlidingFriction<R>); 3] = [
        ("Stribeck's friction", &stribeck),
        ("friction with a grain", &anisotropic),
        ("viscous friction", &viscous),
    ];
    for (name, friction) in frictions {
        let stepper = Stepper::new(&lopsided)?
            .with_gravity(gravity)?
            .with_ground(FlatGround::level(real(4000.0), real(6.0)).on(slope))?
            .with_friction(friction)?
            .with_integrator(by())?;
        see(name, follow(&stepper, thrown, 0.5003));
    }

    let nickel = SolidCoin::new(mass, real(0.3), real(0.06));
    let stepper = Stepper::new(&nickel)?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(2000.0), real(2.0)).on(slope))?
        .with_friction(coulomb)?
        .with_integrator(by())?;
    see("solid coin", follow(&stepper, thrown, 0.5003));

    // Solids joined and turned, a hull, and round corners: all of the mass properties' arithmetic.
    let edges = vector::<R>(0.3, 0.4, 0.5);
    let hull = MassDistribution::hull(
        real(0.4),
        &[
            vector::<R>(0.1, 0.0, 0.0),
            vector::<R>(0.0, 0.2, 0.1),
            vector::<R>(-0.1, -0.1, 0.2),
            vector::<R>(0.1, 0.1, 0.3),
            vector::<R>(0.0, 0.1, -0.2),
        ],
    )?;
    let turn = Rotation::<R>::from_rotation_vector(vector::<R>(0.3, -0.2, 0.5));
    let heavy = MassDistribution::cuboid(mass, edges)
        .with(&MassDistribution::capsule(real(0.2), real(0.02), real(0.1)).turned(turn))
        .with(&MassDistribution::cone(real(0.3), real(0.05), real(0.1)))
        .with(&hull);
    let stepper = Stepper::new(Cuboid::loaded(edges, heavy).rounded(real(0.04)))?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(3000.0), real(3.0)))?
        .with_friction(smooth)?
        .with_integrator(by())?;
    see("loaded die", follow(&stepper, thrown, 0.5003));

    let stepper = Stepper::new(Cone::solid(mass, real(0.2), real(0.4)))?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(2000.0), real(3.0)))?
        .with_friction(coulomb)?
        .with_integrator(by())?;
    see("cone", follow(&stepper, thrown, 0.3003));

    let top = MassDistribution::ball(mass, real(0.25)).at(vector::<R>(0.0, 0.0, -0.08));
    let stepper = Stepper::new(Sphere::loaded(real(0.3), top))?
        .with_gravity(gravity)?
        .with_ground(FlatGround::level(real(2000.0), real(5.0)))?
        .with_friction(coulomb)?
        .with_integrator(by())?;
    see("loaded sphere", follow(&stepper, thrown, 0.5003));

    // Far beyond the explicit methods' limits: they are thrown off with whatever speed the first touch gives.
    let stepper = Stepper::new(&lopsided)?
        .with_gravity(NoGravity)?
        .with_ground(FlatGround::level(real(1e7), real(300.0)))?
        .with_friction(coulomb)?
        .with_integrator(method(real(1e-2)))?;
    see("stiff", follow(&stepper, falling, 2.003));
    Ok(())
}
