use super::estimated::Whitened;
use crate::preparation::Problem;
use thetahat_estimation::statistics::instrument_strength;
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, norm};
use thetahat_report::results::InstrumentResult;

/// Relative size of a diagonal entry below which projected columns count as dependent.
const DEPENDENT: f64 = 1e-10;

/// How strongly the simulated motion determines each parameter.
pub(super) fn instruments(problem: &Problem, iv: &Whitened<'_>) -> InstrumentResult {
    let f_statistics: Vec<f64> =
        instrument_strength(&iv.z, &iv.x).unwrap_or_default().iter().map(|s| s.f_statistic).collect();
    let weakest = f_statistics.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
    let scale: Vec<f64> = (0..iv.x.columns()).map(|c| norm(iv.x.column(c))).collect();
    let unit = Matrix::from_fn(iv.x.rows(), iv.x.columns(), |i, j| iv.x.at(i, j) / scale[j]);
    let projected = PivotedQr::new(&iv.z).thin_q().transposed_times(&unit);
    InstrumentResult {
        smallest_f: weakest.map_or(0.0, |(_, f)| *f),
        weakest: weakest.map(|(i, _)| problem.estimated.parameters()[i].name.clone()).unwrap_or_default(),
        rank: PivotedQr::new(&projected).rank(DEPENDENT),
        condition_number: projected.condition_number(),
        f_statistics,
    }
}
