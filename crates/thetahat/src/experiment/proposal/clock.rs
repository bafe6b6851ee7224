use super::{
    error::ProposalError,
    grouping::Group,
    named::{Entry, entry},
    offer::Offer,
    request::ProposalRequest,
    source::Source,
    text::{ProposedChannels, ProposedClock},
};
use thetahat_data::recording::{Side, TimeSummary};
use thetahat_ground::number::significant;

/// Largest part of the rate by which a stated rate may differ from that of the times.
pub(super) const RATE_TOLERANCE: f64 = 0.01;

/// The clock of a recording: the times that were named, or the likeliest of its files, or a stated rate.
pub(super) fn clock(
    request: &ProposalRequest,
    offers: &[Offer<'_>],
    group: &Group,
) -> Result<ProposedClock, ProposalError> {
    let sources: Vec<Source<'_>> = group.files().map(|file| offers[file].source).collect();
    let times = match &request.time {
        Some(named) => Some(named_time(named, &sources)?),
        None => sources.iter().find_map(|source| Some((*source, source.time()?))),
    };
    let of_driver = request.driver.as_ref().and_then(|driver| driver.rate_hz);
    match (request.sample_rate_hz, times, of_driver) {
        (None, Some((source, time)), _) => match time.restart {
            None => Ok(recorded(&source, time)),
            Some(sample) => {
                let (file, column) = (source.file.to_owned(), time.column.clone());
                Err(ProposalError::TimeRestarts { file, column, sample })
            }
        },
        (Some(rate), times, _) => stated(rate, times),
        (None, None, Some(rate_hz)) => Ok(ProposedClock { rate_hz, time: None }),
        (None, None, None) => {
            let first = &sources[0];
            Err(ProposalError::NoTime { file: first.file.to_owned(), columns: first.listed() })
        }
    }
}

fn named_time<'a>(named: &str, sources: &[Source<'a>]) -> Result<(Source<'a>, &'a TimeSummary), ProposalError> {
    let Entry { file, column } = entry(named, sources);
    let asked = || sources.iter().enumerate().filter(|(n, _)| file.is_none_or(|of| of == *n)).map(|(_, s)| *s);
    let time = |source: Source<'a>| {
        let mut times = source.table.into_iter().flat_map(|t| &t.times);
        times.find(|t| column.is_none_or(|name| name == t.column)).map(|time| (source, time))
    };
    if let Some(found) = asked().find_map(time) {
        return Ok(found);
    }
    let has = |source: &Source<'_>| column.is_none_or(|name| source.names().iter().any(|n| n == name));
    let column = column.unwrap_or_default().to_owned();
    match asked().find(has) {
        Some(source) => {
            let problem = "its values do not rise in steps";
            Err(ProposalError::NotATime { file: source.file.to_owned(), column, problem })
        }
        None => {
            let (file, columns) = (sources[0].file.to_owned(), sources[0].listed());
            Err(ProposalError::NoSuchColumn { file, name: column, columns })
        }
    }
}

/// Steps of a stated rate, if no times with the name of a time contradict it.
fn stated(rate_hz: f64, times: Option<(Source<'_>, &TimeSummary)>) -> Result<ProposedClock, ProposalError> {
    let contradicts = |time: &&TimeSummary| time.is_named && (time.rate_hz / rate_hz - 1.0).abs() > RATE_TOLERANCE;
    if let Some((source, time)) = times.filter(|(_, time)| contradicts(time)) {
        return Err(ProposalError::RateContradictsTimes {
            file: source.file.to_owned(),
            column: time.column.clone(),
            stated: rate_hz,
            found: time.rate_hz,
        });
    }
    Ok(ProposedClock { rate_hz, time: None })
}

fn recorded(source: &Source<'_>, time: &TimeSummary) -> ProposedClock {
    let [rms, largest] = [time.jitter_rms, time.jitter_max].map(|j| 100.0 * j);
    let unit = match time.contradicted_unit {
        Some(named) => {
            let rate = significant(time.rate_hz * time.unit.to_si() / named.to_si(), 3);
            format!("; unit a guess: the name says {}, by which the rate is {rate} Hz", named.symbol())
        }
        None if time.is_count => {
            "; unit a guess: the times count by one; if they count samples, give --rate instead".to_owned()
        }
        None => String::new(),
    };
    let comment = format!(
        "{} Hz; its steps deviate by {rms:.2} % rms, {largest:.2} % at most; {} gaps{unit}.",
        (1e6 * time.rate_hz).round() / 1e6,
        time.gaps.len(),
    );
    ProposedClock {
        rate_hz: time.rate_hz,
        time: Some(ProposedChannels {
            file: source.file.to_owned(),
            topic: source.topic().map(str::to_owned),
            columns: vec![time.column.clone()],
            unit: time.unit.into(),
            side: Side::Joint,
            drop_cut_line: source.is_cut(),
            channels_in_rows: false,
            comment,
            gain: None,
            factor: None,
            unit_guessed: false,
            contradiction: None,
            left_out: false,
        }),
    }
}
