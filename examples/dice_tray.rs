//! Dice that are thrown against the walls of a tray: a ground of several surfaces.
//!
//! Run `cargo run --release --example dice_tray -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    Camera, Check, Column, Film, Mesh, Options, Outcome, Page, Picture, Pose, Random, Shot, mesh,
};
use indicatif::{ProgressBar, ProgressStyle};
use kuva::prelude::*;
use rayon::prelude::*;
use tumble::glam::{DQuat, DVec3};
use tumble::{
    Block, Coulomb, Cuboid, Dynamics, EnergyMomentum, FlatGround, Ground, Sample, SpringDamper,
    State, Stepper, UniformGravity, UntilRest,
};

const ABOUT: &str = "\
Throws five dice in turn against the walls of a tray. The floor is felt and the walls are wood: each
surface has its own springs, dampers and friction. Then throws many dice, and counts their faces and
where they lie.";

/// Mass of a die of acrylic, kg. The next constant is its edge, m.
const MASS: f64 = 0.0048;
const EDGE: f64 = 0.016;
const CORNER: f64 = 0.0015;
const GRAVITY: f64 = 9.81;
/// Half of the inner length and width of the tray, height and half of the thickness of its walls, m.
const LENGTH: f64 = 0.11;
const WIDTH: f64 = 0.08;
const HEIGHT: f64 = 0.08;
const WALL: f64 = 0.01;
/// Coefficients of friction of acrylic on felt and on wood.
const FELT: f64 = 0.45;
const WOOD: f64 = 0.25;
/// Chi-square with 5 degrees of freedom that one fair die in a thousand exceeds.
const CRITICAL: f64 = 20.515;
/// Longest time of a throw, s. A die that moves for longer is an error.
const PATIENCE: f64 = 20.0;
/// Interval between two shots of the film, s, and number of shots between two throws.
const INTERVAL: f64 = 0.004;
const TURN: usize = 200;
/// Height of the walls in the film, m. Higher walls would hide the dice.
const DRAWN: f64 = 0.006;
/// Colours of the dice, and of their curves.
const COLOURS: [(mesh::Colour, &str); 5] = [
    (mesh::IVORY, "ink"),
    (mesh::ORANGE, "orange"),
    (mesh::GREEN, "green"),
    (mesh::BLUE, "blue"),
    (mesh::RED, "purple"),
];
/// Names of their curves.
const NAMES: [&str; 5] = ["1st die", "2nd die", "3rd die", "4th die", "5th die"];

/// Marks of the film.
const LIES: [&str; 5] = ["1st lies", "2nd lies", "3rd lies", "4th lies", "5th lies"];

/// Floor, and four walls with an upper edge.
type Tray = (FlatGround, [Ground<SpringDamper, Block>; 4]);
/// Friction of the floor, and of each wall.
type Felted = (Coulomb, [Coulomb; 4]);
type Die = Stepper<Cuboid, Tray, Felted, UniformGravity>;

fn main() -> ExitCode {
    common::main("dice_tray", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let throws = if options.quick { 300 } else { 3000 };
    let die = stepper()?;
    let thrown = throw_many(&die, throws)?;
    let five = five(&die)?;
    let faces: Vec<String> = five.iter().map(|end| end.face.to_string()).collect();
    Ok(Page {
        title: "Dice in a tray",
        text: vec![
            format!(
                "Five dice are thrown in turn against the end of a tray of {:.0} cm by {:.0} cm. \
                 They show {}. Dice do not meet: a throw that would end on an earlier die is \
                 thrown again.",
                200.0 * LENGTH,
                200.0 * WIDTH,
                faces.join(", ")
            ),
            format!(
                "Each of {throws} further throws hit a wall {:.1} times on average.",
                thrown.iter().map(|end| f64::from(end.hits)).sum::<f64>() / f64::from(throws)
            ),
        ],
        checks: checks(&thrown, &five),
        pictures: vec![picture_of_paths(&five)?, picture_of_places(&thrown)?],
        film: Some(film(&five)),
    })
}

/// Wall whose inner side is at this place along an axis (0 or 1).
fn wall(axis: usize, side: f64) -> Block {
    let inner = [LENGTH, WIDTH];
    let mut centre = DVec3::Z * (0.5 * HEIGHT);
    let mut half = DVec3::new(LENGTH + 2.0 * WALL, WIDTH + 2.0 * WALL, 0.5 * HEIGHT);
    centre[axis] = side * (inner[axis] + WALL);
    half[axis] = WALL;
    Block { centre, half }
}

fn walls() -> [Block; 4] {
    [wall(0, 1.0), wall(0, -1.0), wall(1, 1.0), wall(1, -1.0)]
}

fn stepper() -> Outcome<Die> {
    // A corner that supports the whole weight penetrates the felt by 24 µm.
    let floor = FlatGround::level(2000.0, 1.2);
    let wood = SpringDamper {
        stiffness: 8000.0,
        damping: 1.0,
    };
    let felt = Coulomb {
        coefficient: FELT,
        slip_speed: 1e-4,
    };
    let smooth = Coulomb {
        coefficient: WOOD,
        slip_speed: 1e-4,
    };
    let walls = walls().map(|shape| Ground { law: wood, shape });
    Ok(
        Stepper::builder(Cuboid::solid(MASS, DVec3::splat(EDGE)).rounded(CORNER))
            .gravity(UniformGravity::down(GRAVITY))
            .ground((floor, walls))
            .friction((felt, [smooth; 4]))
            .integrator(EnergyMomentum { time_step: 2e-4 })
            .build()?,
    )
}

/// A die as it leaves the hand over one end of the tray, towards the other.
fn thrown(die: &Die, random: &mut Random) -> State {
    let place = DVec3::new(-0.7 * LENGTH, random.between(-0.3, 0.3) * WIDTH, 0.035);
    let velocity = DVec3::new(
        random.between(1.2, 2.0),
        random.between(-0.6, 0.6),
        random.between(-0.3, 0.3),
    );
    let mut rate = || random.between(-40.0, 40.0);
    let spin = DVec3::new(rate(), rate(), rate());
    let state = State::at(place)
        .with_orientation(DQuat::from_array(random.turn()))
        .with_linear_velocity(velocity);
    die.with_angular_velocity(state, spin)
}

/// How a throw went.
struct Throw {
    face: u8,
    state: State,
    /// Time at which the die lies, s.
    time: f64,
    /// Number of times that it began to touch a wall.
    hits: u32,
    /// Largest increase of the energy in a step, J; never above 0.
    gain: f64,
    shots: Vec<Shot>,
}

impl Throw {
    fn is_inside(&self) -> bool {
        let place = self.state.position;
        place.x.abs() < LENGTH && place.y.abs() < WIDTH && place.z < EDGE
    }

    fn is_apart_from(&self, other: &Self) -> bool {
        let between = self.state.position - other.state.position;
        between.length() > 1.5 * EDGE
    }
}

/// Throws a die until it lies.
fn throw(die: &Die, start: State) -> Outcome<Throw> {
    // At rest, it moves by at most a hundredth of a millimetre in 50 ms.
    let rest = UntilRest::new(die.body(), 1e-5, 0.05)?;
    let mut camera = Camera::new(INTERVAL);
    let (mut hits, mut touches, mut gain) = (0, false, f64::NEG_INFINITY);
    let mut energy = die.energy(&start).total();
    let watch = |sample: &Sample<'_>| {
        let now = sample.energy().total();
        if sample.time > 0.0 {
            gain = gain.max(now - energy);
        }
        energy = now;
        let before = touches;
        touches = touches_wall(die, sample.state);
        hits += u32::from(touches && !before);
        let height = 1e3 * sample.state.position.z;
        camera.look(sample, || [height]);
        ControlFlow::Continue(())
    };
    let mut state = start;
    let mut both = (rest, watch);
    let time = die.run(&mut state, PATIENCE, &mut both)?;
    let (rest, _) = both;
    if !rest.is_reached() {
        return Err(format!("a die is not at rest after {PATIENCE} s").into());
    }
    let side = die
        .body()
        .face_up(&state)
        .ok_or("the die stands on an edge")?;
    Ok(Throw {
        face: side.pips(),
        state,
        time,
        hits,
        gain,
        shots: camera.shots,
    })
}

/// Returns true if a corner presses on a wall: on any surface but the first.
fn touches_wall(die: &Die, state: &State) -> bool {
    let mut touches = false;
    let scene = die.scene();
    scene.visit_contacts(&scene.motion(state), |contact| {
        touches |= contact.surface > 0;
    });
    touches
}

/// Many throws, without their shots.
fn throw_many(die: &Die, throws: u32) -> Outcome<Vec<Throw>> {
    let mut random = Random(7);
    let style = ProgressStyle::with_template("{pos} of {len} throws {wide_bar} {eta} left")?;
    let bar = ProgressBar::new(u64::from(throws)).with_style(style);
    let starts: Vec<State> = (0..throws).map(|_| thrown(die, &mut random)).collect();
    let ends: Result<_, String> = (starts.into_par_iter())
        .map(|start| {
            let end = throw(die, start).map_err(|error| error.to_string())?;
            bar.inc(1);
            Ok(Throw {
                shots: Vec::new(),
                ..end
            })
        })
        .collect();
    Ok(ends?)
}

/// The five throws of the film.
fn five(die: &Die) -> Outcome<Vec<Throw>> {
    let mut random = Random(1);
    let mut five: Vec<Throw> = Vec::new();
    while five.len() < COLOURS.len() {
        let end = throw(die, thrown(die, &mut random))?;
        if end.is_inside() && five.iter().all(|other| end.is_apart_from(other)) {
            five.push(end);
        }
    }
    Ok(five)
}

/// Pearson's statistic of the faces, if all are equally probable.
fn chi_square(thrown: &[Throw]) -> f64 {
    let expected = thrown.len() as f64 / 6.0;
    let mut faces = [0.0; 6];
    for end in thrown {
        faces[usize::from(end.face) - 1] += 1.0;
    }
    let terms = faces.map(|found: f64| (found - expected).powi(2) / expected);
    terms.iter().sum()
}

fn checks(thrown: &[Throw], five: &[Throw]) -> Vec<Check> {
    let count = thrown.len() as f64;
    let all = || thrown.iter().chain(five);
    let inside = thrown.iter().filter(|end| end.is_inside()).count() as f64;
    let across: Vec<f64> = thrown.iter().map(|end| end.state.position.y).collect();
    let mean = across.iter().sum::<f64>() / count;
    let spread = (across.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / count).sqrt();
    vec![
        Check::energy_gains("in a step", all().map(|end| end.gain)),
        Check::between(
            "chi-square of the faces",
            "chi-square with 5 degrees of freedom, 0.999 quantile",
            chi_square(thrown),
            0.0,
            CRITICAL,
        ),
        Check::between(
            "mean position across the tray, in standard errors",
            "throws and tray are their own mirror images; 0.999 quantile",
            mean / spread * count.sqrt(),
            -3.3,
            3.3,
        ),
        Check::between(
            "fraction of the throws that stay in the tray",
            "the dice start below the upper edge of the walls",
            inside / count,
            0.99,
            1.0,
        ),
        Check::near(
            "height of the centre of a die that lies, mm",
            "half of the edge, less m g/(4 k) in the felt",
            1e3 * five[0].state.position.z,
            1e3 * (0.5 * EDGE - MASS * GRAVITY / (4.0 * 2000.0)),
            1e-3,
        ),
    ]
}

/// Outline of the tray from above, cm.
fn outline() -> Plot {
    let (x, y) = (100.0 * LENGTH, 100.0 * WIDTH);
    let corners = vec![(-x, -y), (x, -y), (x, y), (-x, y), (-x, -y)];
    common::line(corners, common::GREY, "walls")
}

fn picture_of_paths(five: &[Throw]) -> Outcome<Picture> {
    let mut plots = vec![outline()];
    let colours = [
        "#8a7f5c",
        common::ORANGE,
        "#28966e",
        common::BLUE,
        "#7a5cad",
    ];
    for (number, (end, colour)) in (1..).zip(five.iter().zip(colours)) {
        let path = end.shots.iter().map(|shot| {
            let place = 100.0 * shot.poses[0].place;
            (place.x, place.y)
        });
        plots.push(common::line(
            path.collect(),
            colour,
            &format!("die {number}"),
        ));
    }
    Picture::new("paths", plots, |layout| {
        layout
            .with_title("paths of five dice from above")
            .with_x_label("along the tray (cm)")
            .with_y_label("across the tray (cm)")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

fn picture_of_places(thrown: &[Throw]) -> Outcome<Picture> {
    let places = thrown.iter().map(|end| {
        let place = 100.0 * end.state.position;
        (place.x, place.y)
    });
    let dots = ScatterPlot::new()
        .with_data(places.collect::<Vec<_>>())
        .with_color(common::BLUE)
        .with_size(2.0)
        .with_legend("a die that lies");
    let plots = vec![outline(), Plot::Scatter(dots)];
    Picture::new("places", plots, |layout| {
        layout
            .with_title("where the dice lie, from above")
            .with_x_label("along the tray (cm)")
            .with_y_label("across the tray (cm)")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

/// Pose of a die and the height of its centre (mm), `own` shots after its throw. Before that it lies
/// beside the tray.
fn shown(five: &[Throw], die: usize, own: Option<usize>) -> (Pose, f64) {
    let shots = &five[die].shots;
    match own {
        Some(own) => {
            let shot = &shots[own.min(shots.len() - 1)];
            (shot.poses[0], shot.values[0])
        }
        None => {
            let place = DVec3::new(
                -LENGTH - 3.0 * EDGE,
                1.6 * EDGE * (die as f64 - 2.0),
                0.5 * EDGE,
            );
            let pose = Pose {
                place,
                orientation: DQuat::IDENTITY,
                lowest: place,
            };
            (pose, 1e3 * place.z)
        }
    }
}

/// Film of the five throws, each a while after the one before.
fn film(five: &[Throw]) -> Film {
    let walls = walls();
    let longest = five.iter().map(|end| end.shots.len()).max().unwrap_or(0);
    let low = |wall: &Block, lowest: DVec3| Pose {
        place: wall.centre.with_z(0.5 * DRAWN),
        orientation: DQuat::IDENTITY,
        lowest,
    };
    let shots = (0..longest + TURN * five.len()).map(|number| {
        let dice = (0..five.len()).map(|die| shown(five, die, number.checked_sub(TURN * die)));
        let (mut poses, heights): (Vec<Pose>, Vec<_>) = dice.unzip();
        // The mark of a wall's lowest point is hidden behind that of the first die.
        let lowest = poses[0].lowest;
        poses.extend(walls.iter().map(|wall| low(wall, lowest)));
        Shot {
            time: INTERVAL * number as f64,
            poses,
            values: heights,
        }
    });
    let dice = COLOURS.map(|(colour, _)| Mesh::die(DVec3::ZERO, EDGE, colour, mesh::INK));
    let drawn = walls.map(|wall| Mesh::block((2.0 * wall.half).with_z(DRAWN), mesh::SAND));
    Film {
        title: "Five dice in a tray".to_owned(),
        lines: vec![format!(
            "The walls are {:.0} mm high and drawn {:.0} mm high.",
            1e3 * HEIGHT,
            1e3 * DRAWN
        )],
        size: 0.5 * EDGE,
        distance: 44.0,
        slower: 2.0,
        bodies: dice.into_iter().chain(drawn).collect(),
        readouts: Vec::new(),
        curves: (NAMES.into_iter().zip(COLOURS))
            .map(|(name, (_, ink))| Column::new(name, "mm", 1, ink))
            .collect(),
        events: (LIES.into_iter().zip(five))
            .zip((0..).step_by(TURN))
            .map(|((name, end), shot)| (name, end.time + INTERVAL * f64::from(shot)))
            .collect(),
        shots: shots.collect(),
    }
}
