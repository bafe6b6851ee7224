use std::path::Path;

use super::super::table::RequestedColumns;
use super::super::test_files::MatBytes;
use super::super::{Format, RecordingError, select, written_elsewhere};
use super::*;
use thetahat_ground::series::Series;

const FILE: &str = "q.mat";

fn loaded(bytes: &[u8], names: &[&str]) -> Result<Series, RecordingError> {
    let (path, names) = (Path::new(FILE), names.iter().map(|&n| n.to_owned()).collect::<Vec<_>>());
    let wanted = if names.is_empty() { RequestedColumns::All } else { RequestedColumns::Named(&names) };
    select::series(&read(bytes.to_vec(), path, wanted)?, Format::Mat, &names, path)
}

fn failure(bytes: &[u8], names: &[&str]) -> RecordingError {
    loaded(bytes, names).unwrap_err()
}

fn is_of_kind(bytes: &[u8], name: &str, kind: &str) -> bool {
    matches!(failure(bytes, &[name]), RecordingError::NotNumeric { found, .. } if found == kind)
}

/// A column, a row, a matrix of two columns, and a scalar.
fn valid() -> MatBytes {
    let file = MatBytes::new();
    let file = file.with("t", &[3, 1], &[0.0, 0.1, 0.2]).with("row", &[1, 3], &[1.0, 2.0, 3.0]);
    file.with("tau", &[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).with("kp", &[1, 1], &[160.18])
}

#[test]
fn matrix_gives_one_channel_a_column() {
    let series = loaded(valid().bytes(), &["tau"]).unwrap();
    assert_eq!((series.channels(), series.channel(1)), (2, vec![4.0, 5.0, 6.0]));
}

#[test]
fn variables_stand_side_by_side_and_a_row_is_a_channel() {
    let series = loaded(valid().bytes(), &["row", "tau"]).unwrap();
    assert_eq!(series.values(), [1.0, 1.0, 4.0, 2.0, 2.0, 5.0, 3.0, 3.0, 6.0]);
}

#[test]
fn variable_without_elements() {
    let file = MatBytes::new().with("q", &[0, 2], &[]);
    assert!(matches!(failure(file.bytes(), &["q"]), RecordingError::NoSamples { .. }));
}

#[test]
fn sample_that_is_nan() {
    let file = MatBytes::new().with("q", &[3, 1], &[1.0, f64::NAN, 2.0]);
    assert!(matches!(failure(file.bytes(), &["q"]), RecordingError::NotFiniteSample { sample: 1, .. }));
}

#[test]
fn variables_of_different_lengths() {
    let file = valid().with("q", &[2, 1], &[1.0, 2.0]);
    let error = failure(file.bytes(), &["t", "q"]);
    assert!(matches!(error, RecordingError::DifferentLengths { first_samples: 3, second_samples: 2, .. }));
}

#[test]
fn one_column_of_a_matrix() {
    assert_eq!(loaded(valid().bytes(), &["tau[2]", "t"]).unwrap().values(), [4.0, 0.0, 5.0, 0.1, 6.0, 0.2]);
    assert!(matches!(failure(valid().bytes(), &["tau[3]"]), RecordingError::MissingChannel { found: 2, .. }));
    assert!(matches!(failure(valid().bytes(), &["tau[0]"]), RecordingError::MissingChannel { .. }));
}

#[test]
fn other_file() {
    assert!(matches!(failure(b"a,b\n1,2\n", &["t"]), RecordingError::NotMat { .. }));
}

#[test]
fn fields_of_a_structure() {
    let file = valid().with_structure("log", [("q", &[1.0, 2.0]), ("tau", &[3.0, 4.0])]);
    assert_eq!(loaded(file.bytes(), &["log.tau", "log.q"]).unwrap().values(), [3.0, 1.0, 4.0, 2.0]);
}

#[test]
fn whole_numbers() {
    let file = MatBytes::new().with_int32("counts", &[1, -2, 1 << 30]);
    assert_eq!(loaded(file.bytes(), &[]).unwrap().values(), [1.0, -2.0, f64::from(1 << 30)]);
}

#[test]
fn compressed_variable() {
    let file = MatBytes::new().with_compressed("tau", &[2, 2], &[1.0, 2.0, 3.0, 4.0]);
    assert_eq!(loaded(file.bytes(), &["tau"]).unwrap().values(), [1.0, 3.0, 2.0, 4.0]);
}

#[test]
fn variable_that_expands_without_end() {
    let values = vec![0.0; 1 << 25];
    let file = MatBytes::new().with_compressed("tau", &[1 << 25, 1], &values);
    assert!(file.bytes().len() < 1 << 20);
    assert!(matches!(failure(file.bytes(), &["tau"]), RecordingError::TooLarge { .. }));
}

#[test]
fn file_cut_short_anywhere_is_refused_or_lacks_the_last_variable() {
    let whole = valid();
    for length in 1..whole.bytes().len() - 1 {
        let error = failure(&whole.bytes()[..length], &["kp"]);
        let missing = matches!(error, RecordingError::MissingColumn { .. });
        let refused = matches!(error, RecordingError::NotMat { .. } | RecordingError::Damaged { .. });
        assert!(missing || refused, "{length}: {error}");
    }
}

#[test]
fn damaged_bytes_never_panic() {
    let whole = valid().with_structure("log", [("q", &[1.0]), ("tau", &[3.0])]).with_compressed("c", &[1, 1], &[1.0]);
    for place in 0..whole.bytes().len() {
        for damage in [0x00, 0x01, 0x02, 0x0e, 0x0f, 0x7f, 0x80, 0xff] {
            let mut bytes = whole.bytes().to_vec();
            bytes[place] = damage;
            let _ = read(bytes, Path::new(FILE), RequestedColumns::All);
        }
    }
}

#[test]
fn size_beyond_all_counting() {
    for size in [[1 << 16, 1 << 16], [u32::MAX, u32::MAX]] {
        let bytes = MatBytes::new().with("t", &size, &[1.0]);
        assert!(matches!(failure(bytes.bytes(), &["t"]), RecordingError::TooLarge { .. }));
    }
}

#[test]
fn size_of_more_values_than_there_are() {
    let bytes = MatBytes::new().with("t", &[2, 3], &[1.0; 5]);
    assert!(matches!(failure(bytes.bytes(), &["t"]), RecordingError::Damaged { .. }));
}

#[test]
fn none_listed_of_several() {
    assert!(matches!(failure(valid().bytes(), &[]), RecordingError::NoColumnListed { found, .. }
        if found == ["t", "row", "tau", "kp"]));
}

#[test]
fn missing_variable_lists_those_present() {
    let error = failure(valid().bytes(), &["q"]);
    assert!(matches!(error, RecordingError::MissingColumn { column, found, .. } if column == "q" && found.len() == 4));
}

#[test]
fn kinds_that_are_not_read_say_what_they_are_and_do_not_hide_the_others() {
    let file =
        valid().with_text("note", "run 3").with_complex("z", &[2, 1], &[1.0, 2.0]).with("q", &[1, 2, 2], &[1.0; 4]);
    assert_eq!(loaded(file.bytes(), &["t"]).unwrap().len(), 3);
    assert!(is_of_kind(file.bytes(), "note", "text"));
    assert!(is_of_kind(file.bytes(), "z", "complex"));
    assert!(is_of_kind(file.bytes(), "q", "an array of 3 dimensions"));
}

/// As MATLAB writes a table: no numbers, and what it consists of in a variable without a name.
#[test]
fn a_table_names_the_commands_that_make_numbers_of_it() {
    let file = valid().with_object("T", "table").with("", &[1, 2], &[1.0, 2.0]);
    assert_eq!(loaded(file.bytes(), &["t"]).unwrap().len(), 3);
    let text = failure(file.bytes(), &["T"]).to_string();
    assert!(text.contains("table2struct(T, 'ToScalar', true)"), "{text}");
    let text =
        failure(valid().with_object("logsout", "Simulink.SimulationData.Dataset").bytes(), &["logsout"]).to_string();
    assert!(text.contains("logsout.get(1).Values"), "{text}");
    assert!(
        matches!(failure(file.bytes(), &[]), RecordingError::NoColumnListed { found, .. } if !found.contains(&String::new()))
    );
}

#[test]
fn cell_arrays_of_vectors_have_a_channel_for_each_cell() {
    let bytes = written_elsewhere::bytes(written_elsewhere::CELLS);
    assert_eq!(loaded(&bytes, &["q", "t"]).unwrap().values(), [1.0, 4.0, 0.0, 2.0, 5.0, 1.0, 3.0, 6.0, 2.0]);
    assert_eq!(loaded(&bytes, &["q[2]"]).unwrap().values(), [4.0, 5.0, 6.0]);
    let text = failure(&bytes, &["bad"]).to_string();
    assert!(text.contains("cell2mat"), "{text}");
}

#[test]
fn damaged_cell_arrays_never_panic() {
    let whole = written_elsewhere::bytes(written_elsewhere::CELLS);
    for place in 128..whole.len() {
        let _ = read(whole[..place].to_vec(), Path::new(FILE), RequestedColumns::All);
        for damage in [0x00, 0x01, 0x0e, 0x7f, 0xff] {
            let mut bytes = whole.clone();
            bytes[place] = damage;
            let _ = read(bytes, Path::new(FILE), RequestedColumns::All);
        }
    }
}

#[cfg(feature = "hdf5")]
mod version_7_3 {
    use hdf5_pure::{AttrValue, FileBuilder};

    use super::*;

    fn matlab(builder: &mut FileBuilder, name: &str, class: &str, sides: &[u64], values: &[f64]) {
        let set = builder.create_dataset(name).with_f64_data(values).with_shape(sides);
        set.set_attr("MATLAB_class", AttrValue::AsciiString(class.to_owned()));
    }

    /// As MATLAB writes a time of three samples and torques of two channels.
    fn valid() -> Vec<u8> {
        let mut builder = FileBuilder::new();
        matlab(&mut builder, "t", "double", &[1, 3], &[0.0, 0.1, 0.2]);
        matlab(&mut builder, "tau", "double", &[2, 3], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        matlab(&mut builder, "note", "char", &[1, 1], &[65.0]);
        builder.create_dataset("plain").with_f64_data(&[1.0, 2.0]);
        builder.finish().unwrap()
    }

    #[test]
    fn matrix_gives_one_channel_a_column() {
        let series = loaded(&valid(), &["tau", "t"]).unwrap();
        assert_eq!(series.values(), [1.0, 4.0, 0.0, 2.0, 5.0, 0.1, 3.0, 6.0, 0.2]);
    }

    #[test]
    fn kinds_that_are_not_read() {
        assert!(is_of_kind(&valid(), "note", "text"));
        assert!(is_of_kind(&valid(), "plain", "a data set without the class that MATLAB gives to its variables"));
    }

    #[test]
    fn fields_of_a_structure() {
        let mut builder = FileBuilder::new();
        let mut group = builder.create_group("log");
        let set = group.create_dataset("q").with_f64_data(&[1.0, 2.0]).with_shape(&[1, 2]);
        set.set_attr("MATLAB_class", AttrValue::AsciiString("double".to_owned()));
        builder.add_group(group.finish());
        assert_eq!(loaded(&builder.finish().unwrap(), &["log.q"]).unwrap().values(), [1.0, 2.0]);
    }

    #[test]
    fn cell_arrays_and_tables() {
        let bytes = written_elsewhere::bytes(written_elsewhere::CELLS_7_3);
        assert_eq!(loaded(&bytes, &["q[2]", "q[1]"]).unwrap().values(), [4.0, 1.0, 5.0, 2.0, 6.0, 3.0]);
        let text = failure(&bytes, &["T"]).to_string();
        assert!(text.contains("table2struct"), "{text}");
        for place in (0..bytes.len()).filter(|&place| bytes[place] != 0) {
            for damage in [0x00, 0x01, 0xff] {
                let mut bytes = bytes.clone();
                bytes[place] = damage;
                let _ = read_v73(bytes, Path::new(FILE), RequestedColumns::All);
            }
        }
    }

    #[test]
    fn file_cut_short() {
        let whole = valid();
        for length in 8..whole.len() {
            let result = loaded(&whole[..length], &["tau"]);
            assert!(matches!(result, Err(RecordingError::Damaged { .. })), "{length}");
        }
    }

    #[test]
    fn damaged_bytes_never_panic() {
        let whole = valid();
        for place in 0..whole.len() {
            for damage in [0x00, 0x01, 0x7f, 0xff] {
                let mut bytes = whole.clone();
                bytes[place] = damage;
                let _ = read_v73(bytes, Path::new(FILE), RequestedColumns::All);
            }
        }
    }
}

#[cfg(feature = "hdf5")]
mod plain_hdf5 {
    use super::*;

    fn h5(bytes: &[u8], names: &[&str]) -> Result<Series, RecordingError> {
        let (path, names) = (Path::new("q.h5"), names.iter().map(|&n| n.to_owned()).collect::<Vec<_>>());
        let table = read_hdf5(bytes.to_vec(), path, RequestedColumns::Named(&names))?;
        select::series(&table, Format::Hdf5, &names, path)
    }

    #[test]
    fn data_sets_in_groups_have_a_sample_in_each_row() {
        let bytes = written_elsewhere::bytes(written_elsewhere::HDF5);
        assert_eq!(h5(&bytes, &["arm/q"]).unwrap().values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(h5(&bytes, &["arm/tau[2]", "t"]).unwrap().values(), [2.0, 0.0, 4.0, 0.1, 6.0, 0.2]);
        let found = h5(&bytes, &["q"]).unwrap_err();
        assert!(matches!(found, RecordingError::MissingColumn { found, .. } if found.contains(&"arm/q".to_owned())));
        let records = h5(&bytes, &["rec"]).unwrap_err();
        assert!(matches!(records, RecordingError::NotNumeric { found, .. } if found.contains("compound")));
    }

    #[test]
    fn damaged_files_never_panic() {
        let whole = written_elsewhere::bytes(written_elsewhere::HDF5);
        for length in (0..whole.len()).step_by(13) {
            assert!(matches!(h5(&whole[..length], &["t"]), Err(RecordingError::Damaged { .. })), "{length}");
        }
        for place in (0..whole.len()).filter(|&place| whole[place] != 0) {
            for damage in [0x00, 0x01, 0xff] {
                let mut bytes = whole.clone();
                bytes[place] = damage;
                let _ = read_hdf5(bytes, Path::new("q.h5"), RequestedColumns::All);
            }
        }
    }
}
