//! Start values around the a-priori parameters.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{Campaign, CampaignError, noise::random};
use crate::{
    experiment::Experiment,
    linear_algebra::Matrix,
    robot::{ParameterTable, Quantity},
};

/// Draws of one start, of which one should be physical.
const DRAWS: u32 = 10_000;
/// The streams of the starts, apart from those of the records.
const STREAM: u64 = 1 << 63;
/// What rounding leaves of an inertia that is zero, relative to the largest.
const ROUNDING: f64 = 1e-12;

impl Campaign {
    /// The experiment with the a-priori values of start number `start`, from zero.
    pub(super) fn start(&self, start: u32) -> Result<Experiment, CampaignError> {
        let mut experiment = self.experiment.clone();
        let deviation = self.file.starts.relative_deviation;
        if deviation == 0.0 {
            return Ok(experiment);
        }
        let mut rng = random(self.file.seed, STREAM | u64::from(start));
        let table = experiment.robot.parameter_table();
        let centre = experiment.robot.a_priori_parameters();
        let impossible = |theta: &[f64]| violation(&table, experiment.robot.link_count(), theta);
        let mut reason = String::new();
        for _ in 0..DRAWS {
            let drawn = draw(&centre, deviation, &mut rng);
            match impossible(&drawn) {
                Some(found) => reason = found,
                None => {
                    let named = table.iter().zip(&drawn).filter(|(_, v)| **v != 0.0);
                    experiment.robot.a_priori = named.map(|(p, v)| (p.name(), *v)).collect();
                    return Ok(experiment);
                }
            }
        }
        let reason = impossible(&centre).map_or_else(
            || format!("The last one failed at {reason}. Lower relative_deviation in [starts]"),
            |found| format!("They are not physical themselves: {found}. Correct them"),
        );
        Err(CampaignError::NoPhysicalStart { path: self.path.clone(), draws: DRAWS, reason })
    }
}

fn draw(centre: &[f64], deviation: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let factor = |value: &f64| {
        let normal: f64 = StandardNormal.sample(rng);
        value * (1.0 + deviation * normal)
    };
    centre.iter().map(factor).collect()
}

/// What makes a set of standard parameters impossible, if anything: a link with a negative mass, or whose inertia about
/// its centre of mass is not that of a body, or a motor inertia or friction below zero.
fn violation(table: &ParameterTable, links: usize, theta: &[f64]) -> Option<String> {
    use Quantity::{Fc, Fcm, Fcn, Fcp, Fv, Fvm, Fvn, Fvp, Ia, Iam};
    let not_negative = [Ia, Fv, Fc, Fvp, Fcp, Fvn, Fcn, Iam, Fvm, Fcm];
    let negative = table.iter().zip(theta).find(|(p, v)| not_negative.contains(&p.quantity) && **v < 0.0);
    if let Some((parameter, value)) = negative {
        return Some(format!("{} = {value:.3e}, below zero", parameter.name()));
    }
    (0..links).find_map(|link| impossible_link(table, link, theta))
}

fn impossible_link(table: &ParameterTable, link: usize, theta: &[f64]) -> Option<String> {
    let value = |quantity| table.index(quantity, link).map_or(0.0, |i| theta[i]);
    let inertial = crate::robot::INERTIAL.map(value);
    if inertial.iter().all(|v| *v == 0.0) {
        return None;
    }
    let [xx, xy, xz, yy, yz, zz, mx, my, mz, m] = inertial;
    let number = link + 1;
    if m <= 0.0 {
        return Some(format!("link {number}: its mass is {m:.3e}"));
    }
    // The inertia about the centre of mass, by the theorem of Huygens and Steiner.
    let square = mx * mx + my * my + mz * mz;
    let at = |i: usize, j: usize, about_origin: f64| {
        let s = [mx, my, mz];
        about_origin - (if i == j { square } else { 0.0 } - s[i] * s[j]) / m
    };
    let upper = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let inertia = Matrix::from_fn(3, 3, |i, j| at(i, j, upper[i][j]));
    let principal = symmetric_eigenvalues(&inertia);
    let [smallest, middle, largest] = principal;
    let body = smallest > 0.0 && smallest + middle >= largest * (1.0 - ROUNDING);
    (!body).then(|| {
        format!(
            "link {number}: its principal inertias about the centre of mass are {smallest:.3e}, {middle:.3e} and \
             {largest:.3e}: not all positive, or the largest above the sum of the others"
        )
    })
}

/// Eigenvalues of a symmetric matrix of three rows, rising, in closed form (O. K. Smith, "Eigenvalues of a symmetric
/// 3 x 3 matrix", Communications of the ACM 4, 1961).
fn symmetric_eigenvalues(a: &Matrix) -> [f64; 3] {
    let mean = (a.at(0, 0) + a.at(1, 1) + a.at(2, 2)) / 3.0;
    let off = a.at(0, 1).powi(2) + a.at(0, 2).powi(2) + a.at(1, 2).powi(2);
    let spread = (0..3).map(|i| (a.at(i, i) - mean).powi(2)).sum::<f64>() + 2.0 * off;
    let p = (spread / 6.0).sqrt();
    if p <= f64::MIN_POSITIVE {
        return [mean; 3];
    }
    let b = Matrix::from_fn(3, 3, |i, j| (a.at(i, j) - if i == j { mean } else { 0.0 }) / p);
    let angle = (0.5 * determinant(&b)).clamp(-1.0, 1.0).acos() / 3.0;
    let largest = mean + 2.0 * p * angle.cos();
    let smallest = mean + 2.0 * p * (angle + 2.0 * std::f64::consts::FRAC_PI_3).cos();
    [smallest, 3.0 * mean - largest - smallest, largest]
}

fn determinant(a: &Matrix) -> f64 {
    let minor = |i: usize, j: usize| a.at(1, i) * a.at(2, j) - a.at(1, j) * a.at(2, i);
    a.at(0, 0) * minor(1, 2) - a.at(0, 1) * minor(0, 2) + a.at(0, 2) * minor(0, 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Friction, JointKind};

    fn table() -> ParameterTable {
        ParameterTable::new(&[JointKind::Revolute], Friction::Symmetric, &[])
    }

    fn set(values: &[(&str, f64)]) -> Vec<f64> {
        let table = table();
        let mut theta = vec![0.0; table.len()];
        values.iter().for_each(|(name, v)| theta[table.index_of(name).unwrap()] = *v);
        theta
    }

    #[test]
    fn eigenvalues_are_those_of_a_turned_diagonal() {
        let (c, s) = (0.6, 0.8);
        let turn = Matrix::from_fn(3, 3, |i, j| [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]][i][j]);
        let diagonal = Matrix::from_fn(3, 3, |i, j| if i == j { [3.0, 1.0, 2.0][i] } else { 0.0 });
        let turned = turn.times_matrix(&diagonal).times_matrix(&turn.transpose());
        for (found, expected) in symmetric_eigenvalues(&turned).iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }

    #[test]
    fn a_body_away_from_its_frame_is_possible_and_a_defect_is_named() {
        // A ball of 2 kg, 0.02 kg m^2 about its centre, at x = 0.5 m.
        let ball = [("m1", 2.0), ("mx1", 1.0), ("xx1", 0.02), ("yy1", 0.52), ("zz1", 0.52), ("ia1", 0.1)];
        assert_eq!(violation(&table(), 1, &set(&ball)), None);
        for (name, value, word) in
            [("m1", -2.0, "mass"), ("yy1", 0.49, "principal"), ("xx1", 0.05, "principal"), ("ia1", -0.1, "ia1")]
        {
            let mut wrong = set(&ball);
            wrong[table().index_of(name).unwrap()] = value;
            let found = violation(&table(), 1, &wrong).unwrap();
            assert!(found.contains(word), "{name}: {found}");
        }
    }
}
