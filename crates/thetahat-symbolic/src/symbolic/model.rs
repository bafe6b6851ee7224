//! The generated models, as programs.

use super::{
    drives::Drives,
    error::SymbolicError,
    expression::{Builder, Expression},
    forward_dynamics::solve,
    graph::{Array, Signed},
    inertia::{PseudoInertia, links},
    joints::Chain,
    kinematics::{entries, jacobian, poses},
    mass_matrix::{mass_matrix, place},
    newton_euler::{Rates, link_torques, motions},
    program::Program,
    regressor::link_columns,
    request::{DriveTorques, ModelKind, ParameterSet, Request},
    snapping::{Snapped, snapped},
    terms::{TermTorques, term_torques},
};
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters},
    dynamics::Model,
    robot::{JointKind, LinkQuantity, Parameter, Quantity, Robot, TermColumn},
};

/// Most units of length that are tried: each costs a program.
const MOST_UNITS: usize = 12;

/// A parameter of a function.
#[derive(Debug, Clone, PartialEq)]
pub struct FunctionParameter {
    /// Its name.
    pub name: String,
    /// Its unit in SI.
    pub unit: String,
    /// Its expression in standard parameters.
    pub expression: String,
}

/// A model as a program, with the information for its reader.
#[derive(Debug, Clone)]
pub struct Function {
    /// The robot.
    pub robot: String,
    /// Names of the joints of the coordinates, with their kinds.
    pub coordinates: Vec<(String, JointKind)>,
    /// Names of the joints whose links carry no other: the tips of the kinematic models.
    pub tips: Vec<String>,
    /// The model.
    pub model: ModelKind,
    /// The parameters: inputs, or columns of the regressor, or those whose values are inserted.
    pub parameters: Vec<FunctionParameter>,
    /// The inserted values of these parameters.
    pub values: Option<Vec<f64>>,
    /// The torques of the drives that it includes.
    pub drives: DriveTorques,
    /// Where the parameters come from, a line each.
    pub about: Vec<String>,
    /// Whether it includes the robot's own torque terms.
    pub has_terms: bool,
    /// Base parameters whose sums include a drive's parameter that was to be omitted.
    pub kept_drives: Vec<String>,
    /// Numbers of the description that were replaced by special values.
    pub snapped: Vec<Snapped>,
    /// Rows and columns of the output.
    pub shape: [usize; 2],
    /// Velocity v of `tanh(dq / v)` in place of the sign of a velocity, which is in proportion for joints that slide where others turn; none
    /// for the sign itself.
    pub friction_transition: Option<f64>,
    /// The operations.
    pub program: Program,
}

impl Function {
    /// The function of a robot with the fewest operations, over the units of length that its description offers.
    ///
    /// # Errors
    /// [`SymbolicError`] for a torque term that cannot be written as code, base parameters that are not unique, a wrong number
    /// of values, or values for which the mass matrix is singular.
    pub fn new(robot: &Robot, request: &Request) -> Result<Self, SymbolicError> {
        let (robot, snapped) = snapped(robot);
        let made = Made::new(&robot, request)?;
        let mut program = made.program(1.0)?;
        for unit in units(&robot) {
            let other = made.program(unit)?;
            if weight(&other) < weight(&program) {
                program = other;
            }
        }
        Ok(Self {
            robot: robot.name.clone(),
            coordinates: robot.coordinates().map(|joint| (joint.name.clone(), joint.kind)).collect(),
            tips: tips(&robot).into_iter().map(|link| robot.joints[link].name.clone()).collect(),
            model: request.model,
            drives: request.drives,
            about: request.about.clone(),
            has_terms: !robot.terms.is_empty()
                && request.model.has_drive_torques()
                && request.drives == DriveTorques::All,
            kept_drives: made.kept_drives(),
            parameters: made.parameters(),
            shape: made.shape(),
            values: made.values,
            snapped,
            friction_transition: request.friction_transition.map(|transition| transition.turning),
            program,
        })
    }
}

/// The cost of a function: a product counts as two sums.
fn weight(program: &Program) -> usize {
    let count = program.count();
    2 * count.multiplications + count.additions
}

/// The units of length other than 1 m that can save products: if all joints are revolute, the most frequent lengths of the
/// geometry.
fn units(robot: &Robot) -> Vec<f64> {
    let mut units: Vec<(f64, usize)> = Vec::new();
    if robot.joints.iter().all(|joint| joint.kind == JointKind::Revolute) {
        let lengths = robot.joints.iter().flat_map(|joint| joint.placement.origin).map(f64::abs);
        for length in lengths.filter(|length| *length > 0.0) {
            match units.iter_mut().find(|(known, _)| *known == length) {
                Some((_, times)) => *times += 1,
                None => units.push((length, 1)),
            }
        }
    }
    units.sort_by_key(|(_, times)| std::cmp::Reverse(*times));
    units.into_iter().take(MOST_UNITS).map(|(length, _)| length).collect()
}

fn tips(robot: &Robot) -> Vec<usize> {
    (0..robot.joints.len()).filter(|&link| robot.joints.iter().all(|joint| joint.parent != Some(link))).collect()
}

/// A robot, the request, and its parameters.
struct Made<'a> {
    robot: &'a Robot,
    request: &'a Request,
    model: Model,
    base: Option<BaseParameters>,
    /// Values of its parameters.
    values: Option<Vec<f64>>,
}

impl<'a> Made<'a> {
    fn new(robot: &'a Robot, request: &'a Request) -> Result<Self, SymbolicError> {
        if let Some(joint) = robot.joints.iter().find(|joint| !joint.also_follows.is_empty()) {
            return Err(SymbolicError::FollowsSeveral { joint: joint.name.clone() });
        }
        if !robot.loops.is_empty() {
            return Err(SymbolicError::Loops);
        }
        let model = Model::new(robot);
        let base = match request.parameters {
            ParameterSet::Base if request.model.has_parameters() => Some(BaseParameters::of(&model, &[])?),
            ParameterSet::Base | ParameterSet::Standard => None,
        };
        let expected = model.parameter_table().len();
        if let Some(found) = request.values.as_ref().map(Vec::len).filter(|found| *found != expected) {
            return Err(SymbolicError::Values { found, expected });
        }
        let of_set = |theta: &Vec<f64>| base.as_ref().map_or_else(|| theta.clone(), |base| base.from_standard(theta));
        let values = request.values.as_ref().map(of_set);
        Ok(Self { robot, request, model, base, values })
    }

    /// Whether the request omits a standard parameter.
    fn leaves_out(&self, index: usize) -> bool {
        !self.request.drives.contain(self.model.parameter_table().get(index).quantity)
    }

    /// Names of the kept base parameters whose sums include what the request omits.
    fn kept_drives(&self) -> Vec<String> {
        let base = self.base.iter().flat_map(|base| base.parameters());
        let holds = |p: &&BaseParameter| !self.leaves_out(p.kept) && p.regrouped.iter().any(|r| self.leaves_out(r.0));
        base.filter(holds).map(|parameter| parameter.name.clone()).collect()
    }

    /// Number of parameters.
    fn count(&self) -> usize {
        self.base.as_ref().map_or(self.model.parameter_table().len(), BaseParameters::len)
    }

    /// Indices in the table of the acting parameters: all, or those that base parameters keep.
    fn columns(&self) -> Vec<usize> {
        self.base.as_ref().map_or_else(|| (0..self.count()).collect(), BaseParameters::columns)
    }

    fn parameters(&self) -> Vec<FunctionParameter> {
        let standard = |parameter: &Parameter| FunctionParameter {
            name: parameter.name(),
            unit: parameter.unit.to_string(),
            expression: parameter.name(),
        };
        match &self.base {
            None => self.model.parameter_table().iter().map(standard).collect(),
            Some(base) => {
                let of = |p: &BaseParameter| FunctionParameter {
                    name: p.name.clone(),
                    unit: p.unit.to_string(),
                    expression: p.expression.clone(),
                };
                base.parameters().iter().map(of).collect()
            }
        }
    }

    fn shape(&self) -> [usize; 2] {
        let n = self.model.coordinate_count();
        let tips = tips(self.robot).len();
        match self.request.model {
            ModelKind::InverseDynamics | ModelKind::ForwardDynamics | ModelKind::Gravity | ModelKind::Coriolis => {
                [n, 1]
            }
            ModelKind::InverseDynamicsDerivatives => [n, 3 * n],
            ModelKind::MassMatrix => [n, n],
            ModelKind::Regressor => [n, self.count()],
            ModelKind::ForwardKinematics => [3 * tips, 4],
            ModelKind::Jacobian => [6 * tips, n],
        }
    }

    /// The standard parameters as expressions: those that base parameters omit are zero.
    fn theta<'g>(&self, builder: &'g Builder) -> Vec<Expression<'g>> {
        let mut theta = vec![builder.zero(); self.model.parameter_table().len()];
        for (place, column) in self.columns().into_iter().enumerate() {
            if !self.leaves_out(column) {
                theta[column] = match &self.values {
                    Some(values) => builder.constant(values[place]),
                    None => builder.input(Array::Parameter, place),
                };
            }
        }
        theta
    }

    fn program(&self, unit: f64) -> Result<Program, SymbolicError> {
        let builder = Builder::default();
        let outputs: Vec<Signed> = self.outputs(&builder, unit)?.iter().map(|output| output.value).collect();
        Ok(Program::new(&builder.into_graph(), &outputs))
    }

    /// The outputs, row by row.
    fn outputs<'g>(&self, builder: &'g Builder, unit: f64) -> Result<Vec<Expression<'g>>, SymbolicError> {
        let sliding = self.request.friction_transition.map_or(1.0, |t| t.turning / t.sliding);
        let chain = Chain::new(builder, self.robot, unit, sliding);
        let theta = self.theta(builder);
        let table = self.model.parameter_table();
        let drives = Drives { chain: &chain, table, motors: self.model.coupled_motors(), theta: &theta };
        let links = links(&chain, self.robot, &theta);
        let state = Arrays::new(&chain);
        Ok(match self.request.model {
            ModelKind::InverseDynamics => self.torques(&drives, &links, state.rates(true, true, true))?,
            ModelKind::InverseDynamicsDerivatives => {
                let torques = self.torques(&drives, &links, state.rates(true, true, true))?;
                derivatives_of(&torques)
            }
            ModelKind::Gravity => link_torques(&chain, &links, state.rates(false, false, true)),
            ModelKind::Coriolis => link_torques(&chain, &links, state.rates(true, false, false)),
            ModelKind::MassMatrix => full(&mass_matrix(&drives, &links), chain.coordinates),
            ModelKind::ForwardDynamics => {
                self.require_no_acceleration()?;
                let bias = self.torques(&drives, &links, state.rates(true, false, true))?;
                let tau = builder.inputs(Array::Torque, chain.coordinates);
                let rest = tau.into_iter().zip(bias).map(|(tau, bias)| tau - bias).collect();
                solve(mass_matrix(&drives, &links), rest).map_err(|coordinate| self.not_definite(coordinate))?
            }
            ModelKind::Regressor => self.regressor(&drives, state.rates(true, true, true))?,
            ModelKind::ForwardKinematics => {
                let poses = poses(&chain);
                tips(self.robot).into_iter().flat_map(|link| entries(&chain, &poses[link])).collect()
            }
            ModelKind::Jacobian => jacobians(&chain, &tips(self.robot)),
        })
    }

    /// The torques of the links, the drives and the terms.
    fn torques<'g>(
        &self,
        drives: &Drives<'_, 'g>,
        links: &[PseudoInertia<'g>],
        rates: Rates<'_, 'g>,
    ) -> Result<Vec<Expression<'g>>, SymbolicError> {
        let mut torques = link_torques(drives.chain, links, rates);
        drives.add_inertia(rates, &mut torques);
        drives.add_friction(rates, &mut torques);
        let terms = self.terms(drives.chain, rates)?;
        for (parameter, value) in self.model.parameter_table().iter().zip(drives.theta) {
            let Quantity::Term(term) = parameter.quantity else { continue };
            for &(coordinate, torque) in &terms[term.column] {
                torques[coordinate] = torques[coordinate] + torque * *value;
            }
        }
        Ok(torques)
    }

    /// The torques of the terms for a unit of their parameters; none if the request omits them.
    fn terms<'g>(&self, chain: &Chain<'g>, rates: Rates<'_, 'g>) -> Result<Vec<TermTorques<'g>>, SymbolicError> {
        match self.request.drives {
            DriveTorques::All => term_torques(chain, self.robot, rates),
            DriveTorques::Inertia | DriveTorques::None => Ok(vec![Vec::new(); self.robot.terms.len()]),
        }
    }

    /// Refuses terms that depend on the accelerations, which would depend on the terms.
    fn require_no_acceleration(&self) -> Result<(), SymbolicError> {
        let takes = |term: &&TermColumn| term.shape.needs_acceleration();
        match self.robot.terms.iter().find(takes).filter(|_| self.request.drives == DriveTorques::All) {
            Some(term) => Err(SymbolicError::Acceleration { parameter: term.parameter.clone() }),
            None => Ok(()),
        }
    }

    fn not_definite(&self, coordinate: usize) -> SymbolicError {
        let joint = self.robot.coordinates().nth(coordinate).map_or_else(String::new, |joint| joint.name.clone());
        SymbolicError::NotDefinite { joint }
    }

    /// Row by row, a column for each parameter.
    fn regressor<'g>(
        &self,
        drives: &Drives<'_, 'g>,
        rates: Rates<'_, 'g>,
    ) -> Result<Vec<Expression<'g>>, SymbolicError> {
        let chain = drives.chain;
        let axes: Vec<_> = self.robot.joints.iter().map(|joint| joint.link_axes).collect();
        let columns = link_columns(chain, &motions(chain, rates), &axes);
        let terms = self.terms(drives.chain, rates)?;
        let places = self.columns();
        let mut phi = vec![chain.builder.zero(); chain.coordinates * places.len()];
        for (place, index) in places.iter().enumerate() {
            if self.leaves_out(*index) {
                continue;
            }
            let parameter = self.model.parameter_table().get(*index);
            let number = parameter.number - 1;
            let entries: Vec<(usize, Expression<'g>)> = match parameter.quantity {
                Quantity::Link(quantity) => {
                    let of_link = columns.iter().filter(|column| column.link == number);
                    of_link.map(|column| (column.coordinate, column.entries[component(quantity)])).collect()
                }
                Quantity::Term(term) => terms[term.column].clone(),
                quantity @ (Quantity::Joint(_) | Quantity::Motor(_)) => drives.column(quantity, number, rates),
            };
            for (coordinate, entry) in entries {
                let value = &mut phi[coordinate * places.len() + place];
                *value = *value + entry;
            }
        }
        Ok(phi)
    }
}

/// Row by row the derivatives with respect to positions, velocities and accelerations.
fn derivatives_of<'g>(torques: &[Expression<'g>]) -> Vec<Expression<'g>> {
    let n = torques.len();
    let arrays = [Array::Position, Array::Velocity, Array::Acceleration];
    let by_input = arrays.iter().flat_map(|array| (0..n).map(|c| Expression::derivatives(torques, *array, c)));
    let columns: Vec<Vec<Expression<'g>>> = by_input.collect();
    (0..n).flat_map(|row| columns.iter().map(move |column| column[row])).collect()
}

fn component(quantity: LinkQuantity) -> usize {
    quantity as usize
}

fn full<'g>(lower: &[Expression<'g>], n: usize) -> Vec<Expression<'g>> {
    (0..n * n).map(|entry| lower[place(entry / n, entry % n)]).collect()
}

/// The Jacobians of links, six rows each.
fn jacobians<'g>(chain: &Chain<'g>, links: &[usize]) -> Vec<Expression<'g>> {
    let poses = poses(chain);
    let mut rows = Vec::new();
    for &link in links {
        let columns = jacobian(chain, &poses, link);
        for row in 0..6 {
            rows.extend(columns.iter().map(|column| column[row / 3][row % 3]));
        }
    }
    rows
}

/// The arrays of a motion as expressions.
struct Arrays<'g> {
    dq: Vec<Expression<'g>>,
    ddq: Vec<Expression<'g>>,
    zeros: Vec<Expression<'g>>,
}

impl<'g> Arrays<'g> {
    fn new(chain: &Chain<'g>) -> Self {
        let n = chain.coordinates;
        Self {
            dq: chain.builder.inputs(Array::Velocity, n),
            ddq: chain.builder.inputs(Array::Acceleration, n),
            zeros: vec![chain.builder.zero(); n],
        }
    }

    fn rates(&self, moves: bool, accelerates: bool, with_gravity: bool) -> Rates<'_, 'g> {
        let dq = if moves { &self.dq } else { &self.zeros };
        let ddq = if accelerates { &self.ddq } else { &self.zeros };
        Rates { dq, ddq, with_gravity }
    }
}
