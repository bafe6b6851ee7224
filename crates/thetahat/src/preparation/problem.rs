//! The regression problem of one friction model over all recordings: base parameters, decimation, y and X.

use std::sync::{Arc, OnceLock};

use super::{
    error::PreparationError,
    filtered::FilteredRecording,
    settings::{Case, NamedChoice, ParameterChoice},
    setup::{Basis, Setup},
    simulable::Simulable,
};
use thetahat_estimation::{
    identification::{
        Assembly, DependentColumn, Elimination, Fit, RowMask, SeparatedColumns, eliminate, idim_ls, nested_f_test,
    },
    regression::{Regression, RowLayout},
    signal::{Decimator, SignalError},
    statistics::FTest,
};
use thetahat_ground::series::Series;
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters},
    consistency::{ConsistencyError, ConsistentSet},
    dynamics::Model,
};

/// The regression of one friction model.
pub(crate) struct Problem {
    pub(crate) model: Model,
    /// All base parameters.
    pub(crate) base: BaseParameters,
    /// Those that are estimated.
    pub(crate) estimated: BaseParameters,
    pub(crate) elimination: Option<Elimination>,
    /// The columns of the base that the motion does not separate from others, which are left out.
    pub(crate) dependent: Vec<DependentColumn>,
    /// The parallel filter of each recording.
    pub(crate) decimators: Vec<Decimator>,
    /// The samples of each recording that make no rows because a joint is near rest; none if all make rows.
    pub(crate) masks: Vec<Option<Arc<RowMask>>>,
    /// The rows without weights.
    pub(crate) regression: Regression,
    /// The same with X of all base parameters, where fewer are estimated.
    full: Option<Regression>,
    /// What a robot made of bodies can have, once it was asked for.
    pub(super) consistent_set: OnceLock<Result<ConsistentSet, ConsistencyError>>,
}

/// Which base parameters are estimated.
struct SelectedParameters {
    estimated: BaseParameters,
    /// Their columns among those of the base.
    columns: Vec<usize>,
    elimination: Option<Elimination>,
    dependent: Vec<DependentColumn>,
}

impl Setup<'_> {
    /// Builds y and X for the friction model of a case, and chooses the parameters among those that the motion separates.
    pub(crate) fn problem(&self, case: &Case, recordings: &[&FilteredRecording]) -> Result<Problem, PreparationError> {
        let choice = &self.settings.parameters.estimate;
        self.problem_on(self.basis(case)?, recordings, choice)?.of_separated(choice)
    }

    /// Builds y and X of other recordings for parameters that are estimated already.
    pub(crate) fn validation_problem(
        &self,
        case: &Case,
        recordings: &[&FilteredRecording],
        estimated: &BaseParameters,
    ) -> Result<Problem, PreparationError> {
        let names = estimated.parameters().iter().map(|p| p.name.clone()).collect();
        self.problem_on(self.basis(case)?, recordings, &ParameterChoice::List(names))
    }

    /// Builds y and X of recordings for the parameters chosen from a base.
    pub(crate) fn problem_on(
        &self,
        Basis { model, base }: Basis,
        recordings: &[&FilteredRecording],
        choice: &ParameterChoice,
    ) -> Result<Problem, PreparationError> {
        self.require_rows(recordings, choice, base.len())?;
        let decimator = |r: &&FilteredRecording| r.decimator(&self.settings.signal);
        let decimators = recordings.iter().map(decimator).collect::<Result<Vec<_>, _>>()?;
        let rows: Vec<usize> = decimators.iter().map(Decimator::rows).collect();
        let masks: Vec<_> = recordings.iter().map(|r| r.mask(&model, &base.columns())).collect();
        let layout = RowLayout::new(model.coordinate_count(), &rows);
        let layout = with_shares(layout, &decimators, &masks)?;
        let (mut matrices, mut vectors) = (Vec::new(), Vec::new());
        for (recording, (decimator, mask)) in recordings.iter().zip(decimators.iter().zip(&masks)) {
            let assembly = Assembly::new(&model, &base.columns(), decimator.clone()).masked(mask.clone());
            matrices.push(recording.observation_matrix(&assembly)?);
            vectors.push(assembly.measurement_vector(&recording.centred_torque())?);
        }
        let (x, y) = (layout.stack_matrices(matrices), layout.stack_vectors(vectors));
        let problem = self.problem_of_rows(Basis { model, base }, Regression::new(x, y, layout), choice)?;
        Ok(Problem { decimators, masks, ..problem })
    }

    /// The problem of rows with all columns of a base, for the parameters chosen from it.
    pub(crate) fn problem_of_rows(
        &self,
        Basis { model, base }: Basis,
        all: Regression,
        choice: &ParameterChoice,
    ) -> Result<Problem, PreparationError> {
        let SelectedParameters { estimated, columns, elimination, dependent } =
            self.choose(choice, (&model, &base), &all)?;
        let (regression, full) =
            if columns.len() == base.len() { (all, None) } else { (all.with_columns(&columns), Some(all)) };
        let (decimators, masks, consistent_set) = (Vec::new(), Vec::new(), OnceLock::new());
        Ok(Problem {
            model,
            base,
            estimated,
            elimination,
            dependent,
            decimators,
            masks,
            regression,
            full,
            consistent_set,
        })
    }

    /// The parameters of a base that are estimated, where no recording has to choose them.
    pub(crate) fn estimated(&self, Basis { model, base }: &Basis) -> Result<BaseParameters, PreparationError> {
        match &self.settings.parameters.estimate {
            ParameterChoice::List(names) => Ok(base.select(model.parameter_table(), names)?),
            ParameterChoice::Base | ParameterChoice::Named(_) => Ok(base.clone()),
        }
    }

    /// A decimation must leave more rows than there are parameters, with which the estimation begins.
    fn require_rows(
        &self,
        recordings: &[&FilteredRecording],
        choice: &ParameterChoice,
        base: usize,
    ) -> Result<(), PreparationError> {
        let parameters = match choice {
            ParameterChoice::List(names) => names.len(),
            ParameterChoice::Base | ParameterChoice::Named(_) => base,
        };
        let decimation = self.settings.signal.decimation;
        let rows_of = |r: &&FilteredRecording| r.motion.q.channels() * r.used_samples().count().div_ceil(decimation);
        let rows: usize = recordings.iter().map(rows_of).sum();
        let expected = format!("a smaller factor or a longer window: {rows} rows are left for {parameters} parameters");
        PreparationError::require(rows > parameters, "[signal] decimation", &expected, decimation)
    }

    /// Chooses parameters from the regression of all base parameters; an elimination begins with those that the motion separates.
    fn choose(
        &self,
        choice: &ParameterChoice,
        (model, base): (&Model, &BaseParameters),
        all: &Regression,
    ) -> Result<SelectedParameters, PreparationError> {
        base.select(model.parameter_table(), &self.settings.parameters.show)?;
        let name = |i: usize| base.parameters()[i].name.clone();
        let (names, elimination, dependent): (Vec<String>, _, _) = match choice {
            ParameterChoice::List(names) => (names.clone(), None, Vec::new()),
            ParameterChoice::Base | ParameterChoice::Named(NamedChoice::Base | NamedChoice::Drives) => {
                ((0..base.len()).map(name).collect(), None, Vec::new())
            }
            ParameterChoice::Named(NamedChoice::Essential) => {
                let SeparatedColumns { kept, dependent } = SeparatedColumns::of(&all.x);
                let elimination = self.essential((model, base), all, &kept);
                let kept = elimination.as_ref().map_or(kept, |elimination| elimination.kept.clone());
                (kept.into_iter().map(name).collect(), elimination, dependent)
            }
        };
        let (estimated, columns) = selected((model, base), &names)?;
        Ok(SelectedParameters { estimated, columns, elimination, dependent })
    }

    /// The elimination among some columns of the base; none if even these cannot be estimated, and the runs say why.
    fn essential(&self, of: (&Model, &BaseParameters), all: &Regression, separated: &[usize]) -> Option<Elimination> {
        let rule = self.settings.parameters.elimination;
        let simulable = Simulable::new(self.robot, of, all, separated);
        let in_base = |columns: &[usize]| columns.iter().map(|&c| separated[c]).collect::<Vec<_>>();
        let is_possible = |kept: &[usize], theta: &[f64]| simulable.is_possible(&in_base(kept), theta);
        let found = eliminate(&all.with_columns(separated), rule, &is_possible).ok()?;
        Some(Elimination { kept: in_base(&found.kept), eliminated: in_base(&found.eliminated), ..found })
    }
}

/// Parameters of a base by their names, with their columns.
fn selected(
    (model, base): (&Model, &BaseParameters),
    names: &[String],
) -> Result<(BaseParameters, Vec<usize>), PreparationError> {
    let estimated = base.select(model.parameter_table(), names)?;
    let column = |p: &BaseParameter| base.columns().iter().position(|&c| c == p.kept);
    let columns = estimated.parameters().iter().filter_map(column).collect();
    Ok((estimated, columns))
}

impl Problem {
    /// The same without the parameters that the motion does not separate from others, where all of a base are to be estimated.
    pub(crate) fn of_separated(self, choice: &ParameterChoice) -> Result<Self, PreparationError> {
        let is_whole = match choice {
            ParameterChoice::Base | ParameterChoice::Named(NamedChoice::Base | NamedChoice::Drives) => true,
            ParameterChoice::List(_) | ParameterChoice::Named(NamedChoice::Essential) => false,
        };
        if !is_whole {
            return Ok(self);
        }
        let SeparatedColumns { kept, dependent } = SeparatedColumns::of(&self.regression.x);
        if dependent.is_empty() {
            return Ok(self);
        }
        let names: Vec<String> = kept.iter().map(|&c| self.base.parameters()[c].name.clone()).collect();
        let (estimated, columns) = selected((&self.model, &self.base), &names)?;
        let regression = self.regression.with_columns(&columns);
        Ok(Self { estimated, dependent, full: Some(self.regression), regression, ..self })
    }

    /// The rows with X of all base parameters.
    pub(crate) fn all_columns(&self) -> &Regression {
        self.full.as_ref().unwrap_or(&self.regression)
    }

    /// Whether the estimate of a base parameter includes a part of one that the motion does not separate from it.
    pub(crate) fn includes_another(&self, name: &str) -> bool {
        let mut including = self.dependent.iter().flat_map(|dependent| &dependent.spanned_by);
        including.any(|&column| self.base.parameters()[column].name == name)
    }

    /// The columns of the estimated parameters among those of the base.
    pub(crate) fn estimated_columns(&self) -> Vec<usize> {
        let columns = self.base.columns();
        let place = |p: &BaseParameter| columns.iter().position(|&c| c == p.kept);
        self.estimated.parameters().iter().filter_map(place).collect()
    }

    /// The assembly of one recording.
    pub(crate) fn assembly(&self, recording: usize) -> Assembly<'_> {
        self.assembly_of(recording, &self.model, &self.estimated.columns())
    }

    /// The assembly of other columns in the rows of one recording.
    pub(crate) fn assembly_of<'m>(&self, recording: usize, model: &'m Model, columns: &[usize]) -> Assembly<'m> {
        let mask = self.masks[recording].clone();
        Assembly::new(model, columns, self.decimators[recording].clone()).masked(mask)
    }

    /// One series for each recording at the decimated instants, one vector per joint.
    pub(crate) fn at_rows(&self, series: &[&Series]) -> Vec<Vec<f64>> {
        let of_recording =
            |j| self.decimators.iter().zip(series).flat_map(move |(d, s)| d.kept().map(move |k| s.sample(k)[j]));
        (0..self.model.coordinate_count()).map(|j| of_recording(j).collect()).collect()
    }

    /// The F-test of a fit of the estimated parameters against all base parameters by least squares, where they are fewer.
    pub(crate) fn full_model_test(&self, fit: &Fit) -> Option<FTest> {
        full_model_test(self.full.as_ref()?, fit)
    }
}

/// The layout with the parts of its rows that the masks of the recordings leave.
fn with_shares(
    layout: RowLayout,
    decimators: &[Decimator],
    masks: &[Option<Arc<RowMask>>],
) -> Result<RowLayout, SignalError> {
    if masks.iter().all(Option::is_none) {
        return Ok(layout);
    }
    let shares = |(decimator, mask): (&Decimator, &Option<Arc<RowMask>>)| match mask {
        Some(mask) => mask.shares(decimator),
        None => Ok(vec![1.0; decimator.rows() * layout.joints()]),
    };
    let shares = decimators.iter().zip(masks).map(shares).collect::<Result<_, _>>()?;
    let stacked = layout.stack_vectors(shares);
    Ok(layout.with_shares(Some(stacked)))
}

/// The F-test of a fit against least squares with all columns.
fn full_model_test(full: &Regression, fit: &Fit) -> Option<FTest> {
    nested_f_test(full, fit, &idim_ls(full, Default::default()).ok()?)
}
