//! Topics that are not read.

use serde::Serialize;

/// A topic of a bag that is not read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct OtherTopic {
    /// Its name.
    pub name: String,
    /// The type of its messages.
    pub kind: String,
}
