//! Signals that were recorded late or early, moved to where they belong.

use std::ops::Range;

use super::description::RecordingDescription;
use crate::preparation::Recording;
use thetahat_data::recording::ChannelSource;
use thetahat_estimation::signal::delayed;
use thetahat_ground::series::Series;

/// Every signal moved to where it belongs by its delay. A signal recorded too late lacks its last samples: the recording ends
/// before them. A signal recorded too early lacks its first ones, which become a gap.
pub(super) fn without_delays(recording: Recording, description: &RecordingDescription) -> Recording {
    let rate = recording.sample_rate_hz;
    let of = |source: &ChannelSource| source.delay_s.given().iter().map(|delay| delay * rate).collect::<Vec<f64>>();
    let optional = [&description.torque, &description.velocity, &description.reference, &description.added_signal];
    let [torque, velocity, reference, added_signal] =
        optional.map(|source| source.as_ref().map(of).unwrap_or_default());
    let position = of(&description.position);
    let others = description.channels.values().flat_map(of);
    let own = [&position, &torque, &velocity, &reference, &added_signal].into_iter().flatten().copied();
    let all: Vec<f64> = own.chain(others).collect();
    let [earliest, latest] = [all.iter().copied().fold(0.0, f64::min), all.iter().copied().fold(0.0, f64::max)];
    if earliest == 0.0 && latest == 0.0 {
        return recording;
    }
    let lost = |samples: f64| if samples == 0.0 { 0 } else { samples.abs().ceil() as usize + 2 };
    let end = recording.position.len().saturating_sub(lost(latest)).max(1);
    let moved = |series: Series, samples: &[f64]| {
        let of_channel = |c: usize| samples.get(c).or(samples.first()).map_or(0.0, |delay| -delay);
        let delays: Vec<f64> = (0..series.channels()).map(of_channel).collect();
        let is_late = delays.iter().any(|delay| *delay != 0.0);
        if is_late { delayed(&series, &delays).window(0..end) } else { series.window(0..end) }
    };
    let channel = |(name, series): (String, Series)| {
        let delay = description.channels.get(&name).map(of).unwrap_or_default();
        (name, moved(series, &delay))
    };
    let channels = recording.channels.into_iter().map(channel).collect();
    Recording {
        channels,
        gaps: moved_gaps(&recording.gaps, lost(latest), lost(earliest), end),
        position: moved(recording.position, &position),
        torque: recording.torque.map(|s| moved(s, &torque)),
        velocity: recording.velocity.map(|s| moved(s, &velocity)),
        reference: recording.reference.map(|s| moved(s, &reference)),
        added_signal: recording.added_signal.map(|s| moved(s, &added_signal)),
        ..recording
    }
}

/// Gaps of all signals, which are earlier and later by up to so many samples, and the samples before the first.
fn moved_gaps(gaps: &[Range<usize>], earlier: usize, later: usize, end: usize) -> Vec<Range<usize>> {
    let before = (later > 0).then_some(0..later.min(end));
    let mut moved: Vec<Range<usize>> = before.into_iter().collect();
    for gap in gaps {
        let (start, stop) = (gap.start.saturating_sub(earlier), (gap.end + later).min(end));
        match moved.last_mut().filter(|last| last.end >= start) {
            Some(last) => last.end = last.end.max(stop),
            None if start < stop => moved.push(start..stop),
            None => {}
        }
    }
    moved
}
