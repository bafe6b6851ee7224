//! The last seconds, the older the more of them together.

use std::collections::VecDeque;

use super::likelihood::Sums;

/// Stretches of one length before two of them become one.
const OF_A_LENGTH: usize = 3;

/// Sums of some seconds, one after the other.
#[derive(Debug, Clone)]
pub(super) struct Stretch {
    pub(super) sums: Sums,
    pub(super) began_s: f64,
    /// How many seconds.
    pub(super) ticks: usize,
}

/// Stretches whose lengths are powers of two, the oldest first.
#[derive(Debug, Clone, Default)]
pub(super) struct History {
    stretches: VecDeque<Stretch>,
}

impl History {
    pub(super) fn clear(&mut self) {
        self.stretches.clear();
    }

    /// Adds a second.
    pub(super) fn push(&mut self, second: Stretch) {
        self.stretches.push_back(second);
        let mut newest = self.stretches.len();
        while let Some(ticks) = newest.checked_sub(1).map(|last| self.stretches[last].ticks) {
            let oldest = (0..newest).find(|k| self.stretches[*k].ticks == ticks).unwrap_or(newest);
            if newest - oldest <= OF_A_LENGTH {
                break;
            }
            self.merge(oldest);
            newest = oldest + 1;
        }
    }

    /// Makes one of a stretch and its successor.
    fn merge(&mut self, place: usize) {
        let Some(later) = self.stretches.remove(place + 1) else { return };
        let own = &mut self.stretches[place];
        own.sums.add(&later.sums);
        own.ticks += later.ticks;
    }

    /// Stretches, the newest first.
    pub(super) fn newest_first(&self) -> impl Iterator<Item = &Stretch> {
        self.stretches.iter().rev()
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Stretch> {
        self.stretches.iter_mut()
    }

    /// Takes the oldest stretch out if more seconds than so many follow it.
    pub(super) fn take_older_than(&mut self, ticks: usize) -> Option<Stretch> {
        let after: usize = self.stretches.iter().skip(1).map(|stretch| stretch.ticks).sum();
        if after >= ticks { self.stretches.pop_front() } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::layout::Layout;

    #[test]
    fn old_seconds_are_together_and_none_is_lost() {
        let mut history = History::default();
        let second =
            |k: u32| Stretch { sums: Sums::zeros(Layout { joints: 1, model: 0 }), began_s: f64::from(k), ticks: 1 };
        (0..200).for_each(|k| history.push(second(k)));
        let lengths: Vec<usize> = history.newest_first().map(|stretch| stretch.ticks).collect();
        assert_eq!(lengths.iter().sum::<usize>(), 200);
        assert!(lengths.is_sorted() && lengths.len() < 22, "{lengths:?}");
        let mut next = 200.0;
        for stretch in history.newest_first() {
            next -= stretch.ticks as f64;
            assert_eq!(stretch.began_s, next);
        }
        assert_eq!(history.take_older_than(200).map(|stretch| stretch.ticks), None);
        assert_eq!(history.take_older_than(100).map(|stretch| stretch.began_s), Some(0.0));
    }
}
