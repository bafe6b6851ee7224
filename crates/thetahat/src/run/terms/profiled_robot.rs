//! A robot whose terms say `profile = true`, with the constants that the recordings give them.

use std::collections::BTreeMap;

use super::{column_source::ColumnSource, profile::Projection};
use crate::preparation::{Case, FilteredRecording, PreparationError, Setup};
use thetahat_estimation::identification::JointWeights;
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::robot::{Robot, Shape, TermColumn};
use thetahat_report::results::ProfiledTerm;

/// Rounds over all terms: the constants of one depend little on those of another.
const ROUNDS: usize = 2;

/// The robot of a setup with the constants of its profiled terms, and what they are. Nothing is done where no term asks for it.
pub(in crate::run) fn with_profiled_terms(
    setup: Setup<'_>,
    recordings: &[&FilteredRecording],
) -> Result<Option<(Robot, Vec<ProfiledTerm>)>, PreparationError> {
    let robot = setup.robot;
    let is_asked = |column: &&TermColumn| robot.term_descriptions[column.term].is_profiled();
    let asked: Vec<TermColumn> = robot.terms.iter().filter(is_asked).cloned().collect();
    if asked.is_empty() {
        return Ok(None);
    }
    let problem = setup.problem(&Case::nominal(), recordings)?;
    let regression = problem.all_columns();
    let of_recordings: Vec<f64> = recordings.iter().map(|r| r.recording.weight).collect();
    let Ok(of_joints) = JointWeights::of(regression, &of_recordings) else { return Ok(None) };
    let weights = regression
        .row_weights(&of_recordings, Some(&of_joints.weights))
        .unwrap_or_else(|| vec![1.0; regression.y.len()]);
    let source = ColumnSource { setup, recordings, problem: &problem };
    let table = problem.model.parameter_table();
    let is_profiled = |kept: usize| asked.iter().any(|c| table.get(kept).own_name.as_deref() == Some(&c.parameter));
    let others: Vec<usize> =
        problem.base.columns().iter().enumerate().filter(|(_, kept)| !is_profiled(**kept)).map(|(c, _)| c).collect();
    let others = regression.x.select_columns(&others);
    let mut found = asked.clone();
    let mut profiled = Vec::new();
    for _ in 0..ROUNDS {
        profiled.clear();
        for k in 0..found.len() {
            let Shape::Stribeck(stribeck) = found[k].shape else { continue };
            let rest: Vec<TermColumn> = (0..found.len()).filter(|&i| i != k).map(|i| renamed(&found[i], i)).collect();
            let others_of_terms = if rest.is_empty() { None } else { Some(source.columns(rest)?) };
            let all = Matrix::side_by_side(&[&others].into_iter().chain(&others_of_terms).collect::<Vec<_>>());
            let best = Projection::new(source, weights.clone(), &all).profile(&found[k], stribeck.law)?;
            found[k].shape = Shape::Stribeck(best.stribeck);
            profiled.push(ProfiledTerm {
                term: found[k].term,
                joint: robot.joints[found[k].joint].name.clone(),
                velocity: best.stribeck.velocity,
                exponent: best.stribeck.exponent,
                at_limit: best.at_limit,
            });
        }
    }
    Ok(Some((with_constants(robot, &profiled), profiled)))
}

/// A column under a name that no other has.
fn renamed(column: &TermColumn, place: usize) -> TermColumn {
    TermColumn { parameter: format!("other_{place}"), ..column.clone() }
}

/// The robot with the constants of its terms that were found: a profiled term becomes one for each of its joints, with the constants
/// of that joint.
#[must_use]
pub fn with_constants(robot: &Robot, profiled: &[ProfiledTerm]) -> Robot {
    let (mut descriptions, mut place) = (Vec::new(), BTreeMap::new());
    let mut terms = robot.terms.clone();
    for column in &mut terms {
        let joint = &robot.joints[column.joint].name;
        let of_term: Vec<&ProfiledTerm> = profiled.iter().filter(|p| p.term == column.term).collect();
        let constants = of_term.iter().find(|p| p.joint == *joint);
        let description = robot.term_descriptions[column.term].clone();
        let description = if of_term.is_empty() { description } else { description.on_joint(joint) };
        let description = match constants {
            Some(p) => description.with_constants(p.velocity, p.exponent),
            None => description,
        };
        // The columns of a term that stays as it is share its description.
        let own = (column.term, (!of_term.is_empty()).then_some(column.joint));
        column.term = *place.entry(own).or_insert_with(|| {
            descriptions.push(description);
            descriptions.len() - 1
        });
        if let (Some(p), Shape::Stribeck(stribeck)) = (constants, &mut column.shape) {
            (stribeck.velocity, stribeck.exponent) = (p.velocity, p.exponent);
        }
    }
    Robot { terms, term_descriptions: descriptions, ..robot.clone() }
}
