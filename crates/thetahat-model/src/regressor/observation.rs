use super::inertial::{InertialEntries, InertialEntry};
use crate::{
    dynamics::{JointCoordinate, Model, Sign, State, Workspace},
    robot::{JointQuantity, MotorQuantity, Parameter, Quantity, TermQuantity},
};
use thetahat_ground::{real::Real, series::Series};

/// One entry of `phi` that is not zero by structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// The coordinate, from zero: the row of `phi`.
    pub joint: usize,
    /// The index of the parameter in the regressor's list: the column of `phi`.
    pub column: usize,
}

/// Computes selected columns of `phi`, entry by entry.
#[derive(Debug, Clone)]
pub struct Regressor {
    entries: Vec<Entry>,
    /// The first entries.
    inertial: InertialEntries,
    /// The entries after the inertial ones.
    drives: Vec<DriveEntry>,
    columns: usize,
    /// The recorded channels that torque terms use, sample by sample of the motion.
    channels: Option<Series>,
    /// The regressor of the tree if loops move some of the joints; the entries above are then empty but for their places.
    of_tree: Option<Box<OfTree>>,
}

/// The regressor of the tree, and where its entries act on the robot's coordinates.
#[derive(Debug, Clone)]
pub(super) struct OfTree {
    pub(super) regressor: Regressor,
    /// For each entry of the tree's regressor: the robot's coordinates on which it acts, with the index of the entry there.
    pub(super) targets: Vec<Vec<(usize, usize)>>,
}

/// The source of an entry.
#[derive(Debug, Clone, Copy)]
enum Source {
    Inertial(InertialEntry),
    Drive(DriveEntry),
}

/// An entry of a drive.
#[derive(Debug, Clone, Copy)]
pub(super) enum DriveEntry {
    /// A parameter of a joint, on the coordinate that moves it.
    Joint { quantity: JointQuantity, moved_by: JointCoordinate },
    /// A parameter of a joint that follows several others, on one of their coordinates.
    Sum { quantity: JointQuantity, joint: usize, ratio: f64 },
    /// A parameter of the coupled motor at this index, on one of the coordinates that move it.
    Motor { quantity: MotorQuantity, motor: usize, coordinate: usize },
    /// A parameter of the term at this index, on one of the coordinates on which it acts.
    Term { column: usize, coordinate: usize },
}

impl DriveEntry {
    #[inline(always)]
    pub(super) fn evaluate<T: Real>(&self, model: &Model, state: State<'_, T>, ddq: &[T], sign: Sign) -> T {
        match *self {
            Self::Motor { quantity, motor, coordinate } => {
                model.coupled_motors()[motor].unit_torque(quantity, coordinate, state, ddq, sign)
            }
            Self::Term { column, coordinate } => {
                model.term_torque(&model.terms()[column], coordinate, state, ddq, sign)
            }
            Self::Sum { quantity, joint, ratio } => {
                model.drive_state(joint, state, ddq, sign).unit_torque(quantity) * ratio
            }
            Self::Joint { quantity, moved_by } => {
                moved_by.state(state, ddq, sign).unit_torque(quantity) * moved_by.ratio
            }
        }
    }

    /// The variables on which it can depend: order (0 for q, 1 for dq, 2 for ddq) and coordinate.
    pub(super) fn depends_on(&self, model: &Model) -> Vec<(usize, usize)> {
        let rates = |c: usize| [(1, c), (2, c)];
        match self {
            Self::Joint { moved_by, .. } => rates(moved_by.coordinate).to_vec(),
            Self::Sum { joint, .. } => model.shares_of(*joint).flat_map(|(c, _)| rates(c)).collect(),
            Self::Motor { motor, .. } => {
                model.coupled_motors()[*motor].weights.iter().flat_map(|(c, _)| rates(*c)).collect()
            }
            Self::Term { .. } => (0..3 * model.coordinate_count()).map(|i| (i % 3, i / 3)).collect(),
        }
    }
}

impl Regressor {
    /// A regressor for the standard parameters at `indices` of the model's table.
    ///
    /// # Panics
    /// If an index is beyond the table.
    #[must_use]
    pub fn new(model: &Model, indices: &[usize]) -> Self {
        if let Some((entries, of_tree)) = OfTree::new(model, indices) {
            let columns = indices.len();
            return Self { entries, columns, of_tree: Some(Box::new(of_tree)), ..Self::of_tree(model, &[]) };
        }
        Self::of_tree(model, indices)
    }

    /// The same of a model whose joints are a tree.
    fn of_tree(model: &Model, indices: &[usize]) -> Self {
        let mut placed = Vec::new();
        for (column, &index) in indices.iter().enumerate() {
            let sources = sources_of(model, model.parameter_table().get(index));
            placed.extend(sources.into_iter().map(|(joint, source)| (Entry { joint, column }, source)));
        }
        // Entries of one coordinate and link are consecutive, so that the kernel computes a coordinate's view of a link once.
        placed.sort_by_key(|(entry, source)| block_of(source, entry.joint));
        let entries = placed.iter().map(|(entry, _)| *entry).collect();
        let (mut inertial, mut drives) = (InertialEntries::default(), Vec::new());
        for (_, source) in placed {
            match source {
                Source::Inertial(entry) => inertial.push(entry),
                Source::Drive(entry) => drives.push(entry),
            }
        }
        Self { entries, inertial, drives, columns: indices.len(), channels: None, of_tree: None }
    }

    /// The entries, in the order in which [`Regressor::evaluate`] writes them.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The regressor for a motion recorded with these channels, as in [`State::channels`].
    #[must_use]
    pub fn with_channels(self, channels: Option<Series>) -> Self {
        Self { channels, ..self }
    }

    /// Replaces the channels.
    #[doc(hidden)]
    pub fn set_channels(&mut self, channels: Option<&Series>) {
        self.channels = channels.cloned();
    }

    pub(super) fn channels(&self) -> Option<&Series> {
        self.channels.as_ref()
    }

    /// Number of columns of `phi`.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The entries of `phi` for one sample.
    ///
    /// # Panics
    /// If a slice is shorter than the robot has coordinates, or than `phi` has entries.
    pub fn evaluate(
        &self,
        model: &Model,
        state: State<'_>,
        ddq: &[f64],
        sign: Sign,
        workspace: &mut Workspace,
        phi: &mut [f64],
    ) {
        if let Some(of_tree) = &self.of_tree {
            return of_tree.evaluate(model, (state, ddq), sign, workspace, phi);
        }
        let kernel = OneSample { regressor: self, model, state, ddq, sign, workspace, phi };
        pulp::Arch::new().dispatch(kernel);
    }

    /// The entries of one sample, or of one sample in each lane.
    #[inline(always)]
    pub(super) fn evaluate_of<T: Real>(
        &self,
        model: &Model,
        state: State<'_, T>,
        ddq: &[T],
        sign: Sign,
        workspace: &mut Workspace<T>,
        phi: &mut [T],
    ) {
        let (inertial, drives) = phi.split_at_mut(self.inertial.len());
        // Drives need the rates of their coordinates alone.
        if !inertial.is_empty() {
            model.propagate_motion(state, ddq, &mut workspace.links);
            self.inertial.evaluate(model, workspace, inertial);
        }
        for (value, entry) in drives.iter_mut().zip(&self.drives) {
            *value = entry.evaluate(model, state, ddq, sign);
        }
    }

    pub(super) fn inertial(&self) -> &InertialEntries {
        &self.inertial
    }

    /// The entries of drives, which follow the inertial ones.
    pub(super) fn drives(&self) -> &[DriveEntry] {
        &self.drives
    }
}

/// One sample, compiled for the machine's instructions.
struct OneSample<'a> {
    regressor: &'a Regressor,
    model: &'a Model,
    state: State<'a>,
    ddq: &'a [f64],
    sign: Sign,
    workspace: &'a mut Workspace,
    phi: &'a mut [f64],
}

impl pulp::WithSimd for OneSample<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.regressor.evaluate_of(self.model, self.state, self.ddq, self.sign, self.workspace, self.phi);
    }
}

/// The coordinates on which a parameter acts, each with the source of its entry.
fn sources_of(model: &Model, parameter: &Parameter) -> Vec<(usize, Source)> {
    let own = parameter.number - 1;
    match parameter.quantity {
        Quantity::Link(quantity) => {
            let coordinates = model.support(own).coordinates.iter().enumerate();
            let entry = |place| InertialEntry { link: own, place, component: quantity as usize };
            coordinates.map(|(place, &c)| (c, Source::Inertial(entry(place)))).collect()
        }
        Quantity::Joint(quantity) => {
            let moved_by = model.coordinate_of(own);
            match model.shares_of(own).count() {
                1 => vec![(moved_by.coordinate, Source::Drive(DriveEntry::Joint { quantity, moved_by }))],
                _ => {
                    let entry = |ratio| Source::Drive(DriveEntry::Sum { quantity, joint: own, ratio });
                    model.shares_of(own).map(|(coordinate, ratio)| (coordinate, entry(ratio))).collect()
                }
            }
        }
        Quantity::Motor(quantity) => {
            let motors = model.coupled_motors().iter().enumerate().filter(|(_, m)| m.motor == own);
            let weights =
                motors.flat_map(|(motor, m)| m.weights.iter().map(move |&(coordinate, _)| (motor, coordinate)));
            let entry = |(motor, coordinate)| DriveEntry::Motor { quantity, motor, coordinate };
            weights.map(|place| (place.1, Source::Drive(entry(place)))).collect()
        }
        Quantity::Term(TermQuantity { column, .. }) => {
            let coordinates = model.terms()[column].coordinates.iter();
            coordinates
                .map(|&coordinate| (coordinate, Source::Drive(DriveEntry::Term { column, coordinate })))
                .collect()
        }
    }
}

/// Link and index of an inertial entry; the others follow, ordered by coordinate.
fn block_of(source: &Source, coordinate: usize) -> (usize, usize) {
    match source {
        Source::Inertial(entry) => (entry.link, entry.place),
        Source::Drive(_) => (usize::MAX, coordinate),
    }
}
