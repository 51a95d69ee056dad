//! Labels and cost of a toss by each method, against labels at a tolerance that is very much finer.
//!
//! Each bounce amplifies the error of those before it. So a toss is cheaper if the tolerance is
//! fine while the energy is high, and coarse afterwards.

use core::f64::consts::TAU;
use core::fmt::{Debug, Write as _};
use core::ops::ControlFlow;
use std::collections::BTreeSet;
use std::fs;
use std::time::Instant;

use common::steel_coin;
use tumble::ensemble::{
    Ensemble, EnsembleError, RandomOrientation, RandomSpin, RandomStart, SceneHash, Throw, Toss,
    TossError,
};
use tumble::glam::DVec3;
use tumble::{
    BogackiShampine32, Carried, ContactPoint, Coulomb, Cuboid, DormandPrince54, Dynamics,
    EnergyMomentum, Faces, FlatGround, Flight, Integrator, Nystrom, Outcome as Ended, Sample,
    SceneError, SolidCoin, SpringDamper, State, Stepper, UniformGravity, UntilDecided,
};

use crate::profile::{Measures, Profile};
use crate::shown::{percent, reached};
use crate::{Report, Size};
use common::Outcome;

/// Tolerance of the labels that the others are compared with, m.
const REFERENCE: f64 = 1e-10;
/// s.
pub(crate) const PATIENCE: f64 = 10.0;
/// Tolerance (m) of a toss while its energy is above [`HIGH`] barriers.
const FINE: f64 = 1e-6;
/// Energy, in units of the barrier, above which each error has several bounces to grow.
const HIGH: f64 = 3.0;
/// Largest change of a fraction that counts as converged.
const CONVERGED: f64 = 0.002;

/// The steel coin of `common::steel_coin`: kg, m, m.
pub(crate) const COIN: Measures = Measures {
    mass: 0.0049,
    radius: 0.01,
    thickness: 0.002,
};

/// Fraction of the labels in percent, and cost of a toss in microseconds.
pub(crate) type Target = (f64, f64);

/// A body and its start over a table. A point that supports the weight penetrates by 0.02 mm, and
/// bounces at half of its speed.
#[derive(Clone, Debug)]
pub(crate) struct Tossed<B> {
    pub(crate) name: &'static str,
    pub(crate) body: B,
    pub(crate) start: RandomStart,
    /// Tosses that are compared with the reference, and tosses whose fractions are compared.
    pub(crate) tosses: [u64; 2],
    pub(crate) targets: &'static [Target],
}

/// Labels of some tosses and the processor time of one, s.
#[derive(Debug)]
pub(crate) struct Labels<F> {
    pub(crate) labels: Vec<Ended<F>>,
    pub(crate) cost: f64,
}

impl<F: PartialEq> Labels<F> {
    pub(crate) fn agreeing(&self, others: &Self) -> u64 {
        let pairs = self.labels.iter().zip(&others.labels);
        pairs.filter(|(one, other)| one == other).count() as u64
    }

    fn fraction(&self, label: &Ended<F>) -> f64 {
        let count = self.labels.iter().filter(|one| *one == label).count();
        count as f64 / self.labels.len() as f64
    }
}

/// Plays tosses on this thread, some times over. Returns their results, and the time (s) of one
/// toss in the fastest repetition.
pub(crate) fn timed<T>(
    name: &str,
    tosses: u64,
    repetitions: usize,
    play: impl Fn(&mut Toss<'_>) -> Result<T, TossError>,
) -> Outcome<(Vec<T>, f64)> {
    let ensemble = Ensemble::new(11, SceneHash::of_bytes(name.as_bytes()));
    let (mut results, mut cost) = (Vec::new(), f64::INFINITY);
    for _ in 0..repetitions {
        results.clear();
        let clock = Clock::start();
        for toss in 0..tosses {
            results.push(play(&mut ensemble.toss(toss))?);
        }
        cost = cost.min(clock.seconds() / tosses as f64);
    }
    Ok((results, cost))
}

pub(crate) type Table<B, I> = Stepper<B, FlatGround, Coulomb, UniformGravity, I>;

impl<B> Tossed<B>
where
    B: Faces<Face: Ord> + Clone + Debug + Sync,
{
    pub(crate) fn stepper<I: Integrator>(&self, integrator: I) -> Outcome<Table<B, I>> {
        let stepper = Stepper::builder(self.body.clone())
            .gravity(UniformGravity::down(steel_coin::GRAVITY))
            .ground(ground(self.body.mass())?)
            .friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-2,
            })
            .integrator(integrator);
        Ok(stepper.build()?)
    }

    /// Plays tosses with their own random numbers, some times over. The fastest time counts.
    pub(crate) fn timed<P>(
        &self,
        tosses: u64,
        repetitions: usize,
        play: P,
    ) -> Outcome<Labels<B::Face>>
    where
        P: Fn(&mut Toss<'_>) -> Result<Ended<B::Face>, TossError>,
    {
        let (labels, cost) = timed(self.name, tosses, repetitions, play)?;
        Ok(Labels { labels, cost })
    }

    pub(crate) fn labels<I: Integrator + Debug>(
        &self,
        integrator: I,
        tosses: u64,
        repetitions: usize,
    ) -> Outcome<Labels<B::Face>> {
        let stepper = self.stepper(integrator)?;
        let throw = Throw::new(&stepper, self.start, PATIENCE)?;
        self.timed(tosses, repetitions, |toss| throw.play(toss))
    }

    /// Tosses with the tolerance [`FINE`] while the energy is [`HIGH`], and by `coarse` afterwards.
    fn in_two_parts<I: Integrator>(
        &self,
        coarse: I,
        tosses: u64,
        repetitions: usize,
    ) -> Outcome<Labels<B::Face>> {
        let fine = self.stepper(Flight(DormandPrince54::new(FINE)))?;
        let coarse = self.stepper(coarse)?;
        let barriers = coarse.barriers().ok_or(EnsembleError::NoBarriers)?;
        let basin = self.body.basin(DVec3::NEG_X);
        let low = HIGH * barriers.barrier(&basin.ok_or("no face is below -x")?);
        let throw = Throw::new(&fine, self.start, PATIENCE)?;
        let masses = fine.scene().inertia_properties();
        let moving = |state: &State| {
            let speed = state.linear_velocity.length_squared() / 2.0;
            let height = steel_coin::GRAVITY * state.position.z;
            let rotation =
                masses.rotational_energy(&state.rotation().axes(), state.angular_momentum);
            masses.mass() * (speed + height) + rotation
        };
        self.timed(tosses, repetitions, |toss| {
            let mut state = throw.start(toss)?;
            let mut until_low = |sample: &Sample<'_>| {
                // Most states need no evaluation of the springs, which add to the energy.
                let is_low = moving(sample.state) < low && sample.energy().total() < low;
                match is_low {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                }
            };
            let seconds = fine.run(&mut state, PATIENCE, &mut until_low)?;
            let mut decided = UntilDecided::new(barriers);
            coarse.run(&mut state, PATIENCE - seconds, &mut decided)?;
            Ok(decided.outcome())
        })
    }

    /// The rows of all methods, the targets and the convergence of the fractions.
    fn tables(&self, size: Size) -> Outcome<[String; 3]> {
        let (tosses, repetitions) = (self.tosses[0], size.repetitions());
        let reference = self.labels(Flight(DormandPrince54::new(REFERENCE)), tosses, 1)?;
        let mut rows = String::new();
        let mut reached = Vec::new();
        let mut add = |name: &str, labels: Labels<B::Face>| {
            let agreeing = labels.agreeing(&reference);
            let cost = 1e6 * labels.cost;
            let shown = percent(agreeing, tosses);
            let time = size.machine(format!("{cost:.0}"));
            rows += &format!("| {} | {name} | {tosses} | {shown} | {time} |\n", self.name);
            reached.push((100.0 * agreeing as f64 / tosses as f64, cost));
        };
        for tolerance in TOLERANCES {
            let method = Flight(DormandPrince54::new(tolerance));
            let name = format!("`DormandPrince54`, {tolerance:e} m");
            add(&name, self.labels(method, tosses, repetitions)?);
        }
        for tolerance in COARSE_TOLERANCES {
            let method = Flight(BogackiShampine32::new(tolerance));
            let name = format!("`BogackiShampine32`, {tolerance:e} m");
            add(&name, self.labels(method, tosses, repetitions)?);
        }
        for tolerance in LOW_TOLERANCES {
            let method = Flight(BogackiShampine32::new(tolerance));
            let name = format!("two parts, {FINE:e} m and {tolerance:e} m");
            add(&name, self.in_two_parts(method, tosses, repetitions)?);
        }
        for time_step in [1e-3, 1e-4] {
            let method = Flight(EnergyMomentum { time_step });
            let name = format!("`EnergyMomentum`, {} ms", 1e3 * time_step);
            add(&name, self.labels(method, tosses, repetitions)?);
        }
        let method = Flight(Nystrom { time_step: 3e-4 });
        let labels = self.labels(method, tosses, repetitions)?;
        add("`Nystrom`, 0.3 ms", labels);
        let targets = (self.targets.iter()).map(|target| self.judged(size, *target, &reached));
        Ok([rows, targets.collect(), self.convergence()?])
    }

    /// The cheapest method that has the labels of a target.
    fn judged(&self, size: Size, (labels, cost): Target, points: &[Target]) -> String {
        let enough = points.iter().filter(|point| point.0 >= labels);
        let cheapest = enough.map(|point| point.1).reduce(f64::min);
        let shown = cheapest.map_or("-".to_owned(), |cheapest| format!("{cheapest:.0}"));
        let is_reached = cheapest.is_some_and(|cheapest| cheapest <= cost);
        let [shown, reached] =
            [shown, reached(is_reached).to_owned()].map(|text| size.machine(text));
        format!(
            "| {} | {labels} | {cost} | {shown} | {reached} |\n",
            self.name
        )
    }

    /// The fraction of each outcome at two tolerances from the same starts.
    fn convergence(&self) -> Outcome<String> {
        let [_, tosses] = self.tosses;
        let [coarse, fine] = [1e-5, 1e-7]
            .map(|tolerance| self.labels(Flight(DormandPrince54::new(tolerance)), tosses, 1));
        let (coarse, fine) = (coarse?, fine?);
        let changed = percent(tosses - coarse.agreeing(&fine), tosses);
        let ends: BTreeSet<_> = coarse.labels.iter().chain(&fine.labels).collect();
        let mut rows = String::new();
        for end in ends {
            let [before, after] = [&coarse, &fine].map(|labels| 100.0 * labels.fraction(end));
            let name = match end {
                Ended::Decided(face) => format!("{face:?}"),
                Ended::Undecided => "undecided".to_owned(),
            };
            let change = after - before;
            writeln!(
                rows,
                "| {} | {tosses} | {changed} | {name} | {before:.3} | {after:.3} \
                 | {change:.3} | {} |",
                self.name,
                reached(change.abs() <= 100.0 * CONVERGED)
            )?;
        }
        Ok(rows)
    }
}

const TOLERANCES: [f64; 5] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-8];
const COARSE_TOLERANCES: [f64; 3] = [1e-3, 1e-4, 1e-5];
/// Tolerances (m) of the second part of a toss in two parts.
const LOW_TOLERANCES: [f64; 2] = [1e-3, 4e-3];

fn ground(mass: f64) -> Result<FlatGround, SceneError> {
    let carried = Carried { mass, contacts: 1 };
    let law = SpringDamper::from_rest(carried, 0.5, 2e-5, steel_coin::GRAVITY)?;
    Ok(FlatGround::level(law.stiffness, law.damping))
}

/// From 0.3 m with 60 rad/s.
pub(crate) fn any_start() -> RandomStart {
    let rate = 60.0.into();
    RandomStart::at_height(0.3).with_spin(RandomSpin::Isotropic { rate })
}

fn planar_start() -> RandomStart {
    let orientation = RandomOrientation::Tilted {
        axis: DVec3::X,
        tilt: (0.0..=TAU).into(),
        phase: 0.0.into(),
    };
    let spin = RandomSpin::World {
        axis: DVec3::Y,
        rate: 60.0.into(),
    };
    RandomStart::at_height(0.3)
        .with_orientation(orientation)
        .with_spin(spin)
}

pub(crate) fn isotropic(size: Size) -> Tossed<SolidCoin<f64, [ContactPoint; 48]>> {
    let points = [ContactPoint::default(); 48];
    Tossed {
        name: "steel coin, isotropic",
        body: SolidCoin::new_with_storage(points, COIN.mass, COIN.radius, COIN.thickness),
        start: any_start(),
        tosses: [2_000, 100_000].map(|tosses| size.of(tosses)),
        targets: &[(98.5, 600.0), (99.8, 1_200.0)],
    }
}

fn planar(size: Size) -> Tossed<Profile> {
    Tossed {
        name: "steel coin, planar",
        body: Profile::planar(COIN),
        start: planar_start(),
        tosses: [4_000, 100_000].map(|tosses| size.of(tosses)),
        targets: &[(98.9, 60.0)],
    }
}

fn die(size: Size) -> Tossed<Cuboid> {
    Tossed {
        name: "die of 16 mm",
        body: Cuboid::cube(0.0048, 0.016).rounded(0.001),
        start: any_start(),
        tosses: [2_000, 100_000].map(|tosses| size.of(tosses)),
        targets: &[(99.0, 200.0)],
    }
}

pub(crate) fn tables(size: Size) -> Outcome<Report> {
    let tables = [
        isotropic(size).tables(size)?,
        planar(size).tables(size)?,
        die(size).tables(size)?,
    ];
    let part = |number: usize| tables.iter().map(move |parts| parts[number].as_str());
    let mut text = format!(
        "Dropped from 0.3 m with 60 rad/s; restitution 0.5 of one point, friction 0.3, penetration \
         at rest\n2e-5 m. The labels are compared with those at a tolerance of {REFERENCE:e} m. The \
         cost is processor\ntime on one core, with the energy barriers, in the fastest of \
         {} runs. Each method is in `Flight`.\nA toss in two parts is played by \
         `DormandPrince54` while its energy is above {HIGH} barriers, and by\n`BogackiShampine32` \
         afterwards.\n\n\
         | scene | method | tosses | labels as the reference, % | cost of a toss, µs |\n\
         |---|---|---|---|---|\n",
        size.repetitions()
    );
    text.extend(part(0));
    text += "\n| scene | labels, % | in µs | cheapest method of the table with these labels, µs | \
             target |\n|---|---|---|---|---|\n";
    text.extend(part(1));
    text += "\nThe same starts at two tolerances. A coin of outcome `Edge` stood, and one that is \
             undecided after ten\nseconds still rolled or spun.\n\n\
             | scene | common starts | labels that change, % | outcome | at 1e-5 m, % | at 1e-7 m, \
             % | change, % |";
    writeln!(
        text,
        " target of {} % |\n|---|---|---|---|---|---|---|---|",
        100.0 * CONVERGED
    )?;
    text.extend(part(2));
    Ok(Report {
        text,
        is_as_expected: true,
    })
}

/// Processor time of this thread, where the system states it, and else the time of day. Other
/// programs lengthen the second.
#[derive(Clone, Copy, Debug)]
enum Clock {
    Processor(f64),
    Day(Instant),
}

impl Clock {
    fn start() -> Self {
        processor_time().map_or_else(|| Self::Day(Instant::now()), Self::Processor)
    }

    fn seconds(self) -> f64 {
        match self {
            Self::Processor(start) => processor_time().unwrap_or(start) - start,
            Self::Day(start) => start.elapsed().as_secs_f64(),
        }
    }
}

/// Processor time of this thread on Linux, s.
fn processor_time() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}
