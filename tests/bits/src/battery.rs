//! The scenes and their hashes: every integrator, every built-in law and every kind of body, in
//! both precisions.
//!
//! A hash takes in all bits of the state after each step, and of what is computed from it: energy,
//! works, lowest point.
//!
//! A new part joins by a line: a scene by a `play` at the end of [`scenes`], with the part in it;
//! an integrator by a line in [`each_scene`]. `UPDATE=1 cargo test --test bits` stores the new
//! hashes.

use core::fmt;
use core::ops::ControlFlow;

use tumble::real::{Matrix, Quaternion, Vector};
use tumble::{
    AnisotropicCoulomb, BogackiShampine32, Bowl, Capsule, Coin, Cone, ContactPoint, Coulomb,
    Cuboid, Disc, DormandPrince54, Ellipsoid, EnergyMomentum, FlatGround, Flight, ForwardEuler,
    Frictionless, Gravity, Ground, HuntCrossley, Integrator, Ledger, LimitedDamper,
    LoadDependentCoulomb, MassProperties, NoGravity, NoGround, Nystrom, Plane, PointCloud,
    PointMass, Ramp, Real, RigidPointBody, Rk4, Rod, Rotation, Sample, SceneError, SlidingFriction,
    SmoothCoulomb, SolidCoin, Sphere, SpringDamper, SpringDamperGround, State, Stepper,
    StrangSplitting, Stribeck, SymplecticEuler, Terrain, Trial, UniformGravity, Viscous, Waves,
    WithResistance,
};

/// Result of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    pub precision: &'static str,
    pub integrator: &'static str,
    pub scene: &'static str,
    /// Hash of all bits.
    pub hash: u64,
    /// True if an error ended the run, which must not occur.
    pub ended_early: bool,
}

/// Writes a line for each precision and integrator: `f64 EnergyMomentum 0123456789abcdef`; with
/// `scenes`, one for each scene too.
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

/// Hash of one row: all scenes with one integrator, which is made from its time step (s).
///
/// A program that needs one row only contains the code of one integrator in one precision.
///
/// # Errors
/// If a scene cannot be composed, which is a fault of the battery.
pub fn row<R: Bits, I: Integrator<R>>(method: impl Fn(R) -> I) -> Result<u64, SceneError> {
    let mut row = Hash::new();
    scenes::<R, I>(method, &mut |_, (hash, _)| row.word(hash))?;
    let Hash(hash) = row;
    Ok(hash)
}

/// Runs all scenes, in one order.
///
/// # Errors
/// If a scene cannot be composed, which is a fault of the battery.
pub fn each_scene(see: &mut dyn FnMut(Outcome)) -> Result<(), SceneError> {
    macro_rules! with_each {
        ($($integrator:ident: $method:expr;)*) => {
            with_each!(f32 $($integrator: $method;)*);
            with_each!(f64 $($integrator: $method;)*);
        };
        ($real:ident $($integrator:ident: $method:expr;)*) => {$(
            scenes::<$real, _>($method, &mut |scene, (hash, ended_early)| see(Outcome {
                precision: stringify!($real),
                integrator: stringify!($integrator),
                scene,
                hash,
                ended_early,
            }))?;
        )*};
    }
    // Integrators, each created from the step size (s) of the scene.
    with_each! {
        ForwardEuler: |time_step| ForwardEuler { time_step };
        SymplecticEuler: |time_step| SymplecticEuler { time_step };
        StrangSplitting: |time_step| StrangSplitting { time_step };
        Rk4: |time_step| Rk4 { time_step };
        Nystrom: |time_step| Nystrom { time_step };
        EnergyMomentum: |time_step| EnergyMomentum { time_step };
        BogackiShampine32: |time_step| BogackiShampine32::new(tolerance(time_step));
        DormandPrince54: |time_step| DormandPrince54::new(tolerance(time_step));
        Flight: |time_step| Flight(StrangSplitting { time_step });
    }
    Ok(())
}

/// For a method that chooses its steps: a tenth of what a metre a second covers in the time step
/// (s), m. A finer one costs emulated processors minutes.
fn tolerance<R: Real>(time_step: R) -> R {
    time_step * R::from_f64(0.1)
}

/// A number's bits.
pub trait Bits: Real {
    /// Bits of the number.
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

/// A smooth ball: one contact with a radius. The only part that is not built in, since no built-in
/// body is one.
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

/// Start at a position, with a velocity, a rotation vector and an angular momentum.
fn start<R: Real>([at, moves, turned, spins]: [[f64; 3]; 4]) -> State<R> {
    let vector = |[x, y, z]: [f64; 3]| vector::<R>(x, y, z);
    State::<R>::at(vector(at))
        .with_linear_velocity(vector(moves))
        .with_rotation_vector(vector(turned))
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
    PointCloud::with_storage(places, &points.map(|[.., mass]| real(mass)))
}

/// Duration of a run with the energy audit, as a fraction of the run.
const AUDITED: f64 = 1.0 / 16.0;

/// The hash of a run of so many time steps and a bit, so that the last step is a short one; and
/// whether an error ended it.
fn follow<R: Bits, I: Integrator<R>>(
    stepper: &Stepper<
        impl RigidPointBody<R>,
        impl SpringDamperGround<R>,
        impl SlidingFriction<R>,
        impl Gravity<R>,
        I,
        R,
    >,
    mut state: State<R>,
    seconds: f64,
) -> (u64, bool) {
    let mut hash = Hash::new();
    let mut fold = |sample: &Sample<'_, R>| {
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
    let end = stepper.run(&mut state, real(seconds), &mut fold);
    // The audit follows the exact motion, at several times the cost of the run: a part is enough.
    let mut ledger = Ledger::new();
    let audited = stepper.run(&mut state, real(seconds * AUDITED), &mut ledger);
    hash.number(ledger.energy_error());
    hash.state(&state);
    (hash.0, end.is_err() || audited.is_err())
}

/// Body, ground, friction and gravity of a scene, behind `dyn`, which has the same bits: so each
/// integrator is compiled for one scene, not for all.
type Parts<'a, R> = (
    &'a dyn RigidPointBody<R>,
    &'a dyn SpringDamperGround<R>,
    &'a dyn SlidingFriction<R>,
    &'a dyn Gravity<R>,
);

/// All scenes with one integrator, which is made from its time step (s).
fn scenes<R: Bits, I: Integrator<R>>(
    method: impl Fn(R) -> I,
    see: &mut dyn FnMut(&'static str, (u64, bool)),
) -> Result<(), SceneError> {
    // The report's own trials: a ring that rolls upright, one that spins, and their steep friction.
    // Their parts are known at compile time.
    for (name, number) in [("coin rolls", 1), ("coin spins", 6), ("coin leans", 7)] {
        if let Some(trial) = Trial::<R>::report(number) {
            let stepper = trial.stepper(method(real(1e-3)))?;
            see(name, follow(&stepper, trial.state(), 0.3003));
        }
    }

    // Name, parts, start, time step (s), duration (s).
    let mut play = |name, parts: Parts<'_, R>, start, time_step, seconds| {
        let (body, ground, friction, gravity) = parts;
        let stepper = Stepper::new(body)?
            .with_gravity(gravity)?
            .with_ground(ground)?
            .with_friction(friction)?
            .with_integrator(method(real(time_step)))?;
        see(name, follow(&stepper, start, seconds));
        Ok::<(), SceneError>(())
    };

    let coin = Coin::<R>::ring(real(1.0), real(0.5));
    let lopsided = cloud::<R, 5>([
        [0.31, 0.02, -0.11, 0.0, 0.4],
        [-0.17, 0.23, 0.05, 0.0, 0.3],
        [0.04, -0.29, 0.13, 0.0, 0.7],
        [-0.08, -0.06, 0.27, 0.0, 0.2],
        [0.11, 0.14, -0.21, 0.0, 0.5],
    ])?;
    let rod = cloud::<R, 3>([
        [-0.3, 0.0, 0.0, 0.0, 0.5],
        [0.1, 0.0, 0.0, 0.0, 0.2],
        [0.4, 0.0, 0.0, 0.0, 0.3],
    ])?;
    let point = cloud::<R, 1>([[0.0, 0.0, 0.0, 0.0, 0.7]])?;
    // Corners with a radius.
    let die = cloud::<R, 8>(core::array::from_fn(|i| {
        let side = |bit: usize| if i & bit == 0 { -0.2 } else { 0.2 };
        [side(1), side(2), side(4), 0.03, 0.125]
    }))?;
    let ball = Ball {
        mass: real(1.0),
        moment: real(0.036),
        contact: [ContactPoint {
            position: R::Vec3::ZERO,
            radius: real(0.3),
        }],
    };

    let disc = Disc::<R>::solid(real(1.0), real(0.5), 40);
    let nickel = SolidCoin::new(real(1.0), real(0.3), real(0.06));
    // Joined and rotated solids, a hull, and round corners: all of the arithmetic of the mass
    // properties.
    let edges = vector::<R>(0.3, 0.4, 0.5);
    let hull = MassProperties::hull(
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
    let heavy = MassProperties::cuboid(real(1.0), edges)
        .with(&MassProperties::capsule(real(0.2), real(0.02), real(0.1)).turned(turn))
        .with(&MassProperties::cone(real(0.3), real(0.05), real(0.1)))
        .with(&hull);
    let loaded_die = Cuboid::loaded(edges, heavy).rounded(real(0.04));
    let cone = Cone::solid(real(1.0), real(0.2), real(0.4));
    let load = MassProperties::ball(real(1.0), real(0.25)).at(vector::<R>(0.0, 0.0, -0.08));
    let loaded_sphere = Sphere::loaded(real(0.3), load);
    let semi_axes = vector::<R>(0.3, 0.2, 0.15);
    let load = MassProperties::ellipsoid(real(1.0), semi_axes);
    let egg = Ellipsoid::loaded(semi_axes, load.at(vector::<R>(0.02, 0.0, -0.01)));

    let level = |stiffness, damping| FlatGround::level(real(stiffness), real(damping));
    let plane = Plane::<R>::through(vector::<R>(0.1, -0.2, 0.05), vector::<R>(0.2, -0.1, 1.0));
    let slope = |stiffness, damping| level(stiffness, damping).on(plane);
    let falls = UniformGravity::<R>::down(real(9.8));
    let coulomb = Coulomb::<R> {
        coefficient: real(0.3),
        slip_speed: real(1e-3),
    };
    let smooth = SmoothCoulomb::<R> {
        coefficient: real(0.4),
        slip_speed: real(1e-2),
    };
    let limited = Ground {
        law: LimitedDamper {
            stiffness: real(3000.0),
            damping: real(40.0),
        },
        shape: plane,
    };
    let hertzian = |exponent| Ground {
        law: HuntCrossley {
            stiffness: real(20000.0),
            exponent: real(exponent),
            damping: real(0.2),
        },
        shape: plane,
    };
    let stribeck = Stribeck::<R> {
        static_coefficient: real(0.5),
        kinetic_coefficient: real(0.3),
        stribeck_speed: real(0.05),
        viscous: real(0.01),
        slip_speed: real(1e-3),
    };
    let (grain, coefficients) = (vector::<R>(0.6, 0.8, 0.0), [real(0.5), real(0.2)]);
    let grained = AnisotropicCoulomb::<R>::on(plane.normal, grain, coefficients, real(1e-3));
    let viscous = Viscous::<R> {
        coefficient: real(0.4),
    };
    let resisting = WithResistance::<_, R> {
        friction: smooth,
        rolling: real(2e-3),
        spinning: real(5e-3),
        turn_speed: real(1e-2),
    };
    let weakening = LoadDependentCoulomb::<R> {
        coefficient: real(0.5),
        transition_load: real(20.0),
        slip_speed: real(1e-3),
    };
    // The square of its slip speed is below f32's normal numbers.
    let steep = SmoothCoulomb::<R> {
        coefficient: real(0.2),
        slip_speed: real(1e-21),
    };

    let law = SpringDamper::<R> {
        stiffness: real(4000.0),
        damping: real(6.0),
    };
    let height_field = Waves::<R> {
        amplitude: real(0.05),
        length: real(1.0),
    };
    let waves = Ground {
        law,
        shape: Terrain { height_field },
    };
    let height_field = Ramp::<R> {
        slope: real(0.3),
        width: real(0.2),
    };
    let ramp = Ground {
        law,
        shape: Terrain { height_field },
    };
    let height_field = Bowl::<R> {
        curvatures: [real(0.7), real(0.3)],
    };
    let bowl = Ground {
        law,
        shape: Terrain { height_field },
    };

    // Position, velocity, rotation vector and angular momentum.
    let thrown = start::<R>([
        [0.0, 0.0, 0.6],
        [0.7, -0.4, -0.5],
        [0.5, 0.9, -0.3],
        [0.2, 0.5, -0.3],
    ]);
    let falling = start::<R>([
        [0.0, 0.0, 0.3],
        [0.2, 0.6, 0.0],
        [0.0, 0.8, 0.1],
        [0.0, 0.02, 0.03],
    ]);
    // All points of a coin in touch.
    let lying = start::<R>([
        [0.0, 0.0, -2e-4],
        [0.8, 0.1, 0.0],
        [0.01, core::f64::consts::FRAC_PI_2, 0.0],
        [0.0, 0.02, 0.6],
    ]);
    let slow = start::<R>([[0.0, 0.0, -4e-3], [0.02, -0.01, 0.0], [0.0; 3], [0.0; 3]]);

    #[rustfmt::skip] // a line a scene
    let () = {
        play("coin tumbles", (&coin, &slope(3000.0, 4.0), &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        play("coin lies", (&coin, &level(200.0, 1.0), &smooth, &falls), lying, 1e-3, 0.1003)?;
        play("cloud on a slope", (&lopsided, &slope(4000.0, 6.0), &smooth, &falls), thrown, 1e-3, 0.5003)?;
        play("cloud in empty space", (&lopsided, &NoGround, &Frictionless, &NoGravity), thrown, 1e-3, 0.2003)?;
        play("coin in flight", (&coin, &NoGround, &coulomb, &falls), thrown, 1e-3, 0.2003)?;
        play("rod", (&rod, &level(2000.0, 3.0), &coulomb, &falls), falling, 1e-3, 0.5003)?;
        play("point on a slope", (&point, &slope(1500.0, 2.0), &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        // Comes to slide slowly.
        play("point comes to rest", (&point, &level(1500.0, 20.0), &steep, &falls), slow, 1e-3, 0.3003)?;
        play("die without friction", (&die, &level(2500.0, 3.0), &Frictionless, &falls), thrown, 1e-3, 0.5003)?;
        play("ball on a slope", (&ball, &slope(2000.0, 5.0), &smooth, &falls), thrown, 1e-3, 0.5003)?;
        play("limited damper", (&lopsided, &limited, &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        play("Hertz", (&lopsided, &hertzian(1.5), &smooth, &falls), thrown, 1e-3, 0.5003)?;
        play("power of the depth", (&lopsided, &hertzian(1.3), &smooth, &falls), thrown, 1e-3, 0.5003)?;
        play("Stribeck's friction", (&lopsided, &slope(4000.0, 6.0), &stribeck, &falls), thrown, 1e-3, 0.5003)?;
        play("friction that falls with the load", (&lopsided, &slope(4000.0, 6.0), &weakening, &falls), thrown, 1e-3, 0.5003)?;
        play("friction with a grain", (&lopsided, &slope(4000.0, 6.0), &grained, &falls), thrown, 1e-3, 0.5003)?;
        play("viscous friction", (&lopsided, &slope(4000.0, 6.0), &viscous, &falls), thrown, 1e-3, 0.5003)?;
        play("waves", (&lopsided, &waves, &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        play("ramp", (&lopsided, &ramp, &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        play("ball in a bowl", (&ball, &bowl, &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        play("ball that rolls out", (&ball, &level(2000.0, 5.0), &resisting, &falls), thrown, 1e-3, 0.5003)?;
        play("cloud that resists turning", (&lopsided, &slope(4000.0, 6.0), &resisting, &falls), thrown, 1e-3, 0.5003)?;
        play("solid coin", (&nickel, &slope(2000.0, 2.0), &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        play("loaded die", (&loaded_die, &level(3000.0, 3.0), &smooth, &falls), thrown, 1e-3, 0.5003)?;
        play("cone", (&cone, &level(2000.0, 3.0), &coulomb, &falls), thrown, 1e-3, 0.3003)?;
        play("loaded sphere", (&loaded_sphere, &level(2000.0, 5.0), &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        play("egg", (&egg, &level(2000.0, 5.0), &smooth, &falls), thrown, 1e-3, 0.5003)?;
        play("round rim", (&disc, &slope(3000.0, 4.0), &coulomb, &falls), thrown, 1e-3, 0.5003)?;
        play("round rim lies", (&disc, &level(200.0, 1.0), &smooth, &falls), lying, 1e-3, 0.1003)?;
        play("round rim in a bowl", (&disc, &bowl, &coulomb, &falls), thrown, 1e-3, 0.3003)?;
        play("capsule", (&Capsule::solid(real(1.0), real(0.1), real(0.4)), &level(2000.0, 3.0), &smooth, &falls), thrown, 1e-3, 0.5003)?;
        play("thin rod", (&Rod::new(real(1.0), real(0.8)), &slope(2000.0, 3.0), &smooth, &falls), thrown, 1e-3, 0.5003)?;
        play("point mass", (&PointMass::new(real(0.7)), &slope(1500.0, 2.0), &grained, &falls), thrown, 1e-3, 0.5003)?;
        // Far beyond the explicit methods' limits: they are thrown off with whatever speed the
        // first touch gives.
        play("stiff", (&lopsided, &level(1e7, 300.0), &coulomb, &NoGravity), falling, 1e-2, 2.003)?;
    };
    Ok(())
}
