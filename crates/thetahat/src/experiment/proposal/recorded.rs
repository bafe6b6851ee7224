//! The positions of a robot's joints that a file has, by the names of its columns.

use super::{
    super::column_names::Signal,
    columns,
    offer::{sources, tables},
    request::ProposalRequest,
    source::{SelectedColumn, Source},
};
use thetahat_data::recording::Contents;
use thetahat_model::robot::Robot;

/// Name, least and largest value of the position's column of each joint; `None` where the names show none.
pub(in crate::experiment) fn recorded_positions(contents: &Contents, robot: &Robot) -> Vec<Option<(String, [f64; 2])>> {
    let request = ProposalRequest { recording_files: vec![contents.file.clone()], ..ProposalRequest::default() };
    let contents = std::slice::from_ref(contents);
    let tables = tables(&request, contents, &[]);
    let mut all = sources(&request, contents, &tables).into_iter().map(|source| positions_of(&source, robot));
    all.find(|positions| positions.iter().any(Option::is_some)).unwrap_or_default()
}

/// The same of one table or topic: a recording split by topics has the torques in another one.
fn positions_of(source: &Source<'_>, robot: &Robot) -> Vec<Option<(String, [f64; 2])>> {
    let names: Vec<&str> = robot.coordinates().map(|joint| joint.name.as_str()).collect();
    let positions = columns::measured(source, robot, Signal::Position).0;
    let by_name = source.columns_of(&names, &positions);
    let columns: Vec<Option<SelectedColumn<'_>>> = if by_name.iter().any(Option::is_some) {
        by_name.into_iter().map(|column| column.map(SelectedColumn::of)).collect()
    } else {
        let all = columns::by_name(source, robot, Signal::Position).unwrap_or_default();
        all.iter().flat_map(SelectedColumn::each).map(Some).collect()
    };
    let ends = |column: SelectedColumn<'_>| {
        let channel = column.channels.first()?;
        Some((column.name.clone(), [channel.min?, channel.max?]))
    };
    columns.into_iter().map(|column| column.and_then(ends)).collect()
}
