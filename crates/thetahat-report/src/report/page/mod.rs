//! Pages: each one file that needs nothing else. Its folds, switches and figures work without the script.

mod card;
mod render;

pub(super) use card::HeadCard;
pub(super) use render::{Page, render};
