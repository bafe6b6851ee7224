//! The meaning of the names of parameters.

use std::collections::BTreeSet;

/// Symbols of one kind of parameter, and what they stand for.
const KINDS: [(&[&str], &str); 10] = [
    (&["xx", "yy", "zz"], "moments of inertia of a link about the axes of its frame"),
    (&["xy", "xz", "yz"], "products of inertia of a link"),
    (&["mx", "my", "mz"], "first moments of a link: its mass times the coordinates of its centre"),
    (&["m"], "mass of a link"),
    (&["ia"], "inertia of a motor and its gears, seen at the joint"),
    (&["fv", "fvp", "fvn"], "viscous friction (p, n: for positive, negative velocity)"),
    (&["fc", "fcp", "fcn"], "Coulomb friction (p, n: for positive, negative velocity)"),
    (&["off"], "offset of the torque"),
    (&["iam"], "inertia of a motor that moves more than one joint"),
    (&["fvm", "fcm"], "viscous and Coulomb friction of the motor"),
];

/// The symbols that occur in names, as `zz` in `zz1r`, with their meanings.
pub(super) fn key<'a>(names: impl Iterator<Item = &'a str>) -> Vec<(String, &'static str)> {
    let used: BTreeSet<&str> = names.map(symbol).collect();
    let of_kind = |(symbols, meaning): (&[&str], &'static str)| {
        let found: Vec<&str> = symbols.iter().copied().filter(|s| used.contains(s)).collect();
        (!found.is_empty()).then(|| (found.join(" "), meaning))
    };
    KINDS.into_iter().filter_map(of_kind).collect()
}

/// The part of a name before its number.
fn symbol(name: &str) -> &str {
    name.trim_end_matches('r').trim_end_matches(|c: char| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_that_occur_are_explained() {
        let found = key(["zz1r", "xx2", "m12r", "fv3", "spring_2"].into_iter());
        let symbols: Vec<&str> = found.iter().map(|(symbols, _)| &**symbols).collect();
        assert_eq!(symbols, ["xx zz", "m", "fv"]);
        assert!(key(["spring_2"].into_iter()).is_empty());
    }
}
