//! `report.html`: the verdict, the torques, the estimates, and details on demand.

use super::output::Output;
use crate::{
    report::{
        error::ReportError,
        figures,
        page::{HeadCard, Page, render},
        published::Published,
        sections,
    },
    results::Results,
};
use thetahat_ground::output::FileKind;

pub(super) const OUTPUT: Output = Output { name: "report.html", kind: FileKind::Page(GENERATOR), render: report };

const GENERATOR: &str = "thetahat report";

const FOOTER: &str = "Relative errors are 100 |y - y_hat| / |y| in the decimated rows, unweighted; standard deviations (sd) are the \
    classical ones, for independent rows, unless stated otherwise; intervals allow for correlated errors.";

fn report(results: &Results, published: Option<&Published>) -> Result<Vec<u8>, ReportError> {
    let page = Page {
        title: &results.title,
        generator: GENERATOR,
        card: HeadCard::of(results),
        recommended: results.recommended_run().map_or("", |run| run.method.name()),
        picture: figures::skeleton(results),
        facts: vec![("robot", results.robot.clone())],
        sections: sections::all(results, published),
        footer: FOOTER,
    };
    Ok(render(&page)?.into_bytes())
}
