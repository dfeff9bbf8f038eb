//! Numbers in files: those that are not finite, which JSON does not have, as `"NaN"`, `"inf"` and `"-inf"`.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number or the name of one.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Name(String),
}

impl From<f64> for Written {
    fn from(x: f64) -> Self {
        if x.is_finite() { Self::Number(x) } else { Self::Name(x.to_string()) }
    }
}

impl Written {
    fn value<E: serde::de::Error>(self) -> Result<f64, E> {
        match self {
            Self::Number(x) => Ok(x),
            Self::Name(name) => {
                name.parse().map_err(|_| E::custom(format!("`{name}` is not a number, \"NaN\" or \"inf\"")))
            }
        }
    }
}

pub(crate) fn serialize<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Written::from(*x).serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Written::deserialize(deserializer)?.value()
}

/// Three of them, or none.
pub(crate) mod triple {
    use super::{Deserialize, Deserializer, Serialize, Serializer, Written};

    pub(crate) fn serialize<S: Serializer>(x: &Option<[f64; 3]>, serializer: S) -> Result<S::Ok, S::Error> {
        x.map(|x| x.map(Written::from)).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<[f64; 3]>, D::Error> {
        let Some([x, y, z]) = Option::<[Written; 3]>::deserialize(deserializer)? else { return Ok(None) };
        Ok(Some([x.value()?, y.value()?, z.value()?]))
    }
}
