//! Nickels that end on their edge, and on what their fraction depends.
//!
//! A toss ends as heads, tails, stood or still rolling. Heads, tails and stood are proven by the
//! energy barriers. A coin that is upright and moves when the time is over is still rolling.

use core::f64::consts::TAU;
use core::fmt::{Debug, Write as _};
use core::ops::ControlFlow;

use tumble::ensemble::{
    Ensemble, EnsembleError, Histogram, SceneHash, StartDistribution, Toss, TossError,
};
use tumble::glam::{DQuat, DVec3};
use tumble::scene::Dynamics as _;
use tumble::{
    Carried, CoinFace, ContactPoint, Coulomb, DormandPrince54, EnergyMomentum, Faces, FlatGround,
    Flight, InertiaProperties, Integrator, Outcome as Ended, Sample, SceneError, SlidingFriction,
    SolidCoin, SpringDamper, State, Stepper, ThickDisc, UniformGravity, UntilDecided,
    WithResistance,
};

use crate::profile::{Measures, Profile};
use crate::shown::{fraction, interval, percent};
use crate::{Report, Size};
use common::Outcome;

/// The five-cent coin of the United States.
const NICKEL: Measures = Measures {
    mass: 0.005,
    radius: 0.010_605,
    thickness: 0.001_95,
};
const GRAVITY: f64 = 9.81;
/// rad/s.
const TURN_SPEED: f64 = 0.1;
/// Time after which an upright coin is still rolling, s.
const PATIENCE: f64 = 10.0;
/// Speed of an upright coin that still rolls, m/s.
const ROLLING: f64 = 1e-3;
/// Distance from the first impact within which a coin is still on a small table, m.
const NEAR: f64 = 0.2;

/// Start of a toss.
#[derive(Clone, Copy, Debug)]
struct Start {
    motion: Motion,
    /// m.
    height: f64,
    /// Rates of the spin, rad/s.
    rates: [f64; 2],
}

/// Orientation and axis of the spin at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    /// About a horizontal diameter, at any phase. The part `wobble` of the spin is about a random
    /// axis in addition.
    Planar { wobble: f64 },
    /// Any orientation, any axis.
    Isotropic,
    /// That of the former row H5 of the table of the literature, which was called isotropic and is
    /// not: rotation vectors in a box, and axes near a diameter.
    Former,
}

impl StartDistribution for Start {
    fn draw(&self, inertia: &InertiaProperties, toss: &mut Toss<'_>) -> Result<State, TossError> {
        let rate = toss.uniform(self.rates[0]..=self.rates[1]);
        let (orientation, axis) = match self.motion {
            Motion::Planar { wobble } => {
                let tilt = DQuat::from_rotation_y(toss.uniform(0.0..=TAU));
                let wobble = match wobble > 0.0 {
                    true => direction(toss) * wobble,
                    false => DVec3::ZERO,
                };
                (tilt, DVec3::Y + wobble)
            }
            Motion::Isotropic => (orientation(toss), direction(toss)),
            Motion::Former => {
                let lean = DVec3::new(toss.fraction(), toss.fraction(), 0.3) * TAU;
                let orientation = DQuat::from_scaled_axis(lean);
                let axis = DVec3::new(toss.fraction() - 0.5, 1.0, 0.0);
                (orientation, orientation * axis)
            }
        };
        let state = State::at(DVec3::Z * self.height).with_orientation(orientation);
        let momentum = inertia.angular_momentum(&state.rotation().axes(), axis * rate);
        Ok(state.with_angular_momentum(momentum))
    }
}

/// Direction that is uniform over the sphere.
fn direction(toss: &mut Toss<'_>) -> DVec3 {
    let (z, angle) = (toss.uniform(-1.0..=1.0), toss.uniform(0.0..=TAU));
    let level = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(level * angle.cos(), level * angle.sin(), z)
}

/// Rotation that is uniform over all rotations (Shoemake, Graphics Gems III, 1992).
fn orientation(toss: &mut Toss<'_>) -> DQuat {
    let part = toss.fraction();
    let (first, second) = (toss.uniform(0.0..=TAU), toss.uniform(0.0..=TAU));
    let (small, large) = ((1.0 - part).sqrt(), part.sqrt());
    DQuat::from_xyzw(
        small * first.sin(),
        small * first.cos(),
        large * second.sin(),
        large * second.cos(),
    )
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Body {
    /// A rectangle in a plane.
    Planar,
    /// Two rims with so many points each.
    Rims(usize),
    /// Two round rims that represent so many points each.
    Round(usize),
    /// Four circles of 24 points, with a bevel of this width, m.
    Bevelled(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    /// Dormand and Prince with this tolerance, m.
    Tolerance(f64),
    /// `EnergyMomentum` with this step, s.
    Step(f64),
}

/// Tosses that differ in their random numbers only.
#[derive(Clone, Copy, Debug)]
struct Family {
    name: &'static str,
    body: Body,
    start: Start,
    method: Method,
    /// Penetration of one point that supports the weight, m.
    depth: f64,
    coefficient: f64,
    /// m/s.
    slip_speed: f64,
    /// Restitution of one point.
    restitution: f64,
    /// Rolling and spinning resistance, m.
    resistance: [f64; 2],
    tosses: u64,
}

/// End of a toss.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    Heads,
    Tails,
    Stood,
    Rolling,
}

/// Number of tosses by their end.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    tosses: u64,
    heads: u64,
    tails: u64,
    stood: u64,
    /// Stood within [`NEAR`] of the first impact.
    near: u64,
    rolling: u64,
    /// Median path length of the coins that stood, m.
    path: Option<f64>,
}

impl Count {
    fn on_edge(&self) -> u64 {
        self.stood + self.rolling
    }

    /// Neither proven nor upright when the time was over, or failed.
    fn rest(&self) -> u64 {
        self.tosses - self.heads - self.tails - self.on_edge()
    }

    /// Distance of heads from one half of heads and tails, in standard errors.
    fn bias(&self) -> f64 {
        let both = (self.heads + self.tails) as f64;
        (self.heads as f64 - 0.5 * both) / (0.25 * both).sqrt()
    }
}

/// Path of the centre of mass along the ground.
#[derive(Clone, Copy, Debug, Default)]
struct Path {
    last: Option<DVec3>,
    length: f64,
    farthest: f64,
}

impl Path {
    fn pass(&mut self, position: DVec3) {
        let here = position.with_z(0.0);
        self.length += self.last.map_or(0.0, |last| last.distance(here));
        self.farthest = self.farthest.max(here.length());
        self.last = Some(here);
    }
}

impl Family {
    fn count(&self) -> Outcome<Count> {
        match self.body {
            Body::Planar => self.with_body(Profile::planar(NICKEL)),
            Body::Bevelled(bevel) => self.with_body(Profile::bevelled(NICKEL, bevel, 24)),
            Body::Rims(points) => {
                let points = vec![ContactPoint::default(); 2 * points];
                let Measures {
                    mass,
                    radius,
                    thickness,
                } = NICKEL;
                self.with_body(SolidCoin::new_with_storage(points, mass, radius, thickness))
            }
            Body::Round(points) => {
                let Measures {
                    mass,
                    radius,
                    thickness,
                } = NICKEL;
                self.with_body(ThickDisc::solid(mass, radius, thickness, points))
            }
        }
    }

    fn with_body<B>(&self, body: B) -> Outcome<Count>
    where
        B: Faces<Face = CoinFace> + Debug + Sync,
    {
        let friction = Coulomb {
            coefficient: self.coefficient,
            slip_speed: self.slip_speed,
        };
        let [rolling, spinning] = self.resistance;
        if rolling == 0.0 && spinning == 0.0 {
            return self.with_friction(body, friction);
        }
        let friction = WithResistance {
            friction,
            rolling,
            spinning,
            turn_speed: TURN_SPEED,
        };
        self.with_friction(body, friction)
    }

    fn with_friction<B, F>(&self, body: B, friction: F) -> Outcome<Count>
    where
        B: Faces<Face = CoinFace> + Debug + Sync,
        F: SlidingFriction + Debug + Sync,
    {
        let stepper = Stepper::builder(body)
            .gravity(UniformGravity::down(GRAVITY))
            .ground(self.ground()?)
            .friction(friction);
        match self.method {
            Method::Tolerance(tolerance) => {
                let method = Flight(DormandPrince54::new(tolerance));
                self.play(&stepper.integrator(method).build()?)
            }
            Method::Step(time_step) => {
                self.play(&stepper.integrator(EnergyMomentum { time_step }).build()?)
            }
        }
    }

    fn ground(&self) -> Result<FlatGround, SceneError> {
        let carried = Carried {
            mass: NICKEL.mass,
            contacts: 1,
        };
        let law = SpringDamper::from_rest(carried, self.restitution, self.depth, GRAVITY)?;
        Ok(FlatGround::level(law.stiffness, law.damping))
    }

    fn play<B, F, I>(&self, table: &Table<B, F, I>) -> Outcome<Count>
    where
        B: Faces<Face = CoinFace> + Sync,
        F: SlidingFriction + Sync,
        I: Integrator + Sync,
    {
        let barriers = table.barriers().ok_or(EnsembleError::NoBarriers)?;
        let ensemble = Ensemble::new(7, SceneHash::of_debug(self))
            .with_histogram("path", Histogram::new(0.0, 50.0, 5000)?)?
            .with_histogram("farthest", Histogram::new(0.0, NEAR, 1)?)?;
        let tally = ensemble.run(0..self.tosses, |toss| {
            let mut state = self.start.draw(table.scene().inertia_properties(), toss)?;
            let mut path = Path::default();
            let pass = |sample: &Sample<'_>| {
                path.pass(sample.state.position);
                ControlFlow::Continue(())
            };
            let mut watch = (UntilDecided::new(barriers), pass);
            table.run(&mut state, PATIENCE, &mut watch)?;
            let end = end(table, &state, watch.0.outcome());
            if end == Ended::Decided(End::Stood) {
                toss.record("path", path.length)?;
                toss.record("farthest", path.farthest)?;
            }
            Ok(end)
        })?;
        let path = tally.histogram("path").and_then(|path| path.quantile(0.5));
        let near = tally.histogram("farthest").map_or(0, |near| near.bins()[0]);
        Ok(Count {
            tosses: tally.tosses(),
            heads: tally.count(&End::Heads),
            tails: tally.count(&End::Tails),
            stood: tally.count(&End::Stood),
            near,
            rolling: tally.count(&End::Rolling),
            path: path.map(|[low, high]| 0.5 * (low + high)),
        })
    }
}

type Table<B, F, I> = Stepper<B, FlatGround, F, UniformGravity, I>;

/// End of a toss: the proven face, or still rolling for a coin that is upright and moves.
fn end<B, F, I>(table: &Table<B, F, I>, state: &State, proven: Ended<CoinFace>) -> Ended<End>
where
    B: Faces<Face = CoinFace>,
    F: SlidingFriction,
    I: Integrator,
{
    match proven {
        Ended::Decided(CoinFace::Heads) => return Ended::Decided(End::Heads),
        Ended::Decided(CoinFace::Tails) => return Ended::Decided(End::Tails),
        Ended::Decided(CoinFace::Edge) => return Ended::Decided(End::Stood),
        Ended::Undecided => {}
    }
    let down = state.orientation.inverse() * DVec3::NEG_Z;
    let basin = table.body().basin(down);
    let is_upright = basin.is_some_and(|basin| basin.face == CoinFace::Edge);
    let rotation = table.angular_velocity(state).length() * NICKEL.radius;
    if is_upright && state.linear_velocity.length() + rotation > ROLLING {
        Ended::Decided(End::Rolling)
    } else {
        Ended::Undecided
    }
}

/// Planar tosses, which are converged at the second tolerance.
const PLANAR: Family = Family {
    name: "planar",
    body: Body::Planar,
    start: Start {
        motion: Motion::Planar { wobble: 0.0 },
        height: 0.2,
        rates: [20.0 * TAU, 60.0 * TAU],
    },
    method: Method::Tolerance(1e-8),
    depth: 4.9e-5,
    coefficient: 0.3,
    slip_speed: 1e-2,
    restitution: 0.5,
    resistance: [0.0; 2],
    tosses: 100_000,
};

const ISOTROPIC: Family = Family {
    name: "isotropic",
    body: Body::Rims(24),
    start: Start {
        motion: Motion::Isotropic,
        ..PLANAR.start
    },
    method: Method::Tolerance(1e-5),
    tosses: 5_000,
    ..PLANAR
};

/// The scene of the former row H5, with a damping ratio of 0.2 of one point.
const FORMER: Family = Family {
    start: Start {
        motion: Motion::Former,
        ..PLANAR.start
    },
    slip_speed: 1e-3,
    // exp(-2 ζ arccos(ζ)/√(1 - ζ²)) for ζ = 0.2.
    restitution: 0.5717,
    ..ISOTROPIC
};

/// Fraction on edge of an independent program, and its interval, %.
type Independent = Option<[f64; 3]>;

/// The families that are compared with the independent program, the coarser tolerance first.
const COMPARED: [(Family, Independent); 5] = [
    (
        Family {
            name: "former scene of row H5, tolerance 1e-5 m",
            ..FORMER
        },
        Some([1.2, 0.9, 1.7]),
    ),
    (
        Family {
            name: "planar, tolerance 1e-6 m",
            method: Method::Tolerance(1e-6),
            ..PLANAR
        },
        None,
    ),
    (
        Family {
            name: "planar, tolerance 1e-8 m",
            ..PLANAR
        },
        Some([0.018, 0.011, 0.028]),
    ),
    (
        Family {
            name: "isotropic, tolerance 1e-5 m",
            ..ISOTROPIC
        },
        Some([7.6, 6.7, 8.6]),
    ),
    (
        Family {
            name: "isotropic, tolerance 1e-6 m",
            method: Method::Tolerance(1e-6),
            ..ISOTROPIC
        },
        Some([7.6, 6.7, 8.6]),
    ),
];

/// Isotropic tosses of which fewer suffice for a comparison.
const BASE: Family = Family {
    tosses: 1_500,
    ..ISOTROPIC
};
/// The base on hard ground, with rolling and spinning resistance.
const RESISTED: Family = Family {
    depth: 1e-5,
    resistance: [1e-4; 2],
    ..BASE
};

const ROUND: Family = Family {
    body: Body::Round(24),
    ..BASE
};

/// A family that differs from a base in one parameter.
fn changed(base: Family, name: &'static str, change: impl FnOnce(&mut Family)) -> Family {
    let mut family = Family { name, ..base };
    change(&mut family);
    family
}

fn other_starts() -> Vec<Family> {
    let wobbling = |name, wobble| {
        let motion = Motion::Planar { wobble };
        changed(BASE, name, |family| family.start.motion = motion)
    };
    let spun = |name, height, rate: f64| {
        changed(BASE, name, |family| {
            family.start.height = height;
            family.start.rates = [0.8 * rate, 1.2 * rate];
        })
    };
    vec![
        wobbling("planar, and 1 % of the spin about any axis", 0.01),
        wobbling("planar, and 10 %", 0.1),
        wobbling("planar, and 30 %", 0.3),
        spun("isotropic, from 0.05 m, 250 rad/s", 0.05, 250.0),
        spun("isotropic, from 0.5 m, 250 rad/s", 0.5, 250.0),
        spun("isotropic, 60 rad/s", 0.2, 60.0),
        spun("isotropic, 500 rad/s", 0.2, 500.0),
        spun("isotropic, 1000 rad/s", 0.2, 1000.0),
    ]
}

fn other_laws() -> Vec<Family> {
    let slip = |name, speed| changed(BASE, name, |family| family.slip_speed = speed);
    let bounce = |name, restitution| changed(BASE, name, |family| family.restitution = restitution);
    let soft = |base, name, depth| changed(base, name, |family| family.depth = depth);
    let rubbing = |base, name, number| changed(base, name, |family| family.coefficient = number);
    let planar = Family {
        tosses: 30_000,
        ..PLANAR
    };
    vec![
        slip("isotropic, slip speed 1e-3 m/s", 1e-3),
        slip("isotropic, slip speed 1e-4 m/s", 1e-4),
        bounce("isotropic, restitution 0.3", 0.3),
        bounce("isotropic, restitution 0.7", 0.7),
        soft(planar, "planar, penetration 1e-5 m", 1e-5),
        soft(planar, "planar, penetration 1e-6 m", 1e-6),
        soft(BASE, "isotropic, penetration 1e-5 m", 1e-5),
        soft(BASE, "isotropic, penetration 1.5e-4 m", 1.5e-4),
        soft(BASE, "isotropic, penetration 2.1e-4 m", 2.1e-4),
        rubbing(BASE, "isotropic, friction 0.1", 0.1),
        rubbing(BASE, "isotropic, friction 0.6", 0.6),
        rubbing(
            RESISTED,
            "with rolling and spinning resistance, friction 0.1",
            0.1,
        ),
        rubbing(RESISTED, "with both resistances, friction 0.3", 0.3),
        rubbing(RESISTED, "with both resistances, friction 0.6", 0.6),
        changed(RESISTED, "with rolling resistance only", |family| {
            family.resistance = [1e-4, 0.0];
        }),
    ]
}

fn other_bodies_and_methods() -> Vec<Family> {
    let shaped = |base, name, body| changed(base, name, |family| family.body = body);
    let with_step = |name, step| changed(BASE, name, |family| family.method = Method::Step(step));
    let [small, large] = [3e-4, 8e-4].map(Body::Bevelled);
    vec![
        shaped(RESISTED, "with both resistances, bevel 0.3 mm", small),
        shaped(RESISTED, "with both resistances, bevel 0.8 mm", large),
        shaped(BASE, "6 points a rim", Body::Rims(6)),
        shaped(BASE, "48 points a rim", Body::Rims(48)),
        shaped(BASE, "120 points a rim", Body::Rims(120)),
        with_step("`EnergyMomentum`, step of 1/60 s", 1.0 / 60.0),
        with_step("`EnergyMomentum`, step of 1/240 s", 1.0 / 240.0),
        with_step("`EnergyMomentum`, step of 1 ms", 1e-3),
    ]
}

/// Greatest penetration of one point that supports the weight, at which the nickel stands on one
/// point of each rim, m. The guide derives it.
fn deepest() -> f64 {
    NICKEL.thickness * NICKEL.thickness / (2.0 * NICKEL.radius)
}

pub(crate) fn tables(size: Size) -> Outcome<Report> {
    let mut text = format!(
        "Nickel of 5 g, 21.21 mm by 1.95 mm, dropped from 0.2 m with 20 to 60 revolutions a \
         second;\nrestitution 0.5 of one point. If a row does not say otherwise: friction 0.3, \
         penetration d of one\npoint at rest 4.9e-5 m, 24 points a rim, no resistance to rolling and \
         spinning. A coin that is\nupright and moves after {PATIENCE} s is still rolling. On one \
         point of each rim it stands if\nd < t²/(2 r) = {:.2e} m.\n\n\
         | start, method | tosses | stood, % | still rolling, % | on edge, % | on edge by an \
         independent program, % | intervals overlap | heads against tails, standard errors |\n\
         |---|---|---|---|---|---|---|---|\n",
        deepest()
    );
    let mut is_as_expected = true;
    for (family, independent) in COMPARED {
        let family = family.sized(size);
        let count = family.count()?;
        is_as_expected &= count.rest() * 100 <= count.tosses;
        text += &compared_row(&family, &count, independent)?;
    }
    text += "\n";
    let varied = [other_starts(), other_laws(), other_bodies_and_methods()];
    text += &varied_table(&varied.concat(), size)?;
    Ok(Report {
        text,
        is_as_expected,
    })
}

/// Isotropic tosses of a nickel with round rims, which lose less by rolling on harder ground.
pub(crate) fn rims(size: Size) -> Outcome<Report> {
    let soft = |name, depth| changed(ROUND, name, |family| family.depth = depth);
    let families = [
        changed(BASE, "rims of 24 points each", |_| ()),
        changed(ROUND, "round rims that represent 24 points each", |_| ()),
        soft("round rims, penetration 1e-5 m", 1e-5),
        soft("round rims, penetration 1e-6 m", 1e-6),
        changed(ROUND, "round rims, slip speed 1e-4 m/s", |family| {
            family.slip_speed = 1e-4;
        }),
        changed(ROUND, "round rims, restitution 0.7", |family| {
            family.restitution = 0.7;
        }),
    ];
    Ok(Report {
        text: varied_table(&families, size)?,
        is_as_expected: true,
    })
}

fn varied_table(families: &[Family], size: Size) -> Outcome<String> {
    let mut text = format!(
        "| changed | tosses | stood, % | stood within {NEAR} m of the first impact, % | still \
         rolling, % | on edge, fraction | undecided or failed | median path of those that stood, m \
         |\n|---|---|---|---|---|---|---|---|\n"
    );
    for family in families {
        let family = family.sized(size);
        let count = family.count()?;
        text += &varied_row(&family, &count)?;
    }
    Ok(text)
}

impl Family {
    fn sized(self, size: Size) -> Self {
        let tosses = size.of(self.tosses);
        Self { tosses, ..self }
    }
}

fn compared_row(
    family: &Family,
    count: &Count,
    independent: Independent,
) -> Result<String, core::fmt::Error> {
    let total = count.tosses;
    let on_edge = count.on_edge();
    let [low, high] = interval(on_edge, total);
    let (known, overlap) = match independent {
        Some([middle, least, most]) => (
            format!("{middle} [{least}, {most}]"),
            if 100.0 * low <= most && least <= 100.0 * high {
                "yes"
            } else {
                "no"
            },
        ),
        None => ("-".to_owned(), "-"),
    };
    let mut row = String::new();
    writeln!(
        row,
        "| {} | {total} | {} | {} | {} | {known} | {overlap} | {:.1} |",
        family.name,
        percent(count.stood, total),
        percent(count.rolling, total),
        percent(on_edge, total),
        count.bias(),
    )?;
    Ok(row)
}

fn varied_row(family: &Family, count: &Count) -> Result<String, core::fmt::Error> {
    let total = count.tosses;
    let path = count
        .path
        .map_or("-".to_owned(), |path| format!("{path:.2}"));
    let mut row = String::new();
    writeln!(
        row,
        "| {} | {total} | {} | {} | {} | {} | {} | {path} |",
        family.name,
        percent(count.stood, total),
        percent(count.near, total),
        percent(count.rolling, total),
        fraction(count.on_edge(), total),
        count.rest(),
    )?;
    Ok(row)
}
