/// A parameter that a campaign estimates.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignParameter {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its true value; absent where the twin has another friction model.
    pub truth: Option<f64>,
}

/// What the rows of a campaign have in common.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Facts {
    /// The parameters of all cases, in the order of the rows' numbers.
    pub parameters: Vec<CampaignParameter>,
}

impl Facts {
    /// The place of a parameter, which is added where it is not known.
    pub(super) fn place(&mut self, name: &str, unit: &str, truth: Option<f64>) -> usize {
        if let Some(place) = self.parameters.iter().position(|p| p.name == name) {
            let known = &mut self.parameters[place].truth;
            *known = known.or(truth);
            return place;
        }
        self.parameters.push(CampaignParameter { name: name.to_owned(), unit: unit.to_owned(), truth });
        self.parameters.len() - 1
    }
}
