//! Panics of libraries on damaged files, turned into errors.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use super::error::RecordingError;

/// The result of `read`; a panic of the library inside becomes [`RecordingError::Damaged`].
///
/// Sizes and counts are checked before, so this is the last guard. Only the error survives the panic; no partially built value remains.
pub(super) fn panics_as_damage<T>(
    path: &Path,
    library: &str,
    read: impl FnOnce() -> Result<T, RecordingError>,
) -> Result<T, RecordingError> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|panic| {
        let reason = format!("the reader of {library} stopped: {}", message(&*panic));
        Err(RecordingError::damaged(path, reason))
    })
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("for an unknown reason")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panic_is_reported_as_damage() {
        let result = panics_as_damage::<()>(Path::new("q.mat"), "HDF5", || panic!("index out of bounds"));
        assert!(
            matches!(result, Err(RecordingError::Damaged { reason, .. }) if reason.contains("index out of bounds"))
        );
    }
}
