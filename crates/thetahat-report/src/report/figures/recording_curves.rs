//! Curves over the time of recordings: measured values, predictions, and borders between recordings.

use crate::{
    report::plot::{Curve, Panel},
    results::RecordStart,
};

/// Values per joint over the time of recordings.
pub(super) struct RecordingCurves<'a> {
    pub(super) time_s: &'a [f64],
    pub(super) measured: &'a [Vec<f64>],
    pub(super) starts: &'a [RecordStart],
}

impl RecordingCurves<'_> {
    /// A curve with a gap between recordings.
    pub(super) fn curve(&self, class: &str, values: impl Iterator<Item = f64>) -> Curve {
        let mut points = Vec::with_capacity(self.time_s.len() + self.starts.len());
        for (row, point) in self.time_s.iter().copied().zip(values).enumerate() {
            if row > 0 && self.starts.iter().any(|s| s.row == row) {
                points.push((f64::NAN, f64::NAN));
            }
            points.push(point);
        }
        Curve::new(class, points)
    }

    /// `values - reference`, scaled, with a gap between recordings.
    pub(super) fn difference(&self, class: &str, [values, reference]: [&[f64]; 2], scale: f64) -> Curve {
        self.curve(class, values.iter().zip(reference).map(|(v, r)| scale * (v - r)))
    }

    /// Marks where each recording but the first begins. Where there are several, their names stand above one panel only.
    pub(super) fn borders(&self, panel: Panel, with_names: bool) -> Panel {
        let named = with_names && self.starts.len() > 1;
        let time_of = |start: &RecordStart| self.time_s.get(start.row).copied();
        let next = self.starts.iter().skip(1).map(time_of).chain([None]);
        let all = self.starts.iter().zip(next).filter_map(|(start, next)| Some((time_of(start)?, next, start)));
        all.fold(panel, |panel, (time, next, start)| {
            let end = next.unwrap_or(panel.x[1]);
            let panel = if named { panel.name_between([time, end], &start.name) } else { panel };
            if start.row > 0 { panel.upright("border", time) } else { panel }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::plot::{Chart, NARROW, Range};

    #[test]
    fn the_second_recording_begins_at_its_border() {
        let starts = [("a", 0), ("b", 2)].map(|(name, row)| RecordStart { name: name.to_owned(), row });
        let records = RecordingCurves { time_s: &[0.0, 1.0, 5.0, 10.0], measured: &[], starts: &starts };
        let curve = records.curve("measured", [1.0, 2.0, 3.0, 4.0].into_iter());
        assert!(curve.points.len() == 5 && curve.points[2].0.is_nan());
        let range = Range { low: 0.0, high: 10.0 };
        let chart = Chart::new(String::new(), "", NARROW).with(80.0, |p| records.borders(p.over(range, 0.0), true));
        let panel = &chart.panels[0];
        // 5 s of 10 s: the middle of the panel, in tenths of a pixel.
        assert_eq!(panel.paths[0].data, format!("M{} 0v800", 5.0 * panel.width));
        let names: Vec<&str> = panel.texts.iter().map(|t| t.text.as_str()).collect();
        assert_eq!((panel.paths.len(), names), (1, vec!["a", "b"]));
    }
}
