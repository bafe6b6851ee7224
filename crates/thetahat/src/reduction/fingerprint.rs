/// A fingerprint of the values of a recording, by which it is known again whatever its file is called.
///
/// A sum of scrambled words times powers of an odd number modulo 2^64, so that parts can be put together: equal for every
/// way to cut the recording into parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Fingerprint {
    hash: u64,
    /// The power of the base by the number of values.
    power: u64,
}

const BASE: u64 = 0x9e37_79b9_7f4a_7c15;

impl Fingerprint {
    pub(super) const EMPTY: Self = Self { hash: 0, power: 1 };

    pub(super) fn add(&mut self, values: &[f64]) {
        for value in values {
            self.hash = self.hash.wrapping_mul(BASE).wrapping_add(scrambled(value.to_bits()));
            self.power = self.power.wrapping_mul(BASE);
        }
    }

    /// This one followed by another.
    pub(super) fn followed_by(self, next: Self) -> Self {
        let hash = self.hash.wrapping_mul(next.power).wrapping_add(next.hash);
        Self { hash, power: self.power.wrapping_mul(next.power) }
    }

    pub(super) fn to_hex(self) -> String {
        format!("{:016x}", self.hash)
    }
}

/// The finaliser of G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", 2014.
pub(super) fn scrambled(word: u64) -> u64 {
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_give_the_fingerprint_of_the_whole() {
        let values: Vec<f64> = (0..100).map(|k| f64::from(k).sin()).collect();
        let of = |values: &[f64]| {
            let mut fingerprint = Fingerprint::EMPTY;
            fingerprint.add(values);
            fingerprint
        };
        for cut in [0, 1, 37, 100] {
            assert_eq!(of(&values[..cut]).followed_by(of(&values[cut..])), of(&values));
        }
        let mut other = values.clone();
        other.swap(3, 4);
        assert_ne!(of(&other), of(&values));
    }
}
