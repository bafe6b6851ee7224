//! In a build without Parquet there is no store: campaigns run in memory.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::{
    description::Campaign,
    error::CampaignError,
    facts::Facts,
    row::{Key, Row},
};

/// A folder that keeps the rows of a campaign; it cannot be opened in this build.
#[derive(Debug, Clone)]
pub enum Store {}

impl Store {
    /// Refuses the folder.
    ///
    /// # Errors
    /// [`CampaignError::NoParquet`], always.
    pub fn open(folder: &Path, _campaign: &Campaign) -> Result<Self, CampaignError> {
        Err(CampaignError::NoParquet { folder: folder.to_owned() })
    }

    pub(super) fn finished(
        &self,
        _campaign: &Campaign,
        _facts: &Facts,
    ) -> Result<BTreeMap<Key, Vec<Row>>, CampaignError> {
        match *self {}
    }

    pub(super) fn keep(&self, _key: Key, _rows: &[Row], _facts: &Facts) -> Result<(), CampaignError> {
        match *self {}
    }

    pub(super) fn finish(&self, _rows: &[Row], _facts: &Facts) -> Result<Vec<PathBuf>, CampaignError> {
        match *self {}
    }
}
