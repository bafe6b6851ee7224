//! What IV simulates: its estimate where that is a robot's, else the parameters of a physical robot nearest to it.

use super::simulator::{Parameters, Simulator};
use crate::{
    base_parameters::BaseParameters,
    consistency::{ConsistencyError, ConsistentFit, ConsistentSet, SimulationOptions, nearest_to_simulate},
    identification::idim_ls,
    linear_algebra::Matrix,
    preparation::Problem,
    regression::Regression,
    robot::{Bound, Parameter, Role},
};

/// Part of the a-priori mass matrix above which that of an estimate is simulated as it is: the interior of the set.
const PART: f64 = 0.3;
/// The same for start values, which are the user's.
const PART_AT_START: f64 = 0.01;

/// The parameters that IV simulates, iteration by iteration.
pub(super) struct Physical<'a> {
    simulator: &'a Simulator<'a>,
    problem: &'a Problem,
    regression: &'a Regression,
    set: Result<&'a ConsistentSet, &'a ConsistencyError>,
    r: Option<Matrix>,
    before: Option<ConsistentFit>,
    /// Once an estimate could not be simulated, the nearest physical parameters are, to the end.
    pub(super) is_needed: bool,
    failure: Option<ConsistencyError>,
}

impl<'a> Physical<'a> {
    pub(super) fn new(simulator: &'a Simulator<'a>, regression: &'a Regression) -> Self {
        let problem = simulator.problem();
        let set = problem.consistent_set(simulator.setup());
        Self { simulator, problem, regression, set, r: None, before: None, is_needed: false, failure: None }
    }

    /// Standard parameters to simulate first: the start values, or those nearest to the estimate of LS where they are no
    /// robot's.
    pub(super) fn start(&mut self, start: &[f64]) -> Vec<f64> {
        let standard = self.problem.estimated.to_standard(start);
        if self.is_safe(&standard, PART_AT_START) {
            return standard;
        }
        let ls = idim_ls(self.regression, Default::default());
        ls.ok().and_then(|ls| self.nearest(&ls.theta)).unwrap_or(standard)
    }

    /// Standard parameters to simulate for an estimate.
    pub(super) fn of(&mut self, estimate: &[f64]) -> Vec<f64> {
        let standard = self.problem.estimated.to_standard(estimate);
        self.is_needed |= !self.is_safe(&standard, PART);
        if !self.is_needed {
            return standard;
        }
        self.nearest(estimate).unwrap_or(standard)
    }

    /// Standard parameters made here, as a simulation is to take them.
    pub(super) fn as_parameters(&self, standard: Vec<f64>) -> Parameters {
        if self.is_needed { Parameters::Physical(standard) } else { Parameters::Standard(standard) }
    }

    /// What is told of it; nothing where estimates were simulated as they are.
    pub(super) fn note(&self) -> Option<String> {
        if let Some(e) = &self.failure {
            return Some(format!(
                "simulates its estimate, since no physically consistent parameters near it were found: {e}"
            ));
        }
        let note = "simulates the physically consistent parameters nearest to its estimate, which are no robot's";
        self.before.as_ref().map(|_| note.to_owned())
    }

    /// The parameters of the interior nearest to an estimate.
    fn nearest(&mut self, estimate: &[f64]) -> Option<Vec<f64>> {
        let set = match self.set {
            Ok(set) => set,
            Err(e) => {
                self.failure = Some(e.clone());
                return None;
            }
        };
        let (problem, base) = (self.problem, &self.problem.base);
        let r = self.r.get_or_insert_with(|| triangular_factor(problem, self.regression));
        let all = in_base(base, &problem.estimated, estimate);
        match nearest_to_simulate(set, base, r, &all, &SimulationOptions::default(), self.before.as_ref()) {
            Ok(fit) => {
                let standard = fit.standard.clone();
                self.before = Some(fit);
                Some(standard)
            }
            Err(e) => {
                self.failure = Some(e);
                None
            }
        }
    }

    /// Whether parameters can be simulated as they are: the mass matrix is above a part of the a-priori one along the
    /// motion, and no Coulomb friction drives.
    fn is_safe(&self, standard: &[f64], part: f64) -> bool {
        let Ok(set) = &self.set else { return true };
        let drives = |(p, v): (&Parameter, &f64)| {
            p.quantity.role() == Role::CoulombFriction && p.quantity.bound() == Bound::NotNegative && *v < 0.0
        };
        let table = set.parameter_table();
        !table.iter().zip(standard).any(drives) && self.simulator.has_mass_matrix_above(standard, part, set.a_priori())
    }
}

/// The triangular factor of the weighted X of all base parameters.
fn triangular_factor(problem: &Problem, regression: &Regression) -> Matrix {
    regression.whiten_matrix(&problem.all_columns().x).triangular_factor()
}

/// All base parameters: those estimated, zeros elsewhere.
fn in_base(base: &BaseParameters, estimated: &BaseParameters, estimate: &[f64]) -> Vec<f64> {
    let standard = estimated.to_standard(estimate);
    base.columns().into_iter().map(|c| standard[c]).collect()
}
