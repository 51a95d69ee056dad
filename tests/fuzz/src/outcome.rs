//! Decided outcomes stay decided. Results of ensembles are the same for any split, and what is
//! loaded from a file can be merged in any order or is refused.

use std::ops::Range;

use tumble::ensemble::{Ensemble, EnsembleError, Histogram, SceneHash, Tally, Toss, TossError};
use tumble::real::Vector;
use tumble::{
    Barriers, Basin, Coin, ContactPoint, ContactRange, Cuboid, Disc, Dynamics, EnergyMomentum,
    Faces, FlatGround, MassProperties, Outcome, PointCloud, Real, RigidPointBody, Rim, SceneError,
    Solid, SolidCoin, State, Stepper, ThickDisc, UniformGravity,
};

use super::input::Input;
use super::load::edited;
use super::once::Once;
use super::parts::friction;

/// Plays an input.
pub fn run(data: &[u8]) {
    let mut input = Input::new(data);
    match input.below(4) {
        0 => files(&mut input),
        1 => split(&mut input),
        2 => stays_decided_in::<f32>(&mut input),
        _ => stays_decided_in::<f64>(&mut input),
    }
}

// -----------------------------------------------------------------------------------------------
// Part files
// -----------------------------------------------------------------------------------------------

/// Two files, each raw or an edited valid one.
fn files(input: &mut Input<'_>) {
    let valid = [0..7, 7..13].map(|range| part(&ensemble(), range));
    let [a, b] = valid.map(|tally| {
        let text = serde_json::to_string(&tally).unwrap();
        let text = edited(&text, input);
        serde_json::from_str::<Tally<u8>>(&text).ok()
    });
    let raw = serde_json::from_slice::<Tally<u8>>(input.rest()).ok();
    let tallies: Vec<_> = [a, b, raw].into_iter().flatten().collect();
    for a in &tallies {
        is_consistent(a);
        for b in &tallies {
            merge_commutes(a, b);
        }
    }
}

fn merge_commutes(a: &Tally<u8>, b: &Tally<u8>) {
    let (mut ab, mut ba) = (a.clone(), b.clone());
    let (ours, theirs) = (ab.merge(b), ba.merge(a));
    assert_eq!(ours.is_ok(), theirs.is_ok(), "{ours:?}, {theirs:?}");
    let overlap = |r: &Range<u64>, s: &Range<u64>| r.start.max(s.start) < r.end.min(s.end);
    let overlaps = (a.ranges().iter()).any(|r| b.ranges().iter().any(|s| overlap(r, s)));
    match ours {
        Ok(()) => {
            assert!(!overlaps, "tosses are counted twice");
            assert_eq!(ab, ba);
            assert_eq!(ab.tosses(), a.tosses() + b.tosses());
            is_consistent(&ab);
            let text = serde_json::to_string(&ab).unwrap();
            assert_eq!(serde_json::from_str::<Tally<u8>>(&text).unwrap(), ab);
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert_eq!((&ab, &ba), (a, b), "a refused merge changes the result");
            if let EnsembleError::Overlap { start, end } = error {
                assert!(overlaps && start < end, "{error}");
            }
        }
    }
}

/// The counts add up, and every query of a result returns.
fn is_consistent(tally: &Tally<u8>) {
    let decided: u64 = tally.decided().iter().map(|(_, count)| count.count()).sum();
    let errors: u64 = tally.errors().iter().map(|(_, count)| count.count()).sum();
    let rest = tally.undecided().count() + tally.panics().count();
    assert_eq!(decided + errors + rest, tally.tosses());
    assert!(tally.to_string().contains("tosses"));
    for label in [0, 1, 255] {
        let [low, high] = tally.interval(&label, 0.95).unwrap();
        assert!(low <= high && low >= 0.0 && high <= 1.0, "{low}, {high}");
        let [low, high] = tally.bounds(&label, 0.95).unwrap();
        assert!(low <= high && low >= 0.0 && high <= 1.0, "{low}, {high}");
    }
    let gaps = tally.gaps(0..u64::MAX);
    let missing: u64 = gaps.iter().map(|gap| gap.end - gap.start).sum();
    assert_eq!(missing, u64::MAX - tally.tosses());
    if let Some(sizes) = tally.histogram("size") {
        query(sizes);
    }
}

/// Calls every query of a histogram.
pub fn query(histogram: &Histogram) {
    let _ = histogram.count();
    for fraction in [0.0, 0.1, 0.5, 1.0, f64::NAN] {
        if let Some([low, high]) = histogram.quantile(fraction) {
            assert!(low <= high, "{low}, {high}");
        }
    }
    for bin in [0, histogram.bins().len(), usize::MAX] {
        let _ = histogram.edges(bin);
    }
}

// -----------------------------------------------------------------------------------------------
// Splits
// -----------------------------------------------------------------------------------------------

fn ensemble() -> Ensemble {
    Ensemble::new(7, SceneHash::of_bytes(b"fuzz"))
        .with_histogram("size", Histogram::new(0.0, 12.0, 4).unwrap())
        .unwrap()
}

fn part(ensemble: &Ensemble, range: Range<u64>) -> Tally<u8> {
    ensemble.run(range, mixed).unwrap()
}

/// Tosses with each kind of ending but a panic.
fn mixed(toss: &mut Toss<'_>) -> Result<Outcome<u8>, TossError> {
    let fraction = toss.fraction();
    toss.record("size", fraction * 16.0 - 2.0)?;
    match toss.number() % 5 {
        0 => Err(TossError::new("five", "by design")),
        1 => Ok(Outcome::Undecided),
        _ => Ok(Outcome::Decided(u8::from(fraction < 0.3))),
    }
}

/// A range in parts, merged in any order, has the result of the whole.
fn split(input: &mut Input<'_>) {
    let start = match input.below(3) {
        0 => 0,
        1 => input.long() / 2,
        _ => u64::MAX - 64,
    };
    let count = u64::from(input.byte() % 65);
    let ensemble = ensemble().with_block(input.byte().into());
    let whole = part(&ensemble, start..start + count);
    let (mut cuts, mut order) = (vec![0, count], Vec::new());
    for _ in 0..input.below(6) {
        cuts.push(u64::from(input.byte()) % (count + 1));
    }
    cuts.sort_unstable();
    for pair in cuts.windows(2) {
        let range = start + pair[0]..start + pair[1];
        let at = usize::from(input.byte()) % (order.len() + 1);
        order.insert(at, range);
    }
    let mut merged = part(&ensemble, start..start);
    for range in order {
        merged.merge(&part(&ensemble, range)).unwrap();
    }
    assert_eq!(merged, whole);
    is_consistent(&whole);
}

// -----------------------------------------------------------------------------------------------
// Decided outcomes
// -----------------------------------------------------------------------------------------------

/// A body with faces on level ground, from any state that is decided.
fn stays_decided_in<R: Real>(input: &mut Input<'_>) {
    let mass = input.size::<R>(1e-3, 1.0);
    let size = |input: &mut Input<'_>| input.size::<R>(1e-2, 0.2);
    match input.below(8) {
        0 => {
            let ring = Coin::<R, _>::ring_with_storage([blank(); 9], mass, size(input));
            stays_decided(input, &ring);
        }
        1 => {
            let (radius, thickness) = (size(input), size(input));
            let coin = SolidCoin::<R, _>::new_with_storage([blank(); 12], mass, radius, thickness);
            stays_decided(input, &coin);
        }
        2 => {
            let cuboid = Cuboid::solid(mass, input.sizes::<R>(1e-2, 0.2));
            stays_decided(input, &cuboid);
        }
        3 => {
            let (edges, rounding) = (input.sizes::<R>(1e-2, 0.2), input.size(1e-4, 1e-2));
            if let Ok(masses) = MassProperties::cuboid(mass, edges) {
                let loaded = Cuboid::loaded(edges, masses.at(input.vector::<R>(1e-4, 1e-2)));
                stays_decided(input, &loaded.rounded(rounding));
            }
        }
        4 => {
            let disc = Disc::<R>::solid(mass, size(input), 30);
            stays_decided(input, &disc);
        }
        5 => {
            let points = [0; 6].map(|_| input.vector::<R>(1e-2, 0.2));
            if let Ok(solid) = Solid::hull(mass, points) {
                stays_decided(input, &solid);
            }
        }
        7 => {
            let (radius, thickness) = (size(input), size(input));
            stays_decided(input, &ThickDisc::<R>::solid(mass, radius, thickness, 15));
        }
        _ => {
            let points = [0; 5].map(|_| input.vector::<R>(1e-2, 0.2));
            let masses = [0; 5].map(|_| input.size(1e-3, 1.0));
            if let Ok(cloud) = PointCloud::new(points, masses) {
                stays_decided(input, &cloud);
            }
        }
    }
}

fn blank<R: Real>() -> ContactPoint<R> {
    ContactPoint::default()
}

fn stays_decided<R: Real>(input: &mut Input<'_>, body: &dyn Named<R>) {
    let ground = FlatGround::level(input.size(1e2, 1e5), input.size(1e-3, 1e2));
    let friction = friction::<R>(input);
    let time_step = input.size(1e-5, 1e-2);
    let stepper = Stepper::new(Faced(body))
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(input.size(0.1, 20.0))))
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(&*friction))
        .and_then(|stepper| stepper.with_integrator(Once(EnergyMomentum { time_step })));
    let Ok(stepper) = stepper else {
        return;
    };
    let mut state = State::at(input.vector::<R>(1e-3, 0.2))
        .with_orientation(input.quaternion::<R>())
        .with_linear_velocity(input.vector::<R>(1e-4, 1.0))
        .with_angular_momentum(input.vector::<R>(1e-8, 1e-3));
    let Some(barriers) = stepper.barriers() else {
        return;
    };
    let Outcome::Decided(face) = barriers.outcome(&state) else {
        return;
    };
    if !resolves(stepper.scene(), &state, time_step) {
        return;
    }
    for number in 0..48 {
        if stepper.step(&mut state).is_err() {
            return;
        }
        keeps_face(&barriers, stepper.scene(), &state, face, number);
    }
}

/// Returns true if a step is short enough for the proof of a decided outcome.
///
/// The exception in `tumble::outcome` is a step that jumps over a barrier. At a barrier the body
/// falls away from it at the rate `√(m g r/J)` at most. A step that keeps the energy jumps only if
/// it is longer than twice the inverse of this rate. A hundredth of that, for rate and rotation, is
/// well inside.
fn resolves<R: Real>(scene: &impl Dynamics<R>, state: &State<R>, time_step: R) -> bool {
    let inertia = scene.inertia_properties();
    let inverse = inertia.largest_inverse_moment();
    let weight = inertia.mass() * scene.gravity().length();
    let rate = (weight * scene.bounding_radius() * inverse).sqrt();
    let spin = state.angular_momentum.length() * inverse;
    (rate + spin) * time_step < R::from_f64(0.02)
}

/// The body is in the basin of its face, and no other face is decided.
///
/// A later state may be undecided: the bounds of the errors differ from state to state.
fn keeps_face<R: Real, D>(
    barriers: &Barriers<'_, D, R>,
    scene: &D,
    state: &State<R>,
    face: SceneHash,
    step: u32,
) where
    D: Dynamics<R>,
    D::Body: Faces<R, Face = SceneHash>,
{
    let now = barriers.outcome(state);
    assert!(
        now == Outcome::Decided(face) || now == Outcome::Undecided,
        "step {step}: {face} was decided, and is {now:?} at {state:?}"
    );
    let down = (state.rotation().axes()).to_body(R::Vec3::new(R::ZERO, R::ZERO, -R::ONE));
    let basin = scene.body().basin(down).map(|basin| basin.face);
    assert_eq!(basin, Some(face), "step {step}: {state:?}");
}

/// A body with faces behind a pointer, so that the method is compiled once for all of them.
trait Named<R: Real>: RigidPointBody<R> {
    /// Basin of a direction, with the hash of the face's name.
    fn named(&self, down: R::Vec3) -> Option<Basin<SceneHash, R>>;
}

impl<R: Real, B: Faces<R>> Named<R> for B {
    fn named(&self, down: R::Vec3) -> Option<Basin<SceneHash, R>> {
        let Basin { face, height } = self.basin(down)?;
        Some(Basin {
            face: SceneHash::of_debug(&face),
            height,
        })
    }
}

struct Faced<'a, R>(&'a dyn Named<R>);

impl<R: Real> RigidPointBody<R> for Faced<'_, R> {
    fn mass(&self) -> R {
        self.0.mass()
    }
    fn inertia(&self) -> R::Mat3 {
        self.0.inertia()
    }
    fn contacts(&self) -> &[ContactPoint<R>] {
        self.0.contacts()
    }
    fn rims(&self) -> &[Rim<R>] {
        self.0.rims()
    }
    fn bounding_radius(&self) -> R {
        self.0.bounding_radius()
    }
    fn contacts_below(&self, normal: R::Vec3, offset: R) -> ContactRange {
        self.0.contacts_below(normal, offset)
    }
    fn contacts_below_near(&self, normal: R::Vec3, offset: R, near: ContactRange) -> ContactRange {
        self.0.contacts_below_near(normal, offset, near)
    }
    fn support(&self, direction: R::Vec3) -> R {
        self.0.support(direction)
    }
    fn check(&self) -> Result<(), SceneError> {
        self.0.check()
    }
}

impl<R: Real> Faces<R> for Faced<'_, R> {
    type Face = SceneHash;
    fn basin(&self, down: R::Vec3) -> Option<Basin<SceneHash, R>> {
        self.0.named(down)
    }
}
