//! Recordings of real robots in three formats: how much is in them, a few of their values as other software reads them, and
//! what their inspection says.

use libtest_mimic::{Failed, Trial};
use thetahat::{
    Series,
    recording::{ChannelSource, Format, Unit, inspect, read_channels},
};
use thetahat_data::recording::TableSummary;
use thetahat_testing::ensure;

/// Sums of columns are compared to this share of the sum, since they are added in another order.
const ROUNDING: f64 = 1e-9;

fn channels(description: &str) -> Result<Series, Failed> {
    let source: ChannelSource = toml::from_str(description)?;
    Ok(read_channels(&source, &thetahat_testing::data())?)
}

fn largest(tables: &[TableSummary]) -> Result<&TableSummary, Failed> {
    tables.iter().max_by_key(|table| table.samples).ok_or_else(|| "no table".into())
}

/// NumPy: `z["positions"].sum()` and so on.
fn kuka_archive() -> Result<(), Failed> {
    let positions = channels("file = 'kuka_lwr4/measurements_2.npz'\ncolumns = ['positions']\nunit = 'rad'")?;
    ensure(
        (positions.len(), positions.channels()) == (5027, 7),
        format!("{} x {}", positions.len(), positions.channels()),
    )?;
    let sum: f64 = positions.values().iter().sum();
    ensure((sum + 72.37700268390017).abs() < ROUNDING * 5027.0, format!("sum of positions {sum}"))?;
    ensure(positions.channel(6)[5026] == -0.8443223760488284, "last position of joint 7")?;
    let torque = channels("file = 'kuka_lwr4/measurements_2.npz'\ncolumns = ['torques[3]']\nunit = 'N m'")?;
    let sum: f64 = torque.values().iter().sum();
    ensure((sum + 636.8482306849189).abs() < ROUNDING * 5027.0, format!("sum of torques of joint 3 {sum}"))
}

fn kuka_inspection() -> Result<(), Failed> {
    let contents = inspect(&thetahat_testing::data().join("kuka_lwr4/measurements_2.npz"))?;
    let table = largest(&contents.tables)?;
    ensure((contents.format, table.samples, table.columns.len()) == (Format::Npz, 5027, 8), format!("{contents:?}"))?;
    let Some(time) = table.times.first() else { return Err("no time".into()) };
    ensure(time.column == "times" && time.unit == Unit::Second, format!("{time:?}"))?;
    ensure((time.rate_hz - 200.0).abs() < 1.0, format!("{time:?}"))
}

/// A decoder of CDR in Python: positions of the third joint, efforts of the first.
fn ur10_bag() -> Result<(), Failed> {
    let file = "file = 'ur10/ur10_exciting_trajectory.db3'";
    let columns = "columns = ['elbow_joint.position', 'shoulder_pan_joint.position']";
    let positions = channels(&format!("{file}\n{columns}\nunit = 'rad'"))?;
    ensure(
        (positions.len(), positions.channels()) == (3441, 2),
        format!("{} x {}", positions.len(), positions.channels()),
    )?;
    ensure(positions.values()[..2] == [1.6688934532752913, 0.6197782590517766], "first positions")?;
    let sum: f64 = positions.channel(0).iter().sum();
    ensure((sum - 2.5415158479502296).abs() < ROUNDING * 3441.0, format!("sum of positions {sum}"))?;
    let efforts = channels(&format!("{file}\ncolumns = ['effort']\nunit = 'N m'"))?;
    let sum: f64 = efforts.channel(0).iter().sum();
    ensure(
        efforts.channels() == 6 && (sum - 1429.8069141121787).abs() < ROUNDING * 3441.0,
        format!("sum of efforts {sum}"),
    )?;
    let stamps = channels(&format!("{file}\ntopic = '/joint_states'\ncolumns = ['stamp']\nunit = 's'"))?;
    ensure((stamps.values()[0], stamps.values()[3440]) == (0.0, 27_519_999_999.0 * 1e-9), "stamps")
}

fn ur10_inspection() -> Result<(), Failed> {
    let contents = inspect(&thetahat_testing::data().join("ur10/ur10_exciting_trajectory.db3"))?;
    let [table] = contents.tables.as_slice() else { return Err(format!("{} tables", contents.tables.len()).into()) };
    ensure(
        (table.name.as_str(), table.samples, table.columns.len()) == ("/joint_states", 3441, 20),
        format!("{table:?}"),
    )?;
    ensure(table.times.len() == 2, "stamp and log time are times")?;
    let time = &table.times[0];
    ensure((time.rate_hz - 125.0).abs() < 1e-6 && time.gaps.is_empty() && time.jitter_max < 1e-6, format!("{time:?}"))
}

fn emps_matlab() -> Result<(), Failed> {
    let contents = inspect(&thetahat_testing::data().join("emps/DATA_EMPS.mat"))?;
    let table = largest(&contents.tables)?;
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    ensure(table.samples == 24841 && ["t", "qm", "qg", "vir"].iter().all(|n| names.contains(n)), format!("{names:?}"))?;
    let Some(time) = table.times.first() else { return Err("no time".into()) };
    ensure(time.column == "t" && (time.rate_hz - 1000.0).abs() < 1e-3, format!("{time:?}"))?;
    let gain = channels("file = 'emps/DATA_EMPS.mat'\ncolumns = ['gtau']\nunit = '1'")?;
    ensure((gain.values()[0] - 35.15065).abs() < 5e-6, format!("{gain:?}"))
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    thetahat_testing::trials_on_shared_data(
        &["datasets/kuka_lwr4", "datasets/ur10", "datasets/emps"],
        vec![
            ("kuka_archive_has_the_values_that_numpy_reads", kuka_archive),
            ("kuka_archive_is_inspected", kuka_inspection),
            ("ur10_bag_has_the_values_that_its_bytes_say", ur10_bag),
            ("ur10_bag_is_inspected", ur10_inspection),
            ("emps_is_inspected_and_its_gain_read", emps_matlab),
        ],
    )
}
