use std::path::PathBuf;

/// Why there is no driver.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriverError {
    /// No preset has the name.
    #[error(
        "there is no driver {name:?}; {}; a file of your own is named with its ending, ./my_driver.toml",
        choice(similar, known)
    )]
    Unknown {
        /// The name.
        name: String,
        /// The names of presets of which it is a part.
        similar: Vec<&'static str>,
        /// The names of the presets.
        known: Vec<&'static str>,
    },
    /// The file cannot be read.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The file is no TOML, or has a key that a driver has not.
    #[error("{}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The message of the parser, with the line.
        message: String,
    },
    /// A value cannot be meant.
    #[error("{}: {key}: expected {expected}, found {found}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The key.
        key: String,
        /// What it must be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
}

fn choice(similar: &[&str], known: &[&str]) -> String {
    match similar {
        [] => format!("the drivers are {}", known.join(", ")),
        similar => {
            format!("say which of {} it is: `thetahat init --from list` shows what they mean", similar.join(", "))
        }
    }
}
