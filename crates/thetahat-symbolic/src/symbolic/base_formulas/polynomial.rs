use std::{
    collections::BTreeMap,
    ops::{AddAssign, Mul},
};

/// Fraction of a term below which it is rounding.
const NEGLIGIBLE: f64 = 1e-12;

/// A sum of products of symbols: the factor of each product, by its symbols in order.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Polynomial {
    terms: BTreeMap<Vec<String>, f64>,
}

impl Polynomial {
    pub(super) fn number(value: f64) -> Self {
        Self::term(Vec::new(), value)
    }

    pub(super) fn symbol(name: String) -> Self {
        Self::term(vec![name], 1.0)
    }

    fn term(symbols: Vec<String>, factor: f64) -> Self {
        let terms = if factor == 0.0 { BTreeMap::new() } else { BTreeMap::from([(symbols, factor)]) };
        Self { terms }
    }

    pub(super) fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        self * &Self::number(factor)
    }

    /// Its value, given the values of its symbols.
    pub(super) fn value(&self, of: &impl Fn(&str) -> f64) -> f64 {
        self.terms.iter().map(|(symbols, factor)| factor * symbols.iter().map(|name| of(name)).product::<f64>()).sum()
    }

    pub(super) fn symbols(&self) -> impl Iterator<Item = &String> {
        self.terms.keys().flatten()
    }

    /// The polynomial as a factor: sign, and text that is empty if it is one.
    pub(super) fn factor(&self) -> (char, String) {
        let single = self.terms.len() == 1;
        let is_negative = self.terms.values().next().is_some_and(|factor| *factor < 0.0);
        let of = |factor: f64| if is_negative { -factor } else { factor };
        let sign = if is_negative { '-' } else { '+' };
        if single {
            let text = self.terms.iter().map(|(symbols, factor)| product(symbols, of(*factor))).collect::<String>();
            return (sign, if text == "1" { String::new() } else { text });
        }
        let mut text = String::new();
        for (symbols, factor) in &self.terms {
            let joint = match (text.is_empty(), of(*factor) < 0.0) {
                (true, _) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            text += joint;
            text += &product(symbols, factor.abs());
        }
        (sign, format!("({text})"))
    }
}

/// Such as `2*a3*d3^2`.
fn product(symbols: &[String], factor: f64) -> String {
    let mut factors = Vec::new();
    if factor != 1.0 || symbols.is_empty() {
        factors.push(readable(factor));
    }
    for group in symbols.chunk_by(|a, b| a == b) {
        factors.push(if group.len() > 1 { format!("{}^{}", group[0], group.len()) } else { group[0].clone() });
    }
    factors.join("*")
}

/// Up to nine decimals, without trailing zeros.
fn readable(value: f64) -> String {
    format!("{value:.9}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl AddAssign<&Polynomial> for Polynomial {
    fn add_assign(&mut self, other: &Self) {
        for (symbols, factor) in &other.terms {
            let sum = self.terms.entry(symbols.clone()).or_insert(0.0);
            *sum += factor;
            if sum.abs() <= NEGLIGIBLE * factor.abs() {
                self.terms.remove(symbols);
            }
        }
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;

    fn mul(self, other: Self) -> Polynomial {
        let mut product = Polynomial::default();
        for (first, a) in &self.terms {
            for (second, b) in &other.terms {
                let mut symbols = [first.as_slice(), second].concat();
                symbols.sort_unstable();
                product += &Polynomial::term(symbols, a * b);
            }
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_sorted_and_cancel() {
        let [a, d] = ["a3", "d3"].map(|name| Polynomial::symbol(name.to_owned()));
        let mut sum = &a * &a;
        sum += &(&d * &d);
        assert_eq!(sum.factor(), ('+', "(a3^2 + d3^2)".to_owned()));
        sum += &(&a * &a).scaled(-1.0);
        assert_eq!(sum.factor(), ('+', "d3^2".to_owned()));
        assert_eq!((&d * &a).scaled(-2.0).factor(), ('-', "2*a3*d3".to_owned()));
        assert_eq!(Polynomial::number(-1.0).factor(), ('-', String::new()));
        assert_eq!(sum.value(&|_| 3.0), 9.0);
    }
}
