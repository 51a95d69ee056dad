//! The scenes and their hashes: every integrator, every built-in law and every kind of body, in
//! both precisions.
//!
//! A hash takes in all bits of the state after each step, and of what is computed from it: energy,
//! works, lowest point.
//!
//! A second battery, [`driven`], holds the parts that can drive a body or vary over the ground:
//! forces, ground that moves, friction by position, several surfaces, and events. Its rows follow
//! those of the first. A third one, [`rims`], holds bodies with several round rims. A fourth one,
//! [`hard`], holds steps of a frame on ground so stiff that they do not resolve a bounce.
//!
//! A last row is the battery of the live page, `examples/web`, which computes it in the browser. Its
//! scenes are those of the page's source.
//!
//! A new part joins by a line: a scene by a `play` at the end of [`first`] or [`driven`], with the
//! part in it; an integrator by a line in [`each_scene`], with the share ([`RISC_V`]) that it
//! belongs to in each of them. `UPDATE=1 cargo test --test bits` stores the new hashes.

use core::fmt;
use core::ops::ControlFlow;

#[path = "../../../examples/web/src/scenes/mod.rs"]
#[allow(dead_code, reason = "the page uses the rest")]
mod page;

use page::hash::{Bits, Hash};
use tumble::real::{Matrix, Vector};
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AirDrag, AnisotropicCoulomb, Apex, Block,
    BogackiShampine32, Bowl, Capsule, Coin, Cone, ConstantForce, ContactPoint, Coulomb, Cuboid,
    Disc, DormandPrince54, Ellipsoid, EnergyMomentum, Event, FlatGround, Flight, Force,
    ForwardEuler, FrictionField, FrictionPatch, Frictionless, Gravity, Ground, HuntCrossley,
    Integrator, Landing, Ledger, LimitedDamper, LoadDependentCoulomb, MassProperties, MovingGround,
    NoForce, NoGravity, NoGround, Nystrom, Plane, PointCloud, PointMass, Radau5, Ramp, Real,
    Region, RigidPointBody, Rim, Rk4, Rod, Rotation, Sample, SceneError, SlidingFriction, SlipEnds,
    SmoothCoulomb, SolidCoin, Sphere, SpinDrag, SpinLift, SpringDamper, SpringDamperGround, State,
    Stepper, StrangSplitting, Stribeck, SymplecticEuler, Terrain, ThickDisc, Trial, UniformGravity,
    Viscous, Waves, Wind, WithResistance,
};

/// True if this processor runs the rows that are the share of the RISC-V.
///
/// The RISC-V and the Cortex-M4F compute `f64` by integers, with the same functions of the
/// compiler's library, and an emulator takes minutes for all rows. So they share the rows between
/// them, and leave out [some](HARDWARE). The Cortex-M4F has a unit for `f32`, and runs all rows of
/// `f32` in addition to its share. Every other processor runs all rows.
const RISC_V: bool = !IS_CORTEX_M;
/// True if this processor runs the rows that are the share of the Cortex-M4F.
const CORTEX_M: bool = !IS_RISC_V;
/// True if this processor computes `f64` in a unit. It then runs the rows of `f64` too that would
/// cost the others minutes. On those each integrator runs in another battery, and each part with
/// another integrator.
const HARDWARE: bool = RISC_V && CORTEX_M;
const IS_RISC_V: bool = cfg!(all(target_os = "none", target_arch = "riscv32"));
const IS_CORTEX_M: bool = cfg!(all(target_os = "none", target_arch = "arm"));

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

/// Writes a line for each precision and integrator: `f64 EnergyMomentum 0123456789abcdef`, and then
/// those of the other batteries: `f64 EnergyMomentum, driven 0123456789abcdef`. The last
/// line is that of the live page. With `scenes`, it writes one for each scene too.
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
    macro_rules! with_each {
        ($($integrator:ident on $share:ident, driven on $driven:ident: $method:expr;)*) => {
            with_each!(scenes f32 "" $($integrator on $share: $method;)*);
            with_each!(scenes f64 "" $($integrator on $share: $method;)*);
            with_each!(driven f32 ", driven" $($integrator on $driven: $method;)*);
            with_each!(driven f64 ", driven" $($integrator on $driven: $method;)*);
        };
        ($battery:ident $real:ident $name:literal
            $($integrator:ident on $share:ident: $method:expr;)*) => {$(
            if const { $share || (IS_CORTEX_M && size_of::<$real>() == 4) } {
                $battery::<$real, _>($method, &mut |scene, (hash, ended_early)| see(Outcome {
                    precision: stringify!($real),
                    integrator: concat!(stringify!($integrator), $name),
                    scene,
                    hash,
                    ended_early,
                }))?;
            }
        )*};
    }
    // Integrators, each with the share that it belongs to, created from the step size (s) of the
    // scene.
    with_each! {
        ForwardEuler on RISC_V, driven on HARDWARE: |time_step| ForwardEuler { time_step };
        SymplecticEuler on CORTEX_M, driven on HARDWARE: |time_step| SymplecticEuler { time_step };
        StrangSplitting on RISC_V, driven on RISC_V: |time_step| StrangSplitting { time_step };
        Rk4 on CORTEX_M, driven on HARDWARE: |time_step| Rk4 { time_step };
        Nystrom on RISC_V, driven on HARDWARE: |time_step| Nystrom { time_step };
        EnergyMomentum on CORTEX_M, driven on CORTEX_M: |time_step| EnergyMomentum { time_step };
        BogackiShampine32 on CORTEX_M, driven on HARDWARE:
            |step| BogackiShampine32::new(tolerance(step));
        DormandPrince54 on RISC_V, driven on HARDWARE: |step| DormandPrince54::new(tolerance(step));
        Flight on CORTEX_M, driven on HARDWARE: |time_step| Flight(StrangSplitting { time_step });
    }
    // Its steps in the second battery would cost emulated processors ten minutes.
    macro_rules! adaptive {
        ($($real:ident)*) => {$(
            with_each!(scenes $real ""
                AdaptiveEnergyMomentum on RISC_V:
                    |step| AdaptiveEnergyMomentum::new(tolerance(step));
                AdaptiveNystrom on CORTEX_M: |step| AdaptiveNystrom::new(tolerance(step)););
        )*};
    }
    adaptive!(f32 f64);
    macro_rules! rims {
        ($($real:ident)*) => {$(
            with_each!(rims $real ", rims"
                Rk4 on CORTEX_M: |time_step| Rk4 { time_step };
                EnergyMomentum on CORTEX_M: |time_step| EnergyMomentum { time_step };
                DormandPrince54 on RISC_V: |step| DormandPrince54::new(tolerance(step));
                Radau5 on RISC_V: |step| Radau5::new(tolerance(step)););
        )*};
    }
    rims!(f32 f64);
    macro_rules! hard {
        ($($real:ident)*) => {$(
            with_each!(hard $real ", hard ground"
                EnergyMomentum on CORTEX_M: |time_step| EnergyMomentum { time_step };);
        )*};
    }
    hard!(f32 f64);
    if RISC_V {
        of_the_page(see);
    }
    Ok(())
}

/// Runs the battery of the live page.
fn of_the_page(see: &mut dyn FnMut(Outcome)) {
    for run in page::battery::runs() {
        let hash = run.hash();
        see(Outcome {
            precision: "f64",
            integrator: "live page",
            scene: run.name,
            hash: hash.unwrap_or_default(),
            ended_early: hash.is_err(),
        });
    }
}

/// For a method that chooses its steps: a tenth of what a metre a second covers in the time step
/// (s), m. A finer one costs emulated processors minutes.
fn tolerance<R: Real>(time_step: R) -> R {
    time_step * R::from_f64(0.1)
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
        impl Force<R>,
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
                hash.vector::<R>(lowest.slip_velocity);
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

/// A scene of the first four batteries. Its parts are behind `dyn`, which has the same bits: so
/// each integrator is compiled for one scene, not for all.
type AnyStepper<'a, R, I> = Stepper<
    &'a dyn RigidPointBody<R>,
    &'a dyn SpringDamperGround<R>,
    &'a dyn SlidingFriction<R>,
    &'a dyn Gravity<R>,
    I,
    R,
    &'a dyn Force<R>,
>;

/// Body, ground, friction and gravity of a scene of [`scenes`].
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
    // Their parts are known at compile time, so that each integrator is compiled a second time.
    // For processors with 32 bits the firmware and the live page show that this changes no bits,
    // and here it would cost minutes.
    let trials = [
        ("coin rolls", 1, 0.3003),
        ("coin spins", 6, 0.1003),
        ("coin leans", 7, 0.3003),
    ];
    for (name, number, seconds) in trials {
        if let Some(trial) = Trial::<R>::report(number) {
            let (method, start) = (method(real(1e-3)), trial.state());
            let outcome = if const { cfg!(target_pointer_width = "32") } {
                let (coin, ground) = (trial.coin(), trial.ground());
                let (friction, gravity) = (trial.friction(), trial.gravity());
                let stepper = compose((&coin, &ground, &friction, &gravity), method)?;
                follow(&stepper, start, seconds)
            } else {
                follow(&trial.stepper(method)?, start, seconds)
            };
            see(name, outcome);
        }
    }
    first(&mut |name, parts, start, time_step, seconds| {
        let stepper = compose(parts, method(real(time_step)))?;
        see(name, follow(&stepper, start, seconds));
        Ok(())
    })
}

/// Composes a scene of the first battery.
fn compose<'a, R: Bits, I: Integrator<R>>(
    (body, ground, friction, gravity): Parts<'a, R>,
    method: I,
) -> Result<AnyStepper<'a, R, I>, SceneError> {
    Stepper::builder(body)
        .gravity(gravity)
        .ground(ground)
        .friction(friction)
        .force(&NoForce as &dyn Force<R>)
        .integrator(method)
        .build()
}

/// Plays a scene of the first battery: its name, parts, start, time step (s) and duration (s).
type PlayFirst<'a, R> =
    dyn FnMut(&'static str, Parts<'_, R>, State<R>, f64, f64) -> Result<(), SceneError> + 'a;

/// Composes the scenes of [`scenes`]. It does not depend on the integrator, so it is compiled once
/// for each precision.
fn first<R: Bits>(play: &mut PlayFirst<'_, R>) -> Result<(), SceneError> {
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
    let heavy = MassProperties::cuboid(real(1.0), edges)?
        .with(&MassProperties::capsule(real(0.2), real(0.02), real(0.1))?.rotated(turn))
        .with(&MassProperties::cone(real(0.3), real(0.05), real(0.1))?)
        .with(&hull);
    let loaded_die = Cuboid::loaded(edges, heavy).rounded(real(0.04));
    let cone = Cone::solid(real(1.0), real(0.2), real(0.4));
    let load = MassProperties::ball(real(1.0), real(0.25))?.at(vector::<R>(0.0, 0.0, -0.08));
    let loaded_sphere = Sphere::loaded(real(0.3), load);
    let semi_axes = vector::<R>(0.3, 0.2, 0.15);
    let load = MassProperties::ellipsoid(real(1.0), semi_axes)?;
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
        let soft = level(1500.0, 20.0);
        play("point comes to rest", (&point, &soft, &steep, &falls), slow, 1e-3, 0.1003)?;
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

/// Ground, friction and applied force of a scene of [`driven`].
type DrivenParts<'a, R> = (
    &'a dyn RigidPointBody<R>,
    &'a dyn SpringDamperGround<R>,
    &'a dyn SlidingFriction<R>,
    &'a dyn Force<R>,
);

/// The hash of a run, and of the events of another one from the same state; and whether an error
/// ended one of them, or no event occurred.
fn follow_events<R: Bits, I: Integrator<R>>(
    stepper: &AnyStepper<'_, R, I>,
    start: State<R>,
    seconds: f64,
) -> Result<(u64, bool), SceneError> {
    let (run, ended_early) = follow(stepper, start, seconds);
    let mut hash = Hash::new();
    hash.word(run);
    let mut session = stepper.session(start);
    let passes = |sample: &Sample<'_, R>| sample.state.position.x() - real(0.1);
    let slip_ends = SlipEnds::below(real(1e-2))?;
    let events: [&dyn Event<R>; 4] = [&Landing, &Apex, &slip_ends, &passes];
    let mut count = 0_u32;
    let end = session.run_with_events(real(seconds), events, |occurrence| {
        count += 1;
        hash.word(occurrence.event as u64);
        hash.number(occurrence.time);
        hash.state(&occurrence.state);
        ControlFlow::Continue(())
    });
    hash.number(session.time());
    hash.state(session.state());
    Ok((hash.0, ended_early || end.is_err() || count == 0))
}

/// Plays a scene of the second battery: its name, parts and start.
type Play<'a, R> =
    dyn FnMut(&'static str, DrivenParts<'_, R>, State<R>) -> Result<(), SceneError> + 'a;

/// Composes and follows a scene of the second or third battery.
fn play_with_events<R: Bits, I: Integrator<R>>(
    method: &impl Fn(R) -> I,
    (body, ground, friction, force): DrivenParts<'_, R>,
    start: State<R>,
) -> Result<(u64, bool), SceneError> {
    let falls = UniformGravity::down(real::<R>(9.8));
    let stepper: AnyStepper<'_, R, I> = Stepper::builder(body)
        .gravity(&falls as &dyn Gravity<R>)
        .ground(ground)
        .friction(friction)
        .force(force)
        .integrator(method(real(1e-3)))
        .build()?;
    follow_events(&stepper, start, 0.3003)
}

/// All scenes of the third battery with one integrator, which is made from its time step (s):
/// bodies with two and more round rims.
fn rims<R: Bits, I: Integrator<R>>(
    method: impl Fn(R) -> I,
    see: &mut dyn FnMut(&'static str, (u64, bool)),
) -> Result<(), SceneError> {
    let mut play = |name, parts: DrivenParts<'_, R>, start| {
        see(name, play_with_events(&method, parts, start)?);
        Ok::<(), SceneError>(())
    };
    let coin = ThickDisc::<R>::solid(real(1.0), real(0.3), real(0.1), 40);
    let rim = |x: f64, radius: f64| {
        let normal = vector::<R>(1.0, 0.0, 0.0);
        Rim::new(vector::<R>(x, 0.02, 0.0), normal, real(radius), 40)
    };
    let wheel = Rims([rim(-0.1, 0.2), rim(0.0, 0.3), rim(0.1, 0.2)]);
    let tilted = level::<R>().on(slope());
    let walls = (level::<R>(), wall::<R>());
    let coulomb = coulomb::<R>();
    let rolling = start::<R>([
        [0.0, 0.0, 0.2995],
        [0.8, 0.1, 0.0],
        [0.0, 0.0, 1.6],
        [0.0, 0.1, 0.01],
    ]);
    play(
        "thick coin on a slope",
        (&coin, &tilted, &coulomb, &NoForce),
        thrown(),
    )?;
    play(
        "thick coin rolls on both rims",
        (&coin, &level(), &coulomb, &drag()),
        rolling,
    )?;
    play(
        "three rims between walls",
        (&wheel, &walls, &coulomb, &NoForce),
        thrown(),
    )
}

/// All scenes of the fourth battery with one integrator, which is made from its time step (s).
fn hard<R: Bits, I: Integrator<R>>(
    method: impl Fn(R) -> I,
    see: &mut dyn FnMut(&'static str, (u64, bool)),
) -> Result<(), SceneError> {
    let (falls, coulomb) = (UniformGravity::down(real::<R>(9.8)), coulomb::<R>());
    let mut play = |name, parts: (&dyn RigidPointBody<R>, &dyn SpringDamperGround<R>)| {
        let (body, ground) = parts;
        let stepper: AnyStepper<'_, R, I> = Stepper::builder(body)
            .gravity(&falls as &dyn Gravity<R>)
            .ground(ground)
            .friction(&coulomb as &dyn SlidingFriction<R>)
            .force(&NoForce as &dyn Force<R>)
            .integrator(method(real(1.0 / 60.0)))
            .build()?;
        see(name, follow(&stepper, thrown(), 2.003));
        Ok::<(), SceneError>(())
    };
    let floor = FlatGround::level(real::<R>(1e8), real::<R>(300.0));
    let rod = Rod::<R>::new(real(1.0), real(0.4));
    play("die on hard ground", (&die(), &floor))?;
    play("rod on hard ground", (&rod, &floor))?;
    play("egg on a hard slope", (&egg(), &floor.on(slope())))
}

/// A body that is nothing but three rims.
struct Rims<R: Real>([Rim<R>; 3]);

impl<R: Real> RigidPointBody<R> for Rims<R> {
    fn mass(&self) -> R {
        real(1.0)
    }
    fn inertia(&self) -> R::Mat3 {
        R::Mat3::from_diagonal(vector::<R>(0.03, 0.02, 0.02))
    }
    fn contacts(&self) -> &[ContactPoint<R>] {
        &[]
    }
    fn rims(&self) -> &[Rim<R>] {
        &self.0
    }
}

/// All scenes of the second battery with one integrator, which is made from its time step (s):
/// applied forces, ground that moves, friction by position, several surfaces, each with events.
fn driven<R: Bits, I: Integrator<R>>(
    method: impl Fn(R) -> I,
    see: &mut dyn FnMut(&'static str, (u64, bool)),
) -> Result<(), SceneError> {
    let mut play = |name, parts: DrivenParts<'_, R>, start| {
        see(name, play_with_events(&method, parts, start)?);
        Ok(())
    };
    with_forces(&mut play)?;
    on_moving_ground(&mut play)?;
    on_varying_ground(&mut play)?;
    among_walls(&mut play)
}

/// Falls onto an edge, with a spin.
fn thrown<R: Real>() -> State<R> {
    start::<R>([
        [0.0, 0.0, 0.4],
        [1.0, -0.4, -1.5],
        [0.5, 0.9, -0.3],
        [0.05, 0.2, -0.1],
    ])
}

/// Slides with its lowest point in the ground, if it is a ball with a radius of 0.2 m.
fn sliding<R: Real>() -> State<R> {
    start::<R>([
        [0.0, 0.0, 0.199],
        [0.8, 0.1, 0.0],
        [0.1, 0.2, 0.3],
        [0.0, 0.02, 0.1],
    ])
}

fn die<R: Real>() -> Cuboid<R> {
    Cuboid::solid(real(1.0), vector::<R>(0.3, 0.4, 0.5))
}

fn egg<R: Real>() -> Ellipsoid<R> {
    Ellipsoid::solid(real(1.0), vector::<R>(0.3, 0.2, 0.25))
}

fn level<R: Real>() -> FlatGround<R> {
    FlatGround::level(real(3000.0), real(4.0))
}

fn slope<R: Real>() -> Plane<R> {
    Plane::through(vector::<R>(0.1, -0.2, 0.05), vector::<R>(0.2, -0.1, 1.0))
}

/// A belt on a slope.
fn belt<R: Real>() -> MovingGround<FlatGround<R>, R> {
    let plane = slope::<R>();
    let along = plane.normal.cross(vector::<R>(0.3, 1.0, 0.2));
    MovingGround::conveyor(level().on(plane), along)
}

fn coulomb<R: Real>() -> Coulomb<R> {
    Coulomb {
        coefficient: real(0.4),
        slip_speed: real(1e-2),
    }
}

/// Friction with a coefficient from 0.2 to 0.4 along x.
fn field<R: Real>() -> impl SlidingFriction<R> {
    FrictionField::new(|position: R::Vec3| {
        let (sin, cos) = (position.x() * real(9.0)).sin_cos();
        SmoothCoulomb {
            coefficient: real::<R>(0.3) + sin * cos * real(0.2),
            slip_speed: real(1e-2),
        }
    })
}

fn drag<R: Real>() -> AirDrag<R> {
    AirDrag {
        linear: real(0.1),
        quadratic: real(0.05),
    }
}

fn spin_drag<R: Real>() -> SpinDrag<R> {
    SpinDrag {
        linear: real(1e-3),
        quadratic: real(2e-4),
    }
}

fn lift<R: Real>() -> SpinLift<R> {
    SpinLift::tennis_ball(real(0.2), real(1.2))
}

fn wind<R: Real>() -> Wind<(AirDrag<R>, SpinLift<R>), R> {
    Wind {
        velocity: vector::<R>(3.0, -4.0, 0.5),
        force: (drag(), lift()),
    }
}

fn thrust<R: Real>() -> ConstantForce<R> {
    let force = vector::<R>(0.5, 0.2, 1.0);
    ConstantForce { force }
}

fn with_forces<R: Bits>(play: &mut Play<'_, R>) -> Result<(), SceneError> {
    let ball = Sphere::<R>::solid(real(1.0), real(0.2));
    let air = (drag::<R>(), spin_drag::<R>(), lift::<R>());
    let tilted = level::<R>().on(slope());
    let coulomb = coulomb::<R>();
    play("ball in air", (&ball, &level(), &coulomb, &air), thrown())?;
    play(
        "die in wind",
        (&die(), &tilted, &coulomb, &wind()),
        thrown(),
    )?;
    let force = (thrust::<R>(), drag::<R>());
    play(
        "egg under thrust",
        (&egg(), &level(), &coulomb, &force),
        thrown(),
    )
}

fn on_moving_ground<R: Bits>(play: &mut Play<'_, R>) -> Result<(), SceneError> {
    let ball = Sphere::<R>::solid(real(1.0), real(0.2));
    let disc = Disc::<R>::solid(real(1.0), real(0.4), 40);
    let centre = vector::<R>(0.2, 0.1, 0.0);
    let table = MovingGround::turntable(level::<R>(), centre, real(-3.0));
    let resisting = WithResistance::<_, R> {
        friction: coulomb::<R>(),
        rolling: real(2e-3),
        spinning: real(5e-3),
        turn_speed: real(1e-2),
    };
    let law = SpringDamper::<R> {
        stiffness: real(3000.0),
        damping: real(4.0),
    };
    let shape = Terrain::of::<R>(Bowl::<R> {
        curvatures: [real(0.5); 2],
    });
    let bowl = MovingGround::turntable(Ground { law, shape }, R::Vec3::ZERO, real(4.0));
    let coulomb = coulomb::<R>();
    play(
        "die on a belt",
        (&die(), &belt(), &coulomb, &NoForce),
        thrown(),
    )?;
    play(
        "ball on a turntable",
        (&ball, &table, &resisting, &NoForce),
        sliding(),
    )?;
    play(
        "round rim on a belt",
        (&disc, &belt(), &coulomb, &NoForce),
        thrown(),
    )?;
    play(
        "egg in a bowl that turns",
        (&egg(), &bowl, &coulomb, &NoForce),
        thrown(),
    )
}

fn on_varying_ground<R: Bits>(play: &mut Play<'_, R>) -> Result<(), SceneError> {
    let ball = Sphere::<R>::solid(real(1.0), real(0.2));
    let patch = FrictionPatch {
        outside: coulomb::<R>(),
        inside: Viscous {
            coefficient: real(0.4),
        },
        region: Region::Ball {
            centre: vector::<R>(0.1, 0.0, 0.0),
            radius: real(0.2),
        },
    };
    let tilted = level::<R>().on(slope());
    play(
        "die on friction by place",
        (&die(), &tilted, &field(), &NoForce),
        thrown(),
    )?;
    play(
        "ball on a patch",
        (&ball, &level(), &patch, &NoForce),
        sliding(),
    )?;
    let all = (wind::<R>(), thrust::<R>(), spin_drag::<R>());
    play(
        "egg with all of them",
        (&egg(), &belt(), &field(), &all),
        thrown(),
    )
}

/// A wall that leans, in the way of [`thrown`] and [`sliding`] bodies.
fn wall<R: Real>() -> FlatGround<R> {
    let plane = Plane::through(vector::<R>(0.3, 0.0, 0.0), vector::<R>(-1.0, 0.2, 0.1));
    FlatGround::level(real(2000.0), real(3.0)).on(plane)
}

fn among_walls<R: Bits>(play: &mut Play<'_, R>) -> Result<(), SceneError> {
    let ball = Sphere::<R>::solid(real(1.0), real(0.2));
    let disc = Disc::<R>::solid(real(1.0), real(0.4), 40);
    let law = SpringDamper::<R> {
        stiffness: real(2500.0),
        damping: real(3.0),
    };
    let shape = Block {
        centre: vector::<R>(0.5, 0.0, 0.0),
        half: vector::<R>(0.2, 0.6, 0.1),
    };
    let with_wall = (level::<R>().on(slope()), wall::<R>());
    let two_planes = [level::<R>(), wall()];
    let step = (level::<R>(), Ground { law, shape });
    let viscous = Viscous {
        coefficient: real::<R>(0.4),
    };
    let laws = (coulomb::<R>(), viscous);
    let coulomb = coulomb::<R>();
    play(
        "die against a wall",
        (&die(), &with_wall, &laws, &NoForce),
        thrown(),
    )?;
    play(
        "ball along two walls",
        (&ball, &two_planes, &coulomb, &NoForce),
        sliding(),
    )?;
    play(
        "round rim at a step",
        (&disc, &step, &laws, &drag()),
        thrown(),
    )
}
