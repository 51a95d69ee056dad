//! Output of numbers as text without `core::fmt`, which alone would be larger than the simulation,
//! and can panic.

use crate::board;
use tumble::State;
use tumble::real::{Quaternion, Real, Vector};

/// A number that can be printed.
pub trait Number: Real {
    /// Returns the number in millionths, rounded towards 0, up to 2147.
    fn millionths(self) -> i32;
    /// Returns all bits of the number.
    fn bits(self) -> u64;
}

impl Number for f32 {
    fn millionths(self) -> i32 {
        (self * 1e6) as i32
    }
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
}

impl Number for f64 {
    fn millionths(self) -> i32 {
        (self * 1e6) as i32
    }
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

/// Hash by FNV-1a.
pub(crate) struct Hash(u64);

impl Hash {
    pub(crate) fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub(crate) fn state<R: Number>(&mut self, state: &State<R>) {
        for vector in [
            state.position,
            state.linear_velocity,
            state.angular_momentum,
        ] {
            for number in [vector.x(), vector.y(), vector.z()] {
                self.word(number.bits());
            }
        }
        for number in state.orientation.xyzw() {
            self.word(number.bits());
        }
    }

    fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }

    pub(crate) fn print(&self) {
        let mut text = [b'0'; 16];
        for (place, digit) in text.iter_mut().rev().enumerate() {
            let value = (self.0 >> (4 * place)) as u8 & 0xf;
            *digit = if value < 10 {
                b'0' + value
            } else {
                b'a' - 10 + value
            };
        }
        print("hash ");
        board::write(&text);
        print("\n");
    }
}

pub(crate) fn print(text: &str) {
    board::write(text.as_bytes());
}

/// Prints a line of the table for a time in milliseconds.
pub(crate) fn line<R: Number>(time: u32, state: &State<R>, energy: R) {
    board::write(&decimal(time, 0, false));
    let at = state.position;
    for number in [at.x(), at.y(), at.z(), energy] {
        let millionths = number.millionths();
        board::write(&decimal(millionths.unsigned_abs(), 6, millionths < 0));
    }
    print("\n");
}

pub(crate) fn print_count(what: &str, count: u32) {
    print(what);
    board::write(&decimal(count, 0, false));
    print("\n");
}

/// Formats a number with `places` decimal places, right-aligned.
fn decimal(mut value: u32, places: usize, mut negative: bool) -> [u8; 12] {
    let mut text = [b' '; 12];
    for (place, slot) in text.iter_mut().rev().enumerate() {
        if places > 0 && place == places {
            *slot = b'.';
        } else if value > 0 || place <= places + usize::from(places > 0) {
            *slot = b'0' + (value % 10) as u8;
            value /= 10;
        } else if negative {
            *slot = b'-';
            negative = false;
        }
    }
    text
}
