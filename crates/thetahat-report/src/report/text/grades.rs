//! Grades in words and colours.

use crate::results::Grade;

/// The number of parameters of each grade; impossible ones only if there are any.
pub(in crate::report) fn counted(counts: impl IntoIterator<Item = (Grade, usize)>) -> String {
    let words = |(grade, count): (Grade, usize)| format!("{count} {}", grade.name());
    counts.into_iter().filter(|(grade, count)| is_counted(*grade, *count)).map(words).collect::<Vec<_>>().join(", ")
}

/// Whether a count is shown: impossible parameters are the exception.
pub(in crate::report) fn is_counted(grade: Grade, count: usize) -> bool {
    count > 0 || grade != Grade::Impossible
}

/// The class that colours a grade on the page.
pub(in crate::report) fn class(grade: Grade) -> &'static str {
    match grade {
        Grade::Precise => "precise",
        Grade::Rough => "rough",
        Grade::NotIdentified => "not-identified",
        Grade::Impossible => "impossible",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_parameters_are_counted_if_there_are_any() {
        let counts = |impossible| Grade::ALL.into_iter().zip([3, 2, 1, impossible]);
        assert_eq!(counted(counts(0)), "3 precise, 2 rough, 1 not identified");
        assert_eq!(counted(counts(4)), "3 precise, 2 rough, 1 not identified, 4 impossible");
    }
}
