//! Numbers and text that the page reads and writes in the memory of the module.
//!
//! The page and the module share blocks of 64-bit words at fixed addresses. A word is the bits of
//! an `f64`. Words are atomic because a static that changes must be, and the module has one thread.

use core::fmt;
use core::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};

use tumble::State;
use tumble::glam::{DQuat, DVec3};

use crate::scenes::parameters::Parameters;

/// Block of numbers at a fixed address.
#[derive(Debug)]
pub struct Block<const N: usize>([AtomicU64; N]);

impl<const N: usize> Block<N> {
    /// Creates a block of zeros.
    #[must_use]
    pub const fn new() -> Self {
        Self([const { AtomicU64::new(0) }; N])
    }

    /// Address of the first word.
    pub fn address(&self) -> *const AtomicU64 {
        self.0.as_ptr()
    }

    /// Returns a number, or NaN beyond the end.
    pub fn get(&self, index: usize) -> f64 {
        let bits = self.0.get(index).map(|word| word.load(Relaxed));
        bits.map_or(f64::NAN, f64::from_bits)
    }

    /// Stores a number. There is no effect beyond the end.
    pub fn set(&self, index: usize, value: f64) {
        if let Some(word) = self.0.get(index) {
            word.store(value.to_bits(), Relaxed);
        }
    }

    /// Stores numbers one after the other from `index` on.
    pub fn set_all(&self, index: usize, values: &[f64]) {
        for (offset, &value) in values.iter().enumerate() {
            self.set(index + offset, value);
        }
    }
}

impl<const N: usize> Default for Block<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Reads the parameters of a scene from their block.
#[must_use]
pub fn read_parameters(block: &Block<{ Parameters::COUNT }>) -> Parameters {
    Parameters::from_numbers(core::array::from_fn(|index| block.get(index)))
}

/// Count of the numbers of a state.
pub const STATE: usize = 13;

/// Reads a state from the first numbers of a block.
#[must_use]
pub fn read_state<const N: usize>(block: &Block<N>) -> State {
    let vector = |at| DVec3::new(block.get(at), block.get(at + 1), block.get(at + 2));
    let orientation = [6, 7, 8, 9].map(|at| block.get(at));
    State {
        position: vector(0),
        linear_velocity: vector(3),
        orientation: DQuat::from_array(orientation),
        angular_momentum: vector(10),
    }
}

/// Writes a state to the first numbers of a block.
pub fn write_state<const N: usize>(block: &Block<N>, state: &State) {
    block.set_all(0, &state.position.to_array());
    block.set_all(3, &state.linear_velocity.to_array());
    block.set_all(6, &state.orientation.to_array());
    block.set_all(10, &state.angular_momentum.to_array());
}

const TEXT_BYTES: usize = 1024;
static TEXT: [AtomicU8; TEXT_BYTES] = [const { AtomicU8::new(0) }; TEXT_BYTES];
static TEXT_LENGTH: AtomicU32 = AtomicU32::new(0);

/// Address of the text of the last error or report.
pub fn text_address() -> *const AtomicU8 {
    TEXT.as_ptr()
}

/// Length of the text, bytes.
pub fn text_length() -> u32 {
    TEXT_LENGTH.load(Relaxed)
}

/// Replaces the text. What exceeds the space is left out.
pub fn write_text(value: &dyn fmt::Display) {
    TEXT_LENGTH.store(0, Relaxed);
    // The writer has no error of its own.
    let _ = fmt::write(&mut Text, format_args!("{value}"));
}

struct Text;

impl fmt::Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            let length = TEXT_LENGTH.load(Relaxed);
            if let Some(place) = TEXT.get(length as usize) {
                place.store(byte, Relaxed);
                TEXT_LENGTH.store(length + 1, Relaxed);
            }
        }
        Ok(())
    }
}
