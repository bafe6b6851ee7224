//! Estimates with their intervals, a row each, compared with other methods and known values.

use serde::Serialize;

use super::figure::{Key, in_case, main_run, named};
use crate::{
    report::{
        number::{NONE, estimate},
        plot::{Tick, pixel},
        published::Published,
        tables::runs_of,
        text::grades::{self, counted},
    },
    results::{DesignResults, Grade, NOMINAL, ParameterResult, PredictedParameter, Results, RunResult},
};

/// Width of the picture, and height of a row without and for each method, pixels.
const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 10.0;
const LANE: f64 = 7.0;
/// Differences that the axis shows, percent of the estimate, and those with a tick.
const FARTHEST: f64 = 200.0;
const TICKS: [f64; 5] = [1.0, 3.0, 10.0, 30.0, 100.0];
/// Difference below which the axis is nearly linear, percent.
const LINEAR: f64 = 2.0;
/// Space at both ends for arrows, pixels.
const MARGIN: f64 = 12.0;

/// A table of estimates with a picture in each row.
#[derive(Debug, Serialize)]
pub(in crate::report) struct Forest {
    /// Id of the grid lines of its pictures.
    pub(in crate::report) id: String,
    pub(in crate::report) conclusion: String,
    pub(in crate::report) caption: String,
    pub(in crate::report) legend: Vec<Key>,
    pub(in crate::report) width: f64,
    pub(in crate::report) ticks: Vec<Tick>,
    pub(in crate::report) groups: Vec<ForestGroup>,
    pub(in crate::report) notes: Vec<String>,
}

#[derive(Debug, Serialize)]
pub(in crate::report) struct ForestGroup {
    pub(in crate::report) label: String,
    pub(in crate::report) rows: Vec<ForestRow>,
}

#[derive(Debug, Serialize)]
pub(in crate::report) struct ForestRow {
    pub(in crate::report) name: String,
    pub(in crate::report) unit: String,
    pub(in crate::report) formula: String,
    pub(in crate::report) estimate: String,
    /// Half of the interval.
    pub(in crate::report) half: String,
    pub(in crate::report) interval: String,
    pub(in crate::report) grade: &'static str,
    pub(in crate::report) grade_class: &'static str,
    pub(in crate::report) height: f64,
    pub(in crate::report) shapes: Vec<Shape>,
}

/// A line or mark, in pixels from the corner of its row.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(in crate::report) struct Shape {
    pub(in crate::report) class: String,
    pub(in crate::report) data: String,
}

/// The estimates of a case that are identified.
pub(in crate::report) fn forest(results: &Results, published: Option<&Published>, case: &str) -> Option<Forest> {
    let forest = of_parameters(results, published, (case, "estimates"), is_first)?;
    let counts = Grade::ALL.map(|grade| (grade, main_run(results, case).map_or(0, |run| run.graded(grade).count())));
    let all: usize = counts.iter().map(|(_, count)| count).sum();
    let examined = |case: &str| main_run(results, case).is_some_and(|run| !run.hidden_bias.is_empty());
    let rule = if examined(NOMINAL) && !examined(case) { ", by their intervals alone" } else { "" };
    Some(Forest { conclusion: format!("{all} parameters: {}{rule}.", counted(counts)), ..forest })
}

/// The parameters that are not identified.
pub(in crate::report) fn not_identified(
    results: &Results,
    published: Option<&Published>,
    case: &str,
) -> Option<Forest> {
    let forest = of_parameters(results, published, (case, "not identified"), |run, p| !is_first(run, p))?;
    let count: usize = forest.groups.iter().map(|group| group.rows.len()).sum();
    Some(Forest { caption: format!("Parameters not identified ({count}){}", in_case(results, case)), ..forest })
}

/// Whether a parameter is identified, or shown if none is identified.
fn is_first(run: &RunResult, parameter: &ParameterResult) -> bool {
    let identified = |p: &ParameterResult| run.grade(p) != Grade::NotIdentified;
    identified(parameter) || (parameter.shown && !run.parameters.iter().any(identified))
}

/// The predicted intervals of a design about the a-priori values that are not zero.
pub(in crate::report) fn predicted_forest(results: &DesignResults) -> Option<Forest> {
    let known: Vec<&PredictedParameter> = results.predicted.iter().filter(|p| p.a_priori != 0.0).collect();
    let mut groups: Vec<ForestGroup> = Vec::new();
    for parameter in known {
        let label = format!("Joint {}", parameter.joint);
        let row = predicted_row(parameter);
        match groups.iter_mut().find(|g| g.label == label) {
            Some(group) => group.rows.push(row),
            None => groups.push(ForestGroup { label, rows: vec![row] }),
        }
    }
    (!groups.is_empty()).then(|| Forest {
        conclusion: String::new(),
        id: id("design", "predicted"),
        caption: format!("predicted 95 % intervals of {} about the a-priori values", results.method),
        legend: std::iter::once(Key::new("idim-ls", "predicted interval"))
            .chain(results.compared.iter().map(|[title, method]| Key::new("idim-iv", format!("{method} of {title}"))))
            .collect(),
        width: WIDTH,
        ticks: ticks(),
        notes: Vec::new(),
        groups,
    })
}

fn of_parameters(
    results: &Results,
    published: Option<&Published>,
    (case, what): (&str, &str),
    is_listed: fn(&RunResult, &ParameterResult) -> bool,
) -> Option<Forest> {
    let main = main_run(results, case)?;
    let others = runs_of(results, case).into_iter().filter(|r| r.method != main.method && !r.parameters.is_empty());
    let shows_formulas = results.cases().first() == Some(&case);
    let plot = Plot { runs: [main].into_iter().chain(others).collect(), published, shows_formulas };
    let mut groups: Vec<ForestGroup> = Vec::new();
    for (k, parameter) in main.parameters.iter().enumerate().filter(|(_, p)| is_listed(main, p)) {
        let label = main.plots.numbers.get(k).map_or_else(String::new, |number| format!("Joint {number}"));
        let row = plot.row(k, parameter);
        match groups.iter_mut().find(|g| g.label == label) {
            Some(group) => group.rows.push(row),
            None => groups.push(ForestGroup { label, rows: vec![row] }),
        }
    }
    (!groups.is_empty()).then(|| Forest {
        conclusion: String::new(),
        id: id(case, what),
        caption: format!("{what} of {} with 95 % intervals", named(results, main)),
        legend: plot.legend(&groups),
        width: WIDTH,
        ticks: ticks(),
        notes: notes(main, &groups),
        groups,
    })
}

/// A name that an attribute can hold.
fn id(case: &str, what: &str) -> String {
    let letters = format!("{what}-{case}");
    letters.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect()
}

fn notes(run: &RunResult, groups: &[ForestGroup]) -> Vec<String> {
    let is_off = |row: &&ForestRow| row.shapes.iter().any(|s| s.class.starts_with("arrow"));
    let off = groups.iter().flat_map(|g| &g.rows).filter(is_off).count();
    let axis = format!(
        "The picture shows differences from the estimate of {}, in percent of its size; small differences are widened. The value \
         zero lies at -100 % of a positive estimate, at +100 % of a negative one: an interval that reaches it contains zero.",
        run.method.name()
    );
    let plural = if off == 1 { "" } else { "s" };
    let arrows = (off > 0).then(|| format!("An arrow marks values beyond {FARTHEST} %, in {off} row{plural}."));
    let grades = "precise: the interval is within 20 % of the estimate; rough: it is wider, or friction near rest or a delay may \
                  shift the estimate by more; not identified: it contains zero, or would after such a shift; impossible: a motor \
                  inertia or friction below zero. \
                  Intervals allow for errors that are correlated from row to row.";
    [Some(axis), arrows, Some(grades.to_owned())].into_iter().flatten().collect()
}

/// Position of a difference in percent of the estimate; at the end beyond the largest difference.
fn place(percent: f64) -> f64 {
    let scaled = |p: f64| (p / LINEAR).asinh();
    let half = 0.5 * WIDTH - MARGIN;
    0.5 * WIDTH + half * scaled(percent.clamp(-FARTHEST, FARTHEST)) / scaled(FARTHEST)
}

fn ticks() -> Vec<Tick> {
    let negative = TICKS.iter().rev().map(|t| -t);
    let all = negative.chain([0.0]).chain(TICKS);
    all.map(|t| Tick { at: pixel(place(t)), label: if t > 0.0 { format!("+{t}") } else { t.to_string() } }).collect()
}

/// The data of the rows: the recommended run comes first.
struct Plot<'a> {
    runs: Vec<&'a RunResult>,
    published: Option<&'a Published>,
    /// Whether rows show the formulas of their parameters: those of the first case do.
    shows_formulas: bool,
}

impl Plot<'_> {
    fn row(&self, k: usize, of_main: &ParameterResult) -> ForestRow {
        let lane = |lane: usize| 0.5 * HEIGHT + LANE * (lane as f64 + 0.5);
        let intervals = self.runs.iter().enumerate().filter_map(|(i, r)| {
            Some(interval(r.method.name(), of_main.estimate, r.parameter(&of_main.name)?, lane(i)))
        });
        let marks = self.marks(k, of_main).into_iter().flat_map(|(class, value)| mark(class, of_main.estimate, value));
        ForestRow {
            height: HEIGHT + LANE * self.runs.len() as f64,
            shapes: intervals.flatten().chain(marks).collect(),
            formula: if self.shows_formulas { of_main.expression.clone() } else { String::new() },
            ..words(of_main, self.runs[0].grade(of_main))
        }
    }

    /// Known values of a parameter: true, a priori, published.
    fn marks(&self, k: usize, parameter: &ParameterResult) -> Vec<(&'static str, f64)> {
        let main = self.runs[0];
        let a_priori = main.plots.a_priori.get(k).copied().flatten();
        let printed = self.published.and_then(|p| p.value(&main.case, main.method, &parameter.name));
        let all = [("truth", parameter.true_value), ("a-priori", a_priori), ("published", printed.map(|p| p.estimate))];
        all.into_iter().filter_map(|(class, value)| Some((class, value?))).collect()
    }

    /// The methods, and the marks in the rows.
    fn legend(&self, groups: &[ForestGroup]) -> Vec<Key> {
        let methods = self.runs.iter().map(|r| Key::new(r.method.name(), r.method.name()).switched(true));
        let has = |class: &str| groups.iter().flat_map(|g| &g.rows).flat_map(|r| &r.shapes).any(|s| s.class == class);
        let marks = [("truth", "true value"), ("a-priori", "a-priori value"), ("published", "published value")];
        methods
            .chain(marks.into_iter().filter(|(class, _)| has(class)).map(|(class, name)| Key::new(class, name)))
            .collect()
    }
}

fn predicted_row(predicted: &PredictedParameter) -> ForestRow {
    let parameter = predicted.as_result();
    let lane = |k: f64| 0.5 * HEIGHT + (0.5 + k) * LANE;
    let mut shapes = interval("idim-ls", parameter.estimate, &parameter, lane(0.0));
    let compared = predicted.compared.as_ref();
    shapes.extend(compared.into_iter().flat_map(|other| interval("idim-iv", parameter.estimate, other, lane(1.0))));
    let lanes = if compared.is_some() { 2.0 } else { 1.0 };
    let formula = parameter.expression.clone();
    ForestRow { shapes, formula, height: HEIGHT + lanes * LANE, ..words(&parameter, predicted.grade()) }
}

/// The row of a parameter without its picture.
fn words(of_main: &ParameterResult, grade: Grade) -> ForestRow {
    let half = of_main.interval_95.map(|[low, high]| 0.5 * (high - low));
    let digits = half.or(of_main.standard_deviation);
    ForestRow {
        name: of_main.name.clone(),
        unit: of_main.unit.clone(),
        formula: String::new(),
        estimate: estimate(of_main.estimate, digits),
        half: half.map_or_else(|| NONE.to_owned(), |half| estimate(half, digits)),
        interval: of_main
            .interval_95
            .map_or_else(|| NONE.to_owned(), |ends| ends.map(|e| estimate(e, digits)).join(" to ")),
        grade: grade.name(),
        grade_class: grades::class(grade),
        height: HEIGHT,
        shapes: Vec::new(),
    }
}

/// Difference from a centre in percent of its size.
fn percent(value: f64, centre: f64) -> f64 {
    if value == centre { 0.0 } else { 100.0 * (value - centre) / centre.abs() }
}

/// The interval of one method: a line, a dot at the estimate, and an arrow at each end beyond the axis.
fn interval(method: &str, centre: f64, of_run: &ParameterResult, y: f64) -> Vec<Shape> {
    let ends = of_run.interval_95.unwrap_or([of_run.estimate; 2]).map(|e| percent(e, centre));
    let at = percent(of_run.estimate, centre);
    let [from, to] = ends.map(|e| pixel(if e.abs() > FARTHEST { tip(e) } else { place(e) }));
    let shape = |class: String, data: String| Shape { class, data };
    let mut shapes = vec![shape(format!("bar {method}"), format!("M{from} {y}H{to}"))];
    if at.abs() <= FARTHEST {
        shapes.push(shape(format!("dot {method}"), format!("M{} {y}h0", pixel(place(at)))));
    }
    shapes.extend(arrow(ends[0].min(at), method, y));
    shapes.extend(arrow(ends[1].max(at), method, y));
    shapes
}

/// Where an arrow ends.
fn tip(percent: f64) -> f64 {
    if percent < 0.0 { MARGIN - 9.0 } else { WIDTH - MARGIN + 9.0 }
}

/// An arrow head for a value beyond the axis.
fn arrow(percent: f64, method: &str, y: f64) -> Option<Shape> {
    let (end, back) = (tip(percent), if percent < 0.0 { 7.0 } else { -7.0 });
    (percent.abs() > FARTHEST).then(|| Shape {
        class: format!("arrow {method}"),
        data: format!("M{} {}L{end} {y}l{back} 3", end + back, y - 3.0),
    })
}

/// A mark at a known value: on the axis as its own shape, beyond it as an arrow.
fn mark(class: &'static str, centre: f64, value: f64) -> Option<Shape> {
    let percent = percent(value, centre);
    if !percent.is_finite() {
        return None;
    }
    let y = 0.5 * HEIGHT + 0.5 * LANE;
    if percent.abs() > FARTHEST {
        return arrow(percent, class, y);
    }
    let x = pixel(place(percent));
    let data = match class {
        "truth" => format!("M{x} {}l4 4 -4 4 -4-4z", y - 4.0),
        "published" => format!("M{} {}h7v7h-7z", pixel(x - 3.5), y - 3.5),
        _ => format!("M{x} {}l4.5 8h-9z", y - 4.0),
    };
    Some(Shape { class: class.to_owned(), data })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(estimate: f64, interval_95: [f64; 2]) -> ParameterResult {
        ParameterResult {
            name: "zz1".to_owned(),
            estimate,
            standard_deviation: None,
            relative_standard_deviation_percent: None,
            true_value: None,
            unit: String::new(),
            expression: String::new(),
            shown: true,
            standard_deviation_robust: None,
            interval_95: Some(interval_95),
        }
    }

    #[test]
    fn an_interval_runs_from_end_to_end_about_the_middle() {
        let shapes = interval("didim", 2.0, &parameter(2.0, [1.9, 2.1]), 5.0);
        let [bar, dot] = &shapes[..] else { panic!("{shapes:?}") };
        let [low, high] = [-5.0, 5.0].map(|p| pixel(place(p)));
        assert_eq!(bar.data, format!("M{low} 5H{high}"));
        assert_eq!(dot.data, format!("M{} 5h0", 0.5 * WIDTH));
        assert!((low + high - WIDTH).abs() < 0.2, "equally far to both sides");
    }

    #[test]
    fn what_lies_off_the_axis_has_an_arrow_on_its_side() {
        let arrows = |interval_95| {
            let shapes = interval("didim", 1.0, &parameter(1.0, interval_95), 5.0);
            let arrows = shapes.iter().filter(|s| s.class == "arrow didim");
            arrows
                .map(|s| s.data.split('L').nth(1).unwrap().starts_with(&(MARGIN - 9.0).to_string()))
                .collect::<Vec<_>>()
        };
        assert!(arrows([0.9, 1.1]).is_empty());
        assert_eq!(arrows([-5.0, 7.0]), [true, false], "left, then right");
        assert_eq!(arrows([0.0, 3.5]), [false]);
        assert_eq!(mark("truth", 1.0, 9.0).unwrap().class, "arrow truth");
    }
}
