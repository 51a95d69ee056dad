//! Bodies, grounds and states that are drawn at random, whose outcome is decided, and that are
//! followed to rest.
//!
//! The test `physics` and the example `known_outcomes` share the file by `#[path]`. It depends on
//! the crate and on `rand_chacha` only. A start has a stream of random numbers of its own, so that
//! it does not depend on the others. The module that includes the file names the integrator:
//! `Method`, and `method` of a time step.

// Each user of the file calls another part of it, and an invalid scene is an error of this file.
#![allow(dead_code, clippy::unwrap_used)]

use super::{Method, method};
use core::f64::consts::TAU;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use tumble::glam::{DQuat, DVec3};
use tumble::real::{Matrix, Quaternion, Vector};
use tumble::{
    Barriers, Coin, ContactPoint, Coulomb, Cuboid, Disc, Faces, FlatGround, MassProperties,
    Observer, Outcome, Real, Sample, Scene, Solid, SolidCoin, State, Stepper, ThickDisc,
    UniformGravity, UntilDecided, UntilRest,
};

/// m/s².
pub(crate) const GRAVITY: f64 = 9.81;

/// Random numbers of one start: a stream of its own, so that it does not depend on the others.
#[derive(Debug)]
pub(crate) struct Draw(ChaCha8Rng);

impl Draw {
    pub(crate) fn of(seed: u64, number: u64) -> Self {
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        stream.set_stream(number);
        Self(stream)
    }
    pub(crate) fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }
    pub(crate) fn log_between(&mut self, least: f64, most: f64) -> f64 {
        self.between(least.ln(), most.ln()).exp()
    }
    pub(crate) fn below(&mut self, count: usize) -> usize {
        // Below `count`, and not negative.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let number = self.between(0.0, count as f64) as usize;
        number.min(count - 1)
    }
    pub(crate) fn direction(&mut self) -> DVec3 {
        let (height, angle) = (self.between(-1.0, 1.0), self.between(0.0, TAU));
        let level = (1.0 - height * height).sqrt();
        DVec3::new(level * angle.cos(), level * angle.sin(), height)
    }
    /// Any orientation as likely as any other (Shoemake, Graphics Gems III, 1992).
    pub(crate) fn orientation(&mut self) -> DQuat {
        let share = self.between(0.0, 1.0);
        let (a, b) = (self.between(0.0, TAU), self.between(0.0, TAU));
        let (p, q) = ((1.0 - share).sqrt(), share.sqrt());
        DQuat::from_xyzw(p * a.sin(), p * a.cos(), q * b.sin(), q * b.cos())
    }
    /// Corners of a hull with a middle at the origin, within a ball of 1 m.
    pub(crate) fn corners(&mut self) -> Vec<DVec3> {
        let count = 4 + self.below(27);
        let stretch = DVec3::new(1.0, self.between(0.4, 1.0), self.between(0.4, 1.0));
        (0..count)
            .map(|_| self.direction() * self.between(0.7, 1.0) * stretch)
            .collect()
    }
}

pub(crate) fn vector<R: Real>(v: DVec3) -> R::Vec3 {
    R::Vec3::new(R::from_f64(v.x), R::from_f64(v.y), R::from_f64(v.z))
}

/// Ground, step size and start of a throw, in units of the body: its radius, its mass and the time
/// `√(radius/g)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Throw {
    pub(crate) radius: f64,
    mass: f64,
    /// Depth at which one contact carries the body, over the radius.
    softness: f64,
    damping_ratio: f64,
    coefficient: f64,
    step: f64,
    height: f64,
    orientation: DQuat,
    velocity: DVec3,
    spin: DVec3,
}

impl Throw {
    pub(crate) fn drawn(draw: &mut Draw) -> Self {
        Self {
            radius: draw.log_between(5e-3, 1.0),
            mass: draw.log_between(1e-3, 10.0),
            softness: draw.log_between(1e-6, 2e-2),
            damping_ratio: draw.between(0.02, 0.5),
            coefficient: draw.between(0.0, 0.8),
            step: draw.log_between(3e-3, 0.5),
            height: draw.between(1.0, 1.5),
            orientation: draw.orientation(),
            velocity: draw.direction() * draw.between(0.0, 1.0),
            spin: draw.direction() * draw.between(0.0, 4.0),
        }
    }

    fn time(&self) -> f64 {
        (self.radius / GRAVITY).sqrt()
    }

    /// Ground that carries the body at the given depth, with the damping ratio of one contact.
    fn ground<R: Real>(&self) -> FlatGround<R> {
        let stiffness = self.mass * GRAVITY / (self.softness * self.radius);
        let damping = 2.0 * self.damping_ratio * (stiffness * self.mass).sqrt();
        FlatGround::level(R::from_f64(stiffness), R::from_f64(damping))
    }

    fn state<R: Real>(&self) -> State<R> {
        let [x, y, z, w] = self.orientation.to_array().map(R::from_f64);
        State::at(vector::<R>(DVec3::Z * self.height * self.radius))
            .with_orientation(R::Quat::new(x, y, z, w))
            .with_linear_velocity(vector::<R>(self.velocity * self.radius / self.time()))
    }

    /// Puts a body into decided states, follows it to rest, and counts.
    pub(crate) fn follow<R: Real, B: Faces<R>>(
        &self,
        body: B,
        start: Start,
        draw: &mut Draw,
        tally: &mut Tally,
    ) {
        let stepper = self.stepper(body);
        let barriers = stepper.barriers();
        for _ in 0..start.states() {
            tally.started += 1;
            let decided = barriers.and_then(|barriers| match start {
                Start::Thrown => self.thrown(&stepper, barriers),
                Start::AtBarrier => self.at_barrier(&stepper, &barriers, draw),
            });
            if let Some(decided) = decided {
                self.count(&stepper, start, decided, tally);
            }
        }
    }

    /// Follows a decided body to rest, and counts.
    fn count<R: Real, B: Faces<R>>(
        &self,
        stepper: &Level<B, R>,
        start: Start,
        decided: Decided<B::Face, R>,
        tally: &mut Tally,
    ) {
        let Decided { state, face, after } = decided;
        tally.decided += 1;
        let end = self.follow_to_rest(stepper, state, face);
        if let Some(until_rest) = end.rested {
            tally.rested += 1;
            tally.until_decided += after;
            tally.until_rest += after + until_rest;
        }
        if end.has_changed {
            tally.changed += 1;
            println!("changed: {self:?}, {start:?}");
        }
    }

    fn stepper<R: Real, B: Faces<R>>(&self, body: B) -> Level<B, R> {
        let number = R::from_f64;
        let friction = Coulomb {
            coefficient: number(self.coefficient),
            slip_speed: number(1e-3 * self.radius / self.time()),
        };
        let time_step = number(self.step * self.time());
        Stepper::builder(body)
            .ground(self.ground())
            .friction(friction)
            .gravity(UniformGravity::down(number(GRAVITY)))
            .integrator(method(time_step))
            .build()
            .unwrap()
    }

    /// Throws the body until it is decided.
    fn thrown<R: Real, B: Faces<R>>(
        &self,
        stepper: &Level<B, R>,
        barriers: LevelBarriers<'_, B, R>,
    ) -> Option<Decided<B::Face, R>> {
        let spin = vector::<R>(self.spin * (1.0 / self.time()));
        let mut state = stepper.with_angular_velocity(self.state(), spin);
        let mut decided = UntilDecided::new(barriers);
        let patience = R::from_f64(60.0 * self.time());
        let until = stepper.run(&mut state, patience, &mut decided).unwrap();
        decided.face().map(|face| Decided {
            state,
            face,
            after: until.to_f64() / self.time(),
        })
    }

    /// Draws states near the ground until one is decided, with the energy just below the barrier.
    ///
    /// The kinetic energy is at least half of what the barrier leaves. A random part of it is
    /// translation, in a random direction, and the rest is rotation about a random axis.
    fn at_barrier<R: Real, B: Faces<R>>(
        &self,
        stepper: &Level<B, R>,
        barriers: &LevelBarriers<'_, B, R>,
        draw: &mut Draw,
    ) -> Option<Decided<B::Face, R>> {
        (0..ATTEMPTS).find_map(|_| {
            let state = self.near_ground(stepper, draw);
            let basin = stepper.body().basin(down(&state))?;
            let energy = stepper.energy(&state).total().to_f64();
            let left = (barriers.barrier(&basin).to_f64() - energy) * draw.between(0.5, 1.0);
            if left <= 0.0 {
                return None;
            }
            let state = self.moving(stepper, state, left, draw);
            match barriers.outcome(&state) {
                Outcome::Decided(face) => Some(Decided {
                    state,
                    face,
                    after: 0.0,
                }),
                Outcome::Undecided => None,
            }
        })
    }

    /// A body at rest at any orientation. Its lowest point penetrates by up to the depth at which
    /// one contact supports it, or is up to a tenth of its radius above the ground.
    fn near_ground<R: Real, B: Faces<R>>(
        &self,
        stepper: &Level<B, R>,
        draw: &mut Draw,
    ) -> State<R> {
        let [x, y, z, w] = draw.orientation().to_array().map(R::from_f64);
        let mut state = State::at(vector::<R>(DVec3::Z * self.radius))
            .with_orientation(R::Quat::new(x, y, z, w));
        let highest = 0.1 * draw.between(0.0, 1.0);
        let gap = draw.between(-self.softness, highest) * self.radius;
        let lowest = stepper.lowest_point(&state).unwrap().gap.to_f64();
        state.position += vector::<R>(DVec3::Z * (gap - lowest));
        state
    }

    /// The state with a kinetic energy (J), of which a random part is translation.
    fn moving<R: Real, B: Faces<R>>(
        &self,
        stepper: &Level<B, R>,
        state: State<R>,
        energy: f64,
        draw: &mut Draw,
    ) -> State<R> {
        let part = draw.between(0.0, 1.0);
        let speed = (2.0 * part * energy / self.mass).sqrt();
        let state = state.with_linear_velocity(vector::<R>(draw.direction() * speed));
        let axis = draw.direction() * (1.0 / self.time());
        let spinning = stepper.with_angular_velocity(state, vector::<R>(axis));
        let rotation = stepper.energy(&spinning).rotation.to_f64();
        let rate = ((1.0 - part) * energy / rotation).sqrt();
        stepper.with_angular_velocity(state, vector::<R>(axis * rate))
    }

    /// Follows a decided body to rest, and compares its face on the way and at the end.
    fn follow_to_rest<R: Real, B: Faces<R>>(
        &self,
        stepper: &Level<B, R>,
        mut state: State<R>,
        face: B::Face,
    ) -> End {
        let (distance, seconds) = (1e-3 * self.radius, self.time());
        let number = R::from_f64;
        let rest = UntilRest::new(stepper.body(), number(distance), number(seconds));
        let mut rest = rest.unwrap();
        let is_other = |down: R::Vec3| {
            let basin = stepper.body().basin(down);
            basin.is_none_or(|basin| basin.face != face)
        };
        let mut seen = down(&state);
        let mut has_changed = is_other(seen);
        let mut watch = |sample: &Sample<'_, R>| {
            // A query of a hull costs more than a step.
            let here = down(sample.state);
            if (here - seen).length().to_f64() > SEEN {
                seen = here;
                has_changed |= is_other(here);
            }
            rest.observe(sample)
        };
        let patience = number(PATIENCE * self.time());
        let after = stepper.run(&mut state, patience, &mut watch).unwrap();
        End {
            has_changed: has_changed || is_other(down(&state)),
            rested: (rest.is_reached()).then(|| after.to_f64() / self.time()),
        }
    }
}

/// How a decided state is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// A body is thrown, and followed until it is decided.
    Thrown,
    /// A state is drawn whose energy is just below the barrier.
    AtBarrier,
}

impl Start {
    /// States of one body on one ground. Its barriers cost as much as many steps.
    fn states(self) -> u32 {
        match self {
            Self::Thrown => 1,
            Self::AtBarrier => STATES,
        }
    }
}

/// States below the barrier of one body on one ground.
pub(crate) const STATES: u32 = 10;
/// Steps from a state below the barrier, in units of `√(radius/g)`: the longest ones may jump
/// farthest, and many states can be followed.
const LONG_STEPS: [f64; 2] = [0.1, 0.5];
/// Time for which a decided body is followed, in units of `√(radius/g)`.
const PATIENCE: f64 = 20.0;
/// Draws of a state before a start is given up.
const ATTEMPTS: usize = 300;
/// Rotation (rad) of the body after which its face is compared again.
const SEEN: f64 = 0.02;

type Level<B, R> = Stepper<B, FlatGround<R>, Coulomb<R>, UniformGravity<R>, Method<R>, R>;
type LevelBarriers<'a, B, R> =
    Barriers<'a, Scene<B, FlatGround<R>, Coulomb<R>, UniformGravity<R>, R>, R>;

/// A decided state, its face, and the time until it was decided in units of `√(radius/g)`.
#[derive(Debug)]
struct Decided<F, R: Real> {
    state: State<R>,
    face: F,
    after: f64,
}

/// End of a body that was followed to rest. Times are in units of `√(radius/g)`.
#[derive(Clone, Copy, Debug)]
struct End {
    has_changed: bool,
    /// Time to rest, if it came to rest.
    rested: Option<f64>,
}

/// Direction that points down, body axes.
fn down<R: Real>(state: &State<R>) -> R::Vec3 {
    state.rotation().inverse().apply(vector::<R>(-DVec3::Z))
}

/// What became of some starts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) started: u32,
    pub(crate) decided: u32,
    pub(crate) changed: u32,
    pub(crate) rested: u32,
    /// Sums over the bodies that came to rest, in units of `√(radius/g)`.
    pub(crate) until_decided: f64,
    pub(crate) until_rest: f64,
}

impl Tally {
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            started: self.started + other.started,
            decided: self.decided + other.decided,
            changed: self.changed + other.changed,
            rested: self.rested + other.rested,
            until_decided: self.until_decided + other.until_decided,
            until_rest: self.until_rest + other.until_rest,
        }
    }
}

pub(crate) const KINDS: [&str; 6] = ["ring", "disc", "thick coin", "cuboid", "hull", "thick disc"];

/// Follows decided states of one body of a kind. The bodies of a kind are numbered.
pub(crate) fn follow<R: Real>(kind: usize, start: Start, number: u64, tally: &mut Tally) {
    let draw = &mut Draw::of(kind as u64, number);
    let mut throw = Throw::drawn(draw);
    if start == Start::AtBarrier {
        throw.step = draw.log_between(LONG_STEPS[0], LONG_STEPS[1]);
    }
    let number = R::from_f64;
    let (mass, radius) = (number(throw.mass), number(throw.radius));
    let points = |count| vec![ContactPoint::default(); count];
    match kind {
        0 => {
            let count = 3 + draw.below(60);
            let coin = Coin::ring_with_storage(points(count), mass, radius);
            throw.follow::<R, _>(coin, start, draw, tally);
        }
        1 => throw.follow::<R, _>(Disc::solid(mass, radius, 48), start, draw, tally),
        2 => {
            let thickness = number(throw.radius * draw.between(0.1, 2.0));
            let points = points(2 * (3 + draw.below(30)));
            let coin = SolidCoin::new_with_storage(points, mass, radius, thickness);
            throw.follow::<R, _>(coin, start, draw, tally);
        }
        3 => throw.follow::<R, _>(cuboid(&throw, draw), start, draw, tally),
        4 => throw.follow::<R, _>(hull(&throw, draw), start, draw, tally),
        _ => {
            let thickness = number(throw.radius * draw.between(0.1, 2.0));
            let disc = ThickDisc::solid(mass, radius, thickness, 48);
            throw.follow::<R, _>(disc, start, draw, tally);
        }
    }
}

/// A box with round corners whose centre of mass is off its middle.
pub(crate) fn cuboid<R: Real>(throw: &Throw, draw: &mut Draw) -> Cuboid<R> {
    let mut edge = || throw.radius * draw.between(0.4, 1.0);
    let edges = vector::<R>(DVec3::new(edge(), edge(), edge()));
    let mut load = MassProperties::cuboid(R::from_f64(throw.mass), edges).unwrap();
    load.centre_of_mass = vector::<R>(draw.direction() * draw.between(0.0, 0.1) * throw.radius);
    let round = throw.radius * draw.between(0.0, 0.05);
    Cuboid::loaded(edges, load).rounded(R::from_f64(round))
}

/// A hull of 4 to 30 points whose centre of mass is off that of its volume.
pub(crate) fn hull<R: Real>(throw: &Throw, draw: &mut Draw) -> Solid<R, Vec<ContactPoint<R>>> {
    let corners: Vec<DVec3> = (draw.corners().into_iter())
        .map(|corner| corner * throw.radius)
        .collect();
    // In double precision also for `f32`, whose rounding may leave a gap between flat facets.
    let load = MassProperties::hull(throw.mass, &corners).unwrap();
    let shift = draw.direction() * draw.between(0.0, 0.1) * throw.radius;
    let columns = load.inertia.to_cols_array_2d();
    let columns = columns.map(|column| vector::<R>(DVec3::from(column)));
    let load = MassProperties {
        mass: R::from_f64(load.mass),
        centre_of_mass: vector::<R>(load.centre_of_mass + shift),
        inertia: <R::Mat3 as Matrix<R>>::from_columns(columns),
    };
    let contacts = (corners.into_iter())
        .map(|corner| ContactPoint::bare(vector::<R>(corner)))
        .collect();
    Solid::new(load, contacts).unwrap()
}
