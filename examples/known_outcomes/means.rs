//! What each means of a cheap toss saves: the cost of the same tosses with it and without it.

use core::fmt::{Debug, Write as _};

use common::{Outcome, steel_coin};
use tumble::ensemble::{Throw, Toss, TossError};
use tumble::glam::DVec3;
use tumble::{
    BogackiShampine32, Carried, CoinFace, Coulomb, DormandPrince54, Faces, FlatGround, Flight,
    Integrator, Nystrom, Outcome as Ended, SpringDamper, Stepper, ThickDisc, UniformGravity,
    UntilDecided, UntilRest,
};

use crate::methods::{self, COIN, Labels, PATIENCE, Tossed};
use crate::shown::{interval, percent};
use crate::upright::UntilUpright;
use crate::{Report, Size};

/// Tolerances (m) of a toss, and of its reference.
const TOLERANCE: f64 = 1e-4;
const REFERENCE: f64 = 1e-8;
/// Tolerances (m) without closed-form flight, and fixed steps (s). The first one is used whose
/// labels are as good as those of the first row.
const TOLERANCES: [f64; 4] = [1e-4, 1e-5, 1e-6, 1e-7];
const STEPS: [f64; 6] = [4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5, 1.25e-5];
/// Points that a round rim represents: those of a rim of the coin of points.
const POINTS: usize = 24;
/// Penetrations (m) of one point that supports the weight, of the tosses that may end early.
const DEPTHS: [f64; 2] = [2e-5, 1e-6];

/// Cost of one way to play the tosses, and its labels.
struct Row {
    name: String,
    /// Labels that are those of the reference.
    agreeing: u64,
    /// s.
    cost: f64,
}

impl Row {
    fn of<F: PartialEq>(name: &str, labels: &Labels<F>, reference: &Labels<F>) -> Self {
        Self {
            name: name.to_owned(),
            agreeing: labels.agreeing(reference),
            cost: labels.cost,
        }
    }

    fn shown(&self, tosses: u64, base: f64, size: Size) -> String {
        let cost = size.machine(format!("{:.0}", 1e6 * self.cost));
        let ratio = size.machine(format!("{:.2}", self.cost / base));
        let labels = percent(self.agreeing, tosses);
        format!("| {} | {labels} | {cost} | {ratio} |\n", self.name)
    }
}

pub(crate) fn tables(size: Size) -> Outcome<Report> {
    let tosses = size.of(1_000);
    let mut text = format!(
        "The first {tosses} tosses of the isotropic steel coin of the tables above. The first row \
         is `BogackiShampine32`\nin `Flight` with a tolerance of {TOLERANCE:e} m until the face is \
         proven, on points. Each other row changes\none means of it. A tolerance or a step is the \
         first of a list with labels as good as those of the\nfirst row, or the last one.\n\n\
         | tosses | labels as the reference, % | cost of a toss, µs | cost over that of the first \
         row |\n|---|---|---|---|\n"
    );
    let rows = rows(tosses, size)?;
    for row in &rows {
        text += &row.shown(tosses, rows[0].cost, size);
    }
    text += &early_ends(size)?;
    Ok(Report {
        text,
        is_as_expected: true,
    })
}

fn rows(tosses: u64, size: Size) -> Outcome<Vec<Row>> {
    let times = size.repetitions();
    let method = BogackiShampine32::new(TOLERANCE);
    let fine = Flight(DormandPrince54::new(REFERENCE));
    let points = methods::isotropic(size);
    let reference = points.labels(fine, tosses, 1)?;
    let base = points.labels(Flight(method), tosses, times)?;
    let mut rows = vec![Row::of("first row", &base, &reference)];
    let labels = [&base, &reference];
    rows.push(as_good(labels, &TOLERANCES, |tolerance| {
        let method = BogackiShampine32::new(tolerance);
        let name = format!("steps in flight too, tolerance {tolerance:e} m");
        Ok((name, points.labels(method, tosses, times)?))
    })?);
    let rested = until_rest(&points, Flight(method), tosses, times)?;
    let name = "to rest, without certificate";
    rows.push(Row::of(name, &rested, &reference));
    rows.push(as_good(labels, &STEPS, |time_step| {
        let name = format!("`Nystrom`, {time_step:e} s, in place of a tolerance");
        let method = Flight(Nystrom { time_step });
        Ok((name, points.labels(method, tosses, times)?))
    })?);
    let round = Tossed {
        name: points.name,
        body: ThickDisc::solid(COIN.mass, COIN.radius, COIN.thickness, POINTS),
        start: points.start,
        tosses: points.tosses,
        targets: points.targets,
    };
    let reference = round.labels(fine, tosses, 1)?;
    let labels = round.labels(Flight(method), tosses, times)?;
    rows.push(Row::of(
        "round rims in place of points",
        &labels,
        &reference,
    ));
    Ok(rows)
}

/// Tosses that are followed until no point moves by a tenth of a millimetre in a quarter of a
/// second.
fn until_rest<B, I>(
    tossed: &Tossed<B>,
    integrator: I,
    tosses: u64,
    times: usize,
) -> Outcome<Labels<B::Face>>
where
    B: Faces<Face: Ord> + Clone + Debug + Sync,
    I: Integrator,
{
    let stepper = tossed.stepper(integrator)?;
    let throw = Throw::new(&stepper, tossed.start, PATIENCE)?;
    let rest = UntilRest::new(&tossed.body, 1e-4, 0.25)?;
    tossed.timed(tosses, times, |toss| {
        let mut state = throw.start(toss)?;
        let mut rest = rest;
        stepper.run(&mut state, PATIENCE, &mut rest)?;
        let basin = tossed
            .body
            .basin(state.orientation.inverse() * DVec3::NEG_Z);
        let face = basin.filter(|_| rest.is_reached());
        Ok(face.map_or(Ended::Undecided, |basin| Ended::Decided(basin.face)))
    })
}

/// The first of the settings whose labels are as good as those of the base, or the last one.
fn as_good<F: PartialEq>(
    [base, reference]: [&Labels<F>; 2],
    settings: &[f64],
    play: impl Fn(f64) -> Outcome<(String, Labels<F>)>,
) -> Outcome<Row> {
    let enough = base.agreeing(reference);
    let mut row = None;
    for &setting in settings {
        let (name, labels) = play(setting)?;
        let now = Row::of(&name, &labels, reference);
        let is_enough = now.agreeing >= enough;
        row = Some(now);
        if is_enough {
            break;
        }
    }
    Ok(row.ok_or("there is no setting")?)
}

/// End of a toss that may end early.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Early {
    is_upright: bool,
    outcome: Ended<CoinFace>,
}

/// Tosses with round rims, with and without an early end of those that roll upright.
fn early_ends(size: Size) -> Outcome<String> {
    let tosses = size.of(1_000);
    let mut text = String::from(
        "\nAn early end of coins that roll upright is a heuristic, and no proof. The same tosses \
         with round rims,\nwith and without it. A coin that it ends counts as wrong if it falls \
         on a face within ten seconds.\n\n\
         | penetration at rest, m | tosses | ended early | of these wrong | at most, % (95 %) | \
         cost without, µs | cost with, µs |\n|---|---|---|---|---|---|---|\n",
    );
    for depth in DEPTHS {
        let [whole, early] = [false, true].map(|is_early| rolled(depth, tosses, is_early, size));
        let (whole, early) = (whole?, early?);
        let pairs = || {
            early
                .0
                .iter()
                .zip(&whole.0)
                .filter(|(early, _)| early.is_upright)
        };
        let ended = pairs().count() as u64;
        let is_face = |outcome| {
            [CoinFace::Heads, CoinFace::Tails]
                .map(Ended::Decided)
                .contains(&outcome)
        };
        let wrong = pairs().filter(|(_, whole)| is_face(whole.outcome)).count() as u64;
        let [_, most] = interval(wrong, ended);
        let [without, with] =
            [whole.1, early.1].map(|cost| size.machine(format!("{:.0}", 1e6 * cost)));
        writeln!(
            text,
            "| {depth:e} | {tosses} | {ended} | {wrong} | {:.1} | {without} | {with} |",
            100.0 * most
        )?;
    }
    Ok(text)
}

/// Ends of some tosses with round rims, and the cost of one, s.
fn rolled(depth: f64, tosses: u64, is_early: bool, size: Size) -> Outcome<(Vec<Early>, f64)> {
    let carried = Carried {
        mass: COIN.mass,
        contacts: 1,
    };
    let law = SpringDamper::from_rest(carried, 0.5, depth, steel_coin::GRAVITY)?;
    let body = ThickDisc::solid(COIN.mass, COIN.radius, COIN.thickness, POINTS);
    let stepper = Stepper::builder(body)
        .gravity(UniformGravity::down(steel_coin::GRAVITY))
        .ground(FlatGround::level(law.stiffness, law.damping))
        .friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-2,
        })
        .integrator(Flight(BogackiShampine32::new(TOLERANCE)))
        .build()?;
    let throw = Throw::new(&stepper, methods::any_start(), PATIENCE)?;
    let barriers = stepper.barriers().ok_or("no barriers")?;
    let play = |toss: &mut Toss<'_>| -> Result<Early, TossError> {
        let mut state = throw.start(toss)?;
        let mut decided = UntilDecided::new(barriers);
        let mut upright = UntilUpright::new(COIN, steel_coin::GRAVITY);
        if is_early {
            let mut both = (decided, upright);
            stepper.run(&mut state, PATIENCE, &mut both)?;
            (decided, upright) = both;
        } else {
            stepper.run(&mut state, PATIENCE, &mut decided)?;
        }
        Ok(Early {
            is_upright: upright.is_reached(),
            outcome: decided.outcome(),
        })
    };
    methods::timed("early ends", tosses, size.repetitions(), play)
}
