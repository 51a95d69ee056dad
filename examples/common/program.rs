//! Frame of a program: help, errors, exit codes and the folder of its files.

use core::fmt::Display;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::process::{self, ExitCode};

use super::{Outcome, cannot};

/// Runs `work` with the options, or prints the help text if there are none.
///
/// The exit code is 0 if all checked figures are as expected, 1 if not or if the work fails, and 2
/// if the command line is invalid.
pub fn program<T, E: Display>(
    options: Result<Option<T>, E>,
    help: &str,
    work: impl FnOnce(&T) -> Outcome<bool>,
) -> ExitCode {
    let options = match options {
        Ok(Some(options)) => options,
        Ok(None) => {
            say(help);
            return ExitCode::SUCCESS;
        }
        Err(error) => {
            complain(format_args!("{error}\nThe options are listed by --help."));
            return ExitCode::from(2);
        }
    };
    match work(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            complain(error);
            ExitCode::FAILURE
        }
    }
}

/// Prints an error. If that is not possible, the exit code alone states it.
fn complain(error: impl Display) {
    let _ = writeln!(io::stderr(), "error: {error}");
}

/// Prints a text. If nobody reads it, as in a pipe that was closed, the program goes on. If it
/// cannot be written for another reason, such as a full disk, the program ends with exit code 1.
pub fn say(text: impl Display) {
    let mut output = io::stdout();
    // Without the flush, the error of a last line without an end would be lost.
    let written = write!(output, "{text}").and_then(|()| output.flush());
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        complain(format_args!("cannot write the output: {error}"));
        process::exit(1);
    }
}

/// Makes a folder, with those above it. A program calls this before its work, so that no work is
/// lost.
pub fn make_folder(folder: &Path) -> Outcome<()> {
    Ok(fs::create_dir_all(folder).map_err(cannot("make the folder", folder))?)
}
