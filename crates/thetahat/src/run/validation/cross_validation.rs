//! How well estimates predict what they have not seen.

use statrs::distribution::{ContinuousCDF, StudentsT};

use thetahat_estimation::{
    identification::{DesignMatrix, Divisor, EstimationError, Method, Needs, Outcome},
    regression::{Regression, relative_error_percent},
    simulation::Reference,
    trajectory::Moves,
};
use thetahat_ground::linear_algebra::Matrix;

/// Fewest moves of which one can be left out.
const FEWEST_MOVES: usize = 3;
/// Fewest recordings of which one can be left out: the others must identify all parameters.
const FEWEST_RECORDINGS: usize = 2;

/// Parts of a recording that is left out in pieces, where it has no moves that are known.
const PARTS: usize = 5;

/// The part, of five equal ones, to which each decimated row of a joint belongs.
pub(in crate::run) fn folds_by_part(rows: usize) -> Vec<usize> {
    (0..rows).map(|k| k * PARTS / rows.max(1)).collect()
}

/// The fifth of a period to which each decimated row of a joint belongs: other periods do not help to predict one, for they
/// are the same motion.
fn folds_by_phase(base_frequency_hz: f64, times: &[f64]) -> Vec<usize> {
    times.iter().map(|t| ((t * base_frequency_hz).fract() * PARTS as f64) as usize).collect()
}

/// The recording, from zero, to which each decimated row of a joint belongs.
fn folds_by_recording(recordings: Vec<usize>) -> Option<Vec<usize>> {
    let count = recordings.iter().max().map_or(0, |last| last + 1);
    (count >= FEWEST_RECORDINGS).then_some(recordings)
}

/// The move, from zero, to which each decimated row of a joint belongs: the last one that has started. None if the rows
/// belong to fewer than three.
fn folds_by_move(moves: &Moves, times: &[f64]) -> Option<Vec<usize>> {
    let starts: Vec<f64> = moves.moves().iter().map(|m| m.law.start_s).collect();
    let fold = |t: &f64| starts.iter().filter(|s| **s <= *t).count().saturating_sub(1);
    let folds: Vec<usize> = times.iter().map(fold).collect();
    let changes = folds.windows(2).filter(|pair| pair[0] != pair[1]).count();
    (changes + 1 >= FEWEST_MOVES).then_some(folds)
}

/// What is left out in turn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Folds {
    /// The fold of each decimated row of a joint, or of each row of all joints.
    pub(crate) of_row: Vec<usize>,
    /// The name of each fold.
    pub(crate) names: Vec<String>,
}

impl Folds {
    /// A move where three or more are known, else the same fifth of every period, else a part, of one recording with rows at
    /// these times.
    pub(in crate::run) fn of_one_recording(reference: Option<&Reference>, times: &[f64]) -> Self {
        let by_move = match reference {
            Some(Reference::Moves(moves)) => folds_by_move(moves, times),
            Some(Reference::Periodic(periodic)) => {
                let phases = folds_by_phase(periodic.series().base_frequency_hz(), times);
                return Self::numbered("fifth of the period", phases);
            }
            Some(Reference::Sampled(_)) | None => None,
        };
        let by_part = || Self::numbered("part", folds_by_part(times.len()));
        by_move.map_or_else(by_part, |of_row| Self::numbered("move", of_row))
    }

    /// A recording each, from the recording of each row; none for fewer than two.
    pub(crate) fn of_recordings<'n>(of_row: Vec<usize>, names: impl Iterator<Item = &'n str>) -> Option<Self> {
        let names = names.map(|name| format!("recording {name}")).collect();
        Some(Self { of_row: folds_by_recording(of_row)?, names })
    }

    /// Fifths of the stretches of time, from the stretch of each row.
    pub(crate) fn of_stretches(stretch_of_row: &[usize]) -> Self {
        let fifths = folds_by_part(stretch_of_row.iter().max().map_or(0, |last| last + 1));
        Self::numbered("part", stretch_of_row.iter().map(|stretch| fifths[*stretch]).collect())
    }

    /// Folds that are called by a word and their number from one. Those without rows, as moves before the window, are none.
    pub(in crate::run) fn numbered(word: &str, of_row: Vec<usize>) -> Self {
        let mut numbers = of_row.clone();
        numbers.sort_unstable();
        numbers.dedup();
        let place = |fold: &usize| numbers.binary_search(fold).unwrap_or_default();
        Self {
            of_row: of_row.iter().map(place).collect(),
            names: numbers.iter().map(|k| format!("{word} {}", k + 1)).collect(),
        }
    }
}

/// What leaving folds out shows.
pub(in crate::run) struct CrossValidation {
    /// The relative error of all predictions together.
    pub(in crate::run) relative_error_percent: f64,
    /// Its 95 % interval, from how much the folds differ.
    pub(in crate::run) interval_95_percent: Option<[f64; 2]>,
    /// The estimates without each fold.
    pub(in crate::run) theta: Vec<Vec<f64>>,
}

/// Leaves each fold out in turn, estimates from the others with the instruments or sensitivities given, and predicts the
/// one left out.
pub(in crate::run) fn leave_folds_out(
    regression: &Regression,
    method: Method,
    outcome: &Outcome,
    folds: &Folds,
) -> Option<CrossValidation> {
    let instruments = outcome.instruments.as_ref();
    let measured = &regression.y;
    let linear = regression.less(outcome.offset.as_deref());
    let regression = &linear;
    let rows = regression.y.len();
    let of_row: Vec<usize> = (0..rows).map(|k| folds.of_row[k % folds.of_row.len()]).collect();
    let parameters = parameters_of(regression, method, instruments);
    let equations = Equations::new(regression, method, instruments);
    let left = WithoutEach::new(&equations.rows, &of_row, (folds.names.len(), parameters));
    let predicting = match method.design() {
        DesignMatrix::Measured => regression.x.as_ref(),
        DesignMatrix::Simulated => instruments?,
    };
    let mut prediction = vec![0.0; rows];
    let mut estimates = Vec::with_capacity(folds.names.len());
    for fold in 0..folds.names.len() {
        let theta = equations.estimate(method, &left.triangle(fold)).ok()?;
        let all = predicting.times(&theta);
        let offset = |k: usize| measured[k] - regression.y[k];
        (0..rows).filter(|&k| of_row[k] == fold).for_each(|k| prediction[k] = all[k] + offset(k));
        estimates.push(theta);
    }
    Some(CrossValidation {
        relative_error_percent: relative_error_percent(measured, &prediction),
        interval_95_percent: interval(measured, &prediction, &of_row, folds.names.len()),
        theta: estimates,
    })
}

/// What the other folds say of the parameters: `|R theta - z|^2`.
pub(in crate::run) struct Others {
    pub(in crate::run) triangle: Matrix,
    pub(in crate::run) right_side: Vec<f64>,
    /// The rows left out.
    pub(in crate::run) rows: Vec<usize>,
}

/// For each fold the quadratic form of the others.
pub(in crate::run) fn without_each(
    regression: &Regression,
    method: Method,
    instruments: Option<&Matrix>,
    folds: &Folds,
) -> Vec<Others> {
    let (rows, parameters) = (regression.y.len(), regression.parameters());
    let of_row: Vec<usize> = (0..rows).map(|k| folds.of_row[k % folds.of_row.len()]).collect();
    let equations = Equations::new(regression, method, instruments);
    let left = WithoutEach::new(&equations.rows, &of_row, (folds.names.len(), parameters));
    let of_fold = |fold: usize| {
        let triangle = left.triangle(fold);
        let first = triangle.columns() - 1 - parameters;
        Others {
            right_side: triangle.column(first + parameters).to_vec(),
            triangle: triangle.select_columns(&(first..first + parameters).collect::<Vec<_>>()),
            rows: (0..rows).filter(|&k| of_row[k] == fold).collect(),
        }
    };
    (0..folds.names.len()).map(of_fold).collect()
}

/// The interval of `100 sqrt(R)`, where R is the ratio of the sums over the folds of the squared errors and the squared
/// torques: the folds as a sample of clusters (W. G. Cochran, "Sampling techniques", 1977, section 2.11), Student's t.
pub(in crate::run) fn interval(y: &[f64], prediction: &[f64], of_row: &[usize], folds: usize) -> Option<[f64; 2]> {
    let mut squares = vec![[0.0; 2]; folds];
    for ((y, p), fold) in y.iter().zip(prediction).zip(of_row) {
        squares[*fold][0] += (y - p).powi(2);
        squares[*fold][1] += y * y;
    }
    let [error, size] = squares.iter().fold([0.0; 2], |[e, s], f| [e + f[0], s + f[1]]);
    let count = folds as f64;
    let ratio = error / size;
    let spread: f64 = squares.iter().map(|[e, s]| (e - ratio * s).powi(2)).sum();
    let deviation = (count / (count - 1.0) * spread).sqrt() / size;
    let quantile = StudentsT::new(0.0, 1.0, count - 1.0).ok()?.inverse_cdf(0.975);
    let of_percent = 50.0 * deviation / ratio.sqrt() * quantile;
    let centre = 100.0 * ratio.sqrt();
    of_percent.is_finite().then(|| [(centre - of_percent).max(0.0), centre + of_percent])
}

/// Those that multiply the design: of the robot, and of the loop where the method estimates any.
fn parameters_of(regression: &Regression, method: Method, instruments: Option<&Matrix>) -> usize {
    match (method.design(), instruments) {
        (DesignMatrix::Simulated, Some(z)) => z.columns(),
        (DesignMatrix::Measured, _) | (DesignMatrix::Simulated, None) => regression.parameters(),
    }
}

/// The weighted rows from which a method estimates: Z where it needs instruments, X where its prediction is of the measured
/// motion, and y.
struct Equations {
    rows: Matrix,
    parameters: usize,
    /// Whether they begin with Z.
    has_instruments: bool,
    /// Whether X is among them.
    has_measured: bool,
}

impl Equations {
    fn new(regression: &Regression, method: Method, instruments: Option<&Matrix>) -> Self {
        let y = Matrix::from_fn(regression.y.len(), 1, |k, _| regression.y[k]);
        let z = match method.needs() {
            Needs::Measurement => None,
            Needs::Instruments | Needs::Sensitivities => instruments,
        };
        let has_measured = method.design() == DesignMatrix::Measured || z.is_none();
        let x = has_measured.then_some(regression.x.as_ref());
        let parts: Vec<&Matrix> = z.into_iter().chain(x).chain([&y]).collect();
        let rows = regression.whiten_matrix(&Matrix::side_by_side(&parts)).into_owned();
        Self {
            rows,
            parameters: parameters_of(regression, method, instruments),
            has_instruments: z.is_some(),
            has_measured,
        }
    }

    /// An estimate from these rows, or a triangle that stands for some of them.
    fn estimate(&self, method: Method, rows: &Matrix) -> Result<Vec<f64>, EstimationError> {
        let part = |first: usize| rows.select_columns(&(first..first + self.parameters).collect::<Vec<_>>());
        let z = self.has_instruments.then(|| part(0));
        let x = if self.has_measured && self.has_instruments { part(self.parameters) } else { part(0) };
        let regression = Regression::single_series(x, rows.column(rows.columns() - 1).to_vec());
        method.estimate(&regression, z.as_ref(), Divisor::default()).map(|fit| fit.theta)
    }
}

/// For each fold a triangle that stands for the rows of all others: as many rows as parameters, along the columns of Z, or
/// of X where there is none. What is across them has no part in an estimate.
struct WithoutEach {
    /// Those of the folds before each, and after it.
    before: Vec<Matrix>,
    after: Vec<Matrix>,
    parameters: usize,
}

impl WithoutEach {
    fn new(rows: &Matrix, of_row: &[usize], (folds, parameters): (usize, usize)) -> Self {
        let of_fold = |fold: usize| {
            let keep: Vec<bool> = of_row.iter().map(|f| *f == fold).collect();
            triangle(&[&rows.select_rows(&keep)], parameters)
        };
        let each: Vec<Matrix> = (0..folds).map(of_fold).collect();
        let nothing = Matrix::zeros(0, rows.columns());
        let before = sums(each.iter(), &nothing, parameters);
        let mut after = sums(each.iter().rev(), &nothing, parameters);
        after.reverse();
        Self { before, after, parameters }
    }

    fn triangle(&self, fold: usize) -> Matrix {
        triangle(&[&self.before[fold], &self.after[fold]], self.parameters)
    }
}

/// The first rows of the triangle of parts one below the other.
fn triangle(parts: &[&Matrix], rows: usize) -> Matrix {
    let r = Matrix::stack(parts).triangular_factor();
    r.row_range(0..rows.min(r.rows()))
}

/// For each triangle, the one of those ahead of it.
fn sums<'a>(each: impl Iterator<Item = &'a Matrix>, nothing: &Matrix, parameters: usize) -> Vec<Matrix> {
    let mut sum = nothing.clone();
    let add = |part: &Matrix| {
        let next = triangle(&[&sum, part], parameters);
        std::mem::replace(&mut sum, next)
    };
    each.map(add).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_estimation::trajectory::{Move, TimeLaw};

    #[test]
    fn folds_without_rows_are_none() {
        let folds = Folds::numbered("move", vec![3, 3, 5, 4]);
        assert_eq!(
            (folds.of_row, folds.names),
            (vec![0, 0, 2, 1], ["move 4", "move 5", "move 6"].map(String::from).into())
        );
    }

    /// Moves that start at 0, 1, 2 and 3 s.
    fn four_moves() -> Moves {
        let law = |start_s| TimeLaw { start_s, t1_s: 0.5, t2_s: 0.1, t3_s: 0.02 };
        let motion = |k: u8| Move { law: law(f64::from(k)), end: vec![f64::from(k)] };
        Moves::new(vec![0.0], (0..4).map(motion).collect()).unwrap()
    }

    #[test]
    fn fewer_than_three_moves_with_rows_are_no_folds() {
        assert_eq!(folds_by_move(&four_moves(), &[1.2, 1.8, 2.5, 3.1]), Some(vec![1, 1, 2, 3]));
        assert_eq!(folds_by_move(&four_moves(), &[1.2, 1.8, 2.5, 2.9]), None);
    }

    #[test]
    fn all_periods_of_a_phase_are_one_fold() {
        assert_eq!(folds_by_phase(0.5, &[0.1, 0.5, 1.9, 2.1, 2.5, 3.9]), [0, 1, 4, 0, 1, 4]);
    }

    const T_OF_TWO: f64 = 4.302_652_73;

    /// Three folds of one row each, by hand: errors 1, 1.5, 1 of torques 10, 10, 10.
    #[test]
    fn the_interval_is_that_of_a_ratio_of_sums() {
        let [low, high] = interval(&[10.0; 3], &[9.0, 8.5, 9.0], &[0, 1, 2], 3).unwrap();
        // R = 4.25 / 300; the errors less 100 R are -5/12, 10/12, -5/12.
        let ratio: f64 = 4.25 / 300.0;
        let half = 50.0 * (1.5_f64 * 150.0 / 144.0).sqrt() / 300.0 / ratio.sqrt() * T_OF_TWO;
        let centre = 100.0 * ratio.sqrt();
        assert!((high - centre - half).abs() < 1e-6 && (low - centre + half).abs() < 1e-6, "{low} {high}");
    }

    #[test]
    fn the_interval_does_not_go_below_zero() {
        let [low, high] = interval(&[10.0; 3], &[9.0, 8.0, 9.0], &[0, 1, 2], 3).unwrap();
        let half = 50.0 * (1.5_f64 * 6.0).sqrt() / 300.0 / 0.02_f64.sqrt() * T_OF_TWO;
        assert!((high - 100.0 * 0.02_f64.sqrt() - half).abs() < 1e-6, "{high}");
        assert_eq!(low, 0.0);
    }
}
