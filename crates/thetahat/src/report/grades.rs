//! Grades in words and colours.

use crate::results::Grade;

/// The name of a grade. Where the model is doubted, an estimate that is sure by its interval is called precise: what the model
/// lacks may have shifted it.
pub(super) fn word(grade: Grade, model_is_doubted: bool) -> &'static str {
    match grade {
        Grade::Sure if model_is_doubted => "precise",
        Grade::Sure | Grade::Rough | Grade::NotIdentified | Grade::Impossible => grade.name(),
    }
}

/// How many parameters have each grade; impossible ones are named where there are any.
pub(super) fn counted(counts: impl IntoIterator<Item = (Grade, usize)>, model_is_doubted: bool) -> String {
    let words = |(grade, count): (Grade, usize)| format!("{count} {}", word(grade, model_is_doubted));
    counts.into_iter().filter(|(grade, count)| is_counted(*grade, *count)).map(words).collect::<Vec<_>>().join(", ")
}

/// Whether a count is shown: impossible parameters are the exception.
pub(super) fn is_counted(grade: Grade, count: usize) -> bool {
    count > 0 || grade != Grade::Impossible
}

/// The class that colours a grade on the page.
pub(super) fn class(grade: Grade) -> &'static str {
    match grade {
        Grade::Sure => "sure",
        Grade::Rough => "rough",
        Grade::NotIdentified => "lost",
        Grade::Impossible => "impossible",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_parameters_are_counted_where_there_are_any() {
        let counts = |impossible| Grade::ALL.into_iter().zip([3, 2, 1, impossible]);
        assert_eq!(counted(counts(0), false), "3 sure, 2 rough, 1 not identified");
        assert_eq!(counted(counts(4), true), "3 precise, 2 rough, 1 not identified, 4 impossible");
    }
}
