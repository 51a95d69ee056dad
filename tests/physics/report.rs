//! Statements of the report "Special Topics: Coin Project" about its eight trials, which the
//! library reproduces with every integrator.
//!
//! Two of its statements are not physics and are not tested. One is that the coin rocks in the end:
//! its lowest point moves round the rim, ever faster. The other is the time at which an exactly
//! upright spinning coin falls. In exact arithmetic it never falls, so trials 4 and 6 start with a
//! small disturbance here. Whether trial 6 moves farther than trial 4 depends on rounding.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::common::methods::{METHODS, Method, Setup, convergence, method};
use crate::common::report_loop::{self, ReportLoop, ReportTrial};
use core::f64::consts::TAU;
use core::ops::ControlFlow;
use std::sync::OnceLock;
use tumble::glam::{DVec2, DVec3};
use tumble::{EnergyMomentum, Sample, Trial};

const MASS: f64 = 1.0;
const RADIUS: f64 = 0.5;
const GRAVITY: f64 = 9.8;
/// Stiffness of all points together, N/m.
const STIFFNESS: f64 = 120.0 * 1000.0;
/// Lean (rad) that trials 4 and 6 get instead of none.
const NUDGE: f64 = 1e-6;
/// Between two frames of a film, s.
const FRAME: f64 = 0.01;
/// Frames in a second.
const SECOND: usize = 100;

/// Energy of the coin that lies on its 120 springs: `M g z + n S z^2/2` at `z = -M g/(n S)`, J.
const ENERGY_AT_REST: f64 = -(MASS * GRAVITY) * (MASS * GRAVITY) / (2.0 * STIFFNESS);

/// A trial of the report.
fn start(trial: usize) -> Trial {
    Trial::report(trial).unwrap()
}

/// A trial of any tilt starts with its lowest point on the ground, and no spring is compressed.
#[test]
fn a_trial_of_any_tilt_starts_on_the_ground() {
    for degrees in (-400..=400).step_by(20) {
        let trial = Trial {
            tilt: f64::from(degrees).to_radians(),
            ..start(1)
        };
        let stepper = trial.stepper(EnergyMomentum { time_step: 1e-3 }).unwrap();
        let state = trial.state();
        let lowest = stepper.lowest_point(&state).unwrap();
        assert!(lowest.gap.abs() < 1e-15, "{degrees} degrees: {lowest:?}");
        assert!(stepper.energy(&state).springs < 1e-20, "{degrees} degrees");
    }
}

/// A moment of a trial.
#[derive(Clone, Copy, Debug)]
struct Frame {
    time: f64,
    centre: DVec3,
    lowest: DVec3,
    /// Position of the lowest point, m.
    gap: f64,
    /// Slip velocity of the lowest point, m/s.
    slip: f64,
    /// Sine of the lean from upright: 0 upright, 1 flat.
    lean: f64,
    energy: f64,
    touching: usize,
}

/// A trial by one integrator, until two seconds after it has settled.
struct Film {
    trial: usize,
    method: Method,
    frames: Vec<Frame>,
}

impl Film {
    fn shoot(trial: usize, method: Method) -> Self {
        let exact = start(trial);
        let setup = Setup::of(&Trial {
            tilt: exact.tilt.max(NUDGE),
            ..exact
        });
        let mut frames: Vec<Frame> = Vec::new();
        let mut settled = f64::INFINITY;
        let mut camera = |sample: &Sample<'_>| {
            // The clock's rounding is far below a nanosecond.
            if sample.time < frames.len() as f64 * FRAME - 1e-9 {
                return ControlFlow::Continue(());
            }
            let lowest = sample.lowest_point().unwrap();
            let frame = Frame {
                time: sample.time,
                centre: sample.state.position,
                lowest: lowest.position,
                gap: lowest.gap,
                slip: lowest.slip_velocity.length(),
                lean: (sample.state.orientation * DVec3::X).z.abs(),
                energy: sample.energy().total(),
                touching: sample.touching(),
            };
            frames.push(frame);
            if has_settled(&frame) {
                settled = settled.min(frame.time);
            }
            if frame.time > settled + 2.0 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let mut state = setup.state;
        method
            .stepper(&setup, method.time_step)
            .run(&mut state, 160.0, &mut camera);
        Self {
            trial,
            method,
            frames,
        }
    }

    fn name(&self) -> String {
        format!("trial {} by {}", self.trial, self.method.name)
    }

    /// First frame that is so, if any.
    fn first(&self, so: impl Fn(&Frame) -> bool) -> Option<&Frame> {
        self.frames.iter().find(|frame| so(frame))
    }

    /// When the coin settles, s.
    fn settles(&self) -> f64 {
        (self.first(has_settled))
            .unwrap_or_else(|| panic!("{} does not settle", self.name()))
            .time
    }

    /// When the coin leans by 45 degrees, s.
    fn tips(&self) -> f64 {
        self.first(|frame| frame.lean > 0.5_f64.sqrt())
            .unwrap()
            .time
    }

    /// The frames of a span of time, s.
    fn between(&self, from: f64, until: f64) -> impl Iterator<Item = &Frame> + Clone {
        (self.frames.iter()).filter(move |frame| frame.time >= from && frame.time <= until)
    }
}

/// Within 10 mJ of rest: for the flat coin that rolls on its rim, `3/2 M g r lean`, a lean of 0.08
/// degrees.
fn has_settled(frame: &Frame) -> bool {
    frame.energy < ENERGY_AT_REST + 0.01
}

/// The films of a trial, by every integrator.
fn films(trial: usize) -> &'static [Film] {
    static FILMS: [OnceLock<Vec<Film>>; 8] = [const { OnceLock::new() }; 8];
    FILMS[trial - 1].get_or_init(|| {
        (METHODS.iter())
            .map(|&method| Film::shoot(trial, method))
            .collect()
    })
}

/// The films of two trials, side by side by the same integrator.
fn pairs(trial: usize, other: usize) -> impl Iterator<Item = (&'static Film, &'static Film)> {
    films(trial).iter().zip(films(other))
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Distance of the centre's track from where it began, m.
fn strays(frame: &Frame) -> f64 {
    frame.centre.truncate().length()
}

#[test]
fn a_rolling_coin_starts_with_the_slip_of_its_spin_and_loses_it() {
    for trial in [1, 2, 3] {
        let spin = start(trial).angular_momentum / (MASS * RADIUS * RADIUS);
        for film in films(trial) {
            let first = film.frames[0].slip;
            // The centre rests: the lowest point moves at r w. Rounding only.
            assert!((first - RADIUS * spin).abs() < 1e-12, "{}", film.name());
            // "The tangent velocity oscillates but at a much lower range": 0.15 m/s where trial 1
            // began with 2. (Trial 2 skids once more, at 0.6 m/s, when it tips; so it is asked
            // before.)
            let until = if trial == 2 { 15.0 } else { 160.0 };
            let later = largest(film.between(2.0, until).map(|frame| frame.slip));
            assert!(later < 0.1 * first, "{}: {later}", film.name());
        }
    }
}

#[test]
fn an_upright_rolling_coin_skids_for_v_over_two_mu_g_and_then_rolls() {
    // A hoop at rest that spins at v/r rolls after `v/(2 mu g)`. (Trial 1 tips over while it still
    // skids.)
    for trial in [2, 3] {
        let Trial {
            angular_momentum,
            coefficient,
            ..
        } = start(trial);
        let speed = angular_momentum / (MASS * RADIUS);
        let closed_form = speed / (2.0 * coefficient * GRAVITY);
        for film in films(trial) {
            let rolls = film.first(|frame| frame.slip < 0.05 * speed).unwrap().time;
            // The coin leans by 15 to 20 degrees and sinks while it skids: its weight on the table
            // is M g less M times the acceleration of the fall, by up to a fifth. Measured: 12 %
            // and 10 % longer, frame by frame of 10 ms.
            let ratio = rolls / closed_form;
            assert!((0.9..1.25).contains(&ratio), "{}: {ratio}", film.name());
            // Then it rolls: the slip that is left is that of points that touch down.
            let left = largest(film.between(2.0 * rolls, 10.0).map(|frame| frame.slip));
            assert!(left < 0.03 * speed, "{}: {left}", film.name());
        }
    }
}

#[test]
fn trial_1_slips_again_and_again_where_trial_3_does_not() {
    for (slippery, rough) in pairs(1, 3) {
        let slip = |film: &Film| largest(film.between(1.0, 20.0).map(|frame| frame.slip));
        // 0.22 to 0.24 m/s against 0.03 m/s and less.
        let (slippery, rough) = (slip(slippery), slip(rough));
        assert!(slippery > 3.0 * rough, "{slippery} and {rough}");
    }
}

#[test]
fn trial_1_tips_at_once_and_trial_2_travels_before_it_tips() {
    for (slow, fast) in pairs(1, 2) {
        // 0.49 s in the truth and in the report's scheme; a frame more or less, and the first
        // order's error.
        assert!((slow.tips() - 0.49).abs() < 0.02, "{}", slow.name());
        // The report's scheme: 23.0 s; by dt -> 0: 20 s. The long roll is sensitive: 19 to 27 s by
        // the methods here.
        assert!((15.0..30.0).contains(&fast.tips()), "{}", fast.name());
        // Less than its radius, against more than four of its diameters.
        let way = |film: &Film| largest(film.between(0.0, film.tips()).map(strays));
        assert!(way(slow) < RADIUS, "{}", slow.name());
        assert!(way(fast) > 8.0 * RADIUS, "{}", fast.name());
    }
}

#[test]
fn more_friction_lets_trial_3_roll_longer_than_trial_1() {
    for (slippery, rough) in pairs(1, 3) {
        // 78 s against 30.5 s, as dt -> 0. In stick the methods get there by different ways: at the
        // steps here SymplecticEuler rolls for 69 s, Rk4 for 77 s, and StrangSplitting, whose
        // midpoint kick turns a stuck point's slip round instead of stopping it, for 108 s.
        assert!(
            rough.settles() > 2.0 * slippery.settles(),
            "{}",
            rough.name()
        );
    }
}

#[test]
fn trials_4_and_6_spin_on_the_spot_and_then_fall() {
    // How long depends on the nudge, and in trial 4 on rounding: 2 to 9 s and 61 to 68 s here.
    for (trial, at_least) in [(4, 1.5), (6, 50.0)] {
        for film in films(trial) {
            let leans = film.first(|frame| frame.lean > 0.01).unwrap().time;
            assert!(leans > at_least, "{} leans at {leans} s", film.name());
            // On the spot: a lean of 0.01 moves the centre of a coin by 5 mm from its lowest point,
            // and that point moves as far again to either side. Its direction depends on rounding:
            // 4.6 to 11.9 mm over 15 starts that differ by 1e-12 rad, with four methods.
            let strayed = largest(film.between(0.0, leans - FRAME).map(strays));
            assert!(strayed < 4.0 * RADIUS * 0.01, "{}: {strayed}", film.name());
            // Then it falls: not farther than its radius from where it spun.
            let strayed = largest(film.between(0.0, film.tips()).map(strays));
            assert!(strayed < RADIUS, "{}: {strayed}", film.name());
        }
    }
}

#[test]
fn trial_7_jumps() {
    for film in films(7) {
        // The centre reaches 0.622 m in an independent run, where a coin that stands has it at
        // 0.5 m. ForwardEuler jumps 8 mm higher, because its step takes 40 % off the dampers.
        let height = largest(film.frames.iter().map(|frame| frame.centre.z));
        assert!((height - 0.622).abs() < 0.01, "{}: {height}", film.name());
        let gap = largest(film.frames.iter().map(|frame| frame.gap));
        assert!(gap > 0.1, "{}: {gap}", film.name());
    }
}

#[test]
fn trial_7_runs_along_a_line() {
    for film in films(7) {
        let (_, long, wide) = spread(film.between(0.0, 5.0).map(|frame| frame.centre));
        // 16 to 24 times as long as wide, over metres.
        assert!(
            long > 1.0 && long > 10.0 * wide,
            "{}: {long} by {wide}",
            film.name()
        );
    }
}

#[test]
fn trial_5_traces_a_circle_before_it_tumbles() {
    for film in films(5) {
        // The report plots the lowest point.
        let track = film.between(5.0, 25.0).map(|frame| frame.lowest);
        let (middle, ..) = spread(track.clone());
        let arms: Vec<DVec2> = track.map(|point| point.truncate() - middle).collect();
        let count = arms.len() as f64;
        let radius = arms.iter().map(|arm| arm.length()).sum::<f64>() / count;
        // 0.188 m by every method, and round to a standard deviation of 12 %.
        assert!((radius - 0.188).abs() < 0.005, "{}: {radius}", film.name());
        let squares: f64 = arms.iter().map(|arm| (arm.length() - radius).powi(2)).sum();
        let roundness = (squares / count).sqrt() / radius;
        assert!(roundness < 0.15, "{}: {roundness}", film.name());
        // Four times round in these 20 s.
        let turned: f64 = arms.windows(2).map(|pair| pair[0].angle_to(pair[1])).sum();
        let turns = turned.abs() / TAU;
        assert!((3.0..5.0).contains(&turns), "{}: {turns}", film.name());
    }
}

#[test]
fn every_trial_settles_flat_with_the_energy_of_the_sag() {
    for trial in 1..=8 {
        let coefficient = start(trial).coefficient;
        for film in films(trial) {
            film.settles();
            let last = film.frames.last().unwrap();
            let above = last.energy - ENERGY_AT_REST;
            // The lowest energy there is, to rounding of M g z and n S z^2/2.
            assert!(above > -1e-15, "{}: {above:e}", film.name());
            // What an explicit method leaves: at a slip speed of 1e-10 m/s friction flips the
            // velocity by mu g dt from step to step, and the spin by as much at the rim.
            let chatter = coefficient * GRAVITY * film.method.time_step;
            assert!(
                above < MASS * chatter * chatter,
                "{}: {above:e}",
                film.name()
            );
            assert_eq!(last.touching, 120, "{}", film.name());
        }
    }
}

#[test]
fn the_trials_settle_in_their_order() {
    // In the report's scheme at 35, 46, 57, 82 and 91 s for trials 1, 8, 2, 5 and 3, some 13 %
    // sooner as dt -> 0. Trials 4, 6 and 7 hang on rounding, but for this: five times the spin
    // lasts longer.
    for (sooner, later) in [(1, 8), (8, 2), (2, 5), (2, 3), (4, 6), (8, 7)] {
        for (sooner, later) in pairs(sooner, later) {
            let (a, b) = (sooner.settles(), later.settles());
            assert!(
                a < b,
                "{} at {a} s, {} at {b} s",
                sooner.name(),
                later.name()
            );
        }
    }
}

#[test]
fn with_all_of_their_damping_the_trials_settle_a_tenth_sooner_than_in_the_report() {
    // The report's scheme, at its step, takes a fifth off the dampers; it settles at these times,
    // s.
    for (trial, reports) in [(1, 35.2), (2, 56.6), (3, 90.6), (5, 82.1), (8, 46.1)] {
        let rk4 = films(trial).iter().find(|film| film.method.name == "Rk4");
        // 10 to 14 % sooner as dt -> 0; here, where points stick for long (trial 3), 15 %.
        let sooner = 1.0 - rk4.unwrap().settles() / reports;
        assert!((0.08..0.17).contains(&sooner), "trial {trial}: {sooner}");
    }
}

#[test]
fn at_the_scale_of_a_plot_the_energy_only_falls() {
    for trial in 1..=8 {
        for film in films(trial) {
            let settles = film.settles();
            let moving: Vec<_> = film
                .between(0.0, settles)
                .map(|frame| frame.energy)
                .collect();
            for pair in moving.windows(SECOND + 1) {
                let (before, after) = (pair[0], pair[SECOND]);
                assert!(
                    after < before,
                    "{}: {before} J, a second later {after} J",
                    film.name()
                );
            }
        }
    }
}

/// Middle of a track in the plane, and the roots of the mean squares along its longest direction
/// and across it, m.
fn spread(track: impl Iterator<Item = DVec3> + Clone) -> (DVec2, f64, f64) {
    let track = track.map(DVec3::truncate);
    let count = track.clone().count() as f64;
    let middle = track.clone().sum::<DVec2>() / count;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for point in track {
        let DVec2 { x, y } = point - middle;
        xx += x * x / count;
        xy += x * y / count;
        yy += y * y / count;
    }
    // The eigenvalues of the 2x2 tensor.
    let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    (middle, (mean + half).sqrt(), (mean - half).max(0.0).sqrt())
}

/// Difference between `ForwardEuler` and the report's own loop after half a second of a trial, m.
fn forward_euler_from_the_loop(trial: &Trial, report: ReportTrial) -> f64 {
    let end = 0.5;
    let mut report = ReportLoop::new(report);
    let time_step = report.trial().time_step;
    while report.time() < end - 0.5 * time_step {
        report.step();
    }
    let setup = Setup::of(trial);
    let state = method("ForwardEuler").records(&setup, time_step, &[end])[0].state;
    // Point 120 lies on the body's y axis, point 30 on its z axis.
    let arm = |num, axis| {
        let ours = state.orientation.mul_vec3(axis) * RADIUS;
        (DVec3::from(report.arm(num)) - ours).length()
    };
    let centre = (DVec3::from(report.centre()) - state.position).length();
    centre.hypot(arm(30, DVec3::Z)).hypot(arm(120, DVec3::Y))
}

#[test]
fn forward_euler_differs_from_the_reports_loop_by_one_order_of_the_step() {
    // The loop takes its velocities of points from the angular velocity of the step before, which a
    // plain state does not hold.
    for number in [1, 5, 8] {
        let differences = [4e-4, 2e-4, 1e-4, 5e-5].map(|time_step| {
            let report = ReportTrial {
                time_step,
                ..ReportTrial::numbered(number).unwrap()
            };
            (
                time_step,
                forward_euler_from_the_loop(&start(number), report),
            )
        });
        let order = convergence(&differences);
        // 1.04 to 1.06: the first term, and a second that is 10 % of it at the longest step.
        assert!(
            (order - 1.0).abs() < 0.1,
            "trial {number}: {order}, {differences:?}"
        );
    }
}

#[test]
fn forward_euler_is_the_reports_loop_where_no_force_depends_on_a_velocity() {
    for number in [1, 5, 8] {
        let trial = Trial {
            coefficient: 0.0,
            damping: 0.0,
            ..start(number)
        };
        let report = ReportTrial {
            coefficient: 0.0,
            damping: 0.0,
            ..ReportTrial::numbered(number).unwrap()
        };
        // Rounding: 5000 steps, and the growth of what it leaves. Measured: 1e-13 m. A change of
        // the order of operations shows at 5e-4 m.
        let difference = forward_euler_from_the_loop(&trial, report);
        assert!(difference < 1e-10, "trial {number}: {difference:e}");
    }
}

#[test]
fn the_librarys_trials_are_the_reports() {
    for trial in 1..=8 {
        let numbered = ReportTrial::numbered(trial).unwrap();
        let report = ReportLoop::new(numbered);
        let setup = Setup::of(&start(trial));
        let same = |ours: DVec3, theirs: [f64; 3]| (ours - DVec3::from(theirs)).length() < 1e-15;
        assert!(same(setup.state.position, report.centre()), "{trial}");
        assert!(
            same(setup.state.angular_momentum, report.angular_momentum()),
            "{trial}"
        );
        for (num, axis) in [(30, DVec3::Z), (120, DVec3::Y)] {
            assert!(
                same(setup.state.orientation * axis * RADIUS, report.arm(num)),
                "{trial}"
            );
        }
        let ours = [
            setup.ground.stiffness,
            setup.ground.damping,
            setup.friction.coefficient,
            setup.friction.slip_speed,
        ];
        let theirs = [
            numbered.stiffness,
            numbered.damping,
            numbered.coefficient,
            report_loop::SLIP_SPEED,
        ];
        assert_eq!(ours.map(f64::to_bits), theirs.map(f64::to_bits), "{trial}");
    }
    assert!(Trial::<f64>::report(0).is_none() && Trial::<f64>::report(9).is_none());
}
