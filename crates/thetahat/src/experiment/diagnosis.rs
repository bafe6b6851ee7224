//! Diagnosis after the runs of a case: residuals, LS against IV, instruments, and DIDIM against IV.

use super::{Case, chain::Problem};
use crate::{
    identification::{Method, Outcome, Status},
    linear_algebra::{Matrix, PivotedQr, norm},
    results::{
        BiasExplanation, BiasedSimulatorResult, CaseDiagnosis, EndogeneityResult, InstrumentResult, JointResidual,
        ParameterDifference, ResidualResult, Verdict,
    },
    simulation::{BiasKind, SimulatorBias},
    statistics::{
        JointRows, SimulatorComparison, autocorrelation, instrument_strength, jarque_bera, levene, ljung_box,
        usual_lags, wu_hausman,
    },
};

/// Level of the tests.
const SIGNIFICANCE: f64 = 0.05;
/// Average difference of two estimates, in standard deviations, that starts to matter: an estimate that is off by so much
/// lies within its 95 % interval 92 % of the time.
pub(super) const HARMLESS_BELOW: f64 = 0.5;
/// Residual of DIDIM over that of IV below which the measured motion may be wrong as well as the simulated one. Wrong
/// simulators leave 0.94 to 11 times the residual, an exact one beside a filtered velocity whose sign is wrong at rest 0.43
/// to 0.89 times (twins of the TX40 and EMPS).
const EXPLAINS_BETTER: f64 = 0.9;
/// Draws and seed of the bootstrap. With 199, the 190th statistic is the threshold of an exact test at 5 %.
const DRAWS: usize = 199;
const SEED: u64 = 1;
/// Parameters that a comparison names.
const NAMED: usize = 5;
/// The errors of the simulator that may explain a difference, and the steps of their numerical derivatives.
const EXPLAINED_BY: [(BiasKind, f64); 3] =
    [(BiasKind::GearRatio, 0.02), (BiasKind::DriveGain, 0.05), (BiasKind::Delay, 2e-3)];

/// A run of a case with what its diagnosis needs.
pub(super) struct Estimated {
    pub(super) method: Method,
    pub(super) weights: Option<Vec<f64>>,
    pub(super) outcome: Outcome,
}

/// Z of the loop simulated with each of some biases and base parameters, where the simulation succeeds.
pub(super) type Simulate<'a> = dyn Fn(&[SimulatorBias], &[f64]) -> Vec<Option<Matrix>> + 'a;

/// Compares the methods of a case.
pub(super) fn diagnose(
    problem: &Problem,
    case: &Case,
    estimated: &[Estimated],
    simulate: &Simulate<'_>,
) -> CaseDiagnosis {
    let of = |method: Method| estimated.iter().find(|e| e.method == method && e.outcome.status == Status::Converged);
    let iv = of(Method::IdimIv).and_then(|e| Whitened::new(problem, e));
    let didim = of(Method::Didim);
    CaseDiagnosis {
        case: case.name.clone(),
        endogeneity: iv.as_ref().and_then(|w| endogeneity(problem, w)),
        instruments: iv.as_ref().map(|w| instruments(problem, w)),
        biased_simulator: didim.and_then(|d| biased_simulator(problem, case, d, simulate)),
    }
}

/// X, y and Z of a run, whitened alike.
struct Whitened {
    x: Matrix,
    y: Vec<f64>,
    z: Matrix,
    blocks: JointRows,
}

impl Whitened {
    fn new(problem: &Problem, run: &Estimated) -> Option<Self> {
        let z = run.outcome.instruments.as_ref()?;
        let blocks = problem.rows.joint_rows();
        let Some(weights) = &run.weights else {
            return Some(Self { x: problem.x.clone(), y: problem.y.clone(), z: z.clone(), blocks });
        };
        Some(Self {
            x: problem.x.scale_rows(weights),
            y: weighted(&problem.y, Some(weights)),
            z: z.scale_rows(weights),
            blocks,
        })
    }
}

fn weighted(rows: &[f64], weights: Option<&[f64]>) -> Vec<f64> {
    weights.map_or_else(|| rows.to_vec(), |w| rows.iter().zip(w).map(|(r, w)| r * w).collect())
}

/// The tests of one run's residual.
pub(super) fn residual(problem: &Problem, prediction: &[f64], weights: Option<&[f64]>) -> ResidualResult {
    let residual: Vec<f64> = problem.y.iter().zip(prediction).map(|(y, p)| y - p).collect();
    let per_joint = problem.rows.per_joint();
    let joints = problem.rows.joint_rows().segments(&residual);
    let joint = |(j, segments): (usize, &Vec<&[f64]>)| joint_residual(j + 1, segments);
    // A joint that is fitted exactly, as one that is locked and without torque, has no residual to test.
    let is_left = |joint: &JointResidual| joint.rms > 0.0;
    let whitened = weighted(&residual, weights);
    let groups = whitened.chunks(per_joint.max(1)).filter(|joint| joint.iter().any(|r| *r != 0.0));
    let groups: Vec<&[f64]> = groups.collect();
    ResidualResult {
        joints: joints.iter().enumerate().map(joint).filter(is_left).collect(),
        homoscedasticity: levene(&groups),
    }
}

fn joint_residual(joint: usize, segments: &[&[f64]]) -> JointResidual {
    let all = segments.concat();
    let shortest = segments.iter().map(|s| s.len()).min().unwrap_or(0);
    JointResidual {
        joint,
        rms: norm(&all) / (all.len().max(1) as f64).sqrt(),
        autocorrelation: autocorrelation(segments, 1)[0],
        whiteness: ljung_box(segments, usual_lags(shortest)),
        normality: jarque_bera(&all),
    }
}

fn endogeneity(problem: &Problem, iv: &Whitened) -> Option<EndogeneityResult> {
    let test = wu_hausman(&iv.z, &iv.x, &iv.y, &iv.blocks)?;
    Some(EndogeneityResult {
        classical: test.classical,
        robust: test.robust,
        average_difference: test.average_difference,
        parameters: largest(problem, &test.difference, &test.iv_deviation),
        verdict: verdict(test.robust.p_value < SIGNIFICANCE, test.average_difference),
    })
}

fn verdict(rejected: bool, average_difference: f64) -> Verdict {
    match (rejected, average_difference >= HARMLESS_BELOW) {
        (false, _) => Verdict::Agree,
        (true, false) => Verdict::SmallDifference,
        (true, true) => Verdict::Alarm,
    }
}

/// The parameters that differ most, in standard deviations.
fn largest(problem: &Problem, difference: &[f64], deviation: &[f64]) -> Vec<ParameterDifference> {
    let named = problem.estimated.parameters().iter().zip(difference.iter().zip(deviation));
    let mut all: Vec<ParameterDifference> = named
        .map(|(p, (d, sd))| ParameterDifference { name: p.name.clone(), difference: *d, deviations: d / sd })
        .collect();
    all.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    all.truncate(NAMED);
    all
}

fn instruments(problem: &Problem, iv: &Whitened) -> InstrumentResult {
    let f_statistics: Vec<f64> =
        instrument_strength(&iv.z, &iv.x).unwrap_or_default().iter().map(|s| s.f_statistic).collect();
    let weakest = f_statistics.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
    let scale: Vec<f64> = (0..iv.x.columns()).map(|c| norm(iv.x.column(c))).collect();
    let unit = Matrix::from_fn(iv.x.rows(), iv.x.columns(), |i, j| iv.x.at(i, j) / scale[j]);
    let projected = PivotedQr::new(&iv.z).thin_q().transposed_times(&unit);
    InstrumentResult {
        smallest_f: weakest.map_or(0.0, |(_, f)| *f),
        weakest: weakest.map(|(i, _)| problem.estimated.parameters()[i].name.clone()).unwrap_or_default(),
        rank: PivotedQr::new(&projected).rank(1e-10),
        condition_number: projected.condition_number(),
        f_statistics,
    }
}

fn biased_simulator(
    problem: &Problem,
    case: &Case,
    didim: &Estimated,
    simulate: &Simulate<'_>,
) -> Option<BiasedSimulatorResult> {
    let whitened = Whitened::new(problem, didim)?;
    let compared = SimulatorComparison::new(&whitened.z, &whitened.x, &whitened.y, &whitened.blocks)?;
    let statistics = compared.bootstrap(DRAWS, SEED);
    let fifth = ((1.0 - SIGNIFICANCE) * (DRAWS + 1) as f64) as usize - 1;
    let threshold = statistics.get(fifth).copied().filter(|t| t.is_finite())?;
    let larger = statistics.iter().filter(|s| **s >= compared.statistic).count();
    let verdict = match verdict(compared.statistic > threshold, compared.average_difference) {
        Verdict::Agree if compared.average_difference >= HARMLESS_BELOW && compared.residual_ratio > 1.0 => {
            Verdict::Unclear
        }
        Verdict::Alarm if compared.residual_ratio < EXPLAINS_BETTER => Verdict::Undecided,
        other => other,
    };
    let alarm = verdict == Verdict::Alarm;
    let all: f64 = compared.joint_squares.iter().sum();
    Some(BiasedSimulatorResult {
        statistic: compared.statistic,
        freedom: compared.difference.len(),
        threshold,
        p_value: (larger + 1) as f64 / (statistics.len() + 1) as f64,
        draws: DRAWS,
        seed: SEED,
        average_difference: compared.average_difference,
        residual_ratio: compared.residual_ratio,
        harmless_below: HARMLESS_BELOW,
        verdict,
        parameters: largest(problem, &compared.difference, &compared.iv_deviation),
        joint_percent: compared.joint_squares.iter().map(|s| 100.0 * s / all).collect(),
        explanations: if alarm { explain(case, didim, &whitened, &compared, simulate) } else { Vec::new() },
    })
}

/// One DIDIM step with each error of the simulator, and how far its change explains the difference; the best first.
fn explain(
    case: &Case,
    didim: &Estimated,
    whitened: &Whitened,
    compared: &SimulatorComparison,
    simulate: &Simulate<'_>,
) -> Vec<BiasExplanation> {
    let Some(fit) = &didim.outcome.fit else { return Vec::new() };
    let estimate = |z: Option<Matrix>| {
        let z = z?;
        let z = didim.weights.as_ref().map_or_else(|| z.clone(), |w| z.scale_rows(w));
        Some(PivotedQr::new(&z).solve(&whitened.y))
    };
    let steps = EXPLAINED_BY.map(|(kind, step)| (kind, if kind.is_factor() { 1.0 + step } else { step }));
    let biases: Vec<SimulatorBias> =
        std::iter::once(case.simulator).chain(steps.map(|(kind, by)| case.simulator.with(kind, by))).collect();
    let mut estimates = simulate(&biases, &fit.theta).into_iter().map(estimate);
    // The step without a bias takes what the iteration has left to do out of the derivatives.
    let Some(unbiased) = estimates.next().flatten() else { return Vec::new() };
    let explained = |((kind, step), theta): (&(BiasKind, f64), Option<Vec<f64>>)| {
        let change: Vec<f64> = theta?.iter().zip(&unbiased).map(|(a, b)| (a - b) / step).collect();
        explanation(*kind, compared, &change)
    };
    let mut found: Vec<BiasExplanation> = EXPLAINED_BY.iter().zip(estimates).filter_map(explained).collect();
    found.sort_by(|a, b| b.explained_percent.total_cmp(&a.explained_percent));
    found
}

/// A correction c of the simulator's setting means that the setting is `1 / (1 + c)` of the true one, or c less than it.
fn explanation(kind: BiasKind, compared: &SimulatorComparison, change: &[f64]) -> Option<BiasExplanation> {
    let fit = compared.explain(change)?;
    let factor = 1.0 + fit.correction;
    let setting = match (kind.is_factor(), factor > 0.0) {
        (true, true) => Some((1.0 / factor, fit.standard_deviation / factor.powi(2))),
        (true, false) => None,
        (false, _) => Some((-fit.correction, fit.standard_deviation)),
    };
    Some(BiasExplanation {
        kind,
        simulator_to_true: setting.map(|(value, _)| value),
        standard_deviation: setting.map(|(_, deviation)| deviation),
        explained_percent: 100.0 * fit.explained,
    })
}
