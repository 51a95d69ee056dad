//! Loading of every type that can be saved, from any text and from edited valid texts.
//!
//! What loads is used like a value of a constructor, and loads again from its own text.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use tumble::ensemble::{Ensemble, Histogram, RandomStart, SceneHash, Throw, Uniform};
use tumble::{
    AnisotropicCoulomb, AnyIntegrator, Bowl, Capsule, Carried, Coin, CoinFace, Cone, ContactPoint,
    Coulomb, Cuboid, CuboidFace, Disc, Dissipation, Ellipsoid, Energy, EnergyMomentum, FlatGround,
    Flight, Frictionless, Ground, HullFace, HuntCrossley, LimitedDamper, LoadDependentCoulomb,
    MassProperties, Moment, NoForce, NoGravity, NoGround, Outcome, Plane, PointMass, Ramp, Real,
    RigidPointBody, Rod, SavedSession, SlidingFriction, SmoothCoulomb, Solid, SolidCoin, Sphere,
    SpringDamper, SpringDamperGround, State, StepControl, Stepper, Stribeck, Terrain, ThickDisc,
    Trial, UniformGravity, Viscous, Waves, WithResistance,
};

use super::input::Input;
use super::parts::{Meter, Method, Parts};
use super::scene::steps;

/// Plays an input.
pub fn run(data: &[u8]) {
    let mut input = Input::new(data);
    match input.below(3) {
        0 => play_of_one_precision(&mut input),
        1 => play_f32(&mut input),
        _ => play_f64(&mut input),
    }
}

// -----------------------------------------------------------------------------------------------
// Texts
// -----------------------------------------------------------------------------------------------

/// The JSON text with up to 8 of its leaves replaced.
pub fn edited(text: &str, input: &mut Input<'_>) -> String {
    let mut value: Value = serde_json::from_str(text).unwrap();
    for _ in 0..input.below(9) {
        let mut count = usize::from(input.byte());
        let leaf = leaf(input);
        let leaves = count_leaves(&value).max(1);
        count %= leaves;
        replace(&mut value, &mut count, &leaf);
    }
    value.to_string()
}

fn leaf(input: &mut Input<'_>) -> Value {
    match input.below(10) {
        0 => Value::Null,
        1 => Value::from(input.long()),
        2 => Value::from(input.byte()),
        3 => Value::from(u64::MAX - u64::from(input.byte())),
        4 => Value::from(-i64::from(input.byte())),
        5 => Value::Array(vec![Value::from(input.byte()); usize::from(input.below(5))]),
        6 => Value::from(format!("{:x}", input.long())),
        _ => Value::from(input.signed::<f64>(1e-9, 1e9)),
    }
}

fn count_leaves(value: &Value) -> usize {
    match value {
        Value::Array(items) if !items.is_empty() => items.iter().map(count_leaves).sum(),
        Value::Object(items) if !items.is_empty() => items.values().map(count_leaves).sum(),
        _ => 1,
    }
}

fn replace(value: &mut Value, count: &mut usize, leaf: &Value) {
    let inner: Vec<&mut Value> = match value {
        Value::Array(items) if !items.is_empty() => items.iter_mut().collect(),
        Value::Object(items) if !items.is_empty() => items.values_mut().collect(),
        _ => {
            if *count == 0 {
                *value = leaf.clone();
            }
            *count = count.wrapping_sub(1);
            return;
        }
    };
    for value in inner {
        replace(value, count, leaf);
    }
}

/// A value from an edited text of `valid`, or from the bytes that are left.
fn loaded<T: Serialize + DeserializeOwned>(valid: &T, input: &mut Input<'_>) -> Option<T> {
    let valid = serde_json::to_string(valid).unwrap();
    let text = if input.byte() < 224 {
        edited(&valid, input)
    } else {
        String::from_utf8(input.rest().to_vec()).ok()?
    };
    if takes_much_memory(&text) {
        return None;
    }
    let value = serde_json::from_str::<T>(&text).ok()?;
    let own = serde_json::to_string(&value).unwrap();
    match serde_json::from_str::<T>(&own) {
        Ok(again) => assert_eq!(serde_json::to_string(&again).unwrap(), own),
        // A number beyond f32 is an infinity, which JSON does not have.
        Err(error) => assert!(own.contains("null"), "{error}: {own}"),
    }
    Some(value)
}

/// Returns true for a body with many contacts. They are allowed and only take long.
fn takes_much_memory(text: &str) -> bool {
    let value: Option<Value> = serde_json::from_str(text).ok();
    let points = value.as_ref().and_then(|value| value.get("points"));
    points
        .and_then(Value::as_u64)
        .is_some_and(|count| count > 500)
}

// -----------------------------------------------------------------------------------------------
// Values
// -----------------------------------------------------------------------------------------------

/// Values that exist in one precision only.
fn play_of_one_precision(input: &mut Input<'_>) {
    match input.below(6) {
        0 => {
            let valid = Histogram::new(-1.0, 1.0, 3).unwrap();
            if let Some(mut histogram) = loaded(&valid, input) {
                super::outcome::query(&histogram);
                for _ in 0..4 {
                    histogram.add(input.signed(1e-3, 10.0));
                }
                super::outcome::query(&histogram);
            }
        }
        1 => {
            let _ = loaded(&SceneHash::of_bytes(b"fuzz"), input);
        }
        2 => start(input),
        3 => {
            let outcome = Outcome::Decided(CoinFace::Edge);
            let _ = loaded(&outcome, input);
            let _ = loaded(&CuboidFace::X, input).map(CuboidFace::pips);
        }
        4 => {
            let _ = loaded(&HullFace { contacts: [0; 3] }, input);
        }
        _ => {
            let _ = loaded(&Uniform::from(0.0..=1.0), input);
        }
    }
}

/// A start distribution draws a state, or is refused.
fn start(input: &mut Input<'_>) {
    let valid = RandomStart::at_height(0.1..=0.2).with_tilt(tumble::glam::DVec3::X, 0.0..=0.1);
    let Some(start) = loaded(&valid, input) else {
        return;
    };
    let stepper = Stepper::new(Coin::<f64>::ring(1.0, 0.5))
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
        .and_then(|stepper| stepper.with_ground(FlatGround::level(1e4, 1.0)));
    let stepper = stepper.unwrap();
    let Ok(throw) = Throw::new(&stepper, start, 0.0) else {
        return;
    };
    let ensemble = Ensemble::new(input.long(), throw.scene_hash());
    let mut toss = ensemble.toss(input.long());
    if let Ok(state) = throw.start(&mut toss) {
        let length = state.orientation.length();
        assert!(
            (length - 1.0).abs() < 1e-14,
            "{start:?} turns by a length {length}"
        );
    }
}

macro_rules! play {
    ($play:ident, $real:ident) => {
        fn $play(input: &mut Input<'_>) {
            type R = $real;
            match input.below(4) {
                0 => {
                    let kind = input.below(12);
                    bodies::<R>(kind, input);
                }
                1 => {
                    let kind = input.below(9);
                    grounds::<R>(kind, input);
                }
                2 => {
                    let kind = input.below(8);
                    frictions::<R>(kind, input);
                }
                _ => {
                    let kind = input.below(12);
                    others::<R>(kind, input);
                }
            }
        }
    };
}
play!(play_f32, f32);
play!(play_f64, f64);

/// Number types whose vectors can be saved.
trait Saved:
    Real<
        Vec3: Serialize + DeserializeOwned,
        Quat: Serialize + DeserializeOwned,
        Mat3: Serialize + DeserializeOwned,
    > + Serialize
    + DeserializeOwned
{
}
impl Saved for f32 {}
impl Saved for f64 {}

fn bodies<R: Saved>(kind: u8, input: &mut Input<'_>) {
    let n = R::from_f64;
    let (mass, half, tenth) = (R::ONE, R::HALF, n(0.1));
    let points = || vec![ContactPoint::<R>::default(); 12];
    let edges = vector::<R>([0.3, 0.2, 0.1]);
    match kind {
        0 => throw(
            loaded(&Coin::ring_with_storage(points(), mass, half), input),
            input,
        ),
        1 => throw(loaded(&Coin::<R>::ring(mass, half), input), input),
        2 => {
            let coin = SolidCoin::new_with_storage(points(), mass, half, tenth);
            throw(loaded(&coin, input), input);
        }
        3 => throw(
            loaded(
                &Cone::solid_with_storage(points(), mass, half, tenth),
                input,
            ),
            input,
        ),
        4 => throw(loaded(&Disc::solid(mass, half, 12), input), input),
        5 => throw(
            loaded(&Cuboid::solid(mass, edges).rounded(n(0.01)), input),
            input,
        ),
        6 => throw(loaded(&Sphere::solid(mass, half), input), input),
        7 => throw(loaded(&Ellipsoid::solid(mass, edges), input), input),
        8 => throw(loaded(&Capsule::solid(mass, tenth, half), input), input),
        9 => throw(loaded(&Rod::new(mass, half), input), input),
        10 => throw(loaded(&PointMass::new(mass), input), input),
        _ => throw(
            loaded(&ThickDisc::solid(mass, half, tenth, 12), input),
            input,
        ),
    }
}

fn vector<R: Real>(numbers: [f64; 3]) -> R::Vec3 {
    let [x, y, z] = numbers.map(R::from_f64);
    tumble::real::Vector::new(x, y, z)
}

fn flat<R: Real>() -> FlatGround<R> {
    FlatGround::level(R::from_f64(1e4), R::ONE)
}

/// A body that loads is one that a scene accepts, and it moves.
fn throw<R: Real>(body: Option<impl RigidPointBody<R> + 'static>, input: &mut Input<'_>) {
    let Some(body) = body else {
        return;
    };
    let refused = Stepper::new(&body).err();
    assert!(refused.is_none(), "a loaded body is refused: {refused:?}");
    play_parts(
        Box::new(body),
        Box::new(flat()),
        Box::new(Frictionless),
        input,
    );
}

/// A scene steps, or is refused.
fn play_parts<R: Real>(
    body: Box<dyn RigidPointBody<R>>,
    ground: Box<dyn SpringDamperGround<R>>,
    friction: Box<dyn SlidingFriction<R>>,
    input: &mut Input<'_>,
) {
    let time_step = R::from_f64(1e-3);
    let parts = Parts {
        body,
        ground: Meter::new(ground, true),
        friction,
        gravity: UniformGravity::down(R::from_f64(9.8)),
        method: Method {
            method: EnergyMomentum { time_step }.into(),
            flies: false,
        },
        force: Box::new(NoForce),
        is_extended: false,
    };
    if let Ok(stepper) = parts.stepper() {
        let mut state = super::parts::state(input);
        steps(&stepper, &mut state, 4, input);
    }
}

fn grounds<R: Saved>(kind: u8, input: &mut Input<'_>) {
    let n = R::from_f64;
    let (stiffness, damping) = (n(1e4), R::ONE);
    let law = SpringDamper { stiffness, damping };
    let shape = Plane::level(R::ZERO);
    macro_rules! terrain {
        ($height_field:expr) => {{
            let height_field = $height_field;
            let shape = Terrain { height_field };
            fall(loaded(&Ground { law, shape }, input), input)
        }};
    }
    match kind {
        0 => fall(loaded(&flat::<R>(), input), input),
        1 => fall(loaded(&Ground { law, shape }, input), input),
        2 => {
            let law = LimitedDamper { stiffness, damping };
            fall(loaded(&Ground { law, shape }, input), input);
        }
        3 => {
            let law = HuntCrossley::hertz(stiffness, damping);
            fall(loaded(&Ground { law, shape }, input), input);
        }
        4 => terrain!(Bowl {
            curvatures: [R::HALF, R::ONE]
        }),
        5 => terrain!(Ramp {
            slope: R::HALF,
            width: R::HALF
        }),
        6 => terrain!(Waves {
            amplitude: n(0.1),
            length: R::ONE
        }),
        7 => fall::<R>(loaded(&NoGround, input), input),
        _ => {
            let carried = Carried {
                mass: R::ONE,
                contacts: 3,
            };
            if let Some(carried) = loaded(&carried, input) {
                let law = SpringDamper::from_bounce(carried, R::HALF, n(0.1));
                fall(law.ok().map(|law| Ground { law, shape }), input);
            }
        }
    }
}

fn cube<R: Real>() -> Box<dyn RigidPointBody<R>> {
    Box::new(Cuboid::cube(R::ONE, R::HALF))
}

fn fall<R: Real>(ground: Option<impl SpringDamperGround<R> + 'static>, input: &mut Input<'_>) {
    if let Some(ground) = ground {
        play_parts(cube(), Box::new(ground), Box::new(Frictionless), input);
    }
}

fn slide<R: Real>(friction: Option<impl SlidingFriction<R> + 'static>, input: &mut Input<'_>) {
    if let Some(friction) = friction {
        play_parts(cube(), Box::new(flat()), Box::new(friction), input);
    }
}

fn frictions<R: Saved>(kind: u8, input: &mut Input<'_>) {
    let n = R::from_f64;
    let (coefficient, slip_speed) = (R::HALF, n(1e-3));
    let coulomb = Coulomb {
        coefficient,
        slip_speed,
    };
    match kind {
        0 => slide::<R>(loaded(&Frictionless, input), input),
        1 => slide(loaded(&coulomb, input), input),
        2 => slide(
            loaded(
                &SmoothCoulomb {
                    coefficient,
                    slip_speed,
                },
                input,
            ),
            input,
        ),
        3 => {
            let stribeck = Stribeck {
                static_coefficient: R::ONE,
                kinetic_coefficient: coefficient,
                stribeck_speed: n(0.1),
                viscous: R::ZERO,
                slip_speed,
            };
            slide(loaded(&stribeck, input), input);
        }
        4 => {
            let transition_load = R::ONE;
            let law = LoadDependentCoulomb {
                coefficient,
                transition_load,
                slip_speed,
            };
            slide(loaded(&law, input), input);
        }
        5 => {
            let [normal, along] = [vector::<R>([0.0, 0.0, 1.0]), vector::<R>([1.0, 0.0, 0.0])];
            let coefficients = [coefficient, R::ONE];
            let law = AnisotropicCoulomb::<R>::on(normal, along, coefficients, slip_speed);
            slide(loaded(&law, input), input);
        }
        6 => slide(loaded(&Viscous { coefficient }, input), input),
        _ => {
            let law = WithResistance {
                friction: coulomb,
                rolling: n(1e-3),
                spinning: n(1e-3),
                turn_speed: n(1e-3),
            };
            slide(loaded(&law, input), input);
        }
    }
}

fn others<R: Saved>(kind: u8, input: &mut Input<'_>) {
    let start = State::at(vector::<R>([0.0, 0.0, 1.0]));
    match kind {
        0 | 1 => {
            if let Some(mut state) = loaded(&start, input) {
                let parts = standard::<R>(
                    EnergyMomentum {
                        time_step: R::from_f64(1e-3),
                    }
                    .into(),
                );
                steps(&parts.stepper().unwrap(), &mut state, 4, input);
            }
        }
        2..=4 => session(&start, input),
        5 => {
            let control = StepControl::<R> {
                next_step: Some(R::HALF),
                last_error: Some(R::ZERO),
                orientation: Some(start.orientation),
            };
            let _ = loaded(&control, input).map(|control| control.check());
        }
        6 => {
            let any = AnyIntegrator::from(tumble::DormandPrince54::<R>::new(R::from_f64(1e-3)));
            let any = loaded(&Flight(any), input);
            if let Some(Flight(method)) = any {
                let parts = standard::<R>(method);
                if let Ok(stepper) = parts.stepper() {
                    steps(&stepper, &mut start.clone(), 4, input);
                }
            }
        }
        7 => {
            let body = Sphere::solid(R::ONE, R::HALF);
            let masses = MassProperties::ball(R::ONE, body.radius()).unwrap();
            let masses = loaded::<MassProperties<R>>(&masses, input);
            if let Some(solid) = masses
                .and_then(|masses| Solid::new(masses, vec![ContactPoint::<R>::default()]).ok())
            {
                play_parts(
                    Box::new(solid),
                    Box::new(flat()),
                    Box::new(Frictionless),
                    input,
                );
            }
        }
        8 => {
            let trial = Trial::<R>::report(1).unwrap();
            if let Some(trial) = loaded(&trial, input) {
                let method = EnergyMomentum {
                    time_step: R::from_f64(1e-3),
                };
                if let Ok(stepper) = trial.stepper(method) {
                    let _ = stepper.energy(&trial.state()).total();
                }
            }
        }
        9 => {
            let moment = Moment {
                time: R::ZERO,
                steps: 0,
                state: start,
            };
            let _ = loaded(&moment, input);
        }
        10 => {
            let _ = loaded(&Energy::<R>::default(), input);
            let _ = loaded(&Dissipation::<R>::default(), input);
        }
        _ => {
            let _ = loaded(&UniformGravity::<R>::down(R::ONE), input);
            let _ = loaded(&NoGravity, input);
            let _ = loaded(&ContactPoint::<R>::default(), input);
        }
    }
}

/// A cube on level ground.
fn standard<R: Real>(method: AnyIntegrator<R>) -> Parts<R> {
    Parts {
        body: cube(),
        ground: Meter::new(Box::new(flat()), true),
        friction: Box::new(Frictionless),
        gravity: UniformGravity::down(R::from_f64(9.8)),
        method: Method {
            method,
            flies: false,
        },
        force: Box::new(NoForce),
        is_extended: false,
    }
}

/// A saved session that loads can be resumed, or is refused.
fn session<R: Saved>(start: &State<R>, input: &mut Input<'_>) {
    let mut method = tumble::DormandPrince54::<R>::new(R::from_f64(1e-3));
    method.budget = 100;
    let time_step = R::from_f64(1e-3);
    let parts = standard::<R>(if input.flag() {
        method.into()
    } else {
        EnergyMomentum { time_step }.into()
    });
    let stepper = parts.stepper().unwrap();
    let mut session = stepper.session(*start);
    session.step().unwrap();
    let Some(saved) = loaded::<SavedSession<R>>(&session.save(), input) else {
        return;
    };
    let Ok(mut session) = stepper.resume(&saved) else {
        return;
    };
    for _ in 0..3 {
        if session.step().is_err() {
            break;
        }
    }
    let _ = session.advance(time_step * R::from_f64(2.5));
    let _ = session.run(time_step, &mut ());
}
