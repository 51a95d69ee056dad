//! Ensembles: one answer for any split, honest counts, and the distributions of the starts.

#![allow(
    clippy::unwrap_used,
    clippy::std_instead_of_alloc,
    clippy::std_instead_of_core,
    clippy::cast_possible_truncation,
    clippy::incompatible_msrv,
    reason = "a program has std and a newer compiler, its numbers are small, an error ends it"
)]

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tumble::ensemble::{
    Ensemble, EnsembleError, Histogram, Pair, RandomOrientation, RandomSpin, RandomStart, Sampling,
    SceneHash, StartDistribution, Stop, Tally, Throw, Toss, TossError,
};
use tumble::glam::{DVec3, Vec3};
use tumble::{
    AirDrag, Coin, CoinFace, CompactEnergyMomentum, ConstantForce, ContactPoint, Coulomb, Cuboid,
    EnergyMomentum, FlatGround, Force, MovingGround, NoGround, Outcome, Plane, PointCloud,
    SpringDamperGround, State, Stepper, UniformGravity, Wind,
};

#[allow(dead_code, reason = "other programs use the other part")]
#[path = "kit/statistics.rs"]
mod statistics;

use statistics::FractionTest;

type Ring = Stepper<Coin<f64, [ContactPoint; 12]>, FlatGround, Coulomb, UniformGravity>;

const RADIUS: f64 = 0.012; // m
const SEED: u64 = 7;

/// A ring of few points, which costs little.
fn ring() -> Ring {
    ring_with_step(2e-3)
}

fn ring_with_step(time_step: f64) -> Ring {
    let body = Coin::ring_with_storage([ContactPoint::default(); 12], 0.005, RADIUS);
    Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.81)))
        .and_then(|stepper| stepper.with_ground(FlatGround::level(500.0, 0.5)))
        .and_then(|stepper| {
            stepper.with_friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            })
        })
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
        .unwrap()
}

/// Dropped at any orientation, with spin.
fn any_start() -> RandomStart {
    RandomStart::at_height(0.03..=0.04).with_spin(RandomSpin::Isotropic {
        rate: (20.0..=40.0).into(),
    })
}

/// Some tosses of each kind of ending, for the tests of the counts: one in ten is undecided, one in
/// a hundred fails, and one in a hundred panics.
fn mixed(toss: &mut Toss<'_>) -> Result<Outcome<u8>, TossError> {
    toss.record("size", toss_size(toss.number()))?;
    match toss.number() % 100 {
        // A panic without the message on the terminal.
        37 => std::panic::resume_unwind(Box::new(format!("toss {}", toss.number()))),
        38 => Err(TossError::new("thirty-eight", "by design")),
        ending if ending % 10 == 1 => Ok(Outcome::Undecided),
        _ => Ok(Outcome::Decided(u8::from(toss.fraction() < 0.3))),
    }
}

fn toss_size(number: u64) -> f64 {
    (number % 13) as f64
}

fn mixed_ensemble() -> Ensemble {
    Ensemble::new(SEED, SceneHash::of_bytes(b"mixed"))
        .with_histogram("size", Histogram::new(0.0, 12.0, 4).unwrap())
        .unwrap()
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap().install(work)
}

/// Part `number` of `parts` about equal parts of a range.
fn part(tosses: u64, number: u64, parts: u64) -> Range<u64> {
    tosses * number / parts..tosses * (number + 1) / parts
}

fn json<L: serde::Serialize>(tally: &Tally<L>) -> String {
    serde_json::to_string(tally).unwrap()
}

/// Number of tosses of the tests that count faces.
const TOSSES: u64 = 200;

/// Result of the ring's tosses, played in parts and merged in an order that is not theirs.
fn merged(parts: u64, threads: usize) -> Tally<CoinFace> {
    let (stepper, histogram) = (ring(), Histogram::new(0.03, 0.04, 10).unwrap());
    let throw = Throw::new(&stepper, any_start(), 10.0).unwrap();
    let ensemble = Ensemble::new(SEED, throw.scene_hash()).with_block(64);
    let ensemble = ensemble.with_histogram("height", histogram).unwrap();
    let play = |toss: &mut Toss<'_>| -> Result<Outcome<CoinFace>, TossError> {
        let outcome = throw.play(toss)?;
        let start = throw.start(&mut ensemble.toss(toss.number()))?;
        toss.record("height", start.position.z)?;
        Ok(outcome)
    };
    let all = (0..parts).map(|number| {
        let range = part(TOSSES, number, parts);
        on_threads(threads, || ensemble.run(range, play).unwrap())
    });
    let mut all: Vec<_> = all.collect();
    // Odd numbers first, then the even ones downwards: gaps appear and are closed again.
    let mut order: Vec<_> = (1..all.len()).step_by(2).collect();
    order.extend((0..all.len()).step_by(2).rev());
    let mut sum = all[order[0]].clone();
    for &number in &order[1..] {
        sum.merge(&all[number]).unwrap();
    }
    all.clear();
    sum
}

#[test]
fn any_split_over_parts_and_threads_has_the_same_bytes() {
    let whole = merged(1, 1);
    assert_eq!(whole.ranges(), std::slice::from_ref(&(0..TOSSES)));
    assert!(whole.decided().len() == 2 && whole.errors().is_empty());
    for parts in [1, 2, 7, 100] {
        for threads in [1, 2] {
            let split = merged(parts, threads);
            assert_eq!(
                json(&split),
                json(&whole),
                "{parts} parts, {threads} threads"
            );
        }
    }
    let loaded: Tally<CoinFace> = serde_json::from_str(&json(&whole)).unwrap();
    assert_eq!(loaded, whole);
}

/// Hash of the result above. It is the same on every machine. It changes with the version of the
/// crate and the parts of a scene, which the scene hash knows, and with the arithmetic of a step.
const STORED: &str = "baa5d3a34080e4fb";

#[test]
fn the_result_is_the_stored_one() {
    let result = merged(2, 2);
    let hash = SceneHash::of_bytes(json(&result).as_bytes()).to_string();
    assert_eq!(hash, STORED, "{result}\n{}", json(&result));
}

#[test]
fn splits_agree_where_tosses_fail() {
    let ensemble = mixed_ensemble().with_block(128);
    let whole = ensemble.run(0..3000, mixed).unwrap();
    for parts in [2, 7, 100] {
        let mut sum = ensemble.run(0..0, mixed).unwrap();
        for number in (0..parts).rev() {
            let one = ensemble.run(part(3000, number, parts), mixed).unwrap();
            sum.merge(&one).unwrap();
        }
        assert_eq!(json(&sum), json(&whole), "{parts} parts");
    }
}

/// Its counts would be in each part, and the merged result would have them twice.
#[test]
fn only_the_bins_of_a_histogram_with_counts_are_used() {
    let mut filled = Histogram::new(0.0, 12.0, 4).unwrap();
    for value in [-1.0, 1.0, 2.0, 50.0, f64::NAN] {
        filled.add(value);
    }
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"mixed"))
        .with_histogram("size", filled)
        .unwrap();
    let whole = ensemble.run(0..100, mixed).unwrap();
    let mut sum = ensemble.run(0..50, mixed).unwrap();
    sum.merge(&ensemble.run(50..100, mixed).unwrap()).unwrap();
    assert_eq!(json(&sum), json(&whole));
    assert_eq!(
        json(&whole),
        json(&mixed_ensemble().run(0..100, mixed).unwrap())
    );
    let sizes = whole.histogram("size").unwrap();
    let failed = whole.panics().count() + whole.errors()[0].1.count();
    assert_eq!(sizes.count(), whole.tosses() - failed);
    assert_eq!([sizes.below(), sizes.nan()], [0; 2]);
}

#[test]
fn every_toss_is_counted_once_and_failures_can_be_replayed() {
    let ensemble = mixed_ensemble();
    let tally = ensemble.run(0..3000, mixed).unwrap();
    assert_eq!(tally.panics().count(), 30);
    assert_eq!(tally.panics().first()[..3], [37, 137, 237]);
    assert_eq!(tally.panics().first().len(), 16);
    let [(kind, failed)] = tally.errors() else {
        panic!("{:?}", tally.errors())
    };
    assert_eq!((kind.as_str(), failed.count()), ("thirty-eight", 30));
    assert_eq!(tally.undecided().count(), 300);
    assert_eq!(tally.count(&0) + tally.count(&1), 3000 - 30 - 30 - 300);

    let error = mixed(&mut ensemble.toss(failed.first()[1])).unwrap_err();
    assert_eq!(
        (error.kind(), error.to_string().as_str()),
        (kind.as_str(), "by design")
    );
    let panic = std::panic::catch_unwind(|| mixed(&mut ensemble.toss(tally.panics().first()[2])));
    let message = panic.unwrap_err();
    assert_eq!(message.downcast_ref::<String>().unwrap(), "toss 237");
    // A replayed toss of each label has that label.
    for (label, count) in tally.decided() {
        for &number in count.first() {
            let again = mixed(&mut ensemble.toss(number)).unwrap();
            assert_eq!(again, Outcome::Decided(*label));
        }
    }
}

/// Payload of a panic whose `Drop` panics, this many times one after the other.
struct Payload(u32);

impl Drop for Payload {
    fn drop(&mut self) {
        if self.0 > 0 {
            std::panic::resume_unwind(Box::new(Self(self.0 - 1)));
        }
    }
}

#[test]
fn a_panic_whose_payload_panics_when_it_is_dropped_is_counted() {
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"payload"));
    let tally = ensemble.run(0..20, |toss| match toss.number() {
        number @ 5..8 => std::panic::resume_unwind(Box::new(Payload(number as u32 - 5))),
        _ => Ok(Outcome::Decided(0_u8)),
    });
    let tally = tally.unwrap();
    assert_eq!(tally.panics().first(), [5, 6, 7]);
    assert_eq!((tally.count(&0), tally.tosses()), (17, 20));
}

#[test]
fn observables_of_failed_tosses_are_not_counted() {
    let tally = mixed_ensemble().run(0..3000, mixed).unwrap();
    let sizes = tally.histogram("size").unwrap();
    let counted = (0..3000).filter(|number| ![37, 38].contains(&(number % 100)));
    let mut expected = Histogram::new(0.0, 12.0, 4).unwrap();
    counted.for_each(|number| expected.add(toss_size(number)));
    assert_eq!(sizes, &expected);
    assert!(tally.histogram("colour").is_none() && sizes.above() > 0);

    let unknown = mixed_ensemble().run(0..10, |toss| {
        toss.record("colour", 1.0)?;
        Ok(Outcome::Decided(0))
    });
    let unknown = unknown.unwrap();
    assert_eq!(unknown.errors()[0].0, "unknown observable");
    assert_eq!(unknown.errors()[0].1.count(), 10);
}

#[test]
fn overlaps_and_strangers_are_refused_and_change_nothing() {
    let ensemble = mixed_ensemble();
    let run = |ensemble: &Ensemble, range| ensemble.run(range, mixed).unwrap();
    let mut tally = run(&ensemble, 0..50);
    let before = tally.clone();
    let error = tally.merge(&run(&ensemble, 45..60)).unwrap_err();
    assert_eq!(error, EnsembleError::Overlap { start: 45, end: 50 });
    assert_eq!(
        error.to_string(),
        "a toss must be counted once, got the tosses 45..50 in both results"
    );
    let histogram = || Histogram::new(0.0, 12.0, 4).unwrap();
    let other = |seed, scene: &[u8], bins| {
        let other = Ensemble::new(seed, SceneHash::of_bytes(scene));
        other
            .with_histogram("size", bins)
            .unwrap()
            .run(60..70, mixed)
            .unwrap()
    };
    let seed = tally.merge(&other(8, b"mixed", histogram())).unwrap_err();
    assert_eq!(
        seed.to_string(),
        "the seed of a merged result must be 7, got 8"
    );
    let scene = tally
        .merge(&other(SEED, b"another", histogram()))
        .unwrap_err();
    assert!(matches!(scene, EnsembleError::OtherScene { .. }));
    let bins = Histogram::new(0.0, 12.0, 5).unwrap();
    let bins = tally.merge(&other(SEED, b"mixed", bins)).unwrap_err();
    assert_eq!(bins, EnsembleError::OtherHistograms);
    assert_eq!(tally, before);
    tally.merge(&other(SEED, b"mixed", histogram())).unwrap();

    let twice = mixed_ensemble()
        .with_histogram("size", histogram())
        .unwrap_err();
    assert_eq!(
        twice.to_string(),
        "the name of a histogram must be unique, got \"size\" twice"
    );
    let (start, end) = (9, 3);
    let error = ensemble.run(start..end, mixed).unwrap_err();
    assert_eq!(error, EnsembleError::BadRange { start, end });
}

#[test]
fn a_loaded_result_with_two_histograms_of_one_name_is_refused() {
    let tally = mixed_ensemble().run(0..10, mixed).unwrap();
    let mut saved = serde_json::to_value(&tally).unwrap();
    let histograms = saved["histograms"].as_array_mut().unwrap();
    histograms.push(histograms[0].clone());
    let error = serde_json::from_value::<tumble::ensemble::Tally<u8>>(saved).unwrap_err();
    assert!(error.to_string().contains("different names"), "{error}");
}

#[test]
fn a_loaded_histogram_without_bins_or_with_too_many_values_is_refused() {
    let good = serde_json::to_value(Histogram::new(0.0, 1.0, 2).unwrap()).unwrap();
    for (key, bad, rule) in [
        (
            "bins",
            serde_json::json!([]),
            "histograms have bins of a finite width",
        ),
        (
            "high",
            serde_json::json!(0.0),
            "histograms have bins of a finite width",
        ),
        (
            "below",
            serde_json::json!(u64::MAX),
            "a histogram has at most 2⁶³ values",
        ),
    ] {
        let mut saved = good.clone();
        saved[key] = bad;
        let refused = serde_json::from_value::<Histogram>(saved).unwrap_err();
        assert!(refused.to_string().contains(rule), "{refused}");
    }
    let mut full = good.clone();
    full["bins"] = serde_json::json!([1_u64 << 63, 0]);
    let mut full: Histogram = serde_json::from_value(full).unwrap();
    full.add(0.1);
    assert_eq!(full.count(), (1 << 63) + 1);
}

#[test]
fn gaps_are_listed_and_can_be_filled() {
    let ensemble = mixed_ensemble();
    let mut tally = ensemble.run(10..20, mixed).unwrap();
    tally.merge(&ensemble.run(50..60, mixed).unwrap()).unwrap();
    assert_eq!(tally.gaps(0..100), [0..10, 20..50, 60..100]);
    for gap in tally.gaps(0..100) {
        tally.merge(&ensemble.run(gap, mixed).unwrap()).unwrap();
    }
    assert!(tally.gaps(0..100).is_empty());
    assert_eq!(tally, ensemble.run(0..100, mixed).unwrap());
}

#[test]
fn a_result_that_contradicts_itself_is_not_loaded() {
    let text = json(&mixed_ensemble().run(0..200, mixed).unwrap());
    assert!(serde_json::from_str::<Tally<u8>>(&text).is_ok());
    let faults = [
        ("\"undecided\":{\"count\":20", "\"undecided\":{\"count\":21"),
        ("\"end\":200", "\"end\":201"),
        ("\"start\":0", "\"start\":300"),
        ("\"first\":[37,137]", "\"first\":[137,37]"),
        ("\"first\":[37,137]", "\"first\":[37,237]"),
        ("\"low\":0.0", "\"low\":12.0"),
        ("[[0,{", "[[9,{"),
        ("\"nan\":0", "\"nan\":18446744073709551615"),
    ];
    for (from, to) in faults {
        assert!(text.contains(from), "{from} in {text}");
        let error = serde_json::from_str::<Tally<u8>>(&text.replacen(from, to, 1)).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("must be consistent"), "{from}: {message}");
    }
}

#[test]
fn the_size_of_a_result_does_not_grow_with_the_tosses() {
    let size = |tosses| json(&mixed_ensemble().run(0..tosses, mixed).unwrap()).len();
    // Sixteen toss numbers for each ending are kept from 2,000 tosses on; the rest are digits.
    assert!(
        size(100_000) <= size(2_000) + 6 * 12,
        "{} {}",
        size(100_000),
        size(2_000)
    );
}

#[test]
fn a_stop_by_width_is_the_same_on_any_number_of_threads() {
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"width")).with_block(100);
    let play = |toss: &mut Toss<'_>| Ok(Outcome::Decided(toss.fraction() < 0.3));
    let stop = Stop::at_end().at_width(true, 0.95, 0.05).unwrap();
    let run = |threads, range: Range<u64>| {
        let work = || ensemble.run_until(range, &stop, |_| {}, play).unwrap();
        on_threads(threads, work)
    };
    let tally = run(1, 50..100_000);
    assert_eq!(json(&tally), json(&run(2, 50..100_000)));
    let [low, high] = tally.interval(&true, 0.95).unwrap();
    let last = tally.ranges()[0].end;
    assert!(high - low <= 0.05 && last % 100 == 0, "{last}");
    // 4 z² p (1 - p)/w² tosses make it so narrow.
    assert!((1200..1500).contains(&last), "{last}");
    let before = ensemble.run(50..last - 100, play).unwrap();
    let [low, high] = before.interval(&true, 0.95).unwrap();
    assert!(high - low > 0.05);
    // Stopped results are continued.
    let mut all = tally;
    all.merge(&ensemble.run(last..2000, play).unwrap()).unwrap();
    assert_eq!(all, ensemble.run(50..2000, play).unwrap());
    assert!(Stop::at_end().at_width(true, 0.95, 0.0).is_err());
    assert!(Stop::at_end().at_width(true, 1.0, 0.1).is_err());
}

#[test]
fn a_stop_by_time_leaves_whole_blocks_and_progress_counts_them() {
    let ensemble = mixed_ensemble().with_block(10);
    let stop = Stop::at_end().after(Duration::ZERO);
    let mut seen = Vec::new();
    let tally = ensemble.run_until(5..30, &stop, |now| seen.push((now.done, now.total)), mixed);
    assert_eq!(tally.unwrap().ranges(), std::slice::from_ref(&(5..10)));
    assert_eq!(seen, [(5, 25)]);
    seen.clear();
    let mut left = Vec::new();
    let report = |now: &tumble::ensemble::Progress<'_, u8>| {
        seen.push((now.done, now.total));
        left.push((now.rate(), now.remaining()));
        assert_eq!(now.tally.tosses(), now.done);
    };
    ensemble
        .run_until(5..30, &Stop::at_end(), report, mixed)
        .unwrap();
    assert_eq!(seen, [(5, 25), (15, 25), (25, 25)]);
    assert!(left.iter().all(|(rate, _)| *rate > 0.0));
    assert_eq!(left[2].1, Some(Duration::ZERO));
}

#[test]
fn changed_labels_are_counted_on_a_stated_sample() {
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"pairs"));
    let coarse = |toss: &mut Toss<'_>| Ok(Outcome::Decided(toss.fraction() < 0.5));
    // Every tenth label is another one, every hundredth is undecided.
    let fine = |toss: &mut Toss<'_>| {
        let is_low = toss.fraction() < 0.5;
        Ok(match toss.number() {
            number if number % 100 == 0 => Outcome::Undecided,
            number => Outcome::Decided(is_low != (number % 10 == 1)),
        })
    };
    let pairs: Tally<Pair<bool>> = ensemble.compare(0..1000, coarse, fine).unwrap();
    assert_eq!((pairs.compared(), pairs.changed()), (1000, 110));
    let [low, high] = pairs.label_error(0.95).unwrap();
    assert!(low < 0.11 && 0.11 < high && high - low < 0.05);
    let same = ensemble.compare(0..1000, coarse, coarse).unwrap();
    assert_eq!((same.compared(), same.changed()), (1000, 0));
    let loaded: Tally<Pair<bool>> = serde_json::from_str(&json(&pairs)).unwrap();
    assert_eq!(loaded, pairs);
}

#[test]
fn a_shorter_step_changes_labels_and_the_same_step_none() {
    let steppers = [ring_with_step(2e-3), ring_with_step(1e-3)];
    let throws = steppers
        .each_ref()
        .map(|stepper| Throw::new(stepper, any_start(), 10.0).unwrap());
    let ensemble = Ensemble::new(SEED, throws[0].scene_hash());
    let changed = |fine: usize| {
        let pairs = ensemble.compare(
            0..100,
            |toss| throws[0].play(toss),
            |toss| throws[fine].play(toss),
        );
        let pairs = pairs.unwrap();
        assert_eq!(pairs.compared(), 100);
        pairs.changed()
    };
    assert!(changed(0) == 0 && changed(1) > 0);
}

#[test]
fn bounds_hold_whatever_the_undecided_tosses_show() {
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"bounds"));
    let play = |toss: &mut Toss<'_>| {
        Ok(match toss.number() % 10 {
            0..4 => Outcome::Decided('h'),
            4..8 => Outcome::Decided('t'),
            _ => Outcome::Undecided,
        })
    };
    let tally = ensemble.run(0..1_000_000, play).unwrap();
    let [low, high] = tally.bounds(&'h', 0.99).unwrap();
    assert!((low - 0.4).abs() < 2e-3 && (high - 0.6).abs() < 2e-3);
    let [low, high] = tally.interval(&'h', 0.99).unwrap();
    assert!((low - 0.4).abs() < 2e-3 && (high - 0.4).abs() < 2e-3);
}

/// The program of the guide. Chi-square of four equal faces with 3 degrees of freedom, 99.9 %, in
/// 1,000 tosses. Rejected with 99 %: a face of probability 0.335 beside three equal ones, with a
/// noncentrality of 38.5.
#[test]
fn a_regular_tetrahedron_shows_its_faces_alike() {
    let corners = [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]];
    let places = corners.map(|p| DVec3::from(p) * 0.008);
    let stepper = Stepper::new(PointCloud::new(places, [1e-3; 4]).unwrap())
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.81)))
        .and_then(|stepper| stepper.with_ground(FlatGround::level(1000.0, 0.5)))
        .and_then(|stepper| {
            stepper.with_friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            })
        })
        .unwrap();
    let spin = RandomSpin::Isotropic {
        rate: (20.0..=40.0).into(),
    };
    let start = RandomStart::at_height(0.1).with_spin(spin);
    let throw = Throw::new(&stepper, start, 10.0).unwrap();
    let tally = Ensemble::new(1, throw.scene_hash()).run(0..1000, |toss| throw.play(toss));
    let tally = tally.unwrap();
    assert!(
        tally.decided().len() == 4 && tally.undecided().count() == 0,
        "{tally}"
    );
    let counts = tally
        .decided()
        .iter()
        .map(|(_, count)| count.count() as f64);
    let chi_square: f64 = counts.map(|count| (count - 250.0).powi(2) / 250.0).sum();
    assert!(chi_square < 16.27, "{tally}");
}

/// Starts of a number of tosses, of the ring.
fn starts(start: &impl StartDistribution, tosses: Range<u64>) -> Vec<State> {
    let stepper = ring();
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"starts"));
    let inertia = tumble::Dynamics::inertia_properties(stepper.scene());
    let draw = |number| start.draw(inertia, &mut ensemble.toss(number)).unwrap();
    tosses.map(draw).collect()
}

/// Components of the body's axes in the world.
fn matrix(state: &State) -> [f64; 9] {
    let axes = state.rotation().axes();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axes.to_world(axis).to_array());
    std::array::from_fn(|at| axes[at / 3][at % 3])
}

/// Largest deviation of the moments of a rotation matrix, in standard errors of uniform rotations.
///
/// A component x of a uniform unit vector is uniform from -1 to 1: its mean is 0 with variance 1/3,
/// that of x² is 1/3 with variance 4/45. Two orthogonal ones have no correlation.
fn worst_moment(rows: &[[f64; 9]]) -> f64 {
    let n = rows.len() as f64;
    let mean = |of: &dyn Fn(&[f64; 9]) -> f64| rows.iter().map(of).sum::<f64>() / n;
    let deviations = (0..9).flat_map(|at| {
        let first = mean(&|row| row[at]).abs() / (1.0 / 3.0 / n).sqrt();
        let second = (mean(&|row| row[at] * row[at]) - 1.0 / 3.0).abs() / (4.0 / 45.0 / n).sqrt();
        [first, second]
    });
    // NaN if one is NaN.
    deviations.fold(0.0, |a, b| if a >= b || a.is_nan() { a } else { b })
}

/// 18 moments of 20,000 rotations, each within 4.5 standard errors: uniform rotations fail with at
/// most 1.3e-4. Rejected with 99 %: a moment that is off by 4.5 + 2.33 standard errors, which is
/// 0.028 for a mean and 0.015 for a mean square. So is a tilt that is uniform in angle instead of in
/// its cosine.
#[test]
fn uniform_orientations_have_the_moments_of_uniform_rotations() {
    let moments = |start: &RandomStart| {
        let rows: Vec<_> = starts(start, 0..20_000).iter().map(matrix).collect();
        worst_moment(&rows)
    };
    let uniform = RandomStart::at_height(1.0);
    for strata in [None, Some(100)] {
        let sampling = strata.map_or(Sampling::Independent, |strata| Sampling::Latin { strata });
        let worst = moments(&uniform.with_sampling(sampling));
        assert!(worst < 4.5, "{worst}");
    }
    let tilted = uniform.with_tilt(DVec3::X, 0.0..=std::f64::consts::PI);
    assert!(moments(&tilted) > 20.0);
    let near = RandomOrientation::Tilted {
        axis: DVec3::Z,
        tilt: (0.0..=std::f64::consts::PI).into(),
        phase: 0.0.into(),
    };
    assert!(moments(&uniform.with_orientation(near)) > 20.0);
}

/// 1,500 tosses at a level of 1e-3 reject, with 99 %, probabilities beyond 0.5 ± 0.073. A ring that
/// is dropped almost flat does not pass.
#[test]
fn uniform_orientations_give_heads_as_often_as_tails() {
    let (stepper, tosses) = (ring(), 1500);
    let heads = |start: RandomStart| {
        let throw = Throw::new(&stepper, start, 10.0).unwrap();
        let ensemble = Ensemble::new(SEED, throw.scene_hash());
        let tally = ensemble.run(0..u64::from(tosses), |toss| throw.play(toss));
        let tally = tally.unwrap();
        let [heads, tails] = [CoinFace::Heads, CoinFace::Tails].map(|face| tally.count(&face));
        assert_eq!(heads + tails, u64::from(tosses), "{tally}");
        u32::try_from(heads).unwrap()
    };
    let test = FractionTest::at_level(1e-3, tosses, 0.5);
    let [low, high] = test.rejected().map(Option::unwrap);
    assert!(low > 0.427 && high < 0.573, "{low} {high}");
    let count = heads(any_start());
    assert!(test.accepts(count), "{count}");
    let flat = any_start().with_tilt(DVec3::X, 0.0..=0.2);
    let flat = flat.with_spin(RandomSpin::Isotropic { rate: 1.0.into() });
    assert!(!test.accepts(heads(flat)));
}

/// A direction that is uniform on the sphere: 6 moments of 20,000 within 4.5 standard errors.
/// Rejected with 99 %: a mean beyond 0.028, a mean square that is off by 0.015, and a mean rate that
/// is off by 0.14 rad/s. So is a horizontal direction.
#[test]
fn isotropic_spins_have_the_moments_of_the_sphere() {
    let stepper = ring();
    let spins = |spin| -> Vec<DVec3> {
        let start = RandomStart::at_height(1.0).with_spin(spin);
        let states = starts(&start, 0..20_000);
        let spins = states.iter().map(|state| stepper.angular_velocity(state));
        spins.collect()
    };
    let worst = |spins: &[DVec3]| {
        let n = spins.len() as f64;
        let mut worst: f64 = 0.0;
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let components = || spins.iter().map(|spin| spin.normalize().dot(axis));
            let first = components().sum::<f64>() / n;
            let second = components().map(|x| x * x).sum::<f64>() / n - 1.0 / 3.0;
            worst = worst.max(first.abs() / (1.0 / 3.0 / n).sqrt());
            worst = worst.max(second.abs() / (4.0 / 45.0 / n).sqrt());
        }
        worst
    };
    let rate = || (10.0..=20.0).into();
    let isotropic = spins(RandomSpin::Isotropic { rate: rate() });
    assert!(worst(&isotropic) < 4.5);
    let lengths = || isotropic.iter().map(|spin| spin.length());
    assert!(lengths().all(|rate| (10.0 - 1e-12..20.0 + 1e-12).contains(&rate)));
    // Mean 15 with variance 100/12.
    let mean = lengths().sum::<f64>() / 20_000.0;
    assert!((mean - 15.0).abs() < 4.5 * (100.0 / 12.0 / 20_000.0_f64).sqrt());
    let horizontal = spins(RandomSpin::Horizontal { rate: rate() });
    assert!(horizontal.iter().all(|spin| spin.z.abs() < 1e-12));
    assert!(worst(&horizontal) > 20.0);
}

#[test]
fn tilts_spins_heights_and_speeds_are_as_stated() {
    let stepper = ring();
    let axes = [
        DVec3::X,
        DVec3::Z,
        DVec3::NEG_Z,
        DVec3::new(1.0, -2.0, 3.0),
        DVec3::new(0.0, 1e-9, -5.0),
    ];
    for axis in axes {
        let start = RandomStart::at_height(0.1..=0.3)
            .with_tilt(axis, 0.2..=0.4)
            .with_spin(RandomSpin::World {
                axis: DVec3::new(0.0, 3.0, 4.0),
                rate: 50.0.into(),
            })
            .with_speed(DVec3::new(0.0, 0.0, -2.0), 1.0..=2.0);
        for state in starts(&start, 0..200) {
            let up = state.rotation().apply(axis.normalize());
            let tilt = up.x.atan2(up.z);
            assert!((0.2 - 1e-14..=0.4 + 1e-14).contains(&tilt), "{tilt}");
            assert!(up.y.abs() < 1e-15);
            assert!((0.1..=0.3).contains(&state.position.z));
            let speed = -state.linear_velocity.z;
            assert!((1.0..=2.0).contains(&speed) && state.linear_velocity.x == 0.0);
            let spin = stepper.angular_velocity(&state);
            assert!((spin - DVec3::new(0.0, 30.0, 40.0)).length() < 1e-12);
        }
        let about = RandomSpin::Body {
            axis,
            rate: (-9.0).into(),
        };
        let state = starts(&start.with_spin(about), 3..4)[0];
        let expected = state.rotation().apply(axis.normalize()) * -9.0;
        assert!((stepper.angular_velocity(&state) - expected).length() < 1e-13);
    }
}

#[test]
fn a_change_of_one_parameter_leaves_the_others() {
    let start = any_start();
    let faster = any_start().with_spin(RandomSpin::World {
        axis: DVec3::X,
        rate: 90.0.into(),
    });
    let pairs = starts(&start, 0..50)
        .into_iter()
        .zip(starts(&faster, 0..50));
    for (slow, fast) in pairs {
        assert_eq!(
            (slow.position, slow.orientation),
            (fast.position, fast.orientation)
        );
        assert_ne!(slow.angular_momentum, fast.angular_momentum);
    }
    let states = starts(&start, 0..1000);
    let distinct: BTreeSet<u64> = states
        .iter()
        .map(|state| state.position.z.to_bits())
        .collect();
    assert_eq!(distinct.len(), 1000);
}

/// The six orders of three strata in 6,000 groups: chi-square with 5 degrees of freedom, 99.9 %.
/// Rejected with 99 %: a noncentrality of 42, which is a mean square deviation of 8.4 % of the
/// probabilities, and for the nine pairs below one of 47, which is 8.9 %. A cyclic order, which has
/// three of the six only, would reach 6,000.
#[test]
fn latin_strata_are_permuted_uniformly_and_independently() {
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"latin"));
    let stratum = |number, strata: u32, coordinate| {
        let value = ensemble.toss(number).latin(strata, coordinate);
        (0..strata)
            .rfind(|&k| value >= f64::from(k) / f64::from(strata))
            .unwrap()
    };
    for strata in [1, 2, 10, 64] {
        for coordinate in 0..3 {
            for group in [0, 5] {
                let first = group * u64::from(strata);
                let group = first..first + u64::from(strata);
                let seen: BTreeSet<_> = group.map(|i| stratum(i, strata, coordinate)).collect();
                assert_eq!(seen.len(), strata as usize);
            }
        }
    }
    let groups = 6000;
    let chi_square = |code: &dyn Fn(u64) -> usize, cells: usize| {
        let mut counts = vec![0.0; cells];
        (0..groups).for_each(|group| counts[code(group)] += 1.0);
        let expected = groups as f64 / cells as f64;
        counts
            .iter()
            .map(|count| (count - expected).powi(2) / expected)
            .sum::<f64>()
    };
    let order = |group: u64| {
        let [a, b] = [0, 1].map(|at| stratum(3 * group + at, 3, 0) as usize);
        2 * a + usize::from(b == if a == 2 { 1 } else { 2 })
    };
    assert!(chi_square(&order, 6) < 20.5);
    assert!(chi_square(&|group| 2 * (group as usize % 3), 6) > 1000.0);
    // Two coordinates of the same toss: nine cells, 8 degrees of freedom.
    let both = |group: u64| [0, 1].map(|c| stratum(3 * group, 3, c) as usize);
    assert!(chi_square(&|group| both(group)[0] * 3 + both(group)[1], 9) < 26.1);
    assert!(chi_square(&|group| both(group)[0] * 4, 9) > 1000.0);
}

/// The variance of the mean of 50 numbers from 100 groups each. With 50 strata it is a 2,500th of
/// that of independent numbers. Rejected with 99 %: seven strata, with a 49th of it. The logarithm
/// of the ratio of two such variances scatters by 0.2, and the bound is 0.71 below that of a 49th.
#[test]
fn a_stratified_phase_varies_less() {
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"strata"));
    let mean = |strata: u32, group: u64| {
        let tosses = 50 * group..50 * (group + 1);
        tosses
            .map(|i| ensemble.toss(i).stratified(strata))
            .sum::<f64>()
            / 50.0
    };
    // Each number is within a fiftieth of its stratum, so the mean is within a hundredth.
    assert!((0..100).all(|group| (mean(50, group) - 0.5).abs() < 0.01));
    let spread = |strata| {
        (0..100)
            .map(|g| (mean(strata, g) - 0.5).powi(2))
            .sum::<f64>()
    };
    assert!(spread(50) < 1e-2 * spread(1));
}

#[test]
fn closures_are_starts_and_single_precision_has_ensembles() {
    let body = tumble::f32::Coin::ring_with_storage(
        [tumble::f32::ContactPoint::default(); 12],
        0.005,
        0.012,
    );
    let stepper = Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(tumble::f32::UniformGravity::down(9.81)))
        .and_then(|stepper| stepper.with_ground(tumble::f32::FlatGround::level(500.0, 0.5)))
        .unwrap();
    let start = |toss: &mut Toss<'_>| {
        let angle = toss.uniform(-3.0..=3.0) as f32;
        State::at(tumble::glam::Vec3::Z * 0.03).with_rotation_vector(tumble::glam::Vec3::Y * angle)
    };
    let closure = Throw::new(&stepper, start, 5.0).unwrap();
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"dropped at -3 to 3 rad"));
    let tally = ensemble.run(0..50, |toss| closure.play(toss)).unwrap();
    assert!(tally.count(&CoinFace::Heads) > 0 && tally.count(&CoinFace::Tails) > 0);
    let built_in = Throw::new(&stepper, any_start(), 5.0).unwrap();
    let ensemble = Ensemble::new(SEED, built_in.scene_hash());
    let tally = ensemble.run(0..50, |toss| built_in.play(toss)).unwrap();
    assert_eq!(tally.tosses(), 50);
    assert!(tally.errors().is_empty() && tally.undecided().count() < 10);
}

#[test]
fn invalid_starts_and_scenes_are_refused() {
    let stepper = ring();
    let message = |start: RandomStart| Throw::new(&stepper, start, 1.0).unwrap_err().to_string();
    let start = RandomStart::at_height(0.1);
    assert_eq!(
        message(RandomStart::at_height(0.3..=0.1)),
        "width of the heights must be at least 0, got -0.19999999999999998 m"
    );
    assert_eq!(
        message(start.with_tilt(DVec3::ZERO, 0.1)),
        "length of the tilted axis must be above 0, got 0"
    );
    assert_eq!(
        message(start.with_spin(RandomSpin::Isotropic {
            rate: f64::NAN.into()
        })),
        "low end of the spin rate must be finite, got NaN rad/s"
    );
    assert_eq!(
        message(start.with_speed(DVec3::NAN, 1.0)),
        "length of the direction must be finite, got NaN"
    );
    // The square of such a length overflows or underflows.
    for length in [1e200, 2e-162, 5e-324] {
        let [expected, drawn] = [DVec3::X, DVec3::X * length].map(|axis| {
            let rate = 3.0.into();
            let start = start.with_spin(RandomSpin::Body { axis, rate });
            let start = start.with_tilt(axis, 0.2).with_speed(axis, 1.0);
            Throw::new(&stepper, start, 1.0).unwrap();
            starts(&start, 0..3)
        });
        assert_eq!(expected, drawn, "{length:e}");
    }
    assert_eq!(
        message(start.with_sampling(Sampling::Latin { strata: 0 })),
        "number of strata must be at least 1, got 0"
    );
    assert_eq!(
        message(start.with_sampling(Sampling::Latin { strata: 5000 })),
        "number of strata must be at most 4096, got 5000"
    );
    assert!(Throw::new(&stepper, start, f64::INFINITY).is_err());
    let slope = stepper
        .with_gravity(UniformGravity {
            acceleration: DVec3::new(1.0, 0.0, -9.0),
        })
        .unwrap();
    let error = Throw::new(&slope, start, 1.0).unwrap_err();
    assert_eq!(error, EnsembleError::NoBarriers);
}

/// Text of the error of a scene without barriers, or none.
fn refusal(
    ground: impl SpringDamperGround,
    acceleration: DVec3,
    force: impl Force,
) -> Option<String> {
    let body = Coin::ring_with_storage([ContactPoint::default(); 12], 0.005, RADIUS);
    let stepper = Stepper::builder(body)
        .gravity(UniformGravity { acceleration })
        .ground(ground)
        .force(force)
        .build()
        .unwrap();
    let error = Throw::new(&stepper, RandomStart::at_height(0.1), 1.0).err()?;
    assert_eq!(error, EnsembleError::NoBarriers);
    Some(error.to_string())
}

/// One scene for each cause. They have one error, which names all causes.
#[test]
fn a_scene_without_barriers_is_told_every_cause() {
    let (own, down, drag) = (
        FlatGround::level(500.0, 0.5),
        DVec3::Z * -9.81,
        AirDrag::linear(1e-6),
    );
    assert_eq!(refusal(own, down, drag), None);
    let slope = own.on(Plane::through(DVec3::ZERO, DVec3::new(0.1, 0.0, 1.0)));
    let belt = MovingGround::conveyor(own, DVec3::X * 0.1);
    let aside = ConstantForce {
        force: DVec3::X * 0.01,
    };
    let wind = Wind {
        velocity: DVec3::X,
        force: drag,
    };
    let plane = "a single level plane that is at rest";
    let gravity = "gravity plus any constant force must point along -z";
    for (found, cause) in [
        (refusal(NoGround, down, drag), plane),
        (refusal(slope, down, drag), plane),
        (refusal([own, slope], down, drag), plane),
        (refusal(belt, down, drag), plane),
        (
            refusal(FlatGround::level(1e-3, 0.0), down, drag),
            "stiff enough to support the body",
        ),
        (refusal(own, DVec3::ZERO, drag), gravity),
        (refusal(own, DVec3::new(1.0, 0.0, -9.0), drag), gravity),
        (refusal(own, down, aside), gravity),
        (refusal(own, down, wind), "any other force must be passive"),
    ] {
        let found = found.unwrap();
        assert!(found.contains(cause), "{cause}: {found}");
    }
}

#[test]
fn tosses_that_fail_are_counted_by_kind() {
    let stepper = ring();
    let invalid = |_: &mut Toss<'_>| State::at(DVec3::NAN);
    let throw = Throw::new(&stepper, invalid, 1.0).unwrap();
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"nan"));
    let tally = ensemble.run(0..20, |toss| throw.play(toss)).unwrap();
    assert_eq!(tally.errors()[0].0, "invalid state");
    assert_eq!(tally.errors()[0].1.count(), 20);
    let error = throw.play(&mut ensemble.toss(3)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the position before the step must be finite, got NaN m"
    );
}

/// Parameters of a scene and of its tosses.
#[derive(Clone, Copy)]
struct Scene {
    mass: f64,
    radius: f64,
    ground: FlatGround,
    friction: Coulomb,
    gravity: UniformGravity,
    force: AirDrag,
    time_step: f64,
    start: RandomStart,
    seconds: f64,
}

impl Scene {
    fn hash(&self) -> SceneHash {
        let points = [ContactPoint::default(); 12];
        let stepper = Stepper::builder(Coin::ring_with_storage(points, self.mass, self.radius))
            .ground(self.ground)
            .friction(self.friction)
            .gravity(self.gravity)
            .force(self.force)
            .integrator(EnergyMomentum {
                time_step: self.time_step,
            })
            .build()
            .unwrap();
        let throw = Throw::new(&stepper, self.start, self.seconds).unwrap();
        throw.scene_hash()
    }
}

fn hashed() -> Scene {
    Scene {
        mass: 0.005,
        radius: RADIUS,
        ground: FlatGround::level(500.0, 0.5),
        friction: Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        },
        gravity: UniformGravity::down(9.81),
        force: AirDrag::linear(1e-6),
        time_step: 2e-3,
        start: any_start(),
        seconds: 1.0,
    }
}

/// The scene, and others in which one parameter of a part or the time has another value.
fn other_scenes() -> [Scene; 13] {
    let changes: [fn(&mut Scene); 13] = [
        |_| (),
        |scene| scene.mass = scene.mass.next_up(),
        |scene| scene.radius = scene.radius.next_up(),
        |scene| scene.ground.stiffness = scene.ground.stiffness.next_up(),
        |scene| scene.ground.damping = scene.ground.damping.next_up(),
        |scene| scene.ground.plane.height = 1e-9,
        |scene| scene.friction.coefficient = scene.friction.coefficient.next_up(),
        |scene| scene.friction.slip_speed = scene.friction.slip_speed.next_up(),
        |scene| scene.gravity.acceleration.z = scene.gravity.acceleration.z.next_up(),
        |scene| scene.force.linear = scene.force.linear.next_up(),
        |scene| scene.force.quadratic = 1e-12,
        |scene| scene.time_step = scene.time_step.next_up(),
        |scene| scene.seconds = scene.seconds.next_up(),
    ];
    changes.map(|change| {
        let mut scene = hashed();
        change(&mut scene);
        scene
    })
}

/// Starts that differ from [`any_start`] and from each other.
fn other_starts() -> [RandomStart; 18] {
    let axis = DVec3::new(1.0, 2.0, 3.0);
    let tilted = |axis, tilt: f64, phase: f64| RandomOrientation::Tilted {
        axis,
        tilt: tilt.into(),
        phase: phase.into(),
    };
    let own = any_start();
    let rate = || (20.0..=40.0).into();
    [
        RandomStart::at_height(0.03..=0.04_f64.next_up()).with_spin(own.spin),
        RandomStart::at_height(0.03_f64.next_up()..=0.04).with_spin(own.spin),
        own.with_orientation(tilted(axis, 0.1, 0.0)),
        own.with_orientation(tilted(axis * 2.0, 0.1, 0.0)),
        own.with_orientation(tilted(axis, 0.1_f64.next_up(), 0.0)),
        own.with_orientation(tilted(axis, 0.1, 1e-9)),
        own.with_spin(RandomSpin::Isotropic {
            rate: (20.0..=40.0_f64.next_up()).into(),
        }),
        own.with_spin(RandomSpin::Horizontal { rate: rate() }),
        own.with_spin(RandomSpin::Body { axis, rate: rate() }),
        own.with_spin(RandomSpin::World { axis, rate: rate() }),
        own.with_spin(RandomSpin::World {
            axis: axis * 2.0,
            rate: rate(),
        }),
        own.with_speed(DVec3::X, 0.0),
        own.with_speed(DVec3::Z, 1e-9),
        own.with_speed(DVec3::Z, 0.0..=1e-9),
        own.with_sampling(Sampling::StratifiedPhase { strata: 10 }),
        own.with_sampling(Sampling::StratifiedPhase { strata: 11 }),
        own.with_sampling(Sampling::Latin { strata: 10 }),
        own.with_sampling(Sampling::Latin { strata: 11 }),
    ]
}

/// A parameter that is not in the hash would leave it as it is.
#[test]
fn the_scene_hash_knows_every_parameter() {
    let started = other_starts().map(|start| Scene { start, ..hashed() });
    let all: Vec<_> = other_scenes().into_iter().chain(started).collect();
    let hashes: BTreeSet<_> = all.iter().map(|scene| scene.hash().to_string()).collect();
    assert_eq!(hashes.len(), all.len());
    assert_eq!(hashed().hash(), all[0].hash());

    // The types of the parts are in it too.
    let other = Throw::new(&ring(), any_start(), 1.0).unwrap().scene_hash();
    assert!(!hashes.contains(&other.to_string()));
}

/// The result of two tosses with a method that stores this many contacts.
fn with_stored_contacts<const CONTACTS: usize>() -> Tally<CoinFace> {
    let method = CompactEnergyMomentum::<CONTACTS> { time_step: 2e-3 };
    let stepper = ring().with_integrator(method).unwrap();
    let throw = Throw::new(&stepper, any_start(), 10.0).unwrap();
    let ensemble = Ensemble::new(SEED, throw.scene_hash());
    let first = CONTACTS as u64;
    let tally = ensemble.run(first..first + 2, |toss| throw.play(toss));
    tally.unwrap()
}

/// The number is a parameter of the type, and bits of a result may depend on it.
#[test]
fn results_with_another_number_of_stored_contacts_are_not_merged() {
    let mut tally = with_stored_contacts::<2>();
    let error = tally.merge(&with_stored_contacts::<12>()).unwrap_err();
    assert!(matches!(error, EnsembleError::OtherScene { .. }));
}

/// All parameters are numbers that both precisions have.
#[test]
fn the_scene_hash_knows_the_precision() {
    let double = Stepper::builder(Cuboid::solid(0.5, DVec3::splat(0.5)))
        .ground(FlatGround::level(512.0, 0.5))
        .gravity(UniformGravity::down(8.0))
        .build()
        .unwrap();
    let single = Stepper::builder(Cuboid::solid(0.5_f32, Vec3::splat(0.5)))
        .ground(FlatGround::level(512.0, 0.5))
        .gravity(UniformGravity::down(8.0))
        .build()
        .unwrap();
    let start = || RandomStart::at_height(0.5..=1.0);
    let double = Throw::new(&double, start(), 1.0).unwrap().scene_hash();
    let single = Throw::new(&single, start(), 1.0).unwrap().scene_hash();
    assert_ne!(double, single);
}

#[test]
fn a_toss_is_played_once_in_a_run() {
    let plays = AtomicU64::new(0);
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"once")).with_block(0);
    let tally = ensemble.run(u64::MAX - 3..u64::MAX, |toss| {
        plays.fetch_add(1, Ordering::Relaxed);
        Ok(Outcome::Decided(toss.number()))
    });
    assert_eq!((tally.unwrap().tosses(), plays.into_inner()), (3, 3));
}
