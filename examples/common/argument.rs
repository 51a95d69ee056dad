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
