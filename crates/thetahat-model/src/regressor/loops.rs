//! `phi = G^T phi_tree` of mechanisms that close.

use super::observation::{Entry, OfTree, Regressor};
use crate::dynamics::{DIFFERENCES, LoopScratch, Model, Sign, State, Workspace};
use thetahat_ground::series::Series;

impl OfTree {
    /// The entries of a robot's regressor, and its tree's regressor; none of a tree.
    pub(super) fn new(model: &Model, indices: &[usize]) -> Option<(Vec<Entry>, Self)> {
        let closed = model.closed()?;
        let regressor = Regressor::new(&closed.tree, indices);
        let acts = |entry: &Entry| {
            let column = entry.column;
            let on = |&joint: &usize| Entry { joint, column };
            closed.moved_by(entry.joint).iter().map(on).collect::<Vec<_>>()
        };
        let mut entries: Vec<Entry> = regressor.entries().iter().flat_map(acts).collect();
        entries.sort_unstable_by_key(|entry| (entry.column, entry.joint));
        entries.dedup();
        let place = |wanted: Entry| entries.iter().position(|entry| *entry == wanted).unwrap_or(0);
        let of_entry = |entry: &Entry| acts(entry).into_iter().map(|own| (own.joint, place(own))).collect();
        let targets = regressor.entries().iter().map(of_entry).collect();
        Some((entries, Self { regressor, targets }))
    }

    /// The entries for one sample; not numbers where the loops cannot be closed.
    pub(super) fn evaluate(
        &self,
        model: &Model,
        (state, ddq): (State<'_>, &[f64]),
        sign: Sign,
        workspace: &mut Workspace,
        phi: &mut [f64],
    ) {
        let (Some(closed), Some(scratch)) = (model.closed(), workspace.loops.as_deref_mut()) else { return };
        if closed.move_all([state.q, state.dq, ddq], scratch).is_err() {
            return phi.fill(f64::NAN);
        }
        let mut of_tree = vec![0.0; self.regressor.entries().len()];
        let LoopScratch { q, dq, ddq, tree, .. } = scratch;
        self.regressor.evaluate(&closed.tree, State::new(q, dq), ddq, sign, tree, &mut of_tree);
        phi.fill(0.0);
        for ((value, entry), targets) in of_tree.iter().zip(self.regressor.entries()).zip(&self.targets) {
            for &(coordinate, place) in targets {
                phi[place] += closed.slope(scratch, entry.joint, coordinate) * value;
            }
        }
    }
}

impl Regressor {
    /// As [`Regressor::weighted_slopes`].
    pub(super) fn slopes_by_differences(
        &self,
        model: &Model,
        motion: [&Series; 3],
        weights: &[f64],
        sign: Sign,
    ) -> [Series; 3] {
        let [samples, joints] = [motion[0].len(), model.coordinate_count()];
        let size = joints * self.columns();
        let (mut workspace, mut phi) = (Workspace::new(model), vec![0.0; self.entries().len()]);
        let mut sum = |[q, dq, ddq]: &[Vec<f64>; 3], weights: &[f64]| -> f64 {
            self.evaluate(model, State::new(q, dq), ddq, sign, &mut workspace, &mut phi);
            let weight = |entry: &Entry| weights[entry.joint * self.columns() + entry.column];
            self.entries().iter().zip(&phi).map(|(entry, value)| weight(entry) * value).sum()
        };
        let mut slopes = [(); 3].map(|()| Series::zeros(samples, joints));
        for (k, weights) in weights.chunks_exact(size.max(1)).enumerate() {
            let mut state = motion.map(|series| series.sample(k).to_vec());
            for (order, step) in DIFFERENCES.into_iter().enumerate() {
                for joint in 0..joints {
                    let value = state[order][joint];
                    let [above, below] = [value + step, value - step].map(|moved| {
                        state[order][joint] = moved;
                        sum(&state, weights)
                    });
                    state[order][joint] = value;
                    slopes[order].sample_mut(k)[joint] = (above - below) / (2.0 * step);
                }
            }
        }
        slopes
    }
}
