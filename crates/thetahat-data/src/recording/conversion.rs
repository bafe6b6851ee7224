//! Files that another program has to convert, with the command that does it.

use std::path::Path;

/// What a file is, and how it is converted; none for extensions of other files.
pub(super) fn conversion(path: &Path, extension: &str) -> Option<(&'static str, String)> {
    let name = safe_name(path);
    match extension {
        "pt" | "pth" => Some(("a PyTorch file", from_torch(&name))),
        "pkl" | "pickle" => Some(("a Python pickle", from_pickle(&name))),
        "feather" | "arrow" => Some((
            "an Arrow file",
            format!("python -c \"import pandas; pandas.read_feather('{name}').to_csv('{name}.csv', index=False)\""),
        )),
        _ => None,
    }
}

/// Saves the arrays of a dictionary, or a single array, as a NumPy archive. Loading runs code that the file contains.
fn from_torch(name: &str) -> String {
    format!(
        "python -c \"import torch, numpy; d = torch.load('{name}', map_location='cpu', weights_only=False); \
         d = d if isinstance(d, dict) else {{'data': d}}; \
         numpy.savez('{name}.npz', **{{str(k): numpy.asarray(v.detach() if hasattr(v, 'detach') else v) for k, v in d.items() \
         if hasattr(v, 'shape') or isinstance(v, list)}})\" (it runs code in the file: only for files that you trust)"
    )
}

fn from_pickle(name: &str) -> String {
    format!(
        "python -c \"import pickle, numpy; d = pickle.load(open('{name}', 'rb')); d = d if hasattr(d, 'items') else {{'data': d}}; \
         numpy.savez('{name}.npz', **{{str(k): numpy.asarray(v) for k, v in d.items() if hasattr(v, 'shape') or isinstance(v, list)}})\" \
         (it runs code in the file: only for files that you trust)"
    )
}

/// The name of a file for a command: none with characters that have a meaning there.
fn safe_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
    if name.chars().all(is_plain) { name } else { "FILE".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::super::{Format, RecordingError};
    use super::*;

    #[test]
    fn files_to_convert_name_the_command() {
        for (file, part) in [
            ("log.pt", "torch.load('log.pt', map_location='cpu', weights_only=False)"),
            ("log.pkl", "pickle.load(open('log.pkl', 'rb'))"),
        ] {
            let error = Format::of(Path::new(file)).unwrap_err();
            assert!(matches!(error, RecordingError::ToConvert { .. }));
            assert!(error.to_string().contains(part), "{error}");
        }
    }

    #[test]
    fn a_name_is_no_part_of_a_command() {
        let (_, remedy) = conversion(Path::new("a'); import os; ('.pt"), "pt").unwrap();
        assert!(remedy.contains("torch.load('FILE'"), "{remedy}");
    }
}
