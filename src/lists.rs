//! Lists of a fixed length in TOML files: a deserializer that reads the first values of a longer one would lose the rest in
//! silence.

use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer};

/// What is read by [`exact`].
pub(crate) trait Exact: Sized {
    fn exact<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error>;
}

/// For `#[serde(deserialize_with)]`: refuses lists that are too long as well as those that are too short.
///
/// # Errors
/// If a list has not as many values as its type.
pub(crate) fn exact<'de, D: Deserializer<'de>, T: Exact>(deserializer: D) -> Result<T, D::Error> {
    T::exact(deserializer)
}

impl<T: DeserializeOwned, const N: usize> Exact for [T; N] {
    fn exact<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = Vec::<T>::deserialize(deserializer)?;
        let length = values.len();
        let expected = format!("an array of length {N}");
        <[T; N]>::try_from(values).map_err(|_| Error::invalid_length(length, &&*expected))
    }
}

impl<T: Exact> Exact for Option<T> {
    fn exact<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        T::exact(deserializer).map(Some)
    }
}

impl<T: Exact> Exact for Vec<T> {
    fn exact<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Item<T>(T);
        impl<'de, T: Exact> Deserialize<'de> for Item<T> {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                T::exact(deserializer).map(Self)
            }
        }
        let items = Vec::<Item<T>>::deserialize(deserializer)?;
        Ok(items.into_iter().map(|Item(item)| item).collect())
    }
}
