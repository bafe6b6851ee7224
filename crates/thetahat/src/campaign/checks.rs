//! What a campaign file must hold before anything runs.

use std::{collections::BTreeSet, fmt::Display};

use super::{Campaign, CampaignError, NoiseLevel};
use crate::preparation::{NamedChoice, ParameterChoice};
use thetahat_ground::one_or_each::OneOrEach;

/// Most runs along one axis: beyond it, keys no longer fit into the numbers of the random streams.
const MOST: u32 = 1 << 20;
/// Most recordings of a campaign: their rows are held in memory.
const MOST_RECORDINGS: u64 = 10_000_000;

impl Campaign {
    pub(super) fn validate(&self) -> Result<(), CampaignError> {
        let file = &self.file;
        let why = format!(
            "a table in {}: a campaign makes recordings of its simulated robot",
            self.experiment.path.display()
        );
        self.require(self.experiment.file.twin.is_some(), "[twin]", &why, "missing")?;
        self.require((1..=MOST).contains(&file.seeds), "seeds", "from 1 to 1048576", file.seeds)?;
        self.require_distinct("methods", file.methods.iter().map(|m| m.name()))?;
        let expected = "one or more tables with name, position_noise and torque_noise";
        self.require(!file.noise.is_empty(), "[[noise]]", expected, "missing")?;
        self.require_distinct("[[noise]] name", file.noise.iter().map(|n| n.name.as_str()))?;
        file.noise.iter().try_for_each(|level| self.validate_level(level))?;
        self.validate_cases()?;
        let recordings = u64::from(file.seeds) * u64::from(file.starts.count) * file.noise.len() as u64;
        let key = "seeds times starts times noise levels";
        self.require(recordings <= MOST_RECORDINGS, key, "at most 10000000", recordings)?;
        self.validate_starts()?;
        let essential = self.experiment.settings.parameters.estimate == ParameterChoice::Named(NamedChoice::Essential);
        let expected = "\"base\" or a list of base parameters: every run of a campaign estimates the same ones";
        self.require(!essential, "the experiment's [parameters] estimate", expected, "\"essential\"")
    }

    fn validate_level(&self, level: &NoiseLevel) -> Result<(), CampaignError> {
        let joints = self.experiment.robot.coordinate_count();
        for (key, levels) in [("position_noise", &level.position_noise), ("torque_noise", &level.torque_noise)] {
            let key = format!("[[noise]] {}: {key}", level.name);
            if let OneOrEach::Each(values) = levels {
                let expected = format!("a number, or a list of {joints}, one for each joint");
                self.require(values.len() == joints, &key, &expected, format!("a list of {}", values.len()))?;
            }
            let wrong = levels.to_list(joints).into_iter().find(|v| !(v.is_finite() && *v >= 0.0));
            self.require(wrong.is_none(), &key, "finite and not below zero", wrong.unwrap_or_default())?;
        }
        Ok(())
    }

    fn validate_cases(&self) -> Result<(), CampaignError> {
        let Some(cases) = &self.file.cases else { return Ok(()) };
        self.require_distinct("cases", cases.iter().map(String::as_str))?;
        let known: Vec<String> = self.experiment.cases().into_iter().map(|c| c.name).collect();
        let unknown = cases.iter().find(|c| !known.contains(c)).cloned();
        let expected = format!("cases of the experiment: {}", known.join(", "));
        self.require(unknown.is_none(), "cases", &expected, unknown.unwrap_or_default())
    }

    fn validate_starts(&self) -> Result<(), CampaignError> {
        let starts = self.file.starts;
        self.require((1..=MOST).contains(&starts.count), "[starts] count", "from 1 to 1048576", starts.count)?;
        let deviation = starts.relative_deviation;
        self.require((0.0..=1.0).contains(&deviation), "[starts] relative_deviation", "from 0 to 1", deviation)?;
        let several = starts.count == 1 || deviation > 0.0;
        let expected = "above zero where count is more than one: the starts would be the same";
        self.require(several, "[starts] relative_deviation", expected, deviation)?;
        let table = self.experiment.robot.parameter_table();
        for (name, value) in &self.file.a_priori {
            let key = format!("[a_priori] {name}");
            let expected = "a standard parameter of the robot, like zz1, ia2, fcm6";
            self.require(table.index_of(name).is_some(), &key, expected, "unknown")?;
            self.require(value.is_finite(), &key, "a finite number", value)?;
        }
        Ok(())
    }

    fn require_distinct<'a>(&self, key: &str, names: impl Iterator<Item = &'a str>) -> Result<(), CampaignError> {
        let mut seen = BTreeSet::new();
        for name in names {
            self.require(seen.insert(name), key, "each only once", format!("{name}, twice"))?;
        }
        self.require(!seen.is_empty(), key, "at least one", "empty")
    }

    fn require(&self, holds: bool, key: &str, expected: &str, found: impl Display) -> Result<(), CampaignError> {
        if holds {
            return Ok(());
        }
        Err(CampaignError::Value {
            path: self.path.clone(),
            key: key.to_owned(),
            expected: expected.to_owned(),
            found: found.to_string(),
        })
    }
}
