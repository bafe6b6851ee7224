//! Recordings in Parquet are read by groups and pages: the same reduction as from other files, in less memory than they
//! take decoded.

use std::{
    fs::{self, File},
    io::{BufWriter, Write},
    path::Path,
    process::Command,
    sync::Arc,
    time::Instant,
};

use parquet::{
    basic::Compression,
    data_type::DoubleType,
    file::{properties::WriterProperties, writer::SerializedFileWriter},
    schema::parser::parse_message_type,
};
use thetahat::{
    Experiment,
    reduction::{ReduceOptions, ReducedRecording, Reduction},
};
use thetahat_testing::Folder;

/// Samples whose twelve channels take 192 MB decoded.
const LONG: usize = 2_000_000;
const DECODED_BYTES: usize = LONG * 12 * 8;
/// Names the experiment to the process whose memory is measured.
const CHILD: &str = "THETAHAT_TEST_LONG_PARQUET";

/// One motion of the demonstration, repeated for longer records: for each channel its samples.
fn channels(samples: usize) -> Vec<Vec<f64>> {
    let record = Experiment::demo().unwrap().record_twin().unwrap();
    let of = |series: &thetahat::Series| -> Vec<Vec<f64>> {
        let channel = |c| series.channel(c).into_iter().cycle().take(samples).collect();
        (0..series.channels()).map(channel).collect()
    };
    [of(&record.position), of(&record.torque)].concat()
}

fn names() -> Vec<String> {
    ["position", "torque"].iter().flat_map(|name| (1..=6).map(move |j| format!("{name}_{j}"))).collect()
}

fn write_parquet(path: &Path, channels: &[Vec<f64>], of_group: usize) {
    let columns: String = names().iter().map(|name| format!("REQUIRED DOUBLE {name};")).collect();
    let schema = Arc::new(parse_message_type(&format!("message record {{ {columns} }}")).unwrap());
    let properties = Arc::new(WriterProperties::builder().set_compression(Compression::SNAPPY).build());
    let mut writer = SerializedFileWriter::new(File::create(path).unwrap(), schema, properties).unwrap();
    for start in (0..channels[0].len()).step_by(of_group) {
        let mut group = writer.next_row_group().unwrap();
        for channel in channels {
            let values = &channel[start..(start + of_group).min(channel.len())];
            let mut column = group.next_column().unwrap().unwrap();
            column.typed::<DoubleType>().write_batch(values, None, None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    writer.close().unwrap();
}

fn write_csv(path: &Path, channels: &[Vec<f64>]) {
    let mut file = BufWriter::new(File::create(path).unwrap());
    writeln!(file, "{}", names().join(",")).unwrap();
    for k in 0..channels[0].len() {
        let values: Vec<String> = channels.iter().map(|channel| channel[k].to_string()).collect();
        writeln!(file, "{}", values.join(",")).unwrap();
    }
}

/// The demonstration with a file in place of the twin.
fn experiment(folder: &Path, file: &str) -> Experiment {
    let demo = Experiment::demo().unwrap();
    let (_, rest) = demo.text.split_once("[signal]").unwrap();
    let (rest, _) = rest.split_once("[[case]]").unwrap();
    let columns = names();
    let source = |c: &[String], unit: &str| format!("{{ file = '{file}', columns = {c:?}, unit = '{unit}' }}");
    let (position, torque) = (source(&columns[..6], "rad"), source(&columns[6..], "N m"));
    let text = format!(
        "title = 'recorded'\nrobot = 'tx40.toml'\n[recording]\nsample_rate_hz = 5000\nposition = {position}\n\
         torque = {torque}\n[signal]\nwindow_start_s = 0.1\nwindow_end_s = 7.3{rest}"
    );
    Experiment::from_texts(&folder.join("recorded.toml"), text, demo.robot_text).unwrap()
}

fn reduce(experiment: &Experiment, folder: &Path, piece_samples: usize) -> Reduction {
    experiment.reduce(folder, ReduceOptions { threads: 2, piece_samples, rows_only: true }, &mut |_| {}).unwrap()
}

/// The recordings of a reduction, whatever their files are called.
fn without_file_names(reduction: Reduction) -> Vec<ReducedRecording> {
    reduction.recordings.into_iter().map(|r| ReducedRecording { file: String::new(), ..r }).collect()
}

/// Bit by bit, whatever the groups and pieces.
#[test]
#[ignore = "long, each night"]
fn a_reduction_from_parquet_is_that_from_text() {
    let folder = Folder::new();
    let samples = Experiment::demo().unwrap().record_twin().unwrap().position.len();
    let channels = channels(samples);
    write_csv(&folder.at("record.csv"), &channels);
    let text = experiment(folder.path(), "record.csv");
    let [in_pieces, whole] =
        [3000, 1 << 16].map(|piece| (piece, without_file_names(reduce(&text, folder.path(), piece))));
    for (of_group, (piece, expected)) in [(9999, &whole), (1000, &in_pieces)] {
        write_parquet(&folder.at("record.parquet"), &channels, of_group);
        let parquet = experiment(folder.path(), "record.parquet");
        assert_eq!(without_file_names(reduce(&parquet, folder.path(), *piece)), *expected, "{of_group} {piece}");
    }
}

/// In a process of its own, whose memory is then its alone.
#[test]
#[ignore = "long, each night"]
fn a_long_record_takes_less_memory_than_its_channels() {
    if let Some(file) = std::env::var_os(CHILD) {
        return child(Path::new(&file));
    }
    let folder = Folder::new();
    let channels = channels(LONG);
    for of_group in [100_000, 1 << 20] {
        let file = folder.at("record.parquet");
        write_parquet(&file, &channels, of_group);
        let started = Instant::now();
        let name = "a_long_record_takes_less_memory_than_its_channels";
        let mut child = Command::new(std::env::current_exe().unwrap());
        let output = child.args([name, "--exact", "--nocapture"]).env(CHILD, &file).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
        let peak = text.lines().find_map(|line| line.split_once("most memory in kB: ")?.1.trim().parse::<usize>().ok());
        let Some(peak) = peak else {
            println!("the most memory of a process is not told on this system");
            return;
        };
        let seconds = started.elapsed().as_secs_f64();
        println!("groups of {of_group}: {} kB of {} kB, {seconds:.1} s", peak, DECODED_BYTES / 1024);
        assert!(peak * 1024 < DECODED_BYTES, "groups of {of_group}: {peak} kB");
    }
}

fn child(file: &Path) {
    let folder = file.parent().unwrap();
    let mut experiment = experiment(folder, "record.parquet");
    experiment.settings.signal.window_end_s = Some(LONG as f64 / 5000.0 - 0.1);
    let reduction = reduce(&experiment, folder, 1 << 16);
    assert_eq!(reduction.recordings[0].samples, LONG - 1000);
    if let Ok(status) = fs::read_to_string("/proc/self/status")
        && let Some(peak) = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB"))
    {
        println!("most memory in kB: {}", peak.trim());
    }
}
