//! Mechanisms that close: a tree whose passive joints are moved by conditions between links.
//!
//! With the positions of the independent joints `q_a`, the conditions `c(q) = 0` give those of the passive joints, `q_p = g(q_a)`, by
//! Newton steps along the straight way from a closed position that the description names. The result depends on `q_a` alone, so that
//! every order of calls, and every number of threads, gives the same bits. With the Jacobian `J = [J_a J_p]` of the conditions,
//! `dq = G dq_a` and `ddq = G ddq_a + dG dq_a`, where `J_p G_p = -J_a` and `J_p (dG dq_a)_p = -dJ dq`. The dynamics of the tree are
//! projected: `tau = G^T tau_tree`, `phi = G^T phi_tree`, `M = G^T M_tree G`.

mod closed_tree;
mod closing;
mod condition;
mod conditions;
mod dynamics;
mod factors;
mod motion;
mod spin;
#[cfg(test)]
mod tests;

pub(super) use condition::Condition;
pub(crate) use dynamics::DIFFERENCES;
pub(super) use spin::Spin;
