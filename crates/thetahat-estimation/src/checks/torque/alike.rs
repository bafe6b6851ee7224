//! The exchange of two joints that are so alike, as those of a wrist, that the errors of all torques hardly show it.
//!
//! An exchange leaves the number of parameters as it is. So the rows compare it with the recording as it is by their likelihoods
//! (Q. Vuong, "Likelihood ratio tests for model selection and non-nested hypotheses", Econometrica 57, 1989), each coordinate with the
//! variance of its own errors.

use super::hypotheses::Hypothesis;
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{affine::Affine, orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
    numbers::deviation,
};

/// Stretches of time whose likelihoods are compared.
const STRETCHES: usize = 20;
/// Deviations of a difference of likelihoods by chance from which an exchange is likely. The largest of 103 simulated recordings without
/// one is 2.0.
const LIKELY: f64 = 2.5;
/// The same from which it is certain, of all pairs that are tried.
const CERTAIN: f64 = 4.0;

/// Errors of a joint's torque over its deviation from which what the model lacks decides, and not whose torque it is.
const MOST_UNEXPLAINED: f64 = 0.1;

/// Corrects the exchange of positions and torques that the recording supports most, if its likelihood is larger beyond chance.
pub(super) fn check<'h>(
    exam: &mut Examination<'_>,
    recording: &mut ThinnedRecording<'_>,
    hypotheses: impl Iterator<Item = &'h Hypothesis>,
) {
    let Some(before) = Errors::of(recording, &Affine::identity(recording.coordinates())) else { return };
    let Ok(fit) = recording.fit() else { return };
    let is_explained = |j: &usize| fit.joint_error(*j) < MOST_UNEXPLAINED;
    let tried = hypotheses.filter_map(|exchange| {
        exchange.correction.exchanged_joints().filter(|joints| joints.iter().all(is_explained))?;
        let deviations = Errors::of(recording, &exchange.correction)?.deviations_better(&before);
        deviations.is_finite().then_some((exchange, deviations))
    });
    let Some((exchange, deviations)) = tried.max_by(|(_, a), (_, b)| a.total_cmp(b)) else { return };
    let of = |limit: f64| Evidence {
        code: Code::JointsSwapped,
        coordinate: exchange.coordinate,
        value: deviations,
        unit: "deviations",
        limit,
    };
    exam.note_measure(of(LIKELY));
    let message = format!("the torques fit better by {deviations:.1} deviations if {}", exchange.text);
    let text = FindingText::new(message, &exchange.remedy).with_step(exchange.step());
    if deviations > CERTAIN {
        exam.raise(of(CERTAIN), Severity::Problem, text);
        recording.correct(&exchange.correction);
    } else if deviations > LIKELY {
        exam.raise(of(LIKELY), Severity::Warning, text);
    }
}

/// Errors of the filtered torques, of each coordinate.
struct Errors(Vec<Vec<f64>>);

impl Errors {
    /// `None` if those of a coordinate are zero or not finite.
    fn of(recording: &ThinnedRecording<'_>, correction: &Affine) -> Option<Self> {
        let mut corrected = recording.clone();
        corrected.correct(correction);
        let fit = OrthogonalFit::new(&corrected.regression().ok()?).weighted_by_errors();
        let errors: Vec<Vec<f64>> = (0..recording.coordinates()).map(|j| fit.errors(j)).collect();
        errors.iter().all(|e| mean_square(e).is_finite() && mean_square(e) > 0.0).then_some(Self(errors))
    }

    /// How much larger the likelihood is than that of others, over the deviation of the difference by chance.
    fn deviations_better(&self, others: &Self) -> f64 {
        let stretches: Vec<f64> = (0..STRETCHES).map(|s| self.log_likelihood(s) - others.log_likelihood(s)).collect();
        stretches.iter().sum::<f64>() / (deviation(&stretches) * (STRETCHES as f64).sqrt())
    }

    /// Of a stretch of time, but for a constant.
    fn log_likelihood(&self, stretch: usize) -> f64 {
        let of_coordinate = |errors: &Vec<f64>| {
            let rows = stretch * errors.len() / STRETCHES..(stretch + 1) * errors.len() / STRETCHES;
            let square = mean_square(errors);
            -0.5 * rows.map(|k| square.ln() + errors[k].powi(2) / square).sum::<f64>()
        };
        self.0.iter().map(of_coordinate).sum()
    }
}

fn mean_square(errors: &[f64]) -> f64 {
    errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64
}
