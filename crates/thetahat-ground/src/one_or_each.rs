//! A value for all joints, or a list with one for each: the form of every per-joint key in experiment and robot files.

use std::{fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer,
    de::{
        IntoDeserializer, MapAccess, SeqAccess, Visitor,
        value::{MapAccessDeserializer, SeqAccessDeserializer},
    },
};

/// One value for all joints (motors, channels), or a list with one for each, in order.
///
/// ```
/// use thetahat_ground::one_or_each::OneOrEach;
/// #[derive(serde::Deserialize)]
/// struct Keys {
///     gain: OneOrEach<f64>,
///     zero: OneOrEach<f64>,
/// }
/// let keys: Keys = toml::from_str("gain = 2\nzero = [0.1, 0.2]").unwrap();
/// assert_eq!((keys.gain.to_list(3), keys.zero.to_list(2)), (vec![2.0; 3], vec![0.1, 0.2]));
/// assert!(keys.gain.fits(3) && !keys.zero.fits(3));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum OneOrEach<T> {
    /// The same for all.
    One(T),
    /// One for each.
    Each(Vec<T>),
}

impl<T> OneOrEach<T> {
    /// The values as given: one value, or the list.
    #[must_use]
    pub fn given(&self) -> &[T] {
        match self {
            Self::One(value) => std::slice::from_ref(value),
            Self::Each(values) => values,
        }
    }

    /// Whether this is one value, or a list of `count`.
    #[must_use]
    pub fn fits(&self, count: usize) -> bool {
        match self {
            Self::One(_) => true,
            Self::Each(values) => values.len() == count,
        }
    }

    /// The value at `index`, counted from zero.
    ///
    /// # Panics
    /// If the list is shorter.
    #[must_use]
    pub fn of(&self, index: usize) -> &T {
        match self {
            Self::One(value) => value,
            Self::Each(values) => &values[index],
        }
    }
}

impl<T> From<T> for OneOrEach<T> {
    fn from(value: T) -> Self {
        Self::One(value)
    }
}

impl<T: Clone> OneOrEach<T> {
    /// A list of `count` values: the one value repeated, or the list itself.
    #[must_use]
    pub fn to_list(&self, count: usize) -> Vec<T> {
        match self {
            Self::One(value) => vec![value.clone(); count],
            Self::Each(values) => values.clone(),
        }
    }
}

/// Deserializes a list; a single value becomes a list of one.
///
/// # Errors
/// The deserializer's.
pub fn list<'de, D: Deserializer<'de>, T: Deserialize<'de> + Clone>(from: D) -> Result<Vec<T>, D::Error> {
    Ok(OneOrEach::deserialize(from)?.given().to_vec())
}

/// A visitor, because an untagged enum loses the message of what is wrong inside.
struct ScalarOrList<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for ScalarOrList<T> {
    type Value = OneOrEach<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("one value for all, or a list with one for each")
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrEach::One)
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrEach::One)
    }

    fn visit_str<E: serde::de::Error>(self, value: &str) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrEach::One)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(OneOrEach::One)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(sequence)).map(OneOrEach::Each)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrEach<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ScalarOrList(PhantomData))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(rename_all = "lowercase")]
    enum Unit {
        Metre,
        Radian,
        Degree,
    }

    #[derive(Debug, Deserialize)]
    struct Keys {
        #[serde(default, deserialize_with = "list")]
        number: Vec<f64>,
        unit: Option<OneOrEach<Unit>>,
    }

    fn message(text: &str) -> String {
        toml::from_str::<Keys>(text).unwrap_err().message().to_owned()
    }

    #[test]
    fn scalars_and_lists_are_read() {
        let keys: Keys = toml::from_str("number = 3\nunit = ['metre', 'radian']").unwrap();
        assert_eq!((keys.number, keys.unit), (vec![3.0], Some(OneOrEach::Each(vec![Unit::Metre, Unit::Radian]))));
        let keys: Keys = toml::from_str("number = [3, 4.5]\nunit = 'degree'").unwrap();
        assert_eq!((keys.number, keys.unit), (vec![3.0, 4.5], Some(OneOrEach::One(Unit::Degree))));
    }

    #[test]
    fn what_is_wrong_inside_is_said() {
        let unknown = "unknown variant `lbf`, expected one of `metre`, `radian`, `degree`";
        assert_eq!(message("unit = 'lbf'"), unknown);
        assert_eq!(message("unit = ['metre', 'lbf']"), unknown);
        assert_eq!(message("number = 'a'"), "invalid type: string \"a\", expected f64");
        assert_eq!(
            message("number = true"),
            "invalid type: boolean `true`, expected one value for all, or a list with one for each"
        );
    }
}
