//! Laws of torque terms compared joint by joint: each is added to the model as described, or taken out of it, and judged by
//! cross-validation and by an information criterion that counts the independent samples alone.

use super::{
    column_source::ColumnSource,
    profile::{ProfileMinimum, Projection},
};
use crate::{
    diagnosis::independent_rows,
    preparation::PreparationError,
    run::{
        identification::{CaseProblem, Identification},
        prepared::filtered,
        validation::cross_validation::{Folds, without_each},
    },
};
use thetahat_estimation::{
    identification::{Method, idim_ls},
    regression::Regression,
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr};
use thetahat_model::robot::{Shape, Stribeck, StribeckLaw, TermColumn, TermDescription};
use thetahat_report::results::{JointTermComparison, TermComparison, TermLaw};

/// Change of the criterion below which the evidence for a law is very strong (R. E. Kass, A. E. Raftery, "Bayes factors",
/// Journal of the American Statistical Association 90, 1995, p. 777).
pub(in crate::run) const VERY_STRONG: f64 = -10.0;
/// The model as described, or with another law.
struct ComparedTerm {
    estimates: Vec<f64>,
    /// Mean squares of the residual, joint by joint.
    squares: Vec<f64>,
    residual: Vec<f64>,
    /// Relative error of the prediction of what was left out, percent, joint by joint.
    cross_validation: Vec<Option<f64>>,
}

/// The comparison of one problem.
struct Comparison<'a> {
    source: ColumnSource<'a>,
    /// With one weight for each joint.
    regression: Regression,
    weights: Vec<f64>,
    folds: Option<Folds>,
    as_described: ComparedTerm,
    /// Independent samples of each joint.
    effective: Vec<f64>,
}

impl Identification {
    /// Compares laws of torque terms for every joint; none if the model as described has no estimate.
    ///
    /// # Errors
    /// [`PreparationError`] where a recording cannot be filtered.
    pub(in crate::run) fn compare_terms(
        &self,
        problem: &CaseProblem,
    ) -> Result<Option<TermComparison>, PreparationError> {
        let of_recordings: Vec<f64> = self.main.iter().map(|p| p.filtered.recording.weight).collect();
        let rows = problem.problem.regression.y.len();
        let weights =
            problem.weights(self.setup().settings, Method::IDIM_WLS, &of_recordings).unwrap_or_else(|| vec![1.0; rows]);
        let problem = &problem.problem;
        let regression = problem.regression.with_weights(Some(weights.clone()));
        let folds = self.folds(problem);
        let Some(as_described) = judge(&regression, folds.as_ref()) else { return Ok(None) };
        let of_joints = regression.layout.runs(&as_described.residual);
        let effective = of_joints.iter().map(|stretches| independent_rows(stretches)).collect();
        let recordings = filtered(&self.main);
        let source = ColumnSource { setup: self.setup(), recordings: &recordings, problem };
        let comparison = Comparison { source, regression, weights, folds, as_described, effective };
        let joints = (0..source.robot().coordinate_count()).map(|c| comparison.joint(c)).collect::<Result<_, _>>()?;
        Ok(Some(TermComparison { effective_samples: comparison.effective.iter().sum(), joints }))
    }
}

impl Comparison<'_> {
    fn joint(&self, coordinate: usize) -> Result<JointTermComparison, PreparationError> {
        let robot = self.source.robot();
        let joint = robot.joints[robot.joint_of(coordinate)].name.clone();
        let mut laws = Vec::new();
        for description in self.candidates(&joint) {
            laws.extend(self.with(coordinate, &description)?);
        }
        laws.extend(self.without(coordinate));
        let judged = self.as_described.cross_validation[coordinate];
        recommend(&mut laws, judged);
        Ok(JointTermComparison { joint, cross_validation_relative_error_percent: judged, laws })
    }

    /// The laws that can be added to a joint.
    fn candidates(&self, joint: &str) -> Vec<TermDescription> {
        let joints = Some(vec![joint.to_owned()]);
        let (velocity, exponent, profile) = (1.0, 1.0, false);
        let mut all = vec![
            TermDescription::ExponentialStribeck { joints: joints.clone(), velocity, exponent, profile },
            TermDescription::Stribeck { joints: joints.clone(), velocity, exponent, profile },
            TermDescription::PolynomialViscous { joints: joints.clone(), powers: vec![2] },
            TermDescription::PolynomialViscous { joints: joints.clone(), powers: vec![2, 3] },
            TermDescription::AsymmetricViscous { joints: joints.clone() },
            TermDescription::LoadFriction { joints: joints.clone() },
            TermDescription::JointSpring { joints: joints.clone(), rest_deg: None, rest_m: None },
            TermDescription::MotorHarmonics { joints: joints.clone(), harmonics: vec![1.0, 2.0] },
        ];
        let mut recordings = self.source.recordings.iter().map(|r| &r.recording.channels);
        let first = recordings.next().into_iter().flat_map(|channels| channels.iter());
        for (channel, series) in first {
            let reference = series.values().iter().sum::<f64>() / series.values().len().max(1) as f64;
            let (joints, channel) = (joints.clone(), channel.clone());
            let reference = reference.round();
            all.push(TermDescription::ChannelCoulomb { joints: joints.clone(), channel: channel.clone(), reference });
            all.push(TermDescription::ChannelViscous { joints, channel, reference });
        }
        all
    }

    /// A law added to the model as described; none if the robot has it, or the motion does not separate it.
    fn with(&self, coordinate: usize, description: &TermDescription) -> Result<Option<TermLaw>, PreparationError> {
        let mut candidate = self.source.robot().clone();
        // What the robot has already, or cannot have, is no candidate.
        if candidate.add_terms(std::slice::from_ref(description)).is_err() {
            return Ok(None);
        }
        let mut columns = candidate.terms.split_off(self.source.robot().terms.len());
        let mut description = description.clone();
        if let [TermColumn { shape: Shape::Stribeck(Stribeck { law, .. }), .. }] = columns[..] {
            let Some(found) = self.profile(&columns[0], law)? else { return Ok(None) };
            columns[0].shape = Shape::Stribeck(found);
            description = description.with_constants(found.velocity, found.exponent);
        }
        // A constant torque is the joint's offset, where that is estimated.
        let varies = |column: &TermColumn| column.shape != Shape::Constant;
        let varying: Vec<TermColumn> = columns.iter().filter(|column| varies(column)).cloned().collect();
        let Some((judged, parameters)) =
            self.judge_with(columns)?.map_or_else(|| self.judge_with(varying), |j| Ok(Some(j)))?
        else {
            return Ok(None);
        };
        let before = judged.estimates.len() - parameters.len();
        Ok(Some(TermLaw {
            law: description.kind().to_owned(),
            estimates: judged.estimates[before..].to_vec(),
            cross_validation_relative_error_percent: judged.cross_validation[coordinate],
            criterion_change: self.criterion_change(&judged, parameters.len() as f64),
            parameters,
            recommended: false,
            description: description.to_toml(),
        }))
    }

    /// The model as described with more columns, and the names of their parameters; none if they are dependent.
    fn judge_with(&self, columns: Vec<TermColumn>) -> Result<Option<(ComparedTerm, Vec<String>)>, PreparationError> {
        let parameters: Vec<String> = columns.iter().map(|c| c.parameter.clone()).collect();
        let added = self.source.columns(columns)?;
        let x = Matrix::side_by_side(&[&self.regression.x, &added]);
        Ok(judge(&self.regression.with_matrix(x), self.folds.as_ref()).map(|judged| (judged, parameters)))
    }

    /// The model as described without each of the joint's terms.
    fn without(&self, coordinate: usize) -> Vec<TermLaw> {
        let (robot, problem) = (self.source.robot(), self.source.problem);
        let own = robot.joint_of(coordinate);
        let table = problem.model.parameter_table();
        let kept: Vec<usize> = problem.estimated.columns();
        let mut laws = Vec::new();
        for (number, description) in robot.term_descriptions.iter().enumerate() {
            let is_own = |i: &usize| {
                let parameter = table.get(kept[*i]);
                let of_term = robot.terms.iter().find(|t| parameter.own_name.as_deref() == Some(&t.parameter));
                of_term.is_some_and(|t| t.term == number && t.joint == own)
            };
            let taken: Vec<usize> = (0..kept.len()).filter(is_own).collect();
            let left: Vec<usize> = (0..kept.len()).filter(|i| !taken.contains(i)).collect();
            let judged = (!taken.is_empty()).then(|| judge(&self.regression.with_columns(&left), self.folds.as_ref()));
            let Some(judged) = judged.flatten() else { continue };
            laws.push(TermLaw {
                law: format!("without {}", description.kind()),
                parameters: taken.iter().map(|&i| problem.estimated.parameters()[i].name.clone()).collect(),
                estimates: Vec::new(),
                cross_validation_relative_error_percent: judged.cross_validation[coordinate],
                criterion_change: self.criterion_change(&judged, -(taken.len() as f64)),
                recommended: false,
                description: String::new(),
            });
        }
        laws
    }

    /// The constants of Stribeck friction added to the model as described; none if the recording does not identify them.
    fn profile(&self, column: &TermColumn, law: StribeckLaw) -> Result<Option<Stribeck>, PreparationError> {
        let projection = Projection::new(self.source, self.weights.clone(), &self.regression.x);
        let ProfileMinimum { stribeck, at_limit } = projection.profile(column, law)?;
        Ok((!at_limit).then_some(stribeck))
    }

    /// Change of `sum_j n_j log(squares_j) + k log(n)`, with the effective numbers of samples n_j.
    fn criterion_change(&self, judged: &ComparedTerm, more_parameters: f64) -> f64 {
        let squares = judged.squares.iter().zip(&self.as_described.squares);
        let fit: f64 = self.effective.iter().zip(squares).map(|(n, (with, without))| n * (with / without).ln()).sum();
        fit + more_parameters * self.effective.iter().sum::<f64>().ln()
    }
}

/// Estimates by weighted least squares, and predicts what is left out; none if the columns are dependent.
fn judge(regression: &Regression, folds: Option<&Folds>) -> Option<ComparedTerm> {
    let fit = idim_ls(regression, Default::default()).ok()?;
    let residual: Vec<f64> = regression.y.iter().zip(&fit.prediction).map(|(y, p)| y - p).collect();
    let layout = &regression.layout;
    let mean_square = |(joint, square): (usize, f64)| square / layout.rows_of_joint(joint).count().max(1) as f64;
    let cross_validation = match folds {
        None => vec![None; layout.joints()],
        Some(folds) => regression.joint_relative_errors_percent(&left_out(regression, folds)),
    };
    let squares = layout.squares(&residual).into_iter().enumerate().map(mean_square).collect();
    Some(ComparedTerm { estimates: fit.theta, squares, residual, cross_validation })
}

/// The prediction of each row from the folds that it does not belong to.
fn left_out(regression: &Regression, folds: &Folds) -> Vec<f64> {
    let mut prediction = vec![0.0; regression.y.len()];
    for others in without_each(regression, Method::IDIM_LS, None, folds) {
        let theta = PivotedQr::new(&others.triangle).solve(&others.right_side);
        let all = regression.x.times(&theta);
        others.rows.iter().for_each(|&row| prediction[row] = all[row]);
    }
    prediction
}

/// Marks the law with the best criterion, where that is very strong and the joint is predicted better.
pub(super) fn recommend(laws: &mut [TermLaw], as_described: Option<f64>) {
    let predicts_better = |law: &TermLaw| match (law.cross_validation_relative_error_percent, as_described) {
        (Some(with), Some(without)) => with < without || (law.description.is_empty() && with <= 1.001 * without),
        _ => false,
    };
    let is_better = |law: &&mut TermLaw| {
        let limit = if law.description.is_empty() { 0.0 } else { VERY_STRONG };
        law.criterion_change < limit && predicts_better(law)
    };
    let best = laws.iter_mut().filter(is_better).min_by(|a, b| a.criterion_change.total_cmp(&b.criterion_change));
    best.into_iter().for_each(|law| law.recommended = true);
}
