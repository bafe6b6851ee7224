//! Samples averaged to steps, and the steps near rest.

use std::collections::VecDeque;

use super::layout::Layout;

/// Torques of an instant, or their mean, of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    /// Measured torque less the model's, N m or N.
    pub(super) y: f64,
    /// The torque of a unit of each change that acts on the joint.
    pub(super) x: Vec<f64>,
    /// The model's Coulomb friction, N m or N.
    pub(super) friction: f64,
    /// The square of the measured torque.
    pub(super) square: f64,
}

/// The mean of some samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Step {
    /// Time of its last sample, s.
    pub(super) time_s: f64,
    /// Its rows, joint by joint.
    pub(super) rows: Vec<Row>,
    /// Whether a joint is near rest in it or in its neighbours.
    pub(super) rest: Vec<bool>,
}

impl Row {
    pub(super) fn zeros(changes: usize) -> Self {
        Self { y: 0.0, x: vec![0.0; changes], friction: 0.0, square: 0.0 }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.y += other.y;
        self.friction += other.friction;
        self.square += other.square;
        self.x.iter_mut().zip(&other.x).for_each(|(x, o)| *x += o);
    }

    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.y *= factor;
        self.friction *= factor;
        self.square *= factor;
        self.x.iter_mut().for_each(|x| *x *= factor);
        self
    }

    /// The row less a part of the one before.
    pub(super) fn less(mut self, before: &Self, part: f64) -> Self {
        self.y -= part * before.y;
        self.x.iter_mut().zip(&before.x).for_each(|(x, b)| *x -= part * b);
        self
    }

    /// The torque of some changes.
    pub(super) fn torque(&self, changes: &[f64]) -> f64 {
        self.x.iter().zip(changes).map(|(x, c)| x * c).sum()
    }
}

/// The mean of steps, or of samples.
#[derive(Debug, Clone)]
pub(super) struct Mean {
    length: usize,
    count: usize,
    rows: Vec<Row>,
    rest: Vec<bool>,
}

impl Mean {
    pub(super) fn new(layout: Layout, length: usize) -> Self {
        let Layout { joints, .. } = layout;
        Self { length, count: 0, rows: vec![Row::zeros(layout.of_joint()); joints], rest: vec![false; joints] }
    }

    pub(super) fn length(&self) -> usize {
        self.length
    }

    pub(super) fn restart(&mut self) {
        self.count = 0;
        self.rest.fill(false);
        for row in &mut self.rows {
            *row = Row::zeros(row.x.len());
        }
    }

    /// Adds rows; the mean of as many as it takes.
    pub(super) fn push(&mut self, time_s: f64, rows: &[Row], rest: impl Fn(usize) -> bool) -> Option<Step> {
        self.rows.iter_mut().zip(rows).for_each(|(sum, row)| sum.add(row));
        self.rest.iter_mut().enumerate().for_each(|(j, is)| *is |= rest(j));
        self.count += 1;
        if self.count < self.length {
            return None;
        }
        let factor = 1.0 / self.length as f64;
        let rows = self.rows.iter().map(|row| row.clone().scaled(factor)).collect();
        let step = Step { time_s, rows, rest: self.rest.clone() };
        self.restart();
        Some(step)
    }
}

/// Marks the neighbours of steps near rest: the filter smears a rest over a period of its cut-off on either side.
#[derive(Debug, Clone)]
pub(super) struct NearRest {
    neighbours: usize,
    waiting: VecDeque<Step>,
    /// Steps since each joint was near rest.
    since: Vec<usize>,
}

impl NearRest {
    pub(super) fn new(joints: usize, neighbours: usize) -> Self {
        Self { neighbours, waiting: VecDeque::new(), since: vec![neighbours; joints] }
    }

    pub(super) fn neighbours(&self) -> usize {
        self.neighbours
    }

    pub(super) fn restart(&mut self) {
        *self = Self::new(self.since.len(), self.neighbours);
    }

    /// Takes a step and gives the one so many steps before.
    pub(super) fn push(&mut self, mut step: Step) -> Option<Step> {
        for j in 0..self.since.len() {
            if step.rest[j] {
                self.since[j] = 0;
                self.waiting.iter_mut().for_each(|waiting| waiting.rest[j] = true);
            } else {
                self.since[j] += 1;
                step.rest[j] = self.since[j] <= self.neighbours;
            }
        }
        self.waiting.push_back(step);
        if self.waiting.len() > self.neighbours { self.waiting.pop_front() } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_rest_are_marked_on_both_sides() {
        let mut near = NearRest::new(1, 2);
        let step = |k: usize| Step { time_s: k as f64, rows: vec![Row::zeros(1)], rest: vec![k == 5] };
        let marked: Vec<bool> = (0..12).filter_map(|k| near.push(step(k))).map(|step| step.rest[0]).collect();
        let expected: Vec<bool> = (0..10).map(|k| (3..=7).contains(&k)).collect();
        assert_eq!(marked, expected);
    }

    #[test]
    fn a_mean_is_near_rest_where_one_of_its_samples_is() {
        let layout = Layout { joints: 2, model: 0 };
        let mut mean = Mean::new(layout, 2);
        let row = |y: f64| Row { y, ..Row::zeros(layout.of_joint()) };
        assert_eq!(mean.push(0.0, &[row(1.0), row(3.0)], |j| j == 1), None);
        let step = mean.push(1.0, &[row(3.0), row(5.0)], |_| false).unwrap();
        assert_eq!((step.rows[0].y, step.rows[1].y, step.rest), (2.0, 4.0, vec![false, true]));
    }
}
