use toml::Spanned;

use super::{
    file::{Convention, JointEntry, MimicEntry},
    reader::Reader,
};
use crate::robot::{
    DenavitHartenberg, Joint, JointKind, LARGEST, Limits, MOST_JOINTS, Mimic, Placement, RobotError, Share,
    joint::FollowedSum, tree,
};

type Entry = Spanned<JointEntry>;

impl Reader<'_> {
    /// The joints, parents before children. Without any `parent`, each joint is carried by the previous one in the file.
    pub(super) fn joints(&self, entries: &[Entry], convention: Convention) -> Result<Vec<Joint>, RobotError> {
        self.check_count(entries)?;
        self.check_names(entries)?;
        let parents = self.parents(entries)?;
        let order = tree::depth_first(&parents).map_err(|cycle| self.cycle(entries, &cycle))?;
        let mut place = vec![0; entries.len()];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        let sums = self.sums(entries)?;
        let frames = match convention {
            Convention::Modified => entries.iter().map(|e| modified(e.as_ref())).collect(),
            Convention::Standard => self.standard(entries, &parents)?,
        };
        let followed = |old: usize| {
            let mut sum = sums[old].clone()?;
            sum.shares.iter_mut().for_each(|share| share.of = place[share.of]);
            Some(sum)
        };
        let joint = |&old: &usize| Joint {
            name: entries[old].as_ref().name.clone(),
            kind: entries[old].as_ref().kind,
            parent: parents[old].map(|p| place[p]),
            placement: Placement::from(frames[old]),
            link_axes: None,
            mimic: None,
            also_follows: Vec::new(),
            passive: false,
            of_base: false,
            limits: Limits::default(),
        };
        let mut joints: Vec<Joint> = order.iter().map(joint).collect();
        joints.iter_mut().zip(&order).for_each(|(joint, &old)| joint.follow(followed(old)));
        Ok(joints)
    }

    fn check_count(&self, entries: &[Entry]) -> Result<(), RobotError> {
        if entries.is_empty() {
            return Err(self.value("joint", "at least one [[joint]], or urdf = \"FILE\"", "an empty list"));
        }
        if entries.len() > MOST_JOINTS {
            let path = self.path.to_owned();
            return Err(RobotError::TooLarge { path, what: "moving joints", limit: MOST_JOINTS });
        }
        entries.iter().try_for_each(|entry| {
            let e = entry.as_ref();
            let lengths = [("a_m", e.a_m), ("d_m", e.d_m), ("b_m", e.b_m)];
            let angles = [("alpha_deg", e.alpha_deg), ("theta_deg", e.theta_deg), ("gamma_deg", e.gamma_deg)];
            let wrong = |(_, v): &(&str, f64)| !(-LARGEST..=LARGEST).contains(v);
            lengths.into_iter().chain(angles).find(wrong).map_or(Ok(()), |(key, v)| {
                Err(self.joint(entry, &format!("has {key} = {v}, expected a finite number up to 1e9")))
            })
        })
    }

    fn check_names(&self, entries: &[Entry]) -> Result<(), RobotError> {
        let name = |j: usize| &entries[j].as_ref().name;
        // Other formats cannot say these: XML readers trim names, and have no control characters.
        let is_bad =
            |e: &&Entry| e.as_ref().name.trim() != e.as_ref().name || e.as_ref().name.contains(char::is_control);
        if let Some(entry) = entries.iter().find(is_bad) {
            return Err(self.joint(entry, "has a name with blanks at its ends or control characters; leave them out"));
        }
        match (1..entries.len()).find(|&j| (0..j).any(|i| name(i) == name(j))) {
            Some(j) => Err(self.joint(&entries[j], "has the name of another joint")),
            None => Ok(()),
        }
    }

    fn parents(&self, entries: &[Entry]) -> Result<Vec<Option<usize>>, RobotError> {
        if entries.iter().all(|entry| entry.as_ref().parent.is_none()) {
            return Ok((0..entries.len()).map(|j| j.checked_sub(1)).collect());
        }
        let parent = |entry: &Entry| match &entry.as_ref().parent {
            None => Ok(None),
            Some(name) => index_of(entries, name)
                .map(Some)
                .ok_or_else(|| self.joint(entry, &format!("has the unknown parent `{name}`"))),
        };
        entries.iter().map(parent).collect()
    }

    /// The sum of the joints that each joint follows, by their places in the file.
    fn sums(&self, entries: &[Entry]) -> Result<Vec<Option<FollowedSum>>, RobotError> {
        let sum = |entry: &Entry| match &entry.as_ref().mimic {
            None => Ok(None),
            Some(mimics) => self.sum(entries, entry, mimics.given()).map(Some),
        };
        let sums = entries.iter().map(sum).collect::<Result<Vec<_>, _>>()?;
        tree::resolve_sums(&sums).map_err(|j| {
            self.joint(&entries[j], "follows itself, or by a ratio beyond 1e9; one joint must follow none")
        })
    }

    fn sum(&self, entries: &[Entry], entry: &Entry, mimics: &[MimicEntry]) -> Result<FollowedSum, RobotError> {
        if mimics.is_empty() {
            return Err(self.joint(entry, "has mimic = [], which names no joint; leave it out"));
        }
        let mimics = mimics.iter().map(|mimic| self.mimic(entries, entry, mimic)).collect::<Result<Vec<_>, _>>()?;
        let shares = mimics.iter().map(|mimic| Share { of: mimic.of, ratio: mimic.ratio }).collect();
        Ok(FollowedSum { shares, offset: mimics.iter().map(|mimic| mimic.offset).sum() })
    }

    fn mimic(&self, entries: &[Entry], entry: &Entry, mimic: &MimicEntry) -> Result<Mimic, RobotError> {
        let of = index_of(entries, &mimic.joint)
            .ok_or_else(|| self.joint(entry, &format!("follows the unknown joint `{}`", mimic.joint)))?;
        let offset = match (entry.as_ref().kind, mimic.offset_deg, mimic.offset_m) {
            (JointKind::Revolute, degrees, None) => degrees.unwrap_or(0.0).to_radians(),
            (JointKind::Prismatic, None, length) => length.unwrap_or(0.0),
            (JointKind::Revolute, ..) => return Err(self.joint(entry, "is revolute: its offset is offset_deg")),
            (JointKind::Prismatic, ..) => return Err(self.joint(entry, "is prismatic: its offset is offset_m")),
        };
        if !(mimic.ratio.abs() <= LARGEST && offset.abs() <= LARGEST) {
            return Err(self.joint(entry, "has a mimic with a number that is not finite, or beyond 1e9"));
        }
        Ok(Mimic { of, ratio: mimic.ratio, offset })
    }

    /// The modified frames of a standard table: `Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha)` of joint i are
    /// theta and d of its own, a and alpha of the next joint's modified frame.
    fn standard(&self, entries: &[Entry], parents: &[Option<usize>]) -> Result<Vec<DenavitHartenberg>, RobotError> {
        let mut followed = vec![false; entries.len()];
        let mut bases = 0;
        for (entry, parent) in entries.iter().zip(parents) {
            let e = entry.as_ref();
            if e.gamma_deg != 0.0 || e.b_m != 0.0 {
                return Err(self.joint(entry, "has gamma_deg or b_m, which belong to convention = \"modified\""));
            }
            let second = match parent {
                Some(parent) => std::mem::replace(&mut followed[*parent], true),
                None => std::mem::replace(&mut bases, 1) > 0,
            };
            if second {
                return Err(self.joint(entry, "branches off: convention = \"standard\" is for serial robots alone"));
            }
        }
        let before = |parent: &Option<usize>| {
            parent.map_or((0.0, 0.0), |p| (entries[p].as_ref().a_m, entries[p].as_ref().alpha_deg))
        };
        let frame = |(entry, parent): (&Entry, &Option<usize>)| {
            let (a, alpha_deg) = before(parent);
            DenavitHartenberg { a, alpha: alpha_deg.to_radians(), ..modified(entry.as_ref()) }
        };
        Ok(entries.iter().zip(parents).map(frame).collect())
    }

    fn cycle(&self, entries: &[Entry], cycle: &[usize]) -> RobotError {
        let name = |&j: &usize| entries[j].as_ref().name.clone();
        let joints = cycle.iter().chain(cycle.first()).map(name).collect();
        let line = cycle.first().map_or(1, |&j| self.line(entries[j].span()));
        RobotError::Cycle { path: self.path.to_owned(), line, joints }
    }

    fn joint(&self, joint: &Entry, problem: &str) -> RobotError {
        RobotError::Joint {
            path: self.path.to_owned(),
            line: self.line(joint.span()),
            joint: joint.as_ref().name.clone(),
            problem: problem.to_owned(),
        }
    }
}

fn index_of(entries: &[Entry], name: &str) -> Option<usize> {
    entries.iter().position(|entry| entry.as_ref().name == name)
}

fn modified(entry: &JointEntry) -> DenavitHartenberg {
    DenavitHartenberg {
        gamma: entry.gamma_deg.to_radians(),
        b: entry.b_m,
        alpha: entry.alpha_deg.to_radians(),
        a: entry.a_m,
        theta: entry.theta_deg.to_radians(),
        d: entry.d_m,
    }
}
