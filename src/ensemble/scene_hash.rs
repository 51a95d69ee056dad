//! Hash of a scene: results of different scenes are not merged.

use alloc::string::String;
use core::fmt::{self, Write as _};

/// Hash that identifies what was thrown: scene, integrator, start distribution and time limit.
///
/// It detects that results of different scenes are merged by mistake. It is FNV-1a with 64 bits
/// (Fowler, Noll & Vo), the same on every machine. It is no protection against forgery.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "String", try_from = "String")
)]
pub struct SceneHash(u64);

const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0100_0000_01b3;

impl SceneHash {
    /// Returns the hash of a description of your own, such as a text or saved parameters.
    ///
    /// Two scenes with the same bytes are regarded as the same. Include all that changes an
    /// outcome, among it the version of your program.
    #[must_use]
    pub const fn of_bytes(bytes: &[u8]) -> Self {
        Self(extended(OFFSET, bytes))
    }

    /// Returns the hash of the `Debug` text of a value and of the version of the crate.
    ///
    /// The derived text of a built-in part contains all its parameters with every digit. A part of
    /// your own must print all that changes an outcome. The hash changes with the version of the
    /// crate, because a version may change the bits of a result.
    #[must_use]
    pub fn of_debug(value: &impl fmt::Debug) -> Self {
        let mut writer = Writer(extended(OFFSET, env!("CARGO_PKG_VERSION").as_bytes()));
        // The writer itself never fails. A `Debug` that fails has a hash of what it wrote.
        let _ = write!(writer, "{value:?}");
        Self(writer.0)
    }
}

const fn extended(mut hash: u64, bytes: &[u8]) -> u64 {
    let mut at = 0;
    while at < bytes.len() {
        hash = (hash ^ bytes[at] as u64).wrapping_mul(PRIME);
        at += 1;
    }
    hash
}

struct Writer(u64);

impl fmt::Write for Writer {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0 = extended(self.0, text.as_bytes());
        Ok(())
    }
}

/// Sixteen hexadecimal digits.
impl fmt::Display for SceneHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl From<SceneHash> for String {
    fn from(hash: SceneHash) -> Self {
        alloc::format!("{hash}")
    }
}

impl TryFrom<String> for SceneHash {
    type Error = core::num::ParseIntError;

    /// Reads the digits that `Display` writes: exactly sixteen, in lower case and without a sign.
    fn try_from(text: String) -> Result<Self, Self::Error> {
        // The error of the standard library cannot be constructed, and a sign alone causes it.
        let digits = if is_written(&text) { &text } else { "+" };
        u64::from_str_radix(digits, 16).map(Self)
    }
}

/// Returns true if `Display` writes this text for some hash.
fn is_written(text: &str) -> bool {
    let is_digit = |byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
    text.len() == 16 && text.bytes().all(is_digit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_fnv_1a() {
        // Test vectors of the authors, www.isthe.com/chongo/tech/comp/fnv.
        assert_eq!(SceneHash::of_bytes(b"").0, 0xcbf2_9ce4_8422_2325);
        assert_eq!(SceneHash::of_bytes(b"a").0, 0xaf63_dc4c_8601_ec8c);
        assert_eq!(SceneHash::of_bytes(b"foobar").0, 0x8594_4171_f739_67e8);
    }

    #[test]
    fn only_the_digits_that_are_written_are_read() {
        for hash in [0, 1, 0xabcd_ef01_2345_6789, u64::MAX].map(SceneHash) {
            assert_eq!(SceneHash::try_from(String::from(hash)), Ok(hash));
        }
        let texts = [
            "",
            "1",
            "+1",
            "+000000000000001",
            "00000000000000001",
            "ABCDEF0123456789",
            "00000000000000é",
            "000000000000000g",
            " 00000000000000 ",
            "0x00000000000001",
        ];
        for text in texts {
            let read = SceneHash::try_from(String::from(text));
            let error = read.map_err(|error| *error.kind()).unwrap_err();
            assert_eq!(error, core::num::IntErrorKind::InvalidDigit, "{text}");
        }
    }

    #[test]
    fn a_neighbouring_parameter_has_another_hash() {
        let next = 0.3_f64.next_up();
        assert_ne!(SceneHash::of_debug(&0.3), SceneHash::of_debug(&next));
        assert_eq!(SceneHash::of_debug(&0.3), SceneHash::of_debug(&0.3));
    }
}
