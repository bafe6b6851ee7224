//! Which method's numbers to take: the rules of `docs/reference/verdict.md`.

use super::{
    evidence::Evidence,
    sentences::{on_contradictions, on_estimates, on_simulator},
};
use thetahat_estimation::identification::{DesignMatrix, Method, Needs};
use thetahat_report::results::{Advice, CaseDiagnosis, Comparison, RecordingFindings, RunResult};

/// The advice for one case, from its runs and its diagnosis.
pub(crate) fn advise(diagnosis: &CaseDiagnosis, runs: &[RunResult], findings: &[RecordingFindings]) -> Advice {
    advice(&Evidence::of(diagnosis, runs, findings))
}

fn advice(evidence: &Evidence<'_>) -> Advice {
    let distrust: Vec<Method> = evidence.runs.iter().map(|r| r.method).filter(|m| distrusts(evidence, *m)).collect();
    let take = take(evidence);
    let sentences = if evidence.problems.refuse_all() {
        [evidence.problems.refusal(), String::new(), String::new()]
    } else {
        let of_loops = [on_simulator(evidence), on_contradictions(evidence)];
        [on_estimates(evidence, take), evidence.problems.on_joints(), of_loops.join(" ")]
    };
    let said: Vec<&str> = sentences.iter().map(|s| s.trim()).filter(|s| !s.is_empty()).collect();
    Advice { case: evidence.diagnosis.case.clone(), recommended: take, distrust, text: said.join(" ") }
}

/// Whether a method that was run is not to be trusted.
fn distrusts(evidence: &Evidence<'_>, method: Method) -> bool {
    let is_ls = method.needs() == Needs::Measurement;
    let is_didim = method.needs() != Needs::Measurement && method.design() == DesignMatrix::Simulated;
    let by_ls = is_ls && evidence.ls_differs().is_some();
    let by_instruments = !is_ls && evidence.weak().is_some();
    let by_simulator = is_didim && evidence.verdict().is_some_and(Comparison::distrusts);
    let by_estimates = evidence.contradiction(method).is_some();
    let by_comparison = by_ls || by_instruments || by_simulator || by_estimates;
    evidence.problems.refuse_all() || by_comparison || !evidence.has_estimate(method)
}

/// IV wherever its instruments are strong, since it needs no exact simulator, unless LS agrees and is much more precise; then
/// LS, then the methods that fit the simulated loop, those with exact sensitivities first and torques before positions. None
/// of them where DIDIM and IV differ and nothing shows which is wrong, or where the recordings have a problem that makes
/// every number worthless.
fn take(evidence: &Evidence<'_>) -> Option<Method> {
    if evidence.verdict() == Some(Comparison::Undecided) || evidence.problems.refuse_all() {
        return None;
    }
    let first = evidence.wasteful_iv().map(|_| Method::IDIM_LS);
    let in_order = [Method::IDIM_IV, Method::IDIM_LS, Method::CLIE, Method::DIDIM, Method::CLOE];
    first.into_iter().chain(in_order).find(|m| evidence.ran(*m).is_some() && !distrusts(evidence, *m))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::diagnosis::{
        evidence::{Distance, Ran},
        problems::Problems,
    };
    use thetahat_estimation::{
        identification::Status,
        simulation::BiasKind,
        statistics::{ChiSquaredTest, FTest},
    };
    use thetahat_report::results::{
        BiasExplanation, BiasedSimulatorResult, EndogeneityResult, InstrumentResult, ParameterDifference,
    };

    const METHODS: [Method; 3] = [Method::IDIM_LS, Method::IDIM_IV, Method::DIDIM];
    const VERDICTS: [Comparison; 5] =
        [Comparison::Agree, Comparison::SmallDifference, Comparison::Alarm, Comparison::Unclear, Comparison::Undecided];

    fn differing() -> Vec<ParameterDifference> {
        vec![ParameterDifference { name: "fv1".to_owned(), difference: 1.0, deviations: 2.0 }]
    }

    fn endogeneity(verdict: Comparison) -> EndogeneityResult {
        EndogeneityResult {
            classical: FTest { statistic: 5.0, numerator_freedom: 3, denominator_freedom: 100, p_value: 0.01 },
            robust: ChiSquaredTest { statistic: 5.0, freedom: 3, p_value: 0.01 },
            average_difference: 1.0,
            parameters: differing(),
            verdict,
        }
    }

    fn instruments(smallest_f: f64) -> InstrumentResult {
        let (f_statistics, weakest) = (vec![smallest_f], "fv1".to_owned());
        InstrumentResult { f_statistics, smallest_f, weakest, rank: 1, condition_number: 1.0 }
    }

    pub(in crate::diagnosis) fn simulator(verdict: Comparison) -> BiasedSimulatorResult {
        BiasedSimulatorResult {
            statistic: 50.0,
            freedom: 1,
            threshold: 10.0,
            p_value: 0.005,
            draws: 199,
            seed: 1,
            average_difference: 1.0,
            residual_ratio: 1.1,
            harmless_below: 0.5,
            verdict,
            parameters: differing(),
            joint_percent: vec![100.0],
            explanations: vec![explanation(Some(0.9), 97.0)],
        }
    }

    pub(in crate::diagnosis) fn explanation(simulator_to_true: Option<f64>, explained_percent: f64) -> BiasExplanation {
        let standard_deviation = simulator_to_true.map(|_| 0.01);
        BiasExplanation { kind: BiasKind::GearRatio, simulator_to_true, standard_deviation, explained_percent }
    }

    /// Every combination of what was run, how it ended, and what the tests say.
    fn all(each: &mut dyn FnMut(&Evidence<'_>, &Advice)) {
        let ends = [None, Some(Status::Converged), Some(Status::Stalled), Some(Status::Diverged)];
        for code in 0..ends.len().pow(3) {
            let end = |k: u32| ends[code / ends.len().pow(k) % ends.len()];
            let ran = |(k, method): (usize, &Method)| {
                let status = end(k as u32)?;
                Some(Ran { method: *method, status, fit: Some(5.0), unseen: Some(7.0), widening: Some(2.0) })
            };
            let runs: Vec<Ran> = METHODS.iter().enumerate().filter_map(ran).collect();
            let converged = |m: Method| runs.iter().any(|r| r.method == m && r.status == Status::Converged);
            for (ls, verdict, f) in
                VERDICTS.iter().flat_map(|ls| VERDICTS.iter().flat_map(move |v| [3.0, 300.0].map(|f| (*ls, *v, f))))
            {
                let diagnosis = CaseDiagnosis {
                    case: "nominal".to_owned(),
                    approximation: None,
                    endogeneity: converged(Method::IDIM_IV).then(|| endogeneity(ls)),
                    instruments: converged(Method::IDIM_IV).then(|| instruments(f)),
                    biased_simulator: converged(Method::DIDIM).then(|| simulator(verdict)),
                };
                for iv_to_ls in [Some(1.1), Some(5.0)] {
                    let (runs, problems) = (runs.clone(), Problems::default());
                    let evidence = Evidence { diagnosis: &diagnosis, runs, iv_to_ls, distances: Vec::new(), problems };
                    each(&evidence, &advice(&evidence));
                }
            }
        }
    }

    #[test]
    fn what_is_taken_was_run_has_an_estimate_and_is_not_distrusted() {
        all(&mut |evidence, advice| {
            let what = || format!("{:?} {:?}: {advice:?}", evidence.runs, evidence.diagnosis);
            if let Some(method) = advice.recommended {
                assert!(evidence.has_estimate(method) && !advice.distrust.contains(&method), "{}", what());
                let name = method.name();
                assert!(advice.text.starts_with(&format!("Take {name}")), "{}", what());
            }
            assert!(advice.distrust.iter().all(|m| evidence.ran(*m).is_some()), "{}", what());
            assert!(advice.text.ends_with('.') && !advice.text.contains("  "), "{}", what());
        });
    }

    #[test]
    fn nothing_is_taken_of_recordings_that_are_worthless() {
        all(&mut |evidence, _| {
            let problems = Problems::all_of("wrong-robot in recording 1");
            let (runs, iv_to_ls) = (evidence.runs.clone(), evidence.iv_to_ls);
            let refused =
                advice(&Evidence { diagnosis: evidence.diagnosis, runs, iv_to_ls, distances: Vec::new(), problems });
            assert!(refused.recommended.is_none() && refused.distrust.len() == evidence.runs.len(), "{refused:?}");
            assert_eq!(
                refused.text,
                "Take none of these estimates: the recordings have a problem that makes them false (wrong-robot in \
                 recording 1). Solve it first."
            );
        });
    }

    fn agreeing() -> CaseDiagnosis {
        CaseDiagnosis {
            case: "nominal".to_owned(),
            approximation: None,
            endogeneity: Some(EndogeneityResult {
                average_difference: 0.3,
                ..endogeneity(Comparison::SmallDifference)
            }),
            instruments: Some(instruments(300.0)),
            biased_simulator: None,
        }
    }

    fn ran(method: Method) -> Ran {
        Ran { method, status: Status::Converged, fit: Some(5.0), unseen: Some(7.0), widening: None }
    }

    #[test]
    fn ls_is_taken_where_iv_agrees_and_is_five_times_as_uncertain() {
        let diagnosis = agreeing();
        let of = |iv_to_ls| {
            let runs = vec![ran(Method::IDIM_LS), ran(Method::IDIM_IV)];
            let (distances, problems) = (Vec::new(), Problems::default());
            advice(&Evidence { diagnosis: &diagnosis, runs, iv_to_ls, distances, problems })
        };
        assert_eq!(of(Some(1.2)).recommended, Some(Method::IDIM_IV));
        let wasteful = of(Some(5.0));
        assert_eq!((wasteful.recommended, wasteful.distrust), (Some(Method::IDIM_LS), Vec::new()));
        assert!(wasteful.text.contains("5 times as uncertain"), "{}", wasteful.text);
    }

    /// With a position error of 0.00056 % a motor inertia was off by 62 deviations, and nothing said so.
    #[test]
    fn a_method_that_contradicts_the_measured_motion_is_distrusted() {
        let diagnosis = agreeing();
        let of = |rms| {
            let distance = Distance { methods: [Method::CLOE, Method::IDIM_IV], rms, most: "ia7".to_owned() };
            let runs = vec![ran(Method::IDIM_IV), ran(Method::CLOE)];
            let (distances, problems) = (vec![distance], Problems::default());
            advice(&Evidence { diagnosis: &diagnosis, runs, iv_to_ls: None, distances, problems })
        };
        assert_eq!(of(0.4).distrust, Vec::new());
        let far = of(20.0);
        assert_eq!((far.recommended, far.distrust), (Some(Method::IDIM_IV), vec![Method::CLOE]));
        assert!(far.text.contains("Distrust cloe: it differs from idim-iv by 20 standard deviations"), "{}", far.text);
    }

    #[test]
    fn what_the_text_distrusts_is_in_the_list() {
        all(&mut |evidence, advice| {
            for method in METHODS.into_iter().filter(|m| evidence.ran(*m).is_some()) {
                let said = advice.text.contains(&format!("istrust {}", method.name()));
                assert!(!said || advice.distrust.contains(&method), "{:?}: {advice:?}", evidence.runs);
            }
            let passes = advice.text.contains("the simulator passes");
            assert!(!passes || !advice.distrust.contains(&Method::DIDIM), "{advice:?}");
        });
    }
}
