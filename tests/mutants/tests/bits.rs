//! The stored bits.

use core::fmt;

#[path = "../../bits/src/battery.rs"]
mod battery;

/// Ends the battery at the first row that is another, so that a changed result is found early.
struct Compared(&'static str);

impl fmt::Write for Compared {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0 = self
            .0
            .strip_prefix(text)
            .unwrap_or_else(|| panic!("{text}"));
        Ok(())
    }
}

#[test]
fn the_bits_are_the_stored_ones() {
    let mut stored = Compared(include_str!("../../bits/hashes.txt"));
    battery::write(&mut stored, false).unwrap();
    assert_eq!(stored.0, "");
}
