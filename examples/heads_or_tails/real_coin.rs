//! A real coin that is spun on a table, with its centre of mass off its middle.
//!
//! The coin has the size and mass of a cent of the United States (2.5 g, 19.05 mm by 1.52 mm). One
//! half of its thickness is denser: with the masses `(1 ± ε) m/2` of the halves, the centre of mass
//! is `c = ε h/4` from the middle, towards heads. A face lies lower than the other, so the coin
//! prefers to show the lighter side.

use core::f64::consts::{PI, TAU};
use core::ops::Range;

use indicatif::ProgressBar;
use tumble::ensemble::{Ensemble, Pair, SceneHash, Toss, TossError};
use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{
    Basin, CoinFace, ContactPoint, Coulomb, Faces, FlatGround, MassProperties, Nystrom,
    Outcome as Ended, RigidPointBody, SceneError, State, Stepper, UniformGravity, UntilDecided,
};

use crate::count::Count;
use common::Outcome;

/// kg, m, m.
const MASS: f64 = 0.0025;
const RADIUS: f64 = 0.009_525;
const THICKNESS: f64 = 0.001_52;
/// Points on each rim: the corners of the polygon are 0.02 mm high.
const POINTS: usize = 48;
/// Distances of the centre of mass from the middle towards heads, micrometres.
pub(crate) const OFFSETS: [f64; 5] = [-50.0, 0.0, 10.0, 50.0, 200.0];

/// A way to start: rates of the spin, rad/s, and the largest lean from upright, degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spin {
    pub(crate) rates: [f64; 2],
    pub(crate) lean: f64,
}

pub(crate) const SPINS: [Spin; 2] = [
    Spin {
        rates: [40.0, 60.0],
        lean: 5.0,
    },
    Spin {
        rates: [80.0, 120.0],
        lean: 2.0,
    },
];
/// s.
pub(crate) const STEP: f64 = 2e-4;
const PATIENCE: f64 = 15.0;
/// One of so many spins is repeated with half of the step.
pub(crate) const REPEATED: u64 = 10;

/// A coin whose middle is at `x = -offset` in body axes. Heads is on the side of +x.
#[derive(Clone, Debug)]
pub(crate) struct LoadedCoin {
    inertia: DMat3,
    points: [ContactPoint; 2 * POINTS],
    /// Distances of the two faces from the centre of mass, m: that of tails and that of heads.
    faces: [f64; 2],
}

impl LoadedCoin {
    pub(crate) fn new(offset: f64) -> Result<Self, SceneError> {
        let excess = 4.0 * offset / THICKNESS;
        let half = |side: f64| -> Result<MassProperties, SceneError> {
            let disc = MassProperties::cylinder(
                0.5 * MASS * (1.0 + side * excess),
                RADIUS,
                0.5 * THICKNESS,
            )?;
            Ok(disc.at(DVec3::Z * (0.25 * side * THICKNESS)))
        };
        let [across, _, along] = {
            let whole = half(1.0)?.with(&half(-1.0)?).inertia;
            [whole.x_axis.x, whole.y_axis.y, whole.z_axis.z]
        };
        let faces = [0.5 * THICKNESS + offset, 0.5 * THICKNESS - offset];
        let points = core::array::from_fn(|number| {
            let angle = TAU * (number / 2) as f64 / POINTS as f64;
            let x = if number % 2 == 0 { -faces[0] } else { faces[1] };
            ContactPoint {
                position: DVec3::new(x, RADIUS * angle.cos(), RADIUS * angle.sin()),
                radius: 0.0,
            }
        });
        Ok(Self {
            // The cylinder's z is the coin's x.
            inertia: DMat3::from_diagonal(DVec3::new(along, across, across)),
            points,
            faces,
        })
    }
}

impl RigidPointBody for LoadedCoin {
    fn mass(&self) -> f64 {
        MASS
    }
    fn inertia(&self) -> DMat3 {
        self.inertia
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.points
    }
}

/// Heads, tails and edge. Between edge and a face at the distance b, the centre of mass is above
/// the rim of that face, at a height of at least `(b² + r² cos(π/n))/√(b² + r²)`.
impl Faces for LoadedCoin {
    type Face = CoinFace;

    fn basin(&self, down: DVec3) -> Option<Basin<CoinFace>> {
        let level = down.y.hypot(down.z);
        // The face below: that of tails where -x points down.
        let [tails, heads] = self.faces;
        let (below, face) = match down.x < 0.0 {
            true => (tails, CoinFace::Heads),
            false => (heads, CoinFace::Tails),
        };
        let height = |below: f64| {
            (below * below + RADIUS * RADIUS * (PI / POINTS as f64).cos()) / below.hypot(RADIUS)
        };
        if RADIUS * down.x.abs() < below * level {
            let face = CoinFace::Edge;
            let height = height(tails).min(height(heads));
            return Some(Basin { face, height });
        }
        let height = height(below);
        Some(Basin { face, height })
    }
}

type Table = Stepper<LoadedCoin, FlatGround, Coulomb, UniformGravity, Nystrom>;

fn table(offset: f64, time_step: f64) -> Result<Table, SceneError> {
    Stepper::builder(LoadedCoin::new(offset)?)
        .gravity(UniformGravity::down(9.81))
        // A point that supports the weight penetrates by 0.012 mm and bounces at half of its speed.
        .ground(FlatGround::level(2000.0, 1.0))
        .friction(Coulomb {
            coefficient: 0.2,
            slip_speed: 1e-2,
        })
        .integrator(Nystrom { time_step })
        .build()
}

/// Spins of a coin with an offset of its centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    /// Micrometres towards heads.
    pub(crate) offset: f64,
    /// Heads and tails, of which `straight` end with the side up that pointed up at the start. The
    /// edge is counted as undecided.
    pub(crate) count: Count,
    pub(crate) repeated: u64,
    /// Repeated spins of which one is heads and the other is not, and the change of heads.
    pub(crate) changed: u64,
    pub(crate) fewer: f64,
}

pub(crate) fn points(
    start: &Spin,
    first: u64,
    spins: u64,
    bar: &ProgressBar,
) -> Outcome<Vec<Point>> {
    let numbered = OFFSETS.iter().zip(first..);
    let points = numbered.map(|(offset, number)| {
        let first = number << 32;
        point(start, *offset, first..first + spins, bar)
    });
    points.collect()
}

fn point(start: &Spin, offset: f64, spins: Range<u64>, bar: &ProgressBar) -> Outcome<Point> {
    let coarse = table(1e-6 * offset, STEP)?;
    let fine = table(1e-6 * offset, 0.5 * STEP)?;
    let play = |stepper: &Table, toss: &mut Toss<'_>| {
        let face = spin(stepper, start, toss);
        bar.inc(1);
        face
    };
    let ensemble = Ensemble::new(4, SceneHash::of_bytes(b"spun"));
    let middle = spins.start + (spins.end - spins.start) / REPEATED;
    let pairs = ensemble.compare(
        spins.start..middle,
        |t| play(&coarse, t),
        |t| play(&fine, t),
    )?;
    let others = ensemble.run(middle..spins.end, |toss| play(&coarse, toss))?;
    crate::spun::check(&pairs)?;
    crate::spun::check(&others)?;
    let mut point = Point {
        offset,
        count: counted(Ended::Undecided, others.undecided().count()),
        repeated: pairs.compared(),
        changed: 0,
        fewer: 0.0,
    };
    for (face, count) in others.decided() {
        point.count = point
            .count
            .plus(counted(Ended::Decided(*face), count.count()));
    }
    for (pair, count) in pairs.decided() {
        point.add(pair, count.count());
    }
    Ok(point)
}

impl Point {
    fn add(&mut self, pair: &Pair<Face>, spins: u64) {
        self.count = self.count.plus(counted(pair.coarse, spins));
        let heads = |face| counted(face, spins).heads as f64;
        let change = heads(pair.coarse) - heads(pair.fine);
        self.fewer += change;
        self.changed += if change == 0.0 { 0 } else { spins };
    }
}

/// Face up at the end, and true if it pointed up at the start.
type Face = (CoinFace, bool);

fn counted(face: Ended<Face>, spins: u64) -> Count {
    let mut count = Count::default();
    let (counter, is_straight) = match face {
        Ended::Decided((CoinFace::Heads, is_straight)) => (&mut count.heads, is_straight),
        Ended::Decided((CoinFace::Tails, is_straight)) => (&mut count.tails, is_straight),
        _ => (&mut count.undecided, false),
    };
    *counter = spins;
    count.straight = if is_straight { spins } else { 0 };
    count
}

/// Sets the coin on its edge, nearly upright, spinning about the vertical.
fn spin(stepper: &Table, start: &Spin, toss: &mut Toss<'_>) -> Result<Ended<Face>, TossError> {
    let lean = toss.uniform(-start.lean..=start.lean).to_radians();
    let rate = toss.uniform(start.rates[0]..=start.rates[1]);
    let phase = DQuat::from_rotation_x(toss.uniform(0.0..=TAU / POINTS as f64));
    let barriers = (stepper.barriers())
        .ok_or_else(|| TossError::new("no barriers", "the ground must be level"))?;
    let upright = State::at(DVec3::Z * RADIUS);
    let leaning = upright.with_orientation(DQuat::from_rotation_y(lean) * phase);
    let mut state = stepper.with_angular_velocity(leaning, DVec3::Z * rate);
    if let Some(lowest) = stepper.lowest_point(&state) {
        state.position.z -= lowest.gap;
    }
    let first = match crate::steel::is_heads_up(&state) {
        true => CoinFace::Heads,
        false => CoinFace::Tails,
    };
    let mut decided = UntilDecided::new(barriers);
    stepper.run(&mut state, PATIENCE, &mut decided)?;
    Ok(match decided.outcome() {
        Ended::Decided(face) => Ended::Decided((face, face == first)),
        Ended::Undecided => Ended::Undecided,
    })
}
