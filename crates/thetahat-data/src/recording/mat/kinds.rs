//! What both versions of MAT files say of cell arrays and objects.

use super::super::table::Column;

/// Most cells of a cell array.
pub(super) const MOST_CELLS: usize = 4096;
/// A cell array that is not read.
pub(super) const NOT_VECTORS: &str =
    "a cell array that does not hold vectors of one length (in MATLAB: x = cell2mat(c))";

/// A channel for each cell, if all vectors have one length.
pub(super) fn of_cells(name: String, vectors: Vec<Vec<f64>>) -> Column {
    let length = vectors.first().map_or(0, Vec::len);
    if length == 0 || vectors.iter().any(|vector| vector.len() != length) {
        return Column::of_kind(name, NOT_VECTORS);
    }
    Column::of_numbers(name, vectors.len(), vectors.concat())
}

/// The kind of an object of a class of MATLAB, with the commands that make numbers of it.
pub(super) fn kind_of_object(class: &str) -> String {
    let (kind, commands) = match class {
        "table" => ("a MATLAB table", "S = table2struct(T, 'ToScalar', true); save('log.mat', '-struct', 'S', '-v7')"),
        "timetable" => (
            "a MATLAB timetable",
            "t = seconds(T.Properties.RowTimes - T.Properties.RowTimes(1)); x = T.Variables; save('log.mat', 't', 'x', '-v7')",
        ),
        "timeseries" => ("a MATLAB time series", "t = ts.Time; q = squeeze(ts.Data); save('log.mat', 't', 'q', '-v7')"),
        "Simulink.SimulationData.Dataset" | "Dataset" => (
            "a Simulink Dataset",
            "s = logsout.get(1).Values; t = s.Time; q = squeeze(s.Data); save('log.mat', 't', 'q', '-v7')",
        ),
        "string" => ("text", "double(x) if it holds numbers"),
        _ => ("a MATLAB object", "save its numbers as plain vectors and matrices"),
    };
    format!("{kind} of class {class} (in MATLAB: {commands})")
}
