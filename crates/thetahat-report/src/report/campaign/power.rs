//! Power: how often an interval excludes zero, over the size of the parameter.

use statrs::function::erf::erfc;

use crate::{
    report::{
        figures::{Figure, Key},
        number::fixed,
        plot::{Chart, Curve, NARROW, Panel, Range},
    },
    results::{Method, MethodSummary, ParameterSummary},
};

const HEIGHT: f64 = 170.0;
/// Quantile of the normal distribution that bounds an interval of 95 %.
const NORMAL_95: f64 = 1.96;
/// Share of runs from which the interval of a parameter excludes zero reliably, percent.
const RELIABLE: f64 = 80.0;
/// Points of the expected curve.
const POINTS: usize = 80;

/// For the first case, a chart for each noise level; none if no parameter has a size and a deviation.
pub(in crate::report) fn power(summaries: &[MethodSummary]) -> Option<Figure> {
    let case = summaries.iter().find(|s| s.parameters.iter().any(|p| size(p).is_some())).map(|s| &s.case)?;
    let of_case: Vec<&MethodSummary> = summaries.iter().filter(|s| s.case == *case).collect();
    let mut noises: Vec<&str> = of_case.iter().map(|s| s.noise.as_str()).collect();
    noises.dedup();
    let methods: Vec<Method> =
        Method::all().filter(|m| of_case.iter().any(|s| s.method == m.name() && s.converged > 0)).collect();
    let sizes: Vec<f64> = of_case.iter().flat_map(|s| &s.parameters).filter_map(size).collect();
    let at = |noise: &&str| {
        let curves: Vec<Curve> = methods.iter().map(|m| power_of(&of_case, noise, *m)).collect();
        chart(noise, &curves, &sizes)
    };
    Some(Figure {
        conclusion: conclusion(&of_case, &noises, &methods),
        caption: format!("how often a 95 % interval excludes zero, over the size of the parameter ({case})"),
        legend: methods
            .iter()
            .map(|m| Key::new(m.name(), m.name()))
            .chain([Key::new("expected", "expected for correct intervals")])
            .collect(),
        charts: noises.iter().map(at).collect(),
        notes: vec![
            "A dot is a parameter. Its size is its true value over the standard deviation of its estimates. Dots above the \
             curve have intervals that are too narrow, or biased estimates; dots below it have intervals that are too wide."
                .to_owned(),
        ],
    })
}

/// The size of a parameter that is not zero, in standard deviations of its estimates.
fn size(parameter: &ParameterSummary) -> Option<f64> {
    let size = parameter.truth.abs() / parameter.spread?;
    (size > 0.0 && size.is_finite()).then_some(size)
}

fn parameters<'a>(
    summaries: &'a [&MethodSummary],
    noise: &'a str,
    method: Method,
) -> impl Iterator<Item = &'a ParameterSummary> {
    let of_both = summaries.iter().filter(move |s| s.noise == noise && s.method == method.name());
    of_both.flat_map(|s| &s.parameters).filter(|p| size(p).is_some())
}

fn power_of(summaries: &[&MethodSummary], noise: &str, method: Method) -> Curve {
    let points = parameters(summaries, noise, method).filter_map(|p| Some((size(p)?, p.power_percent)));
    Curve::new(method.name(), points.collect())
}

fn chart(noise: &str, curves: &[Curve], sizes: &[f64]) -> Chart {
    Chart::new(format!("{noise}: intervals without zero, %"), "true value, standard deviations", NARROW).with(
        HEIGHT,
        |p| {
            let panel = p.over_by_powers(sizes.iter().copied()).up(Range { low: -4.0, high: 104.0 });
            let panel = panel.level("nominal", RELIABLE);
            let expected = expected(panel.x);
            curves.iter().fold(panel.line(&expected), Panel::dots)
        },
    )
}

/// How often a 95 % interval of an unbiased normal estimate excludes zero, at equal steps of the size's logarithm.
fn expected([low, high]: [f64; 2]) -> Curve {
    let at = |k: usize| low * (high / low).powf(k as f64 / (POINTS - 1) as f64);
    let power = |size: f64| 100.0 * (normal_cdf(size - NORMAL_95) + normal_cdf(-size - NORMAL_95));
    Curve::new("expected", (0..POINTS).map(at).map(|size| (size, power(size))).collect())
}

/// The probability that a standard normal variable is below a value.
fn normal_cdf(value: f64) -> f64 {
    0.5 * erfc(-value * std::f64::consts::FRAC_1_SQRT_2)
}

fn conclusion(summaries: &[&MethodSummary], noises: &[&str], methods: &[Method]) -> String {
    let at = |noise: &&str| {
        let counted = |method: &Method| {
            let of_both: Vec<_> = parameters(summaries, noise, *method).collect();
            let found = of_both.iter().filter(|p| p.power_percent >= RELIABLE).count();
            format!("{method} {found} of {}", of_both.len())
        };
        format!("{} at {noise}", methods.iter().map(counted).collect::<Vec<_>>().join(", "))
    };
    let all: Vec<String> = noises.iter().map(at).collect();
    format!(
        "Parameters whose interval excludes zero in at least {} % of the runs: {}.",
        fixed(RELIABLE, 0),
        all.join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(truth: f64, power_percent: f64) -> ParameterSummary {
        ParameterSummary {
            name: "m1".to_owned(),
            unit: "kg".to_owned(),
            truth,
            mean: truth,
            spread: Some(0.5),
            deviation: 0.5,
            coverage_percent: 95.0,
            classical_coverage_percent: 95.0,
            power_percent,
            count: 10,
        }
    }

    fn summary(noise: &str, parameters: Vec<ParameterSummary>) -> MethodSummary {
        MethodSummary {
            case: "nominal".to_owned(),
            noise: noise.to_owned(),
            method: "idim-iv".to_owned(),
            runs: 10,
            converged: 10,
            bias: None,
            spread: None,
            coverage_percent: None,
            classical_coverage_percent: None,
            iterations: None,
            simulations: None,
            seconds: None,
            distance_percent: None,
            position_error_percent: None,
            torque_error_percent: None,
            parameters,
            failures: Vec::new(),
        }
    }

    #[test]
    fn parameters_whose_interval_excludes_zero_are_counted_per_noise() {
        let low = summary("low", vec![parameter(5.0, 100.0), parameter(-0.5, 20.0), parameter(0.0, 5.0)]);
        let figure = power(&[low, summary("high", vec![parameter(5.0, 90.0), parameter(1.5, 85.0)])]).unwrap();
        let counts = "idim-iv 1 of 2 at low; idim-iv 2 of 2 at high.";
        assert!(figure.conclusion.ends_with(counts), "{}", figure.conclusion);
        assert_eq!(figure.charts.len(), 2);
        let panel = &figure.charts[0].panels[0];
        assert!(panel.x[0] < 1.0 && panel.x[1] > 10.0, "sizes of 1, 3 and 10 deviations: {:?}", panel.x);
    }

    #[test]
    fn the_expected_curve_is_the_power_of_a_test_of_five_percent() {
        let points = expected([1e-3, 10.0]).points;
        assert!((points[0].1 - 5.0).abs() < 0.01, "no size: the size of the test, {:?}", points[0]);
        // A value of 2.80 = 1.96 + 0.84 deviations is found in 80 % of the runs.
        let (_, power) = points.iter().min_by(|a, b| (a.0 - 2.80).abs().total_cmp(&(b.0 - 2.80).abs())).unwrap();
        assert!((power - 80.0).abs() < 8.0, "{power}");
    }

    #[test]
    fn without_spreads_there_is_no_figure() {
        let one_run = ParameterSummary { spread: None, ..parameter(1.0, 100.0) };
        assert!(power(&[summary("low", vec![one_run])]).is_none());
    }
}
