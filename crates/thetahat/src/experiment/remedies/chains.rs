//! Candidates that belong together: the same factor of every joint, and corrections of the same joints one after the other.

use super::candidate::Candidate;
use thetahat_model::robot::Robot;
use thetahat_report::results::RemedyStep;

/// Factors of every joint become one remedy: all torques with the opposite sign, or all positions in degrees.
pub(super) fn together(candidates: Vec<Candidate>, robot: &Robot) -> Vec<Candidate> {
    let n = robot.coordinate_count();
    let mut all: Vec<Candidate> = Vec::new();
    for candidate in &candidates {
        let group: Vec<&Candidate> = candidates.iter().filter(|other| candidate.has_factors_with(other)).collect();
        let is_at = |coordinate: usize| group.iter().any(|other| other.coordinate == Some(coordinate));
        if n < 2 || group.len() != n || !(0..n).all(is_at) {
            all.push(candidate.clone());
        } else if std::ptr::eq(group[0], candidate) {
            all.push(group[1..].iter().fold(candidate.clone(), |all, other| all.and(other)).of_all());
        }
    }
    all
}

impl Candidate {
    /// Whether both have the same finding, of one joint, and factors of the same signals.
    fn has_factors_with(&self, other: &Self) -> bool {
        let signals = |candidate: &Self| {
            let RemedyStep::Scale { position, torque } = &candidate.step.step else { return None };
            Some((position.is_empty(), torque.is_empty()))
        };
        let own = signals(self).filter(|_| self.coordinate.is_some() && other.coordinate.is_some());
        self.finding == other.finding && own.is_some() && own == signals(other)
    }

    /// With the factors of another one in addition.
    fn and(mut self, other: &Self) -> Self {
        if let (RemedyStep::Scale { position, torque }, RemedyStep::Scale { position: p, torque: t }) =
            (&mut self.step.step, &other.step.step)
        {
            position.iter_mut().zip(p).for_each(|(own, factor)| *own *= factor);
            torque.iter_mut().zip(t).for_each(|(own, factor)| *own *= factor);
        }
        self
    }

    fn of_all(self) -> Self {
        let code = self.finding.map_or(self.code, |finding| finding.name().to_owned());
        Self { code, coordinate: None, found: format!("at every joint: {}", self.found), ..self }
    }
}

/// Corrections of the same joints are links of a chain, each found in the recording that the earlier ones have corrected: they become one
/// remedy. A torque with the other sign, and then torque and position of that joint, is a position with the other sign.
pub(super) fn chained(candidates: Vec<Candidate>, n: usize) -> Vec<Candidate> {
    let mut all: Vec<Candidate> = Vec::new();
    for candidate in candidates {
        let joints = joints_of(&candidate.step.step, n);
        let shares = |other: &Candidate| {
            let steps = other.before.iter().chain([&other.step]);
            steps.flat_map(|step| joints_of(&step.step, n)).any(|joint| joints.contains(&joint))
        };
        match all.iter().position(shares) {
            Some(place) => {
                let earlier = all.remove(place);
                all.push(candidate.after(earlier));
            }
            None => all.push(candidate),
        }
    }
    all
}

/// The joints whose channels a step corrects one by one, from one; empty where it corrects all alike.
fn joints_of(step: &RemedyStep, n: usize) -> Vec<usize> {
    match step {
        RemedyStep::OrderJoints { .. } => step.moved_joints(),
        RemedyStep::Scale { position, torque } => {
            let is_scaled = |k: usize| [position, torque].iter().any(|f| f.get(k - 1).is_some_and(|f| *f != 1.0));
            let joints: Vec<usize> = (1..=n).filter(|k| is_scaled(*k)).collect();
            if n > 1 && joints.len() == n { Vec::new() } else { joints }
        }
        RemedyStep::Side { .. }
        | RemedyStep::Delay { .. }
        | RemedyStep::Hold
        | RemedyStep::EqualSteps { .. }
        | RemedyStep::CorrectReference { .. }
        | RemedyStep::Cutoff { .. }
        | RemedyStep::LowPass { .. }
        | RemedyStep::LeaveOutRests
        | RemedyStep::LeaveOutTimes { .. }
        | RemedyStep::Essential { .. }
        | RemedyStep::LockJoint { .. }
        | RemedyStep::AddTerm { .. }
        | RemedyStep::Gravity { .. }
        | RemedyStep::Estimated { .. } => Vec::new(),
    }
}

/// Factors one after the other; none if one of the steps has another form.
fn product(first: &RemedyStep, second: &RemedyStep) -> Option<RemedyStep> {
    let (RemedyStep::Scale { position, torque }, RemedyStep::Scale { position: p, torque: t }) = (first, second) else {
        return None;
    };
    let times = |a: &[f64], b: &[f64]| -> Vec<f64> {
        let n = a.len().max(b.len());
        let of = |factors: &[f64], j: usize| factors.get(j).copied().unwrap_or(1.0);
        let both: Vec<f64> = (0..n).map(|j| of(a, j) * of(b, j)).collect();
        if both.iter().all(|factor| *factor == 1.0) { Vec::new() } else { both }
    };
    Some(RemedyStep::Scale { position: times(position, p), torque: times(torque, t) })
}

impl Candidate {
    /// The candidate as the last link of a chain.
    fn after(mut self, earlier: Self) -> Self {
        self.also = earlier.also.into_iter().chain(earlier.finding).collect();
        self.before = earlier.before;
        match product(&earlier.step.step, &self.step.step) {
            Some(step) => {
                self.step.with_reference |= earlier.step.with_reference;
                self.step.with_velocity |= earlier.step.with_velocity;
                self.step.step = step;
            }
            None => self.before.push(earlier.step),
        }
        self
    }
}
