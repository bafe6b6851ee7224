//! `phi = G^T phi_tree` of mechanisms that close.

use super::observation::{Entry, Regressor};
use crate::dynamics::{LoopScratch, Model, Sign, State, Workspace};

/// The regressor of the tree, and where its entries act on the robot's coordinates.
#[derive(Debug, Clone)]
pub(super) struct OfTree {
    regressor: Regressor,
    /// For each entry of the tree's regressor: the robot's coordinates on which it acts, with the index of the entry there.
    targets: Vec<Vec<(usize, usize)>>,
}

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
