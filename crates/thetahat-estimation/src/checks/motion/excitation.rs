//! Parameters that the motion does not excite, and the parameters that they are confounded with.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, norm};

/// Variance inflation above which a parameter counts as confounded with others: they span 99.99 % of its column.
/// The recorded KUKA, whose motion has few frequencies, has 7900 (clean).
const INFLATION_LIMIT: f64 = 1e4;
/// Most partners that are named for a confounded parameter.
const PARTNERS: usize = 3;
/// Smallest share of a named partner, relative to the strongest partner's.
const WEAKEST_PARTNER: f64 = 0.2;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let Ok(fit) = recording.fit() else { return };
    let columns = unit_columns(&fit.x);
    let names: Vec<&str> = exam.subject.base.parameters().iter().map(|p| p.name.as_str()).collect();
    let independent = &fit.qr.pivots()[..fit.rank];
    dependent(exam, &fit, &columns, &names);
    confounded(exam, &columns.select_columns(independent), &pick(&names, independent));
}

/// The matrix with columns of unit length; zero columns stay.
fn unit_columns(x: &Matrix) -> Matrix {
    let mut unit = x.clone();
    for j in 0..x.columns() {
        let size = norm(x.column(j));
        if size > 0.0 {
            unit.column_mut(j).iter_mut().for_each(|v| *v /= size);
        }
    }
    unit
}

fn pick<'n>(names: &[&'n str], columns: &[usize]) -> Vec<&'n str> {
    columns.iter().map(|&c| names[c]).collect()
}

fn owned(names: &[&str], columns: &[usize]) -> Vec<String> {
    columns.iter().map(|&c| names[c].to_owned()).collect()
}

/// Columns that other columns span.
fn dependent(exam: &mut Examination<'_>, fit: &OrthogonalFit, columns: &Matrix, names: &[&str]) {
    let (kept, lost) = fit.qr.pivots().split_at(fit.rank);
    let value = lost.len() as f64;
    let evidence = Evidence { code: Code::NotExcited, coordinate: None, value, unit: "parameters", limit: 0.5 };
    let mut lost = lost.to_vec();
    lost.sort_unstable();
    exam.judge(evidence, Severity::Warning, || {
        let qr = PivotedQr::new(&columns.select_columns(kept));
        let phrase = |&c: &usize| {
            let coefficients = qr.solve(columns.column(c));
            let partners = strongest(coefficients.iter().map(|v| v.abs()).zip(pick(names, kept)));
            if partners.is_empty() {
                format!("{} (no effect)", names[c])
            } else {
                format!("{} (with {partners})", names[c])
            }
        };
        let list: Vec<String> = lost.iter().map(phrase).collect();
        let message =
            format!("the motion does not separate {} parameters from the others: {}", lost.len(), list.join(", "));
        let remedy =
            "move these joints faster and in other configurations; until then identify leaves these parameters out";
        FindingText::new(message, remedy).about(owned(names, &lost))
    });
}

/// Columns that other columns nearly span. The inverse of the Gram matrix of unit columns shows how nearly, and which.
fn confounded(exam: &mut Examination<'_>, columns: &Matrix, names: &[&str]) {
    let inverse = PivotedQr::new(columns).inverse_gram();
    let inflation = |c: usize| inverse.at(c, c);
    let worst: Vec<usize> = (0..names.len()).filter(|&c| inflation(c) > INFLATION_LIMIT).collect();
    let value = (0..names.len()).map(inflation).fold(0.0, f64::max);
    let evidence = Evidence {
        code: Code::NotExcited,
        coordinate: None,
        value,
        unit: "variance inflation",
        limit: INFLATION_LIMIT,
    };
    exam.judge(evidence, Severity::Warning, || {
        let partners = |c: usize| {
            let share = (0..names.len()).filter(move |&i| i != c).map(|i| (inverse.at(c, i).abs(), names[i]));
            strongest(share)
        };
        let list: Vec<String> = worst.iter().map(|&c| format!("{} (with {})", names[c], partners(c))).collect();
        let message =
            format!("the motion hardly separates {} parameters from others: {}", worst.len(), list.join(", "));
        let remedy = "move these joints in other configurations and at other speeds, or leave these parameters out by exclude = [...] in [parameters]";
        FindingText::new(message, remedy).about(owned(names, &worst))
    });
}

/// The names with the largest sizes.
fn strongest<'n>(shares: impl Iterator<Item = (f64, &'n str)>) -> String {
    let mut shares: Vec<(f64, &str)> = shares.filter(|s| s.0 > 0.0).collect();
    shares.sort_by(|a, b| b.0.total_cmp(&a.0));
    let largest = shares.first().map_or(0.0, |s| s.0);
    shares.retain(|s| s.0 >= WEAKEST_PARTNER * largest);
    shares.iter().take(PARTNERS).map(|s| s.1).collect::<Vec<_>>().join(" ")
}
