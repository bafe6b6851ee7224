use std::collections::BTreeMap;

use super::{
    UrdfError,
    element::{Element, shortened},
    joints::{JointElement, MimicElement, Moving},
    links,
    structure::{Structure, unknown},
    transmissions::{self, Coupling, Drive, Drives},
};
use crate::robot::{
    Doubt, INERTIAL, Joint, Placement, Share, Transmission,
    body::{Frame, RigidBody},
    joint::FollowedSum,
    tree,
};
use thetahat_ground::{
    linear_algebra::Matrix,
    vector::{product, times, transpose},
};

/// The robot under construction, from the base, joint by joint.
pub(super) struct Assembly<'s, 'a> {
    links: &'s [Element<'a>],
    /// The carrier of each link, once it is reached.
    pub(super) places: Vec<Option<LinkPlace>>,
    pub(super) joints: Vec<Joint>,
    moving: Vec<&'s Moving<'a>>,
    /// The body of each joint's link, with everything fixed to it.
    bodies: Vec<RigidBody>,
    /// The index of that link.
    moved_links: Vec<usize>,
    /// The body of the root link, with everything fixed to it.
    pub(super) root_body: RigidBody,
}

/// The drive of each joint of the file, with its name, and the pairs of joints that two motors drive together.
pub(super) struct NamedDrives<'a> {
    of_joints: Vec<(&'a str, Drive<'a>)>,
    couplings: Vec<Coupling<'a>>,
}

/// The moving joint that carries a link, none for the base, and the link's frame in the frame of the carrier's own
/// link.
#[derive(Clone, Copy)]
pub(super) struct LinkPlace {
    pub(super) carrier: Option<usize>,
    pub(super) frame: Frame,
}

impl<'s, 'a> Assembly<'s, 'a> {
    pub(super) fn new(structure: &'s Structure<'a>) -> Result<Self, UrdfError> {
        let mut places = vec![None; structure.link_count()];
        if let Some(root) = places.get_mut(structure.root) {
            *root = Some(LinkPlace { carrier: None, frame: Frame::SAME });
        }
        let root_body = structure.links.get(structure.root).map(|root| links::body_of(*root)).transpose()?;
        Ok(Self {
            links: &structure.links,
            places,
            joints: Vec::new(),
            moving: Vec::new(),
            bodies: Vec::new(),
            moved_links: Vec::new(),
            root_body: root_body.unwrap_or_default(),
        })
    }

    pub(super) fn add(&mut self, joint: &'s JointElement<'a>, parent: usize, child: usize) -> Result<(), UrdfError> {
        let Some(LinkPlace { carrier, frame }) = self.places[parent] else { return Ok(()) };
        let frame = frame.then(&joint.frame);
        let body = links::body_of(self.links[child])?;
        self.places[child] = Some(match &joint.moving {
            None => {
                let carrying = carrier.map_or(&mut self.root_body, |carrier| &mut self.bodies[carrier]);
                carrying.absorb(&body.seen_in(&frame));
                LinkPlace { carrier, frame }
            }
            Some(moving) => {
                self.joints.push(self.joint(joint.name, moving, carrier, &frame));
                self.moving.push(moving);
                self.bodies.push(body);
                self.moved_links.push(child);
                LinkPlace { carrier: Some(self.joints.len() - 1), frame: Frame::SAME }
            }
        });
        Ok(())
    }

    /// The joint's frame is the link's, rotated so that z is the axis; so is the frame of its carrier.
    fn joint(&self, name: &str, moving: &Moving<'a>, carrier: Option<usize>, frame: &Frame) -> Joint {
        let rotation = product(&frame.rotation, &moving.axes);
        let (rotation, origin) = match carrier.and_then(|c| self.joints[c].link_axes) {
            None => (rotation, frame.origin),
            Some(axes) => (product(&axes, &rotation), times(&axes, frame.origin)),
        };
        Joint {
            name: name.to_owned(),
            kind: moving.kind,
            parent: carrier,
            placement: Placement::new(&rotation, origin),
            link_axes: (!moving.has_link_axes()).then(|| transpose(&moving.axes)),
            mimic: None,
            also_follows: Vec::new(),
            passive: false,
            of_base: false,
            limits: moving.limits,
        }
    }

    /// Resolves the `<mimic>` of joints.
    pub(super) fn follow(&mut self) -> Result<(), UrdfError> {
        let sums = self.moving.iter().map(|m| self.sum(m)).collect::<Result<Vec<_>, _>>()?;
        let resolved = tree::resolve_sums(&sums).map_err(|joint| self.follows_itself(joint))?;
        self.joints.iter_mut().zip(resolved).for_each(|(joint, sum)| joint.follow(sum));
        Ok(())
    }

    /// Notes of joints that follow several others.
    pub(super) fn notes_of_sums(&self) -> Vec<Doubt> {
        let note = |mimic: &MimicElement<'_>| {
            let what =
                "the joint follows the sum of several others; other programs take the first <mimic> alone".to_owned();
            Doubt::note(mimic.element.place().to_string(), what, "leave all but one out where no sum is meant")
        };
        self.moving.iter().filter_map(|moving| moving.mimics.get(1)).map(note).collect()
    }

    /// The sum of the joints that a joint follows.
    fn sum(&self, moving: &Moving<'_>) -> Result<Option<FollowedSum>, UrdfError> {
        let shares = moving.mimics.iter().map(|mimic| self.share(mimic)).collect::<Result<Vec<_>, _>>()?;
        let offset = moving.mimics.iter().map(|mimic| mimic.offset).sum();
        Ok((!shares.is_empty()).then_some(FollowedSum { shares, offset }))
    }

    fn share(&self, mimic: &MimicElement<'_>) -> Result<Share, UrdfError> {
        match self.joints.iter().position(|joint| joint.name == mimic.joint) {
            Some(of) => Ok(Share { of, ratio: mimic.ratio }),
            None => {
                let names: Vec<&str> = self.joints.iter().map(|j| j.name.as_str()).collect();
                Err(unknown(mimic.element, "moving joint", mimic.joint, names.iter()))
            }
        }
    }

    fn follows_itself(&self, joint: usize) -> UrdfError {
        let mimic = self.moving[joint].mimics.first();
        let place = mimic.map_or_else(|| self.links[0].place(), |mimic| mimic.element.place());
        let joint = mimic.map_or(String::new(), |mimic| mimic.joint.to_owned());
        UrdfError::Mimic {
            place,
            joint,
            problem: "it follows itself in the end, or by a ratio beyond 1e9; one joint must follow none",
        }
    }

    pub(super) fn coordinates(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(|joint| joint.mimic.is_none())
    }

    /// The body that a joint moves: its link, with everything fixed to it.
    pub(super) fn body(&self, joint: usize) -> &RigidBody {
        &self.bodies[joint]
    }

    /// The body of each link that a joint moves, with everything fixed to it.
    pub(super) fn moved_bodies(&self) -> Vec<Option<RigidBody>> {
        let mut bodies = vec![None; self.links.len()];
        for (body, link) in self.bodies.iter().zip(&self.moved_links) {
            if let Some(place) = bodies.get_mut(*link) {
                *place = Some(*body);
            }
        }
        bodies
    }

    /// The drives of the joints of the file.
    pub(super) fn drives(
        &self,
        robot: Element<'a>,
        structure: &Structure<'a>,
        locked: &[Option<f64>],
    ) -> Result<NamedDrives<'a>, UrdfError> {
        let names: Vec<&str> = structure.joints.iter().map(|joint| joint.name).collect();
        let is_locked = |name: &str| self.joints.iter().zip(locked).any(|(j, v)| v.is_some() && j.name == name);
        let Drives { of_joints, couplings } = transmissions::drives(robot, &names, &is_locked)?;
        Ok(NamedDrives { of_joints: names.into_iter().zip(of_joints).collect(), couplings })
    }

    /// The transmission of the file's drives.
    ///
    /// # Errors
    /// [`UrdfError::Transmission`] where two motors drive a joint that follows another.
    pub(super) fn transmission(&self, drives: &NamedDrives<'_>) -> Result<Transmission, UrdfError> {
        let of = |joint: &Joint| drives.of_joints.iter().find(|(name, _)| *name == joint.name);
        let drive = |joint: &Joint| of(joint).map(|(_, drive)| *drive).unwrap_or_default();
        let of_joints: Vec<Drive<'_>> = self.coordinates().map(drive).collect();
        let n = of_joints.len();
        let mut matrix = Matrix::from_fn(n, n, |i, j| if i == j { of_joints[i].reduction() } else { 0.0 });
        let mut offset: Vec<f64> = of_joints.iter().map(Drive::offset).collect();
        for coupling in &drives.couplings {
            let coordinate = |name: &str| self.coordinates().position(|joint| joint.name == name);
            let [Some(first), Some(second)] = coupling.joints.map(coordinate) else {
                let problem = "couples a joint that is fixed, or that follows another".to_owned();
                return Err(UrdfError::Transmission { place: coupling.element.place(), problem });
            };
            let pair = [first, second];
            for (column, j) in pair.into_iter().enumerate() {
                pair.into_iter().zip(coupling.matrix).for_each(|(i, row)| matrix.column_mut(j)[i] = row[column]);
                offset[j] = coupling.offset[column];
            }
        }
        Ok(Transmission::new(matrix, offset, vec![1.0; n]).unwrap_or_else(|| Transmission::direct(n)))
    }

    /// The a-priori inertias of the motors, seen at their joints.
    pub(super) fn motor_inertias(&self, drives: &NamedDrives<'_>) -> Vec<(String, f64)> {
        let number = |name: &str| self.joints.iter().position(|joint| joint.name == name);
        let inertia = |(name, drive): &(&str, Drive<'_>)| Some((number(name)?, drive.inertia_at_joint()?));
        let nonzero = drives.of_joints.iter().filter_map(inertia).filter(|(_, inertia)| *inertia != 0.0);
        nonzero.map(|(joint, inertia)| (format!("ia{}", joint + 1), inertia)).collect()
    }

    /// Notes of the motor inertias of joints that do not move, and of motors that drive two joints together.
    pub(super) fn unused_inertias(&self, drives: &NamedDrives<'_>) -> Vec<Doubt> {
        let is_fixed = |name: &str| self.joints.iter().all(|joint| joint.name != name);
        let note = |(name, drive): &(&str, Drive<'_>)| {
            let what = format!("the motor inertia is not used, since joint `{}` is fixed", shortened(name));
            Some(Doubt::note(drive.inertia_place()?, what, "remove the transmission, or let the joint move"))
        };
        let of_coupling = |element: Element<'_>| {
            let what = "the motor inertia is not used, since its motor drives two joints".to_owned();
            Doubt::note(
                element.place().to_string(),
                what,
                "give ia of the joints and iam of the motors in [parameters]",
            )
        };
        let coupled = drives.couplings.iter().flat_map(Coupling::motor_inertias).map(of_coupling);
        drives.of_joints.iter().filter(|(name, _)| is_fixed(name)).filter_map(note).chain(coupled).collect()
    }

    /// The inertial parameters and friction that differ from zero.
    pub(super) fn a_priori(&self) -> BTreeMap<String, f64> {
        let mut values = BTreeMap::new();
        for (k, (body, moving)) in self.bodies.iter().zip(&self.moving).enumerate() {
            let inertial = INERTIAL.iter().map(|quantity| quantity.name()).zip(body.parameters());
            let [viscous, coulomb] = moving.friction;
            let all = inertial.chain([("fv", viscous), ("fc", coulomb)]).filter(|(_, value)| *value != 0.0);
            values.extend(all.map(|(name, value)| (format!("{name}{}", k + 1), value)));
        }
        values
    }
}
