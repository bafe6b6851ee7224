//! DIDIM against IV: whether the simulator agrees with the recorded loop, and which single error of it explains a
//! difference.

use super::{
    comparison::{HARMLESS_BELOW, SIGNIFICANCE, comparison, largest},
    estimated::{MethodEstimate, Whitened},
};
use crate::preparation::{Case, Problem};
use thetahat_estimation::{
    simulation::{BiasKind, SimulatorBias},
    statistics::SimulatorComparison,
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr};
use thetahat_report::results::{BiasExplanation, BiasedSimulatorResult, Comparison};

/// DIDIM's residual over IV's below which the measured motion may be wrong as well as the simulated one. Wrong
/// simulators leave 0.94 to 11 times the residual, an exact one with a filtered velocity whose sign is wrong at rest 0.43
/// to 0.89 times (twins of the TX40 and EMPS).
const EXPLAINS_BETTER: f64 = 0.9;
/// Difference of one parameter, in deviations of IV, that matters by itself: among many parameters the average hides it.
const ONE_MATTERS: f64 = 2.0;
/// How many times what chance makes of the difference it has to be where nothing is rejected. Clean twins reach 1.5 times.
const BEYOND_CHANCE: f64 = 2.0;
/// Draws and seed of the bootstrap. With 199, the 190th statistic is the threshold of an exact test at 5 %.
const DRAWS: usize = 199;
const SEED: u64 = 1;
/// The errors of the simulator that may explain a difference, and the steps of their numerical derivatives.
const EXPLAINED_BY: [(BiasKind, f64); 3] =
    [(BiasKind::GearRatio, 0.02), (BiasKind::DriveGain, 0.05), (BiasKind::Delay, 2e-3)];

/// Z of the loop simulated with each of some biases and base parameters, where the simulation succeeds.
pub(crate) type Simulate<'a> = dyn Fn(&[SimulatorBias], &[f64]) -> Vec<Option<Matrix>> + 'a;

/// The test of DIDIM against IV with the instruments and weights of DIDIM.
pub(super) fn biased_simulator(
    problem: &Problem,
    case: &Case,
    didim: &MethodEstimate,
    simulate: &Simulate<'_>,
) -> Option<BiasedSimulatorResult> {
    let whitened = Whitened::new(didim)?;
    let compared = SimulatorComparison::new(&whitened.z, &whitened.x, &whitened.y, whitened.layout)?;
    let statistics = compared.bootstrap(DRAWS, SEED);
    let threshold = threshold(&statistics)?;
    let larger = statistics.iter().filter(|s| **s >= compared.statistic).count();
    let parameters = largest(problem, &compared.difference, &compared.iv_deviation);
    let most = parameters.first().map_or(0.0, |p| p.deviations.abs());
    let rejected = compared.statistic > threshold;
    let verdict = compare(rejected, compared.average_difference, most, compared.residual_ratio);
    let alarm = verdict == Comparison::Alarm;
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
        parameters,
        joint_percent: compared.joint_squares.iter().map(|s| 100.0 * s / all).collect(),
        explanations: if alarm { explain(case, didim, &whitened, &compared, simulate) } else { Vec::new() },
    })
}

/// What the test, the difference, the residuals and the parameter that differs most say together. A simulated motion that explains
/// the torques much better than the measured one speaks against the measured one whether or not the test rejects: its noise is
/// then that of the measured motion, and hides the difference. Without a rejection the difference has to be larger than chance
/// makes it: of estimates whose residuals have the ratio r, one efficient, it is `sqrt(1 - r^2)` deviations of the other.
fn compare(rejected: bool, average: f64, most: f64, ratio: f64) -> Comparison {
    let matters = average >= HARMLESS_BELOW;
    let chance = if rejected { 0.0 } else { BEYOND_CHANCE * (1.0 - ratio * ratio).max(0.0).sqrt() };
    let one_matters = most >= ONE_MATTERS.max(2.0 * chance);
    if ratio < EXPLAINS_BETTER && (average >= HARMLESS_BELOW.max(chance) || one_matters) {
        return Comparison::Undecided;
    }
    if !rejected && matters && ratio > 1.0 { Comparison::Unclear } else { comparison(rejected, average) }
}

/// The statistic, of sorted ones of so many draws, that 5 % of them and the recording's own exceed; none if it is infinite.
fn threshold(statistics: &[f64]) -> Option<f64> {
    let place = ((1.0 - SIGNIFICANCE) * (statistics.len() + 1) as f64).round() as usize;
    statistics.get(place - 1).copied().filter(|t| t.is_finite())
}

/// One DIDIM step with each error of the simulator, and how far its change explains the difference; the best first.
fn explain(
    case: &Case,
    didim: &MethodEstimate,
    whitened: &Whitened<'_>,
    compared: &SimulatorComparison,
    simulate: &Simulate<'_>,
) -> Vec<BiasExplanation> {
    let Some(fit) = &didim.outcome.fit else { return Vec::new() };
    let estimate = |z: Option<Matrix>| Some(PivotedQr::new(&didim.regression.whiten_matrix(&z?)).solve(&whitened.y));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What twins gave: exact simulators with noise in the measured motion, and a torque that was held.
    #[test]
    fn a_difference_that_chance_makes_of_a_larger_residual_is_none() {
        for (average, ratio) in [(0.56, 0.842), (0.63, 0.888), (0.67, 0.895), (0.54, 0.871), (0.59, 0.884)] {
            assert_eq!(compare(false, average, 1.5, ratio), Comparison::Agree, "{average} {ratio}");
            assert_eq!(compare(true, average, 1.5, ratio), Comparison::Undecided, "{average} {ratio}");
        }
        assert_eq!(compare(false, 2.0, 3.0, 0.35), Comparison::Undecided);
        assert_eq!(compare(false, 0.8, 4.0, 0.89), Comparison::Undecided);
        assert_eq!(compare(false, 0.8, 1.0, 1.2), Comparison::Unclear);
    }

    #[test]
    fn five_percent_of_the_draws_and_the_recording_are_above_the_threshold() {
        let statistics: Vec<f64> = (1..=DRAWS).map(|k| k as f64).collect();
        assert_eq!((DRAWS, threshold(&statistics)), (199, Some(190.0)));
        let unbounded: Vec<f64> = (1..=DRAWS).map(|k| if k < 190 { 1.0 } else { f64::INFINITY }).collect();
        assert_eq!(threshold(&unbounded), None);
    }
}
