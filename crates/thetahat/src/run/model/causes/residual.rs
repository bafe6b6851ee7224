//! The whitened residual of free estimates, and what further columns explain of it.

use statrs::{
    distribution::{ChiSquared, ContinuousCDF},
    function::gamma::ln_gamma,
};

use super::cause::Cause;
use crate::run::model::{deviations::long_run_deviation, rows::ModelRows};
use thetahat_estimation::regression::RowLayout;
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, dot, norm};

/// Pivots below this part of the largest are of columns that the motion does not separate.
const RANK: f64 = 1e-7;
/// Part of a column outside what the regressor explains, below which no motion shows it.
const SEEN: f64 = 1e-6;
/// The same between the columns of one cause.
const OWN_RANK: f64 = 1e-3;
/// Least correlation of an instrument with its column.
const STRONG: f64 = 0.3;
/// Probability below which that of chi-squared is computed by the first term of its tail.
const LEAST: f64 = 1e-300;
/// Largest chi-squared that is looked for.
const LARGEST: f64 = 1e6;

pub(super) struct Residual {
    /// The columns that the motion separates, of all parameters, with their factor.
    separated: Vec<usize>,
    factor: PivotedQr,
    parameters: usize,
    /// The factor of the whitened rows, and an orthonormal basis of what they explain.
    scale: Vec<f64>,
    explained: Matrix,
    pub(super) rest: Vec<f64>,
    /// Norm of the whitened torques.
    torque: f64,
    pub(super) layout: RowLayout,
    pub(super) candidates: Vec<Candidate>,
}

/// A cause with its whitened columns, and what of them is outside of what is explained.
pub(super) struct Candidate {
    pub(super) cause: Cause,
    whitened: Matrix,
    sizes: Vec<f64>,
    columns: Matrix,
    /// The same of its instrument.
    instrument: Option<Matrix>,
}

/// What a cause explains.
pub(super) struct Evidence {
    pub(super) log10_p: f64,
    /// Estimate and deviation, of a cause with one column.
    pub(super) size: Option<[f64; 2]>,
    /// Coefficients of its columns.
    pub(super) coefficients: Vec<f64>,
    /// What it explains, percent of the whitened torques.
    pub(super) error_percent: f64,
}

impl Residual {
    /// The residual in all rows, or without those that are left out: near rest the torque depends on what friction did
    /// before, and on how well the reversal is sampled.
    pub(super) fn new(rows: &ModelRows, deviations: &[f64], left_out: &[bool]) -> Option<Self> {
        let mut scale: Vec<f64> = rows.layout.spread(|block| 1.0 / deviations[block.joint]);
        scale.iter_mut().zip(&rows.weights).for_each(|(s, weight)| *s *= weight);
        scale.iter_mut().zip(left_out).filter(|(_, out)| **out).for_each(|(s, _)| *s = 0.0);
        let x = rows.x.scale_rows(&scale);
        let (separated, factor) = separated(&x);
        let explained = leading(&factor, separated.len());
        let y: Vec<f64> = rows.y.iter().zip(&scale).map(|(y, s)| y * s).collect();
        let torque = norm(&y);
        let rest = outside(&explained, &y);
        let (parameters, layout, candidates) = (x.columns(), rows.layout.clone(), Vec::new());
        let residual = Self { separated, factor, parameters, scale, explained, rest, torque, layout, candidates };
        (torque > 0.0).then_some(residual)
    }

    /// The same with further causes, before any is put in.
    pub(super) fn with(mut self, causes: Vec<Cause>) -> Self {
        let candidates: Vec<Candidate> = causes.into_iter().map(|cause| self.candidate(cause)).collect();
        self.candidates.extend(candidates);
        self
    }

    fn candidate(&self, cause: Cause) -> Candidate {
        let whiten = |columns: Vec<f64>| Matrix::from_columns(self.rest.len(), columns).scale_rows(&self.scale);
        let whitened = whiten(cause.columns.concat());
        let instrument = cause.instrument.as_ref().map(|z| outside_all(&self.explained, &whiten(z.clone())));
        let sizes = (0..whitened.columns()).map(|c| norm(whitened.column(c))).collect();
        Candidate { columns: outside_all(&self.explained, &whitened), whitened, sizes, cause, instrument }
    }

    /// What a cause explains of the residual; none if no motion of the recordings shows it.
    pub(super) fn test(&self, candidate: usize) -> Option<Evidence> {
        let Candidate { cause, sizes, columns, instrument, .. } = &self.candidates[candidate];
        if let Some(found) = instrument.as_ref().and_then(|z| self.by_instrument(columns.column(0), z.column(0))) {
            return Some(found);
        }
        let seen: Vec<usize> = (0..columns.columns()).filter(|&c| norm(columns.column(c)) > SEEN * sizes[c]).collect();
        if seen.is_empty() || self.rest.len() <= seen.len() {
            return None;
        }
        let columns = columns.select_columns(&seen);
        let factor = PivotedQr::with_equal_columns(&columns);
        let rank = factor.rank(OWN_RANK).max(1);
        let basis = leading(&factor, rank);
        let along = basis.transpose_times(&self.rest);
        let statistic = dot(&along, &along);
        let log10_p = log10_tail(self.without_it(&basis.times(&along)), rank)? + (cause.searched as f64).log10();
        let mut coefficients = vec![0.0; cause.columns.len()];
        seen.iter().zip(basic_solution(&factor, &along)).for_each(|(&column, size)| coefficients[column] = size);
        let size = match cause.columns.len() {
            1 => coefficients.first().map(|size| [*size, 1.0 / norm(columns.column(0))]),
            _ => None,
        };
        let error_percent = 100.0 * statistic.sqrt() / self.torque;
        statistic.is_finite().then_some(Evidence { log10_p, size, coefficients, error_percent })
    }

    /// The squares of what a cause explains, in the long-run deviations of the residual without it: an error that is there makes the
    /// residual's own deviations as large as itself, and would hide.
    fn without_it(&self, explained: &[f64]) -> f64 {
        let rest: Vec<f64> = self.rest.iter().zip(explained).map(|(rest, explained)| rest - explained).collect();
        let joints = self.layout.by_joint(&self.rest).into_iter().zip(self.layout.by_joint(&rest));
        let joints = joints.zip(self.layout.by_joint(explained));
        let squares = |((with, without), explained): ((Vec<f64>, Vec<f64>), Vec<f64>)| {
            let larger = long_run_deviation(&with) / long_run_deviation(&without).max(f64::MIN_POSITIVE);
            dot(&explained, &explained) * larger.max(1.0).powi(2)
        };
        joints.map(squares).sum()
    }

    /// What one column explains, by an instrument z: `z^T rest / z^T c`. None if they are not alike.
    fn by_instrument(&self, column: &[f64], z: &[f64]) -> Option<Evidence> {
        let (length, along) = (norm(z), dot(z, column));
        if along < STRONG * length * norm(column) {
            return None;
        }
        let size = dot(z, &self.rest) / along;
        let deviation = length / along;
        let log10_p = log10_tail((size / deviation).powi(2), 1)?;
        let error_percent = 100.0 * size.abs() * norm(column) / self.torque;
        let evidence = Evidence { log10_p, size: Some([size, deviation]), coefficients: vec![size], error_percent };
        size.is_finite().then_some(evidence)
    }

    /// The size of an error of one column with which its evidence is so small by chance in one of two recordings.
    pub(super) fn size_beyond(&self, column: &[f64], log10_p: f64, count: usize) -> f64 {
        deviations_beyond(log10_p, count) / norm(column)
    }

    /// The size of an error of one column that explains a part of the torques, percent.
    pub(super) fn size_explaining(&self, column: &[f64], percent: f64) -> f64 {
        0.01 * percent * self.torque / norm(column)
    }

    /// The column of a cause of one number, outside what is explained.
    pub(super) fn column(&self, candidate: usize) -> &[f64] {
        self.candidates[candidate].columns.column(0)
    }

    /// The column of a cause outside others of its kind, which may be there too, and how many they are with it; none if it is
    /// alone or the motion does not separate it from them. Those that no motion shows are left out.
    pub(super) fn column_with_others(&self, candidate: usize) -> Option<(Vec<f64>, usize)> {
        let together = self.candidates.iter().find(|c| c.cause.members.contains(&candidate))?;
        // What no motion shows leaves rounding errors, which made as long as the others would hide a random direction.
        let is_shown = |k: &usize| norm(self.column(*k)) > SEEN * self.candidates[*k].sizes[0];
        let others: Vec<usize> =
            together.cause.members.iter().copied().filter(|&k| k != candidate).filter(is_shown).collect();
        if others.is_empty() {
            return Some((self.column(candidate).to_vec(), 1));
        }
        let columns: Vec<f64> = others.iter().flat_map(|&k| self.candidates[k].columns.column(0).to_vec()).collect();
        let factor = PivotedQr::with_equal_columns(&Matrix::from_columns(self.rest.len(), columns));
        let own = self.column(candidate);
        let rest = outside(&leading(&factor, factor.rank(OWN_RANK)), own);
        let is_seen = norm(&rest) > OWN_RANK * norm(own);
        is_seen.then_some((rest, others.len() + 1))
    }

    /// What a cause explains is explained from now on.
    pub(super) fn put_in(&mut self, candidate: usize) {
        let factor = PivotedQr::with_equal_columns(&self.candidates[candidate].columns);
        let basis = leading(&factor, factor.rank(OWN_RANK).max(1));
        self.rest = outside(&basis, &self.rest);
        for candidate in &mut self.candidates {
            candidate.columns = outside_all(&basis, &candidate.columns);
            candidate.instrument = candidate.instrument.as_ref().map(|z| outside_all(&basis, z));
        }
    }

    /// How far a cause moved each base parameter, in its deviations: `(X^T X)^-1 X^T c` times the cause's size. Zero for those that the
    /// motion does not separate from the others.
    pub(super) fn shifts(&self, candidate: usize, found: &Evidence) -> Vec<f64> {
        let whitened = &self.candidates[candidate].whitened;
        let mut shifts = vec![0.0; self.parameters];
        let moved = self.factor.solve(&whitened.times(&found.coefficients));
        let covariance = self.factor.inverse_gram();
        for (k, &column) in self.separated.iter().enumerate() {
            shifts[column] = moved[k] / covariance.at(k, k).max(f64::MIN_POSITIVE).sqrt();
        }
        shifts
    }
}

/// The columns that the motion separates, ascending, and the factor of these.
fn separated(x: &Matrix) -> (Vec<usize>, PivotedQr) {
    let factor = PivotedQr::with_equal_columns(x);
    let mut columns = factor.pivots()[..factor.rank(RANK)].to_vec();
    columns.sort_unstable();
    if columns.len() == x.columns() {
        return (columns, factor);
    }
    let factor = PivotedQr::with_equal_columns(&x.select_columns(&columns));
    (columns, factor)
}

/// Size, in deviations, of an error whose evidence in `count` columns has a probability of less than `log10_p` by chance in
/// one of two recordings.
fn deviations_beyond(log10_p: f64, count: usize) -> f64 {
    let (mut low, mut high) = (count as f64, LARGEST);
    while high - low > 1e-9 * high {
        let middle = 0.5 * (low + high);
        if log10_tail(middle, count).is_some_and(|p| p > log10_p) { low = middle } else { high = middle }
    }
    (high - (count as f64 - 1.0)).sqrt()
}

/// log10 of the probability that chi-squared of so many degrees of freedom is larger, however small it is.
pub(super) fn log10_tail(chi_squared: f64, freedom: usize) -> Option<f64> {
    let p = ChiSquared::new(freedom as f64).ok()?.sf(chi_squared);
    if p > LEAST {
        return Some(p.log10());
    }
    let half = 0.5 * chi_squared;
    let shape = 0.5 * freedom as f64;
    Some(((shape - 1.0) * half.ln() - half - ln_gamma(shape)) / std::f64::consts::LN_10)
}

/// The first orthonormal columns of a factorisation.
fn leading(factor: &PivotedQr, rank: usize) -> Matrix {
    factor.thin_q().select_columns(&(0..rank).collect::<Vec<_>>())
}

/// The sizes of columns, from what each leading orthonormal column explains; zero of those that the others span.
fn basic_solution(factor: &PivotedQr, along: &[f64]) -> Vec<f64> {
    let (r, pivots) = (factor.thin_r(), factor.pivots());
    let mut sizes = vec![0.0; pivots.len()];
    for i in (0..along.len()).rev() {
        let known: f64 = (i + 1..along.len()).map(|k| r.at(i, k) * sizes[pivots[k]]).sum();
        sizes[pivots[i]] = (along[i] - known) / r.at(i, i);
    }
    sizes
}

/// The part of a vector that is not along orthonormal columns.
fn outside(basis: &Matrix, rows: &[f64]) -> Vec<f64> {
    let inside = basis.times(&basis.transpose_times(rows));
    rows.iter().zip(inside).map(|(r, i)| r - i).collect()
}

fn outside_all(basis: &Matrix, columns: &Matrix) -> Matrix {
    columns.plus(&basis.times_matrix(&basis.transposed_times(columns)), -1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_report::results::CauseKind;

    const ROWS: usize = 400;

    /// Columns t, sin 3t, 2 sin 3t where they are three, and cos 7t as an error of the robot, which t and cos 7t explain in part.
    fn value(k: usize) -> [f64; 4] {
        let t = k as f64 / ROWS as f64;
        let (wave, error) = ((3.0 * t).sin(), (7.0 * t).cos());
        [t, wave, 2.0 * wave, error]
    }

    fn cause(column: impl Fn(usize) -> f64, members: Vec<usize>) -> Cause {
        let columns = vec![(0..ROWS).map(column).collect()];
        let (kind, subject) = (CauseKind::EncoderZero, String::new());
        Cause { kind, subject, unit: "rad", columns, instrument: None, members, searched: 1 }
    }

    fn residual(columns: &[usize], causes: Vec<Cause>) -> Residual {
        let x = Matrix::from_fn(ROWS, columns.len(), |k, c| value(k)[columns[c]]);
        let noise = |k: usize| 0.01 * (1e4 * (k as f64 + 0.5).sin()).fract();
        let y = (0..ROWS).map(|k| value(k)[0] + value(k)[1] + 0.3 * value(k)[3] + noise(k)).collect();
        let layout = RowLayout::new(1, &[ROWS]);
        let rows = ModelRows { x, y, layout, decimators: Vec::new(), weights: vec![1.0; ROWS] };
        Residual::new(&rows, &[0.01], &[false; ROWS]).unwrap().with(causes)
    }

    /// The quantile and the tail undo each other, and the tail goes on where the probability is no longer a number.
    #[test]
    fn probabilities_of_any_size_have_their_quantile() {
        for count in [1, 6, 40] {
            for log10_p in [-3.0, -5.0, -30.0, -290.0, -310.0, -2000.0] {
                let beyond = deviations_beyond(log10_p, count);
                let chi_squared = beyond * beyond + (count as f64 - 1.0);
                assert!((log10_tail(chi_squared, count).unwrap() / log10_p - 1.0).abs() < 1e-3, "{count} {log10_p}");
            }
        }
        // Five deviations of a normal number, two-sided.
        assert!((log10_tail(25.0, 1).unwrap() - 5.733e-7_f64.log10()).abs() < 1e-3);
    }

    /// What a cause moves is known of the separated columns where others are not separated.
    #[test]
    fn a_column_that_is_not_separated_hides_no_shift_of_the_others() {
        let shift_of_first = |columns: &[usize]| {
            let residual = residual(columns, vec![cause(|k| value(k)[3], Vec::new())]);
            let found = residual.test(0).unwrap();
            residual.shifts(0, &found)[0]
        };
        let [whole, deficient] = [&[0, 1][..], &[0, 1, 2]].map(shift_of_first);
        assert!(whole.abs() > 1.0 && (deficient / whole - 1.0).abs() < 1e-6, "{whole} {deficient}");
    }

    /// Of three columns of which two are one, two have sizes, and both together move the parameters as the fit without the third says.
    #[test]
    fn columns_that_are_not_separated_have_sizes_together() {
        let columns = [1, 2, 3].map(|which| (0..ROWS).map(|k| value(k)[which]).collect::<Vec<f64>>());
        let of = |columns: Vec<Vec<f64>>| {
            let residual = residual(&[0], vec![Cause { columns, ..cause(|k| value(k)[1], Vec::new()) }]);
            let found = residual.test(0).unwrap();
            (residual.shifts(0, &found)[0], found.coefficients)
        };
        let (whole, separated) = (of(columns.to_vec()), of(vec![columns[0].clone(), columns[2].clone()]));
        assert!(whole.0.abs() > 1.0 && (whole.0 / separated.0 - 1.0).abs() < 1e-6, "{whole:?} {separated:?}");
        assert!((whole.1[0] + 2.0 * whole.1[1] - separated.1[0]).abs() < 1e-9, "{whole:?} {separated:?}");
        assert!((whole.1[2] - 0.3).abs() < 0.05 && whole.1[..2].contains(&0.0), "{whole:?}");
    }

    /// Another cause that no motion shows hides nothing, whatever rounding leaves of it.
    #[test]
    fn a_cause_that_no_motion_shows_is_not_among_the_others() {
        let invisible = |sign: f64| cause(move |k| value(k)[0] * (1.0 + sign * 1e-13 * (k % 7) as f64), Vec::new());
        let with_others = |sign: f64| {
            let single = [cause(|k| value(k)[3], Vec::new()), invisible(sign)];
            let both = Cause { columns: single.iter().flat_map(|c| c.columns.clone()).collect(), ..single[0].clone() };
            let both = Cause { members: vec![0, 1], ..both };
            let [first, second] = single;
            residual(&[0, 1], vec![first, second, both]).column_with_others(0).unwrap()
        };
        let ((a, count), (b, _)) = (with_others(1.0), with_others(-1.0));
        assert_eq!((count, a), (1, b));
    }
}
