//! A user's own body: a rattleback, which spins in one direction and reverses in the other.
//!
//! Run `cargo run --release --example custom_body -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLUE, Camera, Check, Column, Film, Mesh, ORANGE, Options, Outcome, Page, Picture, Shot, mesh,
};
use kuva::prelude::*;
use tumble::contract::{CheckPlan, check_body};
use tumble::error::{self, SceneError};
use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{
    ContactPoint, ContactRange, Coulomb, EnergyMomentum, FlatGround, RigidPointBody, Sample, State,
    Stepper, UniformGravity,
};

const ABOUT: &str = "\
Spins a rattleback, or celt: a boat-shaped stone, defined in this file, whose mass is rotated
relative to its keel. Against its preferred direction it rattles, stops, and reverses. Its mirror
image does the same in the mirrored direction, bit by bit.";

// The size is that of the stone of Garcia & Hubbard (Proc. R. Soc. Lond. A 418, 165, 1988). An
// ellipsoid with semi-axes of 0.2, 0.03 and 0.02 m has these radii at its bottom, 0.2²/0.02 and
// 0.03²/0.02.
/// Radius of the keel, m.
const KEEL: f64 = 2.0;
/// Radius across the keel, m.
const BEAM: f64 = 0.045;
/// Height of the centre of mass above the bottom, m.
const HEIGHT: f64 = 0.02;
/// Half of the keel's arc, rad.
const ARC: f64 = 0.1;
/// Mass, kg.
const MASS: f64 = 1.0;
/// Moments about the long, the broad and the upright axis, kg m²: those of the ellipsoid,
/// `m (b² + c²)/5` and so on.
const MOMENTS: DVec3 = DVec3::new(2.6e-4, 8.08e-3, 8.18e-3);
const GRAVITY: f64 = 9.8;
/// Stiffness under each ball, N/m.
///
/// The stone penetrates by some micrometres. A smaller depth would be below the unevenness due to
/// the gaps between the balls. A larger one would cause friction like that of a plank.
const STIFFNESS: f64 = 5e5;
/// Spin, rad/s.
const SPIN: f64 = 4.0;
/// Time between two shots of the film, s. A pitch takes 0.13 s.
const INTERVAL: f64 = 0.005;

fn main() -> ExitCode {
    common::main("custom_body", ABOUT, work)
}

// -----------------------------------------------------------------------------------------------
// The body
// -----------------------------------------------------------------------------------------------

/// A boat-shaped body: balls along an arc under its centre of mass, in the xz plane, and a mass
/// distribution that is rotated relative to it.
///
/// The balls are so close that they form a smooth keel. Body axes: x along the keel, z up.
#[derive(Debug)]
struct Celt {
    /// Angle from the keel to the long axis of the mass distribution, about z, rad.
    askew: f64,
    balls: Vec<ContactPoint>,
}

impl Celt {
    /// Number of balls on each side of the middle one.
    const HALF: usize = 200;

    fn new(askew: f64) -> Self {
        let balls = (0..=2 * Self::HALF).map(|number| {
            let (sin, cos) = Self::place(number).sin_cos();
            let position = DVec3::new(Self::ARM * sin, 0.0, Self::CENTRE - Self::ARM * cos);
            ContactPoint {
                position,
                radius: BEAM,
            }
        });
        Self {
            askew,
            balls: balls.collect(),
        }
    }

    /// Radius of the arc of the balls' centres, which is the height of its middle, m.
    const ARM: f64 = KEEL - BEAM;
    const CENTRE: f64 = KEEL - HEIGHT;

    /// Angle of a ball on the arc, rad. Its mirror image has exactly the opposite angle.
    fn place(number: usize) -> f64 {
        (number as f64 - Self::HALF as f64) * (ARC / Self::HALF as f64)
    }
}

impl RigidPointBody for Celt {
    fn mass(&self) -> f64 {
        MASS
    }

    fn inertia(&self) -> DMat3 {
        let axes = DMat3::from_rotation_z(self.askew);
        axes * DMat3::from_diagonal(MOMENTS) * axes.transpose()
    }

    fn contacts(&self) -> &[ContactPoint] {
        &self.balls
    }

    /// The balls lie on an arc, so the low ones are neighbours:
    /// `ARM |n| cos(φ - φ₀) > CENTRE n_z - BEAM - offset` with φ₀ the lowest point. If the stone
    /// lies on its back, both ends may be low, and the range contains all balls. One more ball on
    /// each side covers rounding. The method is optional, like `check`. Without it each step
    /// evaluates all balls.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "both numbers are clamped to those of the balls"
    )]
    fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
        let level =
            (Self::CENTRE * normal.z - BEAM - offset) / (Self::ARM * normal.x.hypot(normal.z));
        if level.is_nan() || level <= -1.0 || normal.z <= 0.0 {
            return ContactRange::all(self.balls.len());
        }
        let (lowest, half) = ((-normal.x).atan2(normal.z), level.min(1.0).acos());
        let number = |angle: f64| angle / (ARC / Self::HALF as f64) + Self::HALF as f64;
        let first = (number(lowest - half) - 1.0).max(0.0) as usize;
        let end = (number(lowest + half) + 3.0).clamp(0.0, self.balls.len() as f64) as usize;
        ContactRange {
            first,
            count: end.saturating_sub(first),
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::finite("angle of the stone's mass", self.askew, " rad")
    }
}

// -----------------------------------------------------------------------------------------------
// The runs
// -----------------------------------------------------------------------------------------------

fn work(options: &Options) -> Outcome<Page> {
    let duration = if options.quick { 2.0 } else { 8.0 };
    let askew = 8.0_f64.to_radians();
    check_body(&Celt::new(askew), CheckPlan::default())?;
    let mut cameras = [Camera::new(INTERVAL), Camera::new(INTERVAL)];
    let against = run(askew, start(-SPIN), duration, &mut cameras[0])?;
    let along = run(askew, start(SPIN), duration, &mut cameras[1])?;
    let mirror_image = mirrored(&start(-SPIN));
    let image = run(-askew, mirror_image, duration, &mut Camera::new(INTERVAL))?;
    let mut checks = checks_of_spin(&against, &along);
    checks.extend([check_of_image(&against, &image), check_of_pitch()?]);
    checks.push(check_of_energy(&[&against, &along]));
    Ok(Page {
        title: "Rattleback: a user's own body",
        text: vec![
            format!(
                "A stone whose mass is rotated by 8 degrees relative to its keel is spun at \
                     {SPIN} rad/s in both directions, with a small pitch and roll."
            ),
            "In one direction the energy of the spin goes into the pitching, and then into a spin \
             in the other direction. In the other direction the stone only comes to \
             rest."
                .to_owned(),
        ],
        checks,
        pictures: vec![
            spin_picture(&against, &along)?,
            pitch_picture(&against, &along)?,
        ],
        film: Some(film(cameras.map(|camera| camera.shots))),
    })
}

fn checks_of_spin(against: &[Moment], along: &[Moment]) -> Vec<Check> {
    vec![
        Check::between(
            "spun against its preferred direction, largest reversed spin, rad/s",
            "it reverses: Garcia & Hubbard, Proc. R. Soc. Lond. A 418, 165 (1988)",
            largest(against, 1.0),
            0.25 * SPIN,
            SPIN,
        ),
        Check::between(
            "spun in its preferred direction, largest reversed spin, rad/s",
            "it does not reverse, except by its last rocking",
            largest(along, -1.0),
            0.0,
            0.02 * SPIN,
        ),
    ]
}

fn check_of_image(against: &[Moment], image: &[Moment]) -> Check {
    let other =
        (against.iter().zip(image)).filter(|(one, image)| mirrored(&one.state) != image.state);
    Check::near(
        "moments in which the mirrored stone is not the mirror image, bit by bit",
        "the equations have no handedness",
        other.count() as f64,
        0.0,
        0.0,
    )
}

fn check_of_pitch() -> Outcome<Check> {
    let expected =
        TAU * ((MOMENTS.y + MASS * HEIGHT * HEIGHT) / (MASS * GRAVITY * (KEEL - HEIGHT))).sqrt();
    Ok(Check::near(
        "period of a small pitch of the straight stone, s",
        "2π √((I + m h²)/(m g (R - h)))",
        period_of_pitch()?,
        expected,
        0.01 * expected,
    ))
}

fn check_of_energy(runs: &[&[Moment]]) -> Check {
    let pairs = runs.iter().flat_map(|run| run.windows(2));
    Check::energy_gains(
        "in a step",
        pairs.map(|pair| pair[1].energy - pair[0].energy),
    )
}

/// State of the stone at one time.
#[derive(Clone, Copy, Debug)]
struct Moment {
    time: f64,
    state: State,
    /// Spin about the vertical, rad/s.
    spin: f64,
    /// Pitch of the keel, degrees.
    pitch: f64,
    energy: f64,
}

/// Returns an upright state, slightly pitched, that spins about the vertical.
fn start(spin: f64) -> State {
    State::at(DVec3::Z * HEIGHT)
        .with_rotation_vector(DVec3::new(0.01, 0.002, 0.0))
        .with_angular_momentum(DVec3::Z * (MOMENTS.z * spin))
}

/// Mirror image of a state in the xz plane. Angular momentum and the quaternion's vector are axial,
/// so their y components are unchanged.
fn mirrored(state: &State) -> State {
    let image = |v: DVec3| DVec3::new(v.x, -v.y, v.z);
    let axial = |v: DVec3| DVec3::new(-v.x, v.y, -v.z);
    let turn = axial(state.orientation.xyz());
    State {
        position: image(state.position),
        linear_velocity: image(state.linear_velocity),
        orientation: DQuat::from_xyzw(turn.x, turn.y, turn.z, state.orientation.w),
        angular_momentum: axial(state.angular_momentum),
    }
}

/// Runs the stone before a camera, and returns the moment after every step.
fn run(askew: f64, mut state: State, duration: f64, camera: &mut Camera) -> Outcome<Vec<Moment>> {
    let stepper = Stepper::builder(Celt::new(askew))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(STIFFNESS, 10.0))
        .friction(Coulomb {
            coefficient: 1.0,
            slip_speed: 1e-3,
        })
        .integrator(EnergyMomentum { time_step: 5e-4 })
        .build()?;
    let mut moments = Vec::new();
    let mut watch = |sample: &Sample<'_>| {
        let moment = Moment {
            time: sample.time,
            state: *sample.state,
            spin: sample.rates().angular_velocity.z,
            pitch: (sample.state.orientation * DVec3::X).z.asin().to_degrees(),
            energy: sample.energy().total(),
        };
        camera.look(sample, || [moment.spin, moment.pitch]);
        moments.push(moment);
        ControlFlow::Continue(())
    };
    stepper.run(&mut state, duration, &mut watch)?;
    Ok(moments)
}

/// Largest spin of this sign, rad/s.
fn largest(moments: &[Moment], sign: f64) -> f64 {
    moments
        .iter()
        .fold(0.0, |most, moment| f64::max(most, sign * moment.spin))
}

/// Time between two passages of the keel through level, s, for a stone without skew that starts
/// with a small pitch.
fn period_of_pitch() -> Outcome<f64> {
    let state = State::at(DVec3::Z * HEIGHT).with_rotation_vector(DVec3::Y * 0.005);
    let moments = run(0.0, state, 1.0, &mut Camera::new(INTERVAL))?;
    let passages: Vec<f64> = (moments.windows(2))
        .filter(|pair| pair[0].pitch < 0.0 && pair[1].pitch >= 0.0)
        .map(|pair| {
            pair[0].time
                + (pair[1].time - pair[0].time) * pair[0].pitch / (pair[0].pitch - pair[1].pitch)
        })
        .collect();
    let [first, .., last] = passages[..] else {
        return Err("the stone does not pitch".into());
    };
    Ok((last - first) / (passages.len() - 1) as f64)
}

// -----------------------------------------------------------------------------------------------
// The film and the pictures
// -----------------------------------------------------------------------------------------------

/// Semi-axes of the ellipsoid that is drawn, m.
const HALF: DVec3 = DVec3::new(0.2, 0.03, 0.02);

/// Both stones side by side: the one spun against its preferred direction in front.
fn film([against, along]: [Vec<Shot>; 2]) -> Film {
    let apart = DVec3::Y * (1.2 * HALF.x);
    let together = against.into_iter().zip(along).map(|(against, along)| Shot {
        time: against.time,
        poses: vec![against.poses[0].moved(-apart), along.poses[0].moved(apart)],
        // The first two values are spin and pitch.
        values: [0, 1, 0]
            .into_iter()
            .flat_map(|k| [against.values[k], along.values[k]])
            .collect(),
    });
    let stone = |colours| Mesh::ellipsoid(DVec3::ZERO, HALF, colours, [mesh::SAND; 2]);
    let column = |name, unit, digits, colour| Column::new(name, unit, digits, colour);
    Film {
        title: "Rattleback".to_owned(),
        lines: vec![
            "Orange: spun against its preferred direction. Blue: spun in it. The stone is drawn as \
             the ellipsoid whose radii its keel has."
                .to_owned(),
        ],
        size: HALF.x,
        distance: 4.4,
        slower: 2.0,
        bodies: vec![
            stone([mesh::ORANGE, mesh::IVORY]),
            stone([mesh::BLUE, mesh::IVORY]),
        ],
        readouts: vec![
            column("spin, orange", "rad/s", 2, "ink"),
            column("spin, blue", "rad/s", 2, "ink"),
            column("pitch, orange", "°", 2, "ink"),
            column("pitch, blue", "°", 2, "ink"),
        ],
        curves: vec![
            column("spin, orange", "rad/s", 3, "orange"),
            column("spin, blue", "rad/s", 3, "blue"),
        ],
        events: Vec::new(),
        shots: together.collect(),
    }
}

/// Picture of a quantity of both runs over time, every fourth step.
fn picture(
    name: &'static str,
    title: &str,
    unit: &str,
    runs: [&[Moment]; 2],
    of: fn(&Moment) -> f64,
) -> Outcome<Picture> {
    let curve = |moments: &[Moment]| {
        moments
            .iter()
            .step_by(4)
            .map(|moment| (moment.time, of(moment)))
            .collect()
    };
    let lines = vec![
        common::line(curve(runs[1]), BLUE, "spun in its preferred direction"),
        common::line(
            curve(runs[0]),
            ORANGE,
            "spun against its preferred direction",
        ),
    ];
    Picture::new(name, lines, |layout| {
        layout
            .with_title(title)
            .with_x_label("time (s)")
            .with_y_label(unit)
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}

fn spin_picture(against: &[Moment], along: &[Moment]) -> Outcome<Picture> {
    picture(
        "spin",
        "rattleback: spin about the vertical",
        "rad/s",
        [against, along],
        |moment| moment.spin,
    )
}

fn pitch_picture(against: &[Moment], along: &[Moment]) -> Outcome<Picture> {
    picture(
        "pitch",
        "rattleback: pitch of the keel",
        "degrees",
        [against, along],
        |moment| moment.pitch,
    )
}
