//! Loading of the data from which a run continues, with the feature `serde`.

use serde::{Deserialize, Deserializer};

/// Reads an optional value whose key must be there.
///
/// A derived `Deserialize` reads an option without a key as `None`. A file that lost a key, or that
/// misspells it, would continue with other bits.
pub(crate) fn required<'de, T, D>(deserializer: D) -> Result<Option<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    Option::deserialize(deserializer)
}
