//! Files, with errors that name them.

use core::fmt::Display;
use std::fs;
use std::path::Path;

use super::Outcome;

/// Returns the text of an error, with the file and what was not possible: "cannot write
/// out/coin.html: ...". The form is that of an argument of `map_err`.
pub fn cannot<E: Display>(what: &str, file: &Path) -> impl Fn(E) -> String {
    move |error| format!("cannot {what} {}: {error}", file.display())
}

/// Writes a file.
///
/// # Errors
/// Names the file.
pub fn write_file(file: &Path, content: impl AsRef<[u8]>) -> Outcome<()> {
    Ok(fs::write(file, content).map_err(cannot("write", file))?)
}

/// Reads the text of a file.
///
/// # Errors
/// Names the file.
pub fn read_text(file: &Path) -> Outcome<String> {
    Ok(fs::read_to_string(file).map_err(cannot("read", file))?)
}
