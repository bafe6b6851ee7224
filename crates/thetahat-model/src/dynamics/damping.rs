//! Derivatives of the drives' torques with respect to velocities: exact, from the torque kernel.

use super::{model::Model, parameters::DynamicParameters, sign::Sign, state::State, workspace::LoopScratch};
use thetahat_ground::real::Dual;

/// Scratch of [`Model::damping_into`].
#[derive(Debug, Clone, Default)]
#[doc(hidden)]
pub struct DampingWorkspace {
    q: Vec<Dual>,
    channels: Vec<Dual>,
    dq: Vec<Dual>,
    zeros: Vec<Dual>,
    tau: Vec<Dual>,
    /// Scratch of loops.
    loops: Option<Box<(LoopScratch, Self)>>,
}

impl Model {
    /// `D = d tau / d dq` of friction, n by n, row by row, in a state: by dual numbers, so that it includes every term of the
    /// drives.
    ///
    /// Without coupled motors and torque terms each coordinate's friction depends on its own velocity only, and one pass gives
    /// the diagonal.
    #[doc(hidden)]
    pub fn damping_into(
        &self,
        parameters: &DynamicParameters,
        state: State<'_>,
        sign: Sign,
        workspace: &mut DampingWorkspace,
        d: &mut [f64],
    ) {
        if let Some(closed) = self.closed() {
            let new = || Box::new((LoopScratch::new(closed), DampingWorkspace::default()));
            let (scratch, of_tree) = &mut **workspace.loops.get_or_insert_with(new);
            return closed.damping(parameters, state, sign, (scratch, of_tree), d);
        }
        let n = state.dq.len();
        let DampingWorkspace { q, channels, dq, zeros, tau, .. } = workspace;
        channels.clear();
        channels.extend(state.channels.iter().map(|&value| Dual::constant(value)));
        q.clear();
        q.extend(state.q.iter().map(|&value| Dual::constant(value)));
        zeros.resize(n, Dual::constant(0.0));
        let separable = self.coupled_motors().is_empty() && self.terms().is_empty() && !self.has_sums;
        d.fill(0.0);
        for k in 0..if separable { 1 } else { n } {
            let direction = |j: usize| if separable || j == k { 1.0 } else { 0.0 };
            dq.clear();
            dq.extend(state.dq.iter().enumerate().map(|(j, &value)| Dual { value, derivative: direction(j) }));
            tau.clear();
            tau.resize(n, Dual::constant(0.0));
            self.add_drive_torques(parameters, State::new(q, dq).with_channels(channels), zeros, sign, tau);
            for (j, torque) in tau.iter().enumerate() {
                d[j * n + if separable { j } else { k }] = torque.derivative;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{dynamics::Workspace, robot::Robot};

    const COUPLED: &str = "name = \"wrist\"\ngravity = [0, 0, 0]\n[[joint]]\nname = \"a\"\nkind = \"revolute\"\n\
                           [[joint]]\nname = \"b\"\nkind = \"revolute\"\nalpha_deg = 90\n[transmission]\n\
                           matrix = [[45, 0], [32, 32]]\n[parameters]\n\
                           fv1 = 0.4\nfc1 = 0.2\nfv2 = 0.1\nfc2 = 0.3\nfcm2 = 0.25\nfvm2 = 0.15\n";

    /// Without inertia, inverse dynamics is only friction: its central differences are D.
    #[test]
    fn damping_is_the_derivative_of_friction() {
        let robot = Robot::parse(COUPLED, Path::new("robot.toml")).unwrap();
        let model = Model::new(&robot);
        let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
        let sign = Sign::smooth(0.05);
        let mut workspace = Workspace::new(&model);
        let mut torques = |dq: &[f64]| {
            let mut tau = [0.0; 2];
            model.inverse_dynamics(&parameters, State::new(&[0.3, 0.2], dq), &[0.0; 2], sign, &mut workspace, &mut tau);
            tau
        };
        for dq in [[0.0, 0.0], [0.03, -0.02], [0.5, -0.9]] {
            let mut d = [0.0; 4];
            model.damping_into(
                &parameters,
                State::new(&[0.3, 0.2], &dq),
                sign,
                &mut DampingWorkspace::default(),
                &mut d,
            );
            for k in 0..2 {
                let moved =
                    |by: f64| [dq[0] + by * f64::from(u8::from(k == 0)), dq[1] + by * f64::from(u8::from(k == 1))];
                let (above, below) = (torques(&moved(1e-6)), torques(&moved(-1e-6)));
                for j in 0..2 {
                    let expected = (above[j] - below[j]) / 2e-6;
                    assert!((d[j * 2 + k] - expected).abs() < 1e-6 * expected.abs().max(1.0), "{dq:?} {j} {k}");
                }
            }
        }
    }
}
