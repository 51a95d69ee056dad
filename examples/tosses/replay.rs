//! Film and path of one toss, by its number.

use std::ops::ControlFlow;

use tumble::{Outcome as Ended, Sample, Timed, UntilDecided};

use crate::Arguments;
use crate::scene;
use common::{Camera, Column, Film, Mesh, Outcome, Shot, cannot, energy_columns, make_folder, say};

/// Time between two shots of the film and two rows of the path, s.
const INTERVAL: f64 = 0.002;

pub(crate) fn replay(arguments: &Arguments, toss: u64) -> Outcome<()> {
    let table = scene::table(scene::TOLERANCE)?;
    let throw = scene::throw(&table)?;
    let ensemble = scene::ensemble(&throw, arguments.seed);
    let outcome = throw.play(&mut ensemble.toss(toss))?;
    let mut state = throw.start(&mut ensemble.toss(toss))?;
    say(format_args!(
        "toss {toss}: {outcome:?}\nstart: {state:.9}\n"
    ));
    make_folder(&arguments.out)?;
    let path = arguments.out.join("path.csv");
    let mut rows = csv::Writer::from_path(&path).map_err(cannot("write", &path))?;
    rows.write_record(HEADER)?;
    let mut camera = Camera::new(INTERVAL);
    let mut written = Ok(());
    let watch = |sample: &Sample<'_>| {
        let height = 1e3 * sample.state.position.z;
        camera.look(sample, || [height, sample.touching() as f64]);
        written = rows.serialize(row(sample));
        match written {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    };
    let barriers = table.barriers().ok_or("no level ground")?;
    let mut both = (Timed::every(INTERVAL, watch)?, UntilDecided::new(barriers));
    let seconds = table.run(&mut state, throw.seconds(), &mut both)?;
    let decided = both.1.outcome();
    written.map_err(cannot("write", &path))?;
    rows.flush().map_err(cannot("write", &path))?;
    // The observers may not change the motion.
    if decided != outcome {
        return Err(format!("the replay is {decided:?}, the toss was {outcome:?}").into());
    }
    let page = arguments.out.join("play.html");
    let lines = vec![match outcome {
        Ended::Decided(face) => format!("{face:?}, proven after {seconds:.3} s."),
        Ended::Undecided => format!("Undecided after {seconds:.3} s."),
    }];
    film(toss, lines, seconds, camera.shots).write(&page)?;
    say(format_args!(
        "Written: {}, {}\n",
        page.display(),
        path.display()
    ));
    Ok(())
}

const HEADER: [&str; 9] = [
    "time (s)",
    "x (m)",
    "y (m)",
    "z (m)",
    "qx",
    "qy",
    "qz",
    "qw",
    "energy (J)",
];

/// Time, position, orientation and energy.
fn row(sample: &Sample<'_>) -> (f64, [f64; 3], [f64; 4], f64) {
    (
        sample.time,
        sample.state.position.to_array(),
        sample.state.orientation.to_array(),
        sample.energy().total(),
    )
}

fn film(toss: u64, lines: Vec<String>, seconds: f64, shots: Vec<Shot>) -> Film {
    Film {
        title: format!("Toss {toss}"),
        lines,
        size: scene::RADIUS,
        distance: 14.0,
        slower: 4.0,
        bodies: vec![Mesh::coin(scene::RADIUS, 48)],
        readouts: vec![
            Column::new("height of the centre", "mm", 1, "ink"),
            Column::new("points that touch", "", 0, "ink"),
        ],
        curves: energy_columns(),
        events: vec![("end", seconds)],
        shots,
    }
}
