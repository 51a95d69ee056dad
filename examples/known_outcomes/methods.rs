//! Labels and cost of a toss by each method, against labels at a tolerance that is very much finer.

use core::f64::consts::TAU;
use core::fmt::{Debug, Write as _};
use std::fs;
use std::time::Instant;

use common::steel_coin;
use tumble::ensemble::{Ensemble, RandomOrientation, RandomSpin, RandomStart, SceneHash, Throw};
use tumble::glam::DVec3;
use tumble::{
    BogackiShampine32, Carried, ContactPoint, Coulomb, Cuboid, DormandPrince54, EnergyMomentum,
    Faces, FlatGround, Flight, Integrator, Nystrom, Outcome as Ended, SceneError, SolidCoin,
    SpringDamper, Stepper, UniformGravity,
};

use crate::profile::{Measures, Profile};
use crate::shown::{percent, reached};
use crate::{Report, Size};
use common::Outcome;

/// Tolerance of the labels that the others are compared with, m.
const REFERENCE: f64 = 1e-10;
/// Repetitions of the measurement of a cost, of which the fastest counts.
const REPETITIONS: usize = 3;
/// s.
const PATIENCE: f64 = 10.0;
/// Largest change of a fraction that counts as converged.
const CONVERGED: f64 = 0.002;

/// The steel coin of `common::steel_coin`: kg, m, m.
const COIN: Measures = Measures {
    mass: 0.0049,
    radius: 0.01,
    thickness: 0.002,
};

/// Fraction of the labels in percent, and cost of a toss in microseconds.
type Target = (f64, f64);

/// A body and its start over a table. A point that supports the weight penetrates by 0.02 mm, and
/// bounces at half of its speed.
#[derive(Clone, Debug)]
struct Tossed<B> {
    name: &'static str,
    body: B,
    start: RandomStart,
    /// Tosses that are compared with the reference, and tosses whose fractions are compared.
    tosses: [u64; 2],
    targets: &'static [Target],
}

/// Labels of some tosses and the processor time of one, s.
#[derive(Debug)]
struct Labels<F> {
    labels: Vec<Ended<F>>,
    cost: f64,
}

impl<F: PartialEq> Labels<F> {
    fn agreeing(&self, others: &Self) -> u64 {
        let pairs = self.labels.iter().zip(&others.labels);
        pairs.filter(|(one, other)| one == other).count() as u64
    }

    fn fraction(&self, label: &Ended<F>) -> f64 {
        let count = self.labels.iter().filter(|one| *one == label).count();
        count as f64 / self.labels.len() as f64
    }

    /// Largest change of the fraction of a label.
    fn change(&self, others: &Self) -> f64 {
        let all = self.labels.iter().chain(&others.labels);
        let changes = all.map(|label| (self.fraction(label) - others.fraction(label)).abs());
        changes.fold(0.0, f64::max)
    }
}

impl<B: Faces + Clone + Debug + Sync> Tossed<B> {
    fn labels<I: Integrator + Debug>(
        &self,
        integrator: I,
        tosses: u64,
    ) -> Outcome<Labels<B::Face>> {
        let stepper = Stepper::builder(self.body.clone())
            .gravity(UniformGravity::down(steel_coin::GRAVITY))
            .ground(ground(self.body.mass())?)
            .friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-2,
            })
            .integrator(integrator)
            .build()?;
        let throw = Throw::new(&stepper, self.start, PATIENCE)?;
        let ensemble = Ensemble::new(11, SceneHash::of_bytes(self.name.as_bytes()));
        let clock = Clock::start();
        let mut labels = Vec::new();
        for toss in 0..tosses {
            labels.push(throw.play(&mut ensemble.toss(toss))?);
        }
        let cost = clock.seconds() / tosses as f64;
        Ok(Labels { labels, cost })
    }

    /// The row of a method, and its agreement and cost.
    fn row<I: Integrator + Debug + Copy>(
        &self,
        name: &str,
        integrator: I,
        reference: &Labels<B::Face>,
    ) -> Outcome<(String, Target)> {
        let tosses = self.tosses[0];
        let mut labels = self.labels(integrator, tosses)?;
        for _ in 1..REPETITIONS {
            let cost = self.labels(integrator, tosses)?.cost;
            labels.cost = labels.cost.min(cost);
        }
        let agreeing = labels.agreeing(reference);
        let cost = 1e6 * labels.cost;
        let row = format!(
            "| {} | {name} | {tosses} | {} | {cost:.0} |\n",
            self.name,
            percent(agreeing, tosses)
        );
        Ok((row, (100.0 * agreeing as f64 / tosses as f64, cost)))
    }

    /// The rows of all methods, the targets and the convergence of the fractions.
    fn table(&self) -> Outcome<[String; 3]> {
        let reference = self.labels(Flight(DormandPrince54::new(REFERENCE)), self.tosses[0])?;
        let mut rows = String::new();
        let mut reached = Vec::new();
        let mut add = |(row, point): (String, Target)| {
            rows += &row;
            reached.push(point);
        };
        for (name, tolerance) in TOLERANCES {
            let method = Flight(DormandPrince54::new(tolerance));
            add(self.row(name, method, &reference)?);
        }
        for (name, time_step) in STEPS {
            let method = Flight(EnergyMomentum { time_step });
            add(self.row(name, method, &reference)?);
        }
        let method = Flight(BogackiShampine32::new(1e-5));
        add(self.row("`BogackiShampine32`, 1e-5 m", method, &reference)?);
        let method = Flight(Nystrom { time_step: 3e-4 });
        add(self.row("`Nystrom`, 0.3 ms", method, &reference)?);
        let targets = self
            .targets
            .iter()
            .map(|target| self.judged(*target, &reached));
        Ok([rows, targets.collect(), self.convergence()?])
    }

    /// The cheapest method that has the labels of a target.
    fn judged(&self, (labels, cost): Target, points: &[Target]) -> String {
        let enough = points.iter().filter(|point| point.0 >= labels);
        let cheapest = enough.map(|point| point.1).reduce(f64::min);
        let shown = cheapest.map_or("-".to_owned(), |cheapest| format!("{cheapest:.0}"));
        let is_reached = cheapest.is_some_and(|cheapest| cheapest <= cost);
        let name = self.name;
        format!(
            "| {name} | {labels} | {cost} | {shown} | {} |\n",
            reached(is_reached)
        )
    }

    fn convergence(&self) -> Outcome<String> {
        let [_, tosses] = self.tosses;
        let [coarse, fine] = [1e-5, 1e-7]
            .map(|tolerance| self.labels(Flight(DormandPrince54::new(tolerance)), tosses));
        let (coarse, fine) = (coarse?, fine?);
        let change = coarse.change(&fine);
        Ok(format!(
            "| {} | {tosses} | {} | {:.3} | {} |\n",
            self.name,
            percent(tosses - coarse.agreeing(&fine), tosses),
            100.0 * change,
            reached(change <= CONVERGED)
        ))
    }
}

const TOLERANCES: [(&str, f64); 5] = [
    ("`DormandPrince54`, 1e-3 m", 1e-3),
    ("`DormandPrince54`, 1e-4 m", 1e-4),
    ("`DormandPrince54`, 1e-5 m", 1e-5),
    ("`DormandPrince54`, 1e-6 m", 1e-6),
    ("`DormandPrince54`, 1e-8 m", 1e-8),
];
const STEPS: [(&str, f64); 2] = [
    ("`EnergyMomentum`, 1 ms", 1e-3),
    ("`EnergyMomentum`, 0.1 ms", 1e-4),
];

fn ground(mass: f64) -> Result<FlatGround, SceneError> {
    let carried = Carried { mass, contacts: 1 };
    let law = SpringDamper::from_rest(carried, 0.5, 2e-5, steel_coin::GRAVITY)?;
    Ok(FlatGround::level(law.stiffness, law.damping))
}

/// From 0.3 m with 60 rad/s.
fn any_start() -> RandomStart {
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

pub(crate) fn tables(size: Size) -> Outcome<Report> {
    let points = [ContactPoint::default(); 48];
    let isotropic = Tossed {
        name: "steel coin, isotropic",
        body: SolidCoin::new_with_storage(points, COIN.mass, COIN.radius, COIN.thickness),
        start: any_start(),
        tosses: [2_000, 100_000].map(|tosses| size.of(tosses)),
        targets: &[(98.5, 600.0), (99.8, 1_200.0)],
    };
    let planar = Tossed {
        name: "steel coin, planar",
        body: Profile::planar(COIN),
        start: planar_start(),
        tosses: [4_000, 100_000].map(|tosses| size.of(tosses)),
        targets: &[(98.9, 60.0)],
    };
    let die = Tossed {
        name: "die of 16 mm",
        body: Cuboid::cube(0.0048, 0.016).rounded(0.001),
        start: any_start(),
        tosses: [2_000, 100_000].map(|tosses| size.of(tosses)),
        targets: &[(99.0, 200.0)],
    };
    let tables = [isotropic.table()?, planar.table()?, die.table()?];
    let part = |number: usize| tables.iter().map(move |parts| parts[number].as_str());
    let mut text = format!(
        "Dropped from 0.3 m with 60 rad/s; restitution 0.5 of one point, friction 0.3, penetration \
         at rest\n2e-5 m. The labels are compared with those at a tolerance of {REFERENCE:e} m. The \
         cost is processor\ntime on one core, with the energy barriers. Each method is in `Flight`.\n\n\
         | scene | method | tosses | labels as the reference, % | cost of a toss, µs |\n\
         |---|---|---|---|---|\n"
    );
    text.extend(part(0));
    text += "\n| scene | labels, % | in µs | cheapest method of the table with these labels, µs | \
             target |\n|---|---|---|---|---|\n";
    text.extend(part(1));
    writeln!(
        text,
        "\n| scene | common starts | labels that change from 1e-5 m to 1e-7 m, % | largest change \
         of a fraction, % | target of {} % |\n|---|---|---|---|---|",
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
