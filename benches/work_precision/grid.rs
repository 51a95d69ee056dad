//! The whole grid: each scene in both precisions, with few and many points, both friction laws, and
//! three slip speeds.

use core::error::Error;
use core::time::Duration;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};
use tumble::work_precision::{Method, Row, Setting, WorkPrecision};

use crate::scenes::{Friction, Measured, Start};

const SCENES: [&str; 6] = ["trial1", "trial8", "toss", "smooth", "stiff", "rest"];
const POINTS: [usize; 3] = [12, 120, 1200];
/// Slip speeds, m/s.
const SLIP_SPEEDS: [f64; 3] = [1e-2, 1e-3, 1e-6];
/// Errors, m.
const ERRORS: [f64; 4] = [1e-2, 1e-4, 1e-6, 1e-8];
/// Longest run. A method whose run has taken longer is not tried with a shorter step or a tighter
/// tolerance.
const LONGEST_RUN: Duration = Duration::from_millis(300);

/// One point of the grid, in both precisions.
struct Combination {
    scene: &'static str,
    start: Start,
}

/// Measures the combinations whose names contain `wanted`.
///
/// Writes every row into `rows.csv` and the cheapest settings into `cheapest.csv`, as they are
/// measured. Prints the cheapest settings, with one table for each scene.
pub(crate) fn run(wanted: &str, folder: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    let mut rows = csv_file(&folder.join("rows.csv"), ROWS)?;
    let mut cheapest = csv_file(&folder.join("cheapest.csv"), CHEAPEST)?;
    let combinations: Vec<_> = combinations()
        .filter(|combination| combination.name().contains(wanted))
        .collect();
    let bar = ProgressBar::new(combinations.len() as u64).with_style(ProgressStyle::with_template(
        "{bar:30} {pos}/{len} {elapsed} of about {duration}  {msg}",
    )?);
    let mut last = "";
    for combination in &combinations {
        bar.set_message(combination.name());
        if combination.scene != last {
            last = combination.scene;
            bar.suspend(|| print_head(combination));
        }
        match combination.start.measured() {
            Ok(measured) => {
                for single in [false, true] {
                    let curve = try_all(&measured, single);
                    let place = combination.place(single);
                    bar.suspend(|| print_line(&place, &curve));
                    write_rows(&mut rows, &place, &curve)?;
                    write_cheapest(&mut cheapest, &place, &curve)?;
                }
            }
            Err(error) => {
                bar.suspend(|| println!("| {} | no reference: {error} |", combination.name()))
            }
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    println!("\nall rows: {}", folder.join("rows.csv").display());
    Ok(())
}

fn combinations() -> impl Iterator<Item = Combination> {
    SCENES.into_iter().flat_map(|scene| {
        let start = Start::named(scene).unwrap();
        let frictions = frictions(start.friction);
        POINTS.into_iter().flat_map(move |points| {
            let start = start.clone();
            frictions
                .clone()
                .into_iter()
                .map(move |friction| Combination {
                    scene,
                    start: Start {
                        points,
                        friction,
                        ..start.clone()
                    },
                })
        })
    })
}

/// Both laws at each slip speed. A scene without friction stays without.
fn frictions(of_scene: Friction) -> Vec<Friction> {
    let Friction::Coulomb { coefficient, .. } = of_scene else {
        return vec![of_scene];
    };
    let laws = |slip_speed| {
        [
            Friction::Coulomb {
                coefficient,
                slip_speed,
            },
            Friction::Smooth {
                coefficient,
                slip_speed,
            },
        ]
    };
    SLIP_SPEEDS.into_iter().flat_map(laws).collect()
}

impl Combination {
    /// Name of a combination, such as `trial1 120 points Coulomb 1e-3`.
    fn name(&self) -> String {
        let (law, slip_speed) = self.law();
        let points = self.start.points;
        format!("{} {points} points {law} {slip_speed}", self.scene)
    }

    /// Name and slip speed (m/s) of the law.
    fn law(&self) -> (&'static str, String) {
        match self.start.friction {
            Friction::Coulomb { slip_speed, .. } => ("Coulomb", format!("{slip_speed:e}")),
            Friction::Smooth { slip_speed, .. } => ("SmoothCoulomb", format!("{slip_speed:e}")),
            Friction::None => ("none", String::new()),
        }
    }

    /// Columns that identify a combination.
    fn place(&self, single: bool) -> [String; 5] {
        let (law, slip_speed) = self.law();
        let precision = if single { "f32" } else { "f64" };
        let points = self.start.points.to_string();
        [
            self.scene.into(),
            points,
            law.into(),
            slip_speed,
            precision.into(),
        ]
    }
}

/// Measures every setting of the sequence, except those that follow a long run.
fn try_all(measured: &Measured, single: bool) -> WorkPrecision {
    let settings = Setting::built_in();
    let mut whole = measured(&[], single);
    for method in Method::ALL {
        for setting in settings.iter().filter(|setting| setting.method == method) {
            let rows = measured(&[*setting], single).rows;
            let long = rows.iter().any(is_long);
            whole.rows.extend(rows);
            if long {
                break;
            }
        }
    }
    whole
}

fn is_long(row: &Row) -> bool {
    row.time > LONGEST_RUN && row.time != Duration::MAX
}

/// Returns the cheapest setting for an error, if the reference resolves it.
fn cheapest(curve: &WorkPrecision, error: f64) -> Option<&Row> {
    (curve.resolution <= error)
        .then(|| curve.cheapest(error))
        .flatten()
}

fn print_head(combination: &Combination) {
    println!(
        "\n## {}: {} s\n",
        combination.scene, combination.start.seconds
    );
    print!("| points | friction | slip speed, m/s | |");
    for error in ERRORS {
        print!(" {error:e} m |");
    }
    println!(
        " reference good to |\n|---|---|---|---|{}---|",
        "---|".repeat(ERRORS.len())
    );
}

fn print_line(place: &[String], curve: &WorkPrecision) {
    print!("| {} |", place[1..].join(" | "));
    for error in ERRORS {
        match cheapest(curve, error) {
            Some(row) => print!(" {}, {:.0} µs |", row.setting, micros(row)),
            None => print!(" - |"),
        }
    }
    println!(" {:.0e} m |", curve.resolution);
}

fn micros(row: &Row) -> f64 {
    row.time.as_secs_f64() * 1e6
}

const ROWS: &str = "method,parameter,error_m,time_us,evaluations,steps,rejected,energy_rise_J,reference_good_to_m,failure";
const CHEAPEST: &str = "error_asked_m,method,parameter,error_m,time_us,reference_good_to_m";

/// Creates a file with the columns of a combination and further columns.
fn csv_file(path: &Path, columns: &str) -> Result<File, Box<dyn Error>> {
    let mut file = File::create(path)?;
    writeln!(
        file,
        "scene,points,friction,slip_speed_m_per_s,precision,{columns}"
    )?;
    Ok(file)
}

fn write_rows(file: &mut File, place: &[String], curve: &WorkPrecision) -> std::io::Result<()> {
    let place = place.join(",");
    for row in &curve.rows {
        let Setting {
            method, parameter, ..
        } = row.setting;
        let failure = row.failure.map(|failure| failure.to_string());
        writeln!(
            file,
            "{place},{},{parameter:e},{:e},{:.3},{},{},{},{:e},{:e},\"{}\"",
            method.name(),
            row.error,
            micros(row),
            row.evaluations,
            row.steps,
            row.rejected,
            row.energy_rise,
            curve.resolution,
            failure.unwrap_or_default()
        )?;
    }
    Ok(())
}

fn write_cheapest(file: &mut File, place: &[String], curve: &WorkPrecision) -> std::io::Result<()> {
    let place = place.join(",");
    for error in ERRORS {
        let Some(row) = cheapest(curve, error) else {
            writeln!(file, "{place},{error:e},,,,,{:e}", curve.resolution)?;
            continue;
        };
        let Setting {
            method, parameter, ..
        } = row.setting;
        writeln!(
            file,
            "{place},{error:e},{},{parameter:e},{:e},{:.3},{:e}",
            method.name(),
            row.error,
            micros(row),
            curve.resolution
        )?;
    }
    Ok(())
}
