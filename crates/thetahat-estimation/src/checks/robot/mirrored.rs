//! Joints that the log counts the other way than the description, in positions and torques.
//!
//! Such a log is one of the mirrored robot, and often fits as well as before: first moments then have the opposite sign. The masses of the
//! description say which of the two robots it is. Products of inertia change their signs as well, but are known too little.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{affine::Affine, thinned_recording::ThinnedRecording},
};
use thetahat_ground::linear_algebra::norm;
use thetahat_model::robot::{
    LinkQuantity,
    LinkQuantity::{M, Mx, My, Mz, Xx, Xy, Xz, Yy, Yz, Zz},
    Parameter, ParameterTable, Quantity,
};

/// Deviation of a description's first moment from the true one, relative to the length of the link's vector of first moments, of which small
/// parts may have either sign.
const SPREAD: f64 = 0.3;
/// Largest squared distance that a parameter adds, in such deviations: one that is wrong for another reason decides nothing.
const MOST: f64 = 16.0;
/// Difference of the squared distances from which the reversed joint is likelier: some two parameters of opposite signs.
const LIMIT: f64 = 15.0;
/// Largest squared residual of the reversed joint, relative to that of the log as it is: the right robot fits at least as well, and the estimates
/// of a worse fit are near to anything.
const FITS: f64 = 1.001;
/// Mean squared distance up to which the parameters with the reversed joint agree with the description.
const AGREES: f64 = 1.5;

const REMEDY: &str = "reverse both in the experiment file: the sign of gain of position and torque, or of the motor's row in \
                      [transmission] matrix. If the axis of the description is wrong, correct it there";

pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let Some(moments) = FirstMoments::of(recording) else { return };
    let Some(stated) = moments.distance(recording) else { return };
    let Ok(fit) = recording.fit() else { return };
    let (mut reversed, mut nearest) = (Vec::new(), stated);
    while let Some((joint, distance)) = moments.best_reversal(recording, FITS * fit.squares, &reversed) {
        if nearest - distance < LIMIT {
            break;
        }
        reversed.push(joint);
        nearest = distance;
    }
    reversed.sort_unstable();
    let agrees = nearest < AGREES * moments.columns.len() as f64;
    let value = if agrees { stated - nearest } else { 0.0 };
    let coordinate = if let [joint] = reversed[..] { Some(joint) } else { None };
    let evidence = Evidence {
        code: Code::PositionSign,
        coordinate,
        value,
        unit: "squared deviations of the masses",
        limit: LIMIT,
    };
    exam.judge(evidence, Severity::Warning, || {
        let correction = reversal(recording, &reversed);
        let numbers: Vec<String> = reversed.iter().map(|&j| recording.subject.joint_number(j).to_string()).collect();
        let joints = if numbers.len() == 1 { "joint" } else { "joints" };
        let numbers = numbers.join(", ");
        let message = format!(
            "the first moments of the links agree with those of the description only if position and torque of {joints} \
             {numbers} are reversed: there the log counts the other way than the description"
        );
        FindingText::new(message, REMEDY).with_step(correction.step())
    });
}

/// First moments of links, with the description's values and the sizes of what they are made of.
struct FirstMoments {
    columns: Vec<usize>,
    described: Vec<f64>,
    sizes: Vec<f64>,
}

impl FirstMoments {
    /// `None` without masses in the description.
    fn of(recording: &ThinnedRecording<'_>) -> Option<Self> {
        let subject = recording.subject;
        let table = subject.model.parameter_table();
        let theta = subject.robot.a_priori_parameters_for(table);
        let described = subject.all.from_standard(&theta);
        let of_link = |i: usize| matches!(table.get(i).quantity, Quantity::Link(_));
        let parameters = subject.all.parameters();
        let sizes = sizes(table, &theta);
        let size = |c: usize| {
            let parts = parameters[c].regrouped.iter().map(|(i, factor)| (factor * sizes[*i]).powi(2));
            (sizes[parameters[c].kept].powi(2) + parts.sum::<f64>()).sqrt()
        };
        let is_first_moment = |c: &usize| {
            let kept = table.get(parameters[*c].kept).quantity;
            matches!(kept, Quantity::Link(Mx | My | Mz)) && parameters[*c].regrouped.iter().all(|(i, _)| of_link(*i))
        };
        let columns: Vec<usize> = (0..parameters.len()).filter(is_first_moment).filter(|&c| size(c) > 0.0).collect();
        let sizes = columns.iter().map(|&c| size(c)).collect();
        let described = columns.iter().map(|&c| described[c]).collect();
        (!columns.is_empty()).then_some(Self { columns, described, sizes })
    }

    /// Squared distance between a recording's estimates and the description; `None` if the motion does not separate the parameters.
    fn distance(&self, recording: &ThinnedRecording<'_>) -> Option<f64> {
        let fit = recording.fit().ok().filter(|_| recording.has_full_rank())?;
        let (theta, covariance) = (fit.theta(), fit.covariance(&vec![false; fit.y.len()]));
        let distance = |(k, &c): (usize, &usize)| {
            let variance = covariance.at(c, c) + (SPREAD * self.sizes[k]).powi(2);
            ((theta[c] - self.described[k]).powi(2) / variance).min(MOST)
        };
        Some(self.columns.iter().enumerate().map(distance).sum())
    }

    /// The joint whose reversal, with those that are reversed already, brings the estimates nearest to the description, of those with at most
    /// so large a squared residual.
    fn best_reversal(&self, recording: &ThinnedRecording<'_>, most: f64, reversed: &[usize]) -> Option<(usize, f64)> {
        let others = (0..recording.coordinates()).filter(|joint| !reversed.contains(joint));
        let with = others.filter_map(|joint| {
            let other = recording.corrected(&reversal(recording, &[reversed, &[joint]].concat()));
            let fits = other.fit().is_ok_and(|fit| fit.squares < most);
            Some((joint, self.distance(&other).filter(|_| fits)?))
        });
        with.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The size of each standard parameter: of a first moment that of the vector of its link, of a mass its own, zero of all others.
fn sizes(table: &ParameterTable, theta: &[f64]) -> Vec<f64> {
    let moment = |parameter: &Parameter, which: LinkQuantity| {
        table.index(Quantity::Link(which), parameter.number - 1).map_or(0.0, |i| theta[i])
    };
    let size = |(parameter, value): (&Parameter, &f64)| match parameter.quantity {
        Quantity::Link(Mx | My | Mz) => norm(&[Mx, My, Mz].map(|which| moment(parameter, which))),
        Quantity::Link(M) => value.abs(),
        Quantity::Link(Xx | Xy | Xz | Yy | Yz | Zz) | Quantity::Joint(_) | Quantity::Motor(_) | Quantity::Term(_) => {
            0.0
        }
    };
    table.iter().zip(theta).map(size).collect()
}

/// Positions and torques of these joints with the opposite sign.
fn reversal(recording: &ThinnedRecording<'_>, joints: &[usize]) -> Affine {
    let sign = |j: usize| if joints.contains(&j) { -1.0 } else { 1.0 };
    let signs: Vec<f64> = (0..recording.coordinates()).map(sign).collect();
    let positions = Affine::scaled_positions(&signs, recording.subject.robot.transmission.offset());
    Affine { torque: Affine::scaled_torques(&signs).torque, ..positions }
}
