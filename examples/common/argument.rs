//! Bounds of the numbers on a command line.

use core::fmt::Debug;
use core::ops::RangeInclusive;

/// Returns a number of the command line that is within its bounds.
///
/// An upper bound keeps a slip of the keys, such as `--seconds 1e19`, from a run without an end.
///
/// # Errors
/// Names the argument, its bounds and the number.
pub fn within<T: PartialOrd + Copy + Debug>(
    name: &str,
    value: T,
    bounds: RangeInclusive<T>,
    unit: &str,
) -> Result<T, String> {
    if bounds.contains(&value) {
        return Ok(value);
    }
    let (least, most) = (bounds.start(), bounds.end());
    Err(format!(
        "{name} must be from {least:?} to {most:?}{unit}, got {value:?}"
    ))
}

/// Refuses two options that are given together.
///
/// # Errors
/// Names both.
pub fn not_both([first, second]: [(&str, bool); 2]) -> Result<(), String> {
    match (first, second) {
        ((first, true), (second, true)) => Err(format!("{first} must be left out with {second}")),
        _ => Ok(()),
    }
}
