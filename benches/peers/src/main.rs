//! The same work by tumble and by what its users would take instead: error, energy, price.

mod answers;
mod law;
mod measure;
mod programs;
mod scene;
mod table;

use std::process::ExitCode;

const HELP: &str = "\
The same scenes by tumble, rapier3d, rapier3d-f64, a plain Rk4 and ode_solvers: error against a known answer,
worst rise of the energy, ns a step, CPU time for a simulated second, and ratios.

    cargo run --release -- [OPTIONS]

  --markdown     tables in markdown
  --summary      only the table with a row a scene
  --turns N      how often each program is timed, in turns (5)
  --scene TEXT   only scenes whose name holds TEXT
  -h, --help     this";

struct Options {
    markdown: bool,
    summary: bool,
    turns: usize,
    scene: String,
}

fn options() -> Result<Option<Options>, lexopt::Error> {
    use lexopt::prelude::*;
    let mut options = Options {
        markdown: false,
        summary: false,
        turns: 5,
        scene: String::new(),
    };
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("markdown") => options.markdown = true,
            Long("summary") => options.summary = true,
            Long("turns") => options.turns = parser.value()?.parse()?,
            Long("scene") => options.scene = parser.value()?.string()?,
            Short('h') | Long("help") => return Ok(None),
            _ => return Err(argument.unexpected()),
        }
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
    println!(
        "rapier3d {}, rapier3d-f64 {}\n",
        rapier3d::VERSION,
        rapier3d_f64::VERSION
    );
    let mut measured = Vec::new();
    for scene in answers::all()? {
        if scene.name.contains(&options.scene) {
            let rows = measure::rows(&scene, options.turns)?;
            if !options.summary {
                table::print_scene(&scene, &rows, options.markdown);
            }
            measured.push((scene, rows));
        }
    }
    table::print_summary(&measured, options.markdown);
    Ok(())
}
