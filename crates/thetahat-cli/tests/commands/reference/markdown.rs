//! Tables, headings and words in Markdown.

/// A table; without rows, nothing.
pub fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &mut dyn Iterator<Item = String>| format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "));
    let head_line = line(&mut head.iter().map(|h| (*h).to_owned()));
    let rule = line(&mut head.iter().map(|_| "---".to_owned()));
    let rows = rows.iter().map(|row| line(&mut row.iter().map(|cell| cell.replace('|', "\\|"))));
    if rows.len() == 0 { String::new() } else { [head_line, rule].into_iter().chain(rows).collect() }
}

pub fn code(text: &str) -> String {
    format!("`{text}`")
}

/// The anchor that code hosts and mdBook give a heading.
pub fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || ['-', '_', ' '].contains(c);
    heading.trim().to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")
}

/// A doc comment as prose: a link to an item is the item's last name.
pub fn prose(docs: &str) -> String {
    let mut text = String::new();
    let mut rest = docs;
    while let Some((before, after)) = rest.split_once("[`") {
        let Some((path, behind)) = after.split_once("`]") else { break };
        let name = path.rsplit("::").next().unwrap_or(path);
        text += &format!("{before}`{name}`");
        rest = if behind.starts_with('(') { behind.split_once(')').map_or("", |(_, rest)| rest) } else { behind };
    }
    text + rest
}

/// The plural of what a key may hold.
pub fn plural(value: &str) -> String {
    const NAMES: [&str; 7] = ["number", "whole number", "text", "path", "character", "list", "table"];
    if value.starts_with('[') {
        return value.replacen(']', "s]", 1);
    }
    let (first, rest) = value.split_at(value.find(" of ").unwrap_or(value.len()));
    if NAMES.contains(&first) { format!("{first}s{rest}") } else { value.to_owned() }
}
