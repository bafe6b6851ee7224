//! What IV and DIDIM simulate: an estimate as it is where that is a robot's, else parameters of a physical robot.

use super::simulator::{FINE, Parameters, Simulator};
use crate::preparation::Problem;
use thetahat_estimation::{
    identification::{DesignMatrix, Fit, Method, idim_ls},
    regression::Regression,
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{
    base_parameters::BaseParameters,
    consistency::{ConsistencyError, ConsistentFit, ConsistentSet, InteriorOptions, nearest_to_simulate},
    robot::{Bound, Parameter, Role},
};

/// Part of the a-priori mass matrix above which that of start values is simulated as it is: they are the user's.
const PART_AT_START: f64 = 0.01;

/// Weight of the divergence from the a-priori parameters among those that a fit may take, relative to `|R theta_hat|^2`: it only
/// keeps them together, since steps are judged by the error alone.
const PULL_OF_FITS: f64 = 1e-11;

/// Simulations for IV of a robot in the place of its estimate that have viscous friction.
const WITH_VISCOUS: usize = 6;

/// How close to the boundary of the physical set a method goes.
struct Margin {
    /// Part of the a-priori mass matrix above which that of an estimate is simulated as it is.
    part: f64,
    /// Whether an estimate with negative Coulomb friction is simulated as it is.
    may_drive: bool,
    /// Where it is not: the part of the a-priori links and motors that physical parameters have at least.
    options: InteriorOptions,
}

/// IV takes instruments from the interior, which costs it nothing. What DIDIM simulates is its estimate: it goes near the
/// boundary, where a link without mass would make the simulation erratic.
fn margin(design: DesignMatrix) -> Margin {
    match design {
        DesignMatrix::Measured => Margin { part: 0.3, may_drive: false, options: InteriorOptions::default() },
        DesignMatrix::Simulated => {
            let options = InteriorOptions { interior: 0.02, ..InteriorOptions::default() };
            Margin { part: 0.01, may_drive: true, options }
        }
    }
}

/// The parameters that a method simulates, iteration by iteration.
pub(super) struct Physical<'a> {
    simulator: &'a Simulator<'a>,
    problem: &'a Problem,
    regression: &'a Regression,
    design: DesignMatrix,
    set: Result<&'a ConsistentSet, &'a ConsistencyError>,
    /// Triangular factor of the regression in all base parameters: of X, or of Z for DIDIM.
    r: Option<Matrix>,
    before: Option<ConsistentFit>,
    /// Simulations for IV of a robot in the place of its estimate.
    simulations: usize,
    /// Once an estimate could not be simulated, physical parameters are, to the end.
    is_needed: bool,
    /// Whether every step of a fit leads to physical parameters, to the end.
    is_kept_in_set: bool,
    /// An estimate in the physical set with its standard parameters.
    constrained: Option<(Vec<f64>, Vec<f64>)>,
    failure: Option<ConsistencyError>,
    current: Parameters,
}

impl<'a> Physical<'a> {
    pub(super) fn new(method: Method, simulator: &'a Simulator<'a>, regression: &'a Regression) -> Self {
        let problem = simulator.problem();
        Self {
            simulator,
            problem,
            regression,
            design: method.design(),
            set: problem.consistent_set(simulator.setup()),
            r: None,
            before: None,
            simulations: 0,
            is_needed: false,
            is_kept_in_set: false,
            constrained: None,
            failure: None,
            current: Parameters::Estimated(Vec::new()),
        }
    }

    /// What is to be simulated.
    pub(super) fn current(&self) -> &Parameters {
        &self.current
    }

    /// The parameters to simulate first: the start values, or those nearest to the estimate of LS where they are no robot's.
    pub(super) fn start(&mut self, start: &[f64]) -> Vec<f64> {
        let standard = self.problem.estimated.to_standard(start);
        if !self.is_safe(&standard, PART_AT_START)
            && let Some(start) = self.near_ls()
        {
            return start;
        }
        self.current = Parameters::Standard { theta: standard, tolerance: 1.0 };
        start.to_vec()
    }

    /// Starts from the parameters nearest to the estimate of LS.
    pub(super) fn near_ls(&mut self) -> Option<Vec<f64>> {
        let ls = idim_ls(self.regression, Default::default()).ok()?;
        let standard = self.nearest(&ls.theta)?;
        let start = self.problem.estimated.from_standard(&standard);
        self.current = Parameters::Standard { theta: self.followed(standard), tolerance: 1.0 };
        Some(start)
    }

    /// The same, where it has not started there already.
    pub(super) fn start_near_ls(&mut self) -> Option<Vec<f64>> {
        if self.before.is_some() { None } else { self.near_ls() }
    }

    /// Makes an estimate, or a mean of several, what is simulated, with tolerances `tolerance` times as large, or less where it
    /// must be; that factor.
    pub(super) fn simulate(&mut self, estimate: &[f64], tolerance: f64) -> f64 {
        let theta = self.standard(estimate);
        let tolerance = if self.is_needed { tolerance.min(FINE) } else { tolerance };
        self.current = Parameters::Standard { theta, tolerance };
        tolerance
    }

    /// The estimate that counts: of DIDIM, once it leaves what can be simulated, that of the physical set.
    pub(super) fn revise(&mut self, fit: Fit, z: &Matrix) -> Fit {
        match self.design {
            DesignMatrix::Measured => fit,
            DesignMatrix::Simulated => self.constrain(fit, z),
        }
    }

    /// Start values of a fit, the first one first: those given and those nearest to the estimate of LS, if they can be
    /// simulated.
    pub(super) fn starts(&mut self, start: &[f64]) -> Vec<Vec<f64>> {
        let given = self.is_safe(&self.problem.estimated.to_standard(start), PART_AT_START).then(|| start.to_vec());
        let starts: Vec<_> = given.into_iter().chain(self.near_ls()).collect();
        self.before = None;
        if starts.is_empty() { vec![start.to_vec()] } else { starts }
    }

    /// What a step leads to: `theta` where it can be simulated and need not be physical, else the parameters of the physical set
    /// nearest to it in the metric `|R (theta - theta_hat)|` of the step.
    pub(super) fn admit(&mut self, theta: Vec<f64>, r: &Matrix) -> Vec<f64> {
        let estimated = &self.problem.estimated;
        self.is_needed = self.is_kept_in_set || !self.is_safe(&estimated.to_standard(&theta), margin(self.design).part);
        if !self.is_needed {
            return theta;
        }
        let options = InteriorOptions { pull: PULL_OF_FITS, ..margin(self.design).options };
        self.nearest_in(estimated, r, &theta, &options).map_or(theta, |standard| estimated.from_standard(&standard))
    }

    /// Whether what was admitted last is in the physical set because free estimates could not be simulated well enough.
    pub(super) fn is_needed(&self) -> bool {
        self.is_needed
    }

    /// Lets every step of a fit lead to physical parameters from now on; false where they did already, or there is no such set.
    pub(super) fn keep_in_set(&mut self) -> bool {
        self.set.is_ok() && !std::mem::replace(&mut self.is_kept_in_set, true)
    }

    /// Asks for physical parameters from now on; false where they were already.
    pub(super) fn require(&mut self) -> bool {
        !std::mem::replace(&mut self.is_needed, true)
    }

    /// What is reported of it; nothing where estimates were simulated as they are.
    pub(super) fn note(&self) -> Option<String> {
        if let Some(e) = &self.failure {
            return Some(format!(
                "simulates its estimate, since no physically consistent parameters near it were found: {e}"
            ));
        }
        self.before.as_ref()?;
        let note = match self.design {
            DesignMatrix::Measured => {
                "simulates the physically consistent robot nearest to its estimate (the estimate itself is physically impossible), without \
                 Coulomb friction"
            }
            DesignMatrix::Simulated if self.is_kept_in_set => {
                "estimates in the physically consistent set, since near the minimum simulations of its free estimates fail, or \
                 vary too much from one to the next; deviations are those of a free estimate"
            }
            DesignMatrix::Simulated if self.is_needed => {
                "estimates in the physically consistent set, since its free estimates could not be simulated; deviations \
                 are those of a free estimate"
            }
            DesignMatrix::Simulated => {
                "starts from the physically consistent parameters nearest to the estimate of LS, since its start values are \
                 no robot's"
            }
        };
        Some(note.to_owned())
    }

    /// Standard parameters that stand for an estimate in simulations.
    fn standard(&mut self, estimate: &[f64]) -> Vec<f64> {
        if let Some((_, standard)) = self.constrained.as_ref().filter(|(of, _)| of == estimate) {
            return standard.clone();
        }
        let standard = self.problem.estimated.to_standard(estimate);
        self.is_needed |= !self.is_safe(&standard, margin(self.design).part);
        if !self.is_needed {
            return standard;
        }
        match self.nearest(estimate) {
            Some(nearest) => self.followed(nearest),
            None => standard,
        }
    }

    /// The robot whose motion IV takes for instruments in the place of an estimate that is none: without Coulomb friction, so
    /// that the simulated loop follows the reference. A wrist with little inertia and much friction sticks where its
    /// controller is weak, and what does not move is no instrument. Where that has not settled the estimates, viscous
    /// friction holds it back too. DIDIM fits the torques of the robot as it is.
    fn followed(&mut self, mut standard: Vec<f64>) -> Vec<f64> {
        if self.design == DesignMatrix::Simulated {
            return standard;
        }
        self.simulations += 1;
        let without_viscous = self.simulations > WITH_VISCOUS;
        let table = self.problem.model.parameter_table();
        let is_left_out = |i: &usize| {
            let quantity = table.get(*i).quantity;
            quantity.role() == Role::CoulombFriction || (without_viscous && quantity.is_friction())
        };
        (0..standard.len()).filter(is_left_out).for_each(|i| standard[i] = 0.0);
        standard
    }

    /// The estimate of the physical set nearest to a free one, in the metric of its own Z.
    fn constrain(&mut self, fit: Fit, z: &Matrix) -> Fit {
        self.constrained = None;
        let standard = self.problem.estimated.to_standard(&fit.theta);
        self.is_needed |= !self.is_safe(&standard, margin(self.design).part);
        if !self.is_needed {
            return fit;
        }
        self.r = Some(triangular_factor(self.problem, self.regression, Some(z)));
        let Some(standard) = self.nearest(&fit.theta) else { return fit };
        let theta = self.problem.estimated.from_standard(&standard);
        self.constrained = Some((theta.clone(), standard));
        fit.moved_to(theta, self.regression, z)
    }

    /// The parameters of the interior nearest to an estimate.
    fn nearest(&mut self, estimate: &[f64]) -> Option<Vec<f64>> {
        let (problem, base) = (self.problem, &self.problem.base);
        let r = self.r.take().unwrap_or_else(|| triangular_factor(problem, self.regression, None));
        let options = margin(self.design).options;
        let standard = self.nearest_in(base, &r, &in_base(base, &problem.estimated, estimate), &options);
        self.r = Some(r);
        standard
    }

    fn nearest_in(
        &mut self,
        base: &BaseParameters,
        r: &Matrix,
        estimate: &[f64],
        options: &InteriorOptions,
    ) -> Option<Vec<f64>> {
        let set = match self.set {
            Ok(set) => set,
            Err(e) => {
                self.failure = Some(e.clone());
                return None;
            }
        };
        match nearest_to_simulate(set, base, r, estimate, options, self.before.as_ref()) {
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
        let drives = !margin(self.design).may_drive && set.parameter_table().iter().zip(standard).any(drives);
        !drives && self.simulator.has_mass_matrix_above(standard, part, set.a_priori())
    }
}

/// The triangular factor of the weighted matrix of all base parameters: of X, with the columns of Z for those estimated where
/// it is given.
fn triangular_factor(problem: &Problem, regression: &Regression, z: Option<&Matrix>) -> Matrix {
    let all = problem.all_columns();
    let Some(z) = z else { return regression.whiten_matrix(&all.x).triangular_factor() };
    let mut x = all.x.as_ref().clone();
    let columns = problem.base.columns();
    for (j, c) in problem.estimated.columns().into_iter().enumerate() {
        if let Some(place) = columns.iter().position(|&of_base| of_base == c) {
            x.column_mut(place).copy_from_slice(z.column(j));
        }
    }
    regression.whiten_matrix(&x).triangular_factor()
}

/// All base parameters: those estimated, zeros elsewhere.
fn in_base(base: &BaseParameters, estimated: &BaseParameters, estimate: &[f64]) -> Vec<f64> {
    let standard = estimated.to_standard(estimate);
    base.columns().into_iter().map(|c| standard[c]).collect()
}
