//! Frame of a program: help, errors, exit codes and the folder of its files.

use core::fmt::Display;
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

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
            eprintln!("error: {error}\nThe options are listed by --help.");
            return ExitCode::from(2);
        }
    };
    match work(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Prints a text. If nobody reads it, as in a pipe that was closed, the program goes on.
pub fn say(text: impl Display) {
    let _ = write!(io::stdout(), "{text}");
}

/// Makes a folder, with those above it. A program calls this before its work, so that no work is
/// lost.
pub fn make_folder(folder: &Path) -> Outcome<()> {
    Ok(fs::create_dir_all(folder).map_err(cannot("make the folder", folder))?)
}
