//! The hash of a run: FNV-1a over the bits of its numbers.

use tumble::real::{Quaternion, Vector};
use tumble::{Real, State};

/// A number's bits.
pub trait Bits: Real {
    /// Bits of the number.
    fn bits(self) -> u64;
}

impl Bits for f32 {
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
}

impl Bits for f64 {
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

/// FNV-1a.
#[derive(Clone, Copy, Debug)]
pub struct Hash(pub u64);

#[allow(
    clippy::new_without_default,
    reason = "an empty hash is no default result"
)]
impl Hash {
    /// Hash of nothing.
    #[must_use]
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes in a word.
    pub fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Takes in a number. Any NaN is one: IEEE 754 leaves its sign and payload open.
    pub fn number<R: Bits>(&mut self, number: R) {
        let is_nan = number.partial_cmp(&number).is_none();
        self.word(if is_nan { u64::MAX } else { number.bits() });
    }

    /// Takes in the components of a vector.
    pub fn vector<R: Bits>(&mut self, vector: R::Vec3) {
        for number in [vector.x(), vector.y(), vector.z()] {
            self.number(number);
        }
    }

    /// Takes in all numbers of a state.
    pub fn state<R: Bits>(&mut self, state: &State<R>) {
        self.vector::<R>(state.position);
        self.vector::<R>(state.linear_velocity);
        for number in state.orientation.xyzw() {
            self.number(number);
        }
        self.vector::<R>(state.angular_momentum);
    }
}
