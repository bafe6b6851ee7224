use super::{
    elimination::Elimination,
    error::ConsistencyError,
    known::{Known, LinearConditions},
    program::{Barrier, Block, Term},
    pseudo_inertia::{entries, pseudo_inertia},
    symmetric::Symmetric,
};
use crate::{
    base_parameters::BaseParameters,
    dynamics::{CoupledMotor, Model},
    robot::{Bound, INERTIAL, JointQuantity, LinkQuantity, MotorQuantity, ParameterTable, Quantity, Robot, Role},
};

/// The physically consistent set: the standard parameters that a robot can have, with known properties.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsistentSet {
    table: ParameterTable,
    links: usize,
    a_priori: Vec<f64>,
    /// Usual size of each parameter, never zero.
    scale: Vec<f64>,
    interior: f64,
    known: LinearConditions,
    motors: Vec<MotorMatrix>,
    beliefs: Beliefs,
}

/// What is believed of a robot before its recordings are seen, for [`Prior::Belief`](super::Prior::Belief).
#[derive(Debug, Clone, PartialEq)]
pub struct Beliefs {
    /// Usual size of each standard parameter that belongs to no body, in SI; zero where nothing is believed.
    pub sizes: Vec<f64>,
    /// Part of the belief's weight that the a-priori body of each link has: one for a body that the description states.
    pub link_parts: Vec<f64>,
}

/// A quantity that must be nonnegative or positive semidefinite.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// The pseudo-inertia matrix of a link, from one.
    Link(usize),
    /// A motor inertia or a friction coefficient, by its name.
    Parameter(String),
    /// The joint-space matrix of motor inertias or of their viscous friction, with its coupling.
    CoupledMotors(Quantity),
    /// A bound of a known property.
    Bound(String),
}

/// A condition on standard parameters, with the size of its matrix for usual parameters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ConditionBlock {
    pub(super) condition: Condition,
    pub(super) block: Block,
    pub(super) reference: Symmetric,
}

/// The joints that coupled motors connect, with the parameters of the matrix `diag(ia) + sum_i iam_i offdiag(n_i^T n_i)`.
#[derive(Debug, Clone, PartialEq)]
struct MotorMatrix {
    quantity: Quantity,
    size: usize,
    terms: Vec<Term>,
}

impl MotorMatrix {
    fn cross_terms(&self) -> impl Iterator<Item = &Term> {
        self.terms.iter().filter(|term| term.entries.iter().any(|(i, j, _)| i != j))
    }

    fn is_definite(&self, standard: &[f64]) -> bool {
        let mut matrix = Symmetric::zeros(self.size);
        for term in &self.terms {
            term.entries.iter().for_each(|&(i, j, v)| matrix.add(i, j, v * standard[term.unknown]));
        }
        matrix.cholesky().is_some()
    }
}

/// Usual friction, N m s/rad and N m: only its order of magnitude matters, and only during the solution.
const USUAL_FRICTION: f64 = 1.0;
/// Usual fraction of a joint's friction or inertia in a coupled motor.
const COUPLED_PART: f64 = 0.5;
/// Smallest eigenvalue of an a-priori pseudo-inertia, relative to its largest, that counts as definite.
const DEFINITE: f64 = 1e-12;

impl std::fmt::Display for Condition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Link(number) => write!(f, "link {number}"),
            Self::Parameter(name) | Self::Bound(name) => f.write_str(name),
            Self::CoupledMotors(quantity) => write!(f, "coupled {}", quantity.name()),
        }
    }
}

impl ConsistentSet {
    /// The set of a robot: pseudo-inertia matrices positive semidefinite, motor inertias and friction not below zero.
    ///
    /// `a_priori` are standard parameters whose pseudo-inertia matrices are definite, for example those of
    /// [`completed_a_priori`](super::completed_a_priori).
    ///
    /// # Errors
    /// [`ConsistencyError::WrongSize`] and [`ConsistencyError::APrioriNotDefinite`].
    pub fn new(robot: &Robot, a_priori: &[f64]) -> Result<Self, ConsistencyError> {
        let table = robot.parameter_table();
        if a_priori.len() != table.len() {
            let (expected, found) = (table.len(), a_priori.len());
            return Err(ConsistencyError::WrongSize { what: "the a-priori parameters", expected, found });
        }
        let links = robot.link_count();
        let mut set = Self {
            scale: Vec::new(),
            motors: motor_matrices(robot, &table),
            a_priori: a_priori.to_vec(),
            known: LinearConditions::default(),
            interior: 0.0,
            beliefs: Beliefs { sizes: vec![0.0; a_priori.len()], link_parts: vec![1.0; links] },
            links,
            table,
        };
        set.bodies().try_for_each(|k| set.check_definite(k))?;
        set.scale = (0..a_priori.len()).map(|i| set.usual_size(i)).collect();
        Ok(set)
    }

    /// The set with each pseudo-inertia matrix and motor inertia at least `interior` times the a-priori one.
    ///
    /// # Errors
    /// [`ConsistencyError::BadValue`] unless `0 <= interior < 1`.
    pub fn with_interior(mut self, interior: f64) -> Result<Self, ConsistencyError> {
        if !(0.0..1.0).contains(&interior) {
            let reason = format!("{interior} is not between 0 and 1");
            return Err(ConsistencyError::BadValue { what: "interior".to_owned(), reason });
        }
        self.interior = interior;
        Ok(self)
    }

    /// The part of the set in which a known property holds.
    ///
    /// # Errors
    /// [`ConsistencyError`] for invalid names, links and values. Contradictions between known properties are found when the set
    /// is used.
    pub fn with_known(mut self, known: &Known) -> Result<Self, ConsistencyError> {
        self.known.add(&self.table, known)?;
        Ok(self)
    }

    /// The part of the set in which base parameters lie between two bounds each, in their order; equal bounds fix one.
    ///
    /// # Errors
    /// [`ConsistencyError`] if the number of bounds differs from that of the parameters, and for bounds in the wrong order.
    pub fn with_base_between(mut self, base: &BaseParameters, bounds: &[[f64; 2]]) -> Result<Self, ConsistencyError> {
        if bounds.len() != base.len() {
            let (expected, found) = (base.len(), bounds.len());
            return Err(ConsistencyError::WrongSize { what: "the bounds of the base parameters", expected, found });
        }
        for (parameter, [lower, upper]) in base.parameters().iter().zip(bounds) {
            let terms: Vec<(usize, f64)> = parameter.regrouped.iter().copied().chain([(parameter.kept, 1.0)]).collect();
            self.known.between(&parameter.name, &terms, *lower, *upper)?;
        }
        Ok(self)
    }

    /// The set with other beliefs than the a-priori bodies alone.
    ///
    /// # Errors
    /// [`ConsistencyError::WrongSize`] unless there is a size for each parameter and a part for each link.
    pub fn with_beliefs(self, beliefs: Beliefs) -> Result<Self, ConsistencyError> {
        let [sizes, parts] = [beliefs.sizes.len(), beliefs.link_parts.len()];
        if sizes != self.table.len() {
            let (expected, found) = (self.table.len(), sizes);
            return Err(ConsistencyError::WrongSize { what: "the usual sizes", expected, found });
        }
        if parts != self.links {
            let (expected, found) = (self.links, parts);
            return Err(ConsistencyError::WrongSize { what: "the parts of the links' weights", expected, found });
        }
        let mut set = Self { beliefs, ..self };
        for motors in set.motors.clone() {
            set.shrink_coupling(&motors);
        }
        Ok(set)
    }

    /// The same with usual sizes of at least these, of the numbers that cannot be negative and of which a size is believed.
    #[must_use]
    pub fn with_sizes_at_least(mut self, least: &[f64]) -> Self {
        let believed: Vec<usize> = (0..least.len()).filter(|i| self.is_believed_positive(*i)).collect();
        for i in believed {
            self.beliefs.sizes[i] = self.beliefs.sizes[i].max(least[i]);
        }
        self
    }

    /// Makes the usual sizes of coupled motors so small that they are in the set together with those of the joints: two motors that
    /// turn with the same joints may have more between them than a light joint of the two.
    fn shrink_coupling(&mut self, motors: &MotorMatrix) {
        const MOST_HALVINGS: usize = 60;
        for _ in 0..MOST_HALVINGS {
            if motors.is_definite(&self.believed()) {
                return;
            }
            let sizes = &mut self.beliefs.sizes;
            motors.cross_terms().for_each(|term| sizes[term.unknown] *= 0.5);
        }
    }

    /// The table of standard parameters.
    #[must_use]
    pub fn parameter_table(&self) -> &ParameterTable {
        &self.table
    }

    /// The a-priori parameters.
    #[must_use]
    pub fn a_priori(&self) -> &[f64] {
        &self.a_priori
    }

    /// The margin of each condition: the largest t with its matrix at least t times that of usual parameters.
    #[must_use]
    pub fn margins(&self, standard: &[f64]) -> Vec<(Condition, f64)> {
        self.conditions().into_iter().map(|c| (c.condition.clone(), c.margin(standard))).collect()
    }

    /// The pseudo-inertia matrix of each link.
    #[must_use]
    pub fn pseudo_inertias(&self, standard: &[f64]) -> Vec<Symmetric> {
        (0..self.links).map(|k| self.pseudo_inertia_of(k, standard)).collect()
    }

    pub(super) fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// The elimination of the equalities.
    pub(super) fn elimination(&self) -> Result<Elimination, ConsistencyError> {
        Elimination::new(&self.known.equalities, &self.scale)
    }

    pub(super) fn known(&self) -> &LinearConditions {
        &self.known
    }

    /// All conditions, in the standard parameters.
    pub(super) fn conditions(&self) -> Vec<ConditionBlock> {
        let links = self.bodies().map(|k| self.link_condition(k));
        let parameters = (0..self.table.len()).filter(|&i| self.is_positive(i)).map(|i| self.parameter_condition(i));
        let motors = self.motors.iter().map(|motors| self.motor_condition(motors));
        let bounds = self.known.inequalities.iter().map(|inequality| {
            let typical: f64 = inequality.terms.iter().map(|&(v, c)| (c * self.scale[v]).abs()).sum();
            let constant = Symmetric::diagonal(&[inequality.constant]);
            let reference = Symmetric::diagonal(&[typical.max(inequality.constant.abs())]);
            let terms = inequality.terms.iter().map(|&(v, c)| Term { unknown: v, entries: vec![(0, 0, c)] });
            ConditionBlock::new(Condition::Bound(inequality.name.clone()), constant, terms.collect(), reference)
        });
        links.chain(parameters).chain(motors).chain(bounds).collect()
    }

    /// The divergence of a link's pseudo-inertia matrix from the a-priori one, with a weight.
    pub(super) fn divergence(&self, k: usize, weight: f64) -> Option<Block> {
        let barrier = Barrier::kept(weight, &self.pseudo_inertia_of(k, &self.a_priori).cholesky()?, 4);
        Some(Block { constant: Symmetric::zeros(4), terms: self.link_terms(k), barrier })
    }

    /// The divergence of the motor inertias that have an a-priori value: `D(s | s_0) = s / s_0 - log(s / s_0) - 1`.
    pub(super) fn motor_divergences(&self, weight: f64) -> Vec<Block> {
        let given = |i: &usize| {
            let quantity = self.table.get(*i).quantity;
            self.a_priori[*i] > 0.0 && quantity.is_motor_inertia() && self.is_positive(*i)
        };
        let block = |i: usize| {
            let barrier = Barrier::kept(weight, &Symmetric::diagonal(&[self.a_priori[i]]).cholesky()?, 1);
            let terms = vec![Term { unknown: i, entries: vec![(0, 0, 1.0)] }];
            Some(Block { constant: Symmetric::zeros(1), terms, barrier })
        };
        (0..self.table.len()).filter(given).filter_map(block).collect()
    }

    /// The divergences of [`Prior::Belief`](super::Prior::Belief): of each body, and of each number that cannot be negative.
    pub(super) fn belief_divergences(&self, weight: f64) -> Vec<Block> {
        let bodies = self.bodies().filter_map(|k| self.divergence(k, weight * self.beliefs.link_parts[k]));
        let positive = (0..self.table.len()).filter(|&i| self.is_believed_positive(i));
        let numbers = positive.filter_map(|i| {
            let reference = Symmetric::diagonal(&[self.beliefs.sizes[i]]).cholesky()?;
            let terms = vec![Term { unknown: i, entries: vec![(0, 0, 1.0)] }];
            let barrier = Barrier::kept(weight.min(1.0), &reference, 1);
            Some(Block { constant: Symmetric::zeros(1), terms, barrier })
        });
        bodies.chain(numbers).collect()
    }

    /// The parameters of which a size alone is believed, with the factors of their squares in [`Prior::Belief`](super::Prior::Belief).
    pub(super) fn belief_squares(&self, weight: f64) -> Vec<(usize, f64)> {
        let sizes = self.beliefs.sizes.iter().enumerate();
        let free = sizes.filter(|(i, size)| **size > 0.0 && !self.is_positive(*i));
        free.map(|(i, size)| (i, weight.min(1.0).sqrt() / size)).collect()
    }

    /// Whether a condition follows from the divergences of [`Prior::Belief`](super::Prior::Belief).
    pub(super) fn follows_from_belief(&self, condition: &Condition) -> bool {
        match condition {
            Condition::Link(_) => self.interior == 0.0,
            Condition::Parameter(name) => {
                self.interior == 0.0 && self.table.index_of(name).is_some_and(|i| self.is_believed_positive(i))
            }
            Condition::CoupledMotors(_) | Condition::Bound(_) => false,
        }
    }

    fn is_believed_positive(&self, i: usize) -> bool {
        self.beliefs.sizes[i] > 0.0 && self.is_positive(i)
    }

    /// The a-priori bodies, with the usual size of each number that cannot be negative, and zero for those of either sign that have
    /// a size.
    #[must_use]
    pub fn believed(&self) -> Vec<f64> {
        let sizes = &self.beliefs.sizes;
        let value = |i: usize| match self.table.get(i).quantity.is_inertial() {
            true => self.a_priori[i],
            false if self.is_believed_positive(i) => sizes[i],
            false if sizes[i] > 0.0 => 0.0,
            false if self.is_positive(i) && self.a_priori[i] <= 0.0 => self.scale[i],
            false => self.a_priori[i],
        };
        (0..self.table.len()).map(value).collect()
    }

    /// `factor` times the a-priori mass of all links, less their mass: nonnegative for robots that are not heavier.
    pub(super) fn mass_limit(&self, factor: f64) -> Block {
        let mass = |k: usize| self.table.index(Quantity::Link(LinkQuantity::M), k);
        let masses: Vec<usize> = (0..self.links).filter_map(mass).collect();
        let total: f64 = masses.iter().map(|&i| self.a_priori[i]).sum();
        let terms = masses.into_iter().map(|unknown| Term { unknown, entries: vec![(0, 0, -1.0)] }).collect();
        let reference = Symmetric::diagonal(&[factor * total]);
        Block { constant: reference.clone(), terms, barrier: Barrier::vanishing(1, Some(&reference)) }
    }

    /// Geometric mean over the links of the a-priori second moments, kg m^2.
    pub(super) fn usual_moment(&self) -> f64 {
        let moment = |p: &Symmetric| ((p.at(0, 0) + p.at(1, 1) + p.at(2, 2)) / 3.0).ln();
        let all: Vec<f64> = self.pseudo_inertias(&self.a_priori).iter().map(moment).collect();
        (all.iter().sum::<f64>() / all.len().max(1) as f64).exp()
    }

    /// Number of links.
    #[doc(hidden)]
    pub fn links(&self) -> usize {
        self.links
    }

    /// The links that have a body: those of a base that floats have none but for the last.
    fn bodies(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.links).filter(|&k| self.table.index(Quantity::Link(LinkQuantity::M), k).is_some())
    }

    fn check_definite(&self, k: usize) -> Result<(), ConsistencyError> {
        let values = self.pseudo_inertia_of(k, &self.a_priori).eigenvalues();
        match values.as_slice() {
            [smallest, .., largest] if *smallest > DEFINITE * largest => Ok(()),
            _ => {
                let smallest_eigenvalue = values.first().copied().unwrap_or(f64::NAN);
                Err(ConsistencyError::APrioriNotDefinite { link: k + 1, smallest_eigenvalue })
            }
        }
    }

    fn pseudo_inertia_of(&self, k: usize, standard: &[f64]) -> Symmetric {
        pseudo_inertia(
            INERTIAL.map(|quantity| self.table.index(Quantity::Link(quantity), k).map_or(0.0, |i| standard[i])),
        )
    }

    /// The a-priori value, or otherwise the link's own inertia or mass, or a usual friction.
    fn usual_size(&self, i: usize) -> f64 {
        let parameter = self.table.get(i);
        let p = self.pseudo_inertia_of(parameter.number - 1, &self.a_priori);
        let (m, moments) = (p.at(3, 3), p.at(0, 0) + p.at(1, 1) + p.at(2, 2));
        let inertia = if parameter.unit == "kg" { m } else { p.at(0, 0) + p.at(1, 1) };
        let part = if parameter.quantity.is_coupled_motor() { COUPLED_PART } else { 1.0 };
        let given = self.a_priori[i].abs();
        let or_given = |usual: f64| if given > 0.0 { given } else { usual };
        match parameter.quantity.role() {
            Role::Inertial => match &*parameter.unit {
                "kg" => m,
                "kg m" => (m * moments).sqrt(),
                _ => 2.0 * moments,
            },
            Role::MotorInertia => or_given(part * inertia),
            Role::ViscousFriction | Role::CoulombFriction | Role::Load => or_given(part * USUAL_FRICTION),
        }
    }

    fn is_positive(&self, i: usize) -> bool {
        self.table.get(i).quantity.bound() == Bound::NotNegative
    }

    fn link_terms(&self, k: usize) -> Vec<Term> {
        let term = |quantity| {
            let unknown = self.table.index(Quantity::Link(quantity), k)?;
            Some(Term { unknown, entries: entries(quantity).to_vec() })
        };
        INERTIAL.into_iter().filter_map(term).collect()
    }

    fn link_condition(&self, k: usize) -> ConditionBlock {
        let reference = self.pseudo_inertia_of(k, &self.a_priori);
        let constant = reference.times(-self.interior);
        ConditionBlock::new(Condition::Link(k + 1), constant, self.link_terms(k), reference)
    }

    fn parameter_condition(&self, i: usize) -> ConditionBlock {
        let parameter = self.table.get(i);
        let least = if parameter.quantity.is_motor_inertia() { self.interior * self.a_priori[i].max(0.0) } else { 0.0 };
        let term = Term { unknown: i, entries: vec![(0, 0, 1.0)] };
        let reference = Symmetric::diagonal(&[self.scale[i]]);
        let constant = Symmetric::diagonal(&[-least]);
        ConditionBlock::new(Condition::Parameter(parameter.name()), constant, vec![term], reference)
    }

    fn motor_condition(&self, motors: &MotorMatrix) -> ConditionBlock {
        let mut reference = Symmetric::zeros(motors.size);
        for term in &motors.terms {
            let diagonal = term.entries.iter().filter(|(i, j, _)| i == j);
            diagonal.for_each(|&(i, j, v)| reference.add(i, j, v * self.scale[term.unknown]));
        }
        let (condition, constant) = (Condition::CoupledMotors(motors.quantity), Symmetric::zeros(motors.size));
        ConditionBlock::new(condition, constant, motors.terms.clone(), reference)
    }
}

impl ConditionBlock {
    fn new(condition: Condition, constant: Symmetric, terms: Vec<Term>, reference: Symmetric) -> Self {
        let barrier = Barrier::vanishing(constant.size(), Some(&reference));
        Self { condition, block: Block { constant, terms, barrier }, reference }
    }

    /// The largest t with `S - t S_ref` positive semidefinite at this point.
    pub(super) fn margin(&self, y: &[f64]) -> f64 {
        let factor = self.reference.cholesky();
        factor.map_or(f64::NEG_INFINITY, |factor| factor.smallest_ratio(&self.block.value(y)))
    }

    /// The condition with a multiple of the identity as reference: `unit` for links, so that all links have equal weight.
    pub(super) fn with_even_reference(&self, unit: f64) -> Self {
        let size = self.reference.size();
        let mean = (0..size).map(|i| self.reference.at(i, i)).sum::<f64>() / size as f64;
        let each = match self.condition {
            Condition::Link(_) => unit,
            Condition::Parameter(_) | Condition::CoupledMotors(_) | Condition::Bound(_) => mean,
        };
        Self { reference: Symmetric::diagonal(&vec![each; size]), ..self.clone() }
    }

    /// The block with `factor S_ref` times a further unknown.
    pub(super) fn shifted(&self, unknown: usize, factor: f64) -> Block {
        let mut block = self.block.clone();
        block.terms.push(Term::new(unknown, &self.reference.times(factor)));
        block
    }
}

fn motor_matrices(robot: &Robot, table: &ParameterTable) -> Vec<MotorMatrix> {
    let model = Model::new(robot);
    let pairs = [(JointQuantity::Ia, MotorQuantity::Iam), (JointQuantity::Fv, MotorQuantity::Fvm)];
    pairs
        .into_iter()
        .filter_map(|(own, cross)| motor_matrix(robot, table, model.coupled_motors(), own, cross))
        .collect()
}

/// None if no motor is coupled, or if friction depends on the direction, so that a joint has more than one coefficient.
fn motor_matrix(
    robot: &Robot,
    table: &ParameterTable,
    motors: &[CoupledMotor],
    own: JointQuantity,
    cross: MotorQuantity,
) -> Option<MotorMatrix> {
    let joints = robot.coordinate_joints();
    let coupled = |c: &usize| motors.iter().any(|motor| motor.weights.iter().any(|(k, _)| k == c));
    let coordinates: Vec<usize> = (0..joints.len()).filter(coupled).collect();
    let place = |c: usize| coordinates.iter().position(|&k| k == c);
    let mut terms = Vec::new();
    for (i, &c) in coordinates.iter().enumerate() {
        terms.push(Term { unknown: table.index(Quantity::Joint(own), joints[c])?, entries: vec![(i, i, 1.0)] });
    }
    for motor in motors {
        let below =
            motor.cross_terms().filter_map(|(j, k, w)| Some((place(j)?, place(k)?, w))).filter(|(i, j, _)| i > j);
        terms.push(Term { unknown: table.index(Quantity::Motor(cross), motor.motor)?, entries: below.collect() });
    }
    (!coordinates.is_empty()).then_some(MotorMatrix {
        quantity: Quantity::Motor(cross),
        size: coordinates.len(),
        terms,
    })
}
