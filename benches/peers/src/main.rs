//! Error, energy and cost of tumble and of other programs on the same scenes.

mod aims;
mod answers;
mod kept;
mod law;
mod measure;
mod programs;
mod scene;
mod table;
mod trials;

use std::process::ExitCode;

const HELP: &str = "\
The same scenes by tumble, rapier3d, rapier3d-f64, a plain Rk4, ode_solvers and diffsol: error
relative to a known result, largest increase of the energy, ns a step, CPU time for a simulated
second, and ratios.

    cargo run --release -- [OPTIONS]

  --write        write all tables to RESULTS.md, and the summary to src/guide/peers.md
  --markdown     tables in markdown
  --summary      only the table with one row for each scene
  --trials       only the eight trials in one call, by adaptive methods
  --aims         only the figures that the project aims at, with reached or not reached
  --turns N      number of measurements of each program (5)
  --scene TEXT   only scenes whose name contains TEXT
  -h, --help     this text";

struct Options {
    write: bool,
    markdown: bool,
    summary: bool,
    trials: bool,
    aims: bool,
    turns: usize,
    scene: String,
}

fn options() -> Result<Option<Options>, lexopt::Error> {
    use lexopt::prelude::*;
    let mut options = Options {
        write: false,
        markdown: false,
        summary: false,
        trials: false,
        aims: false,
        turns: 5,
        scene: String::new(),
    };
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("write") => options.write = true,
            Long("markdown") => options.markdown = true,
            Long("summary") => options.summary = true,
            Long("trials") => options.trials = true,
            Long("aims") => options.aims = true,
            Long("turns") => options.turns = parser.value()?.parse()?,
            Long("scene") => options.scene = parser.value()?.string()?,
            Short('h') | Long("help") => return Ok(None),
            _ => return Err(argument.unexpected()),
        }
    }
    if options.write && (options.summary || !options.scene.is_empty()) {
        // What is stored has all tables of all scenes.
        return Err("--summary and --scene must be left out with --write".into());
    }
    Ok(Some(options))
}

fn main() -> ExitCode {
    let result = match options() {
        Ok(Some(options)) => run(&options),
        Ok(None) => {
            println!("{HELP}");
            Ok(())
        }
        Err(error) => Err(error.to_string()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("peers: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    let markdown = options.markdown || options.write;
    if options.trials {
        return in_one_call(options, markdown);
    }
    if options.aims {
        return of_aims(options, markdown);
    }
    let mut measured = Vec::new();
    let mut tables = String::new();
    for scene in answers::all()? {
        if scene.name.contains(&options.scene) {
            eprintln!("{} ...", scene.name);
            let rows = measure::rows(&scene, options.turns)?;
            if !options.summary {
                tables += &table::of_scene(&scene, &rows, markdown);
            }
            measured.push((scene, rows));
        }
    }
    if measured.is_empty() {
        return Err(format!("no scene has '{}' in its name", options.scene));
    }
    let within: String = (measured.iter())
        .filter(|(scene, _)| scene.name == "trial 1")
        .map(|(scene, rows)| table::within(1e-4, scene, rows, markdown))
        .collect();
    let summary = table::summary(&measured, markdown);
    let better = table::where_a_peer_is_better(&measured, markdown);
    if options.write {
        let heading = |title: &str, text: &str| format!("## {title}\n\n{text}");
        kept::write(
            &(tables + &within + &better + &heading("Summary", &summary)),
            &summary,
            &(better.clone() + &within),
        )
    } else {
        println!(
            "{}\n\n{tables}{within}{better}Summary\n\n{summary}",
            kept::versions()
        );
        Ok(())
    }
}

/// Measures the figures that the project aims at.
fn of_aims(options: &Options, markdown: bool) -> Result<(), String> {
    let table = table::of_aims(&aims::measure(options.turns)?, markdown);
    if options.write {
        kept::write_aims(&table)
    } else {
        println!("{}\n\n{table}", kept::versions());
        Ok(())
    }
}

/// Measures the eight trials in one call.
fn in_one_call(options: &Options, markdown: bool) -> Result<(), String> {
    let lines = trials::measure(options.turns)?;
    let (all, means) = table::of_trials(&lines, markdown);
    if options.write {
        kept::write_trials(&all, &means)
    } else {
        println!("{}\n\n{all}{means}", kept::versions());
        Ok(())
    }
}
