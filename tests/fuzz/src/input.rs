//! Numbers and vectors from bytes.

use arbitrary::Unstructured;
use tumble::Real;
use tumble::real::{Quaternion, Vector};

/// Bytes of an input, read from front to back. Zeros follow the last byte.
#[derive(Debug)]
pub struct Input<'a> {
    bytes: Unstructured<'a>,
}

/// Numbers at which formulas change, as far as both precisions have them.
const SPECIAL: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN_POSITIVE,
    5e-324,
    f64::EPSILON,
    3e38,
    1e-38,
    1e-45,
    1e19,
    1e-19,
];

impl<'a> Input<'a> {
    /// Creates an input from bytes.
    #[must_use]
    pub fn new(data: &'a [u8]) -> Self {
        Self {
            bytes: Unstructured::new(data),
        }
    }

    /// Returns true if all bytes are read.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Returns the bytes that are not read yet.
    #[must_use]
    pub fn rest(&mut self) -> &'a [u8] {
        let length = self.bytes.len();
        self.bytes.bytes(length).unwrap_or_default()
    }

    /// Returns the next byte.
    pub fn byte(&mut self) -> u8 {
        self.bytes.arbitrary().unwrap_or_default()
    }

    /// Returns the next two bytes.
    pub fn short(&mut self) -> u16 {
        self.bytes.arbitrary().unwrap_or_default()
    }

    /// Returns the next eight bytes.
    pub fn long(&mut self) -> u64 {
        self.bytes.arbitrary().unwrap_or_default()
    }

    /// Returns a number from 0 to `count - 1`, of one byte.
    pub fn below(&mut self, count: u8) -> u8 {
        self.byte() % count
    }

    /// Returns true for one byte in two.
    pub fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    /// Returns the number of any bits.
    pub fn raw<R: Real>(&mut self) -> R {
        // Converting an f32 to f64 and back keeps it, so that f32 needs four bytes.
        R::from_f64(if size_of::<R>() == 4 {
            f64::from(f32::from_bits(self.bytes.arbitrary().unwrap_or_default()))
        } else {
            f64::from_bits(self.long())
        })
    }

    /// Returns a number that is mostly between two positive ones, with an even logarithm, and at
    /// times any number.
    pub fn size<R: Real>(&mut self, low: f64, high: f64) -> R {
        match self.byte() {
            255 | 253 | 251 | 249 => self.raw(),
            254 | 252 | 250 | 248 => {
                let at = usize::from(self.byte()) % SPECIAL.len();
                R::from_f64(SPECIAL[at])
            }
            _ => {
                let fraction = f64::from(self.short()) / 65535.0;
                R::from_f64(low * Real::powf(high / low, fraction))
            }
        }
    }

    /// Returns a number like [`size`](Self::size), of either sign, or 0.
    pub fn signed<R: Real>(&mut self, low: f64, high: f64) -> R {
        match self.byte() % 4 {
            0 => self.size(low, high),
            1 => -self.size::<R>(low, high),
            _ => R::ZERO,
        }
    }

    /// Returns a vector of such numbers.
    pub fn vector<R: Real>(&mut self, low: f64, high: f64) -> R::Vec3 {
        let [x, y, z] = [0; 3].map(|_| self.signed(low, high));
        R::Vec3::new(x, y, z)
    }

    /// Returns a vector of numbers like [`size`](Self::size).
    pub fn sizes<R: Real>(&mut self, low: f64, high: f64) -> R::Vec3 {
        let [x, y, z] = [0; 3].map(|_| self.size(low, high));
        R::Vec3::new(x, y, z)
    }

    /// Returns a quaternion, of length 1 if it is made from an axis.
    pub fn quaternion<R: Real>(&mut self) -> R::Quat {
        if self.byte() < 224 {
            tumble::Rotation::<R>::from_rotation_vector(self.vector::<R>(1e-3, 3.0)).to_quat()
        } else {
            let [x, y, z, w] = [0; 4].map(|_| self.signed(1e-3, 2.0));
            R::Quat::new(x, y, z, w)
        }
    }
}
