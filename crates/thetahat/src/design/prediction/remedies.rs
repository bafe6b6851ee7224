//! What would identify the parameters that a motion leaves unknown: a motion for them alone.

use crate::design::{
    limits::joint_limits::JointLimits,
    motions::sums::Derivatives,
    prediction::expected::Expected,
    search::{
        criterion::Criterion,
        optimiser::Problem,
        searches::{Searches, sign_scales},
        watch::{Descents, Watch},
    },
    text::description::Design,
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::base_parameters::BaseParameters;

/// Searches for the motion that identifies what stays unknown.
const STARTS: usize = 2;

impl Design {
    /// For each expected parameter that stays unknown: how many times narrower its interval is with a motion designed for the unknown ones
    /// alone. By the information of both motions; limits are those of the search.
    pub(in crate::design) fn remedies(
        &self,
        (problem, base, limits): (&Problem, &BaseParameters, &[JointLimits]),
        motion: &Derivatives,
        expected: &Expected,
        watched: (usize, &Watch<'_>),
    ) -> Vec<Option<f64>> {
        let a_priori = self.a_priori_of(base, expected);
        let place = |name: &str| base.parameters().iter().position(|p| p.name == name);
        let places = expected.parameters.iter().enumerate().map(|(i, parameter)| {
            let is_unknown = a_priori[i] != 0.0 && expected.half_width_95[i] >= a_priori[i].abs();
            place(&parameter.name).filter(|_| is_unknown)
        });
        let places: Vec<Option<usize>> = places.collect();
        let unknown: Vec<usize> = places.iter().copied().flatten().collect();
        let made = self.variances_with_own_motion(problem, limits, &unknown, watched);
        let (Some(made), Some(own)) = (made, variances(problem, motion)) else { return vec![None; places.len()] };
        places.into_iter().map(|place| place.map(|i| (own[i] / made[i]).sqrt())).collect()
    }

    /// The variances of all parameters by the best motion for some of them; `None` if there are none, or no motion is found.
    fn variances_with_own_motion(
        &self,
        problem: &Problem,
        limits: &[JointLimits],
        unknown: &[usize],
        (threads, watch): (usize, &Watch<'_>),
    ) -> Option<Vec<f64>> {
        if unknown.is_empty() || watch.is_stopped() {
            return None;
        }
        let problem =
            Problem { criterion: Criterion::SelectedParameters { columns: unknown.to_vec() }, ..problem.clone() };
        let searches =
            Searches { count: STARTS, seed: self.file.motion.seed, threads, sign_scales: sign_scales(limits) };
        let stage = "searching a motion for what stays unknown";
        let descents = Descents::new(watch, stage, searches.descents(&problem));
        let best = searches.run(&problem, &descents).into_iter().min_by(|a, b| a.value.total_cmp(&b.value))?;
        variances(&problem, &self.sampled(&problem.watched, &best.x))
    }
}

/// The variance of each base parameter from the recording of a motion.
fn variances(problem: &Problem, motion: &Derivatives) -> Option<Vec<f64>> {
    let own = problem.information.of_motion_alone(motion);
    let information = problem.information.prior().map_or_else(|| own.clone(), |prior| prior.plus(&own, 1.0));
    let size = information.rows();
    let covariance = information.inverse_times_matrix(&Matrix::identity(size))?;
    Some((0..size).map(|i| covariance.at(i, i)).collect())
}
