use crate::{
    dynamics::{LinkMotion, Model, Sign, Twist, Workspace},
    robot::{INERTIAL, Parameter, Quantity},
    series::Series,
    vector::{add, cross, dot},
};

/// One entry of `phi` that is not zero by structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// The coordinate, from zero: the row of `phi`.
    pub joint: usize,
    /// The place of the parameter in the list that the regressor was made for: the column of `phi`.
    pub column: usize,
}

/// Computes chosen columns of `phi`, entry by entry.
#[derive(Debug, Clone)]
pub struct Regressor {
    entries: Vec<Entry>,
    /// Inertial entries, block by block, then the others, one by one: together in the order of `entries`.
    blocks: Vec<Block>,
    components: Vec<usize>,
    others: Vec<(usize, Term)>,
    columns: usize,
}

/// The entries of one coordinate for the inertial parameters of one link: as many of `components` as it is long.
#[derive(Debug, Clone, Copy)]
struct Block {
    link: usize,
    /// Which of the coordinates that move the link.
    place: usize,
    length: usize,
}

/// What an entry is computed from.
#[derive(Debug, Clone, Copy)]
enum Term {
    /// Inertial parameter `component` (in the order of [`INERTIAL`]) of `link`, for the coordinate at `place` among those
    /// that move it.
    Inertial { link: usize, place: usize, component: usize },
    /// Motor inertia, friction or offset of a joint that moves by `ratio` with the row's coordinate.
    Joint { quantity: Quantity, ratio: f64 },
    /// Cross term of a coupled motor: the row's coordinate and another, with weights.
    Motor { quantity: Quantity, motor: usize },
}

impl Regressor {
    /// A regressor for the standard parameters at `indices` of the model's table.
    #[must_use]
    pub fn new(model: &Model, indices: &[usize]) -> Self {
        let mut placed = Vec::new();
        for (column, &index) in indices.iter().enumerate() {
            let parameter = model.parameter_table().get(index);
            placed.extend(terms_of(model, parameter).map(|(joint, term)| (Entry { joint, column }, term)));
        }
        // Entries of one coordinate and link together, so that the kernel computes a coordinate's view of a link once.
        placed.sort_by_key(|(entry, term)| block_of(term, entry.joint));
        let mut regressor = Self {
            entries: placed.iter().map(|(entry, _)| *entry).collect(),
            blocks: Vec::new(),
            components: Vec::new(),
            others: Vec::new(),
            columns: indices.len(),
        };
        placed.iter().for_each(|(entry, term)| regressor.add(entry.joint, *term));
        regressor
    }

    fn add(&mut self, joint: usize, term: Term) {
        let Term::Inertial { link, place, component } = term else {
            return self.others.push((joint, term));
        };
        self.components.push(component);
        match self.blocks.last_mut() {
            Some(block) if (block.link, block.place) == (link, place) => block.length += 1,
            _ => self.blocks.push(Block { link, place, length: 1 }),
        }
    }

    /// The entries, in the order in which [`Regressor::evaluate`] writes them.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Number of columns of `phi`.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The entries of `phi` for one sample.
    #[allow(clippy::too_many_arguments)]
    pub fn evaluate(
        &self,
        model: &Model,
        q: &[f64],
        dq: &[f64],
        ddq: &[f64],
        sign: Sign,
        workspace: &mut Workspace,
        phi: &mut [f64],
    ) {
        model.propagate_motion(q, dq, ddq, &mut workspace.links);
        let (inertial, others) = phi.split_at_mut(self.components.len());
        self.evaluate_inertial(model, workspace, inertial);
        for (value, &(joint, term)) in others.iter_mut().zip(&self.others) {
            *value = match term {
                Term::Motor { quantity, motor } => motor_entry(model, (quantity, motor), joint, (dq, ddq), sign),
                Term::Joint { quantity, ratio } => {
                    ratio * joint_entry(quantity, ratio * dq[joint], ratio * ddq[joint], sign)
                }
                Term::Inertial { .. } => 0.0,
            };
        }
    }

    /// Walks outwards over the links, as the blocks are ordered, and carries the unit twists of the coordinates along.
    fn evaluate_inertial(&self, model: &Model, workspace: &mut Workspace, mut phi: &mut [f64]) {
        let (links, twists) = (&workspace.links, &mut workspace.twists);
        let (mut reached, mut start, mut axes) = (0, 0, None);
        let mut motion = LinkMotion::default();
        let mut components = &self.components[..];
        for &Block { link, place, length } in &self.blocks {
            if reached <= link {
                (reached..=link).for_each(|k| model.propagate_twists(k, links, twists));
                reached = link + 1;
                start = model.support(link).start;
                axes = model.link_axes(link);
                motion = axes.map_or(links[link], |axes| links[link].in_axes(axes));
            }
            let twist = twists[start + place];
            let entries = inertial_entries(axes.map_or(twist, |axes| twist.in_axes(axes)), &motion);
            let (values, rest) = phi.split_at_mut(length);
            let (chosen, others) = components.split_at(length);
            values.iter_mut().zip(chosen).for_each(|(value, &c)| *value = entries[c]);
            (phi, components) = (rest, others);
        }
    }

    /// The entries of `phi` over a motion: one channel for each entry.
    #[must_use]
    pub fn evaluate_series(&self, model: &Model, q: &Series, dq: &Series, ddq: &Series, sign: Sign) -> Series {
        let mut workspace = Workspace::new(model);
        let mut phi = Series::zeros(q.len(), self.entries.len());
        for k in 0..q.len() {
            self.evaluate(model, q.sample(k), dq.sample(k), ddq.sample(k), sign, &mut workspace, phi.sample_mut(k));
        }
        phi
    }
}

fn terms_of(model: &Model, parameter: &Parameter) -> impl Iterator<Item = (usize, Term)> + use<> {
    let own = parameter.number - 1;
    let quantity = parameter.quantity;
    let terms: Vec<(usize, Term)> = if let Some(component) = INERTIAL.iter().position(|&i| i == quantity) {
        let coordinates = model.support(own).coordinates.iter().enumerate();
        coordinates.map(|(place, &c)| (c, Term::Inertial { link: own, place, component })).collect()
    } else if quantity.is_coupled_motor() {
        let place = model.coupled_motors().iter().position(|m| m.motor == own);
        let motor = place.map(|motor| (motor, &model.coupled_motors()[motor].weights));
        motor
            .into_iter()
            .flat_map(|(motor, weights)| weights.iter().map(move |&(j, _)| (j, Term::Motor { quantity, motor })))
            .collect()
    } else {
        let (coordinate, ratio) = model.coordinate_of(own);
        vec![(coordinate, Term::Joint { quantity, ratio })]
    };
    terms.into_iter()
}

/// Link and place of an inertial entry; the others come behind, by coordinate.
fn block_of(term: &Term, coordinate: usize) -> (usize, usize) {
    match term {
        Term::Inertial { link, place, .. } => (*link, *place),
        Term::Joint { .. } | Term::Motor { .. } => (usize::MAX, coordinate),
    }
}

fn motor_entry(
    model: &Model,
    (quantity, motor): (Quantity, usize),
    joint: usize,
    (dq, ddq): (&[f64], &[f64]),
    sign: Sign,
) -> f64 {
    let motor = &model.coupled_motors()[motor];
    let own = motor.weights.iter().find(|(j, _)| *j == joint).map_or(0.0, |(_, w)| *w);
    match quantity {
        Quantity::Iam => own * (motor.velocity(ddq) - own * ddq[joint]),
        Quantity::Fvm => own * (motor.velocity(dq) - own * dq[joint]),
        _ => own * sign.of(motor.velocity(dq)),
    }
}

fn joint_entry(quantity: Quantity, dq: f64, ddq: f64, sign: Sign) -> f64 {
    let s = sign.of(dq);
    match quantity {
        Quantity::Ia => ddq,
        Quantity::Fv => dq,
        Quantity::Fc => s,
        Quantity::Fvp => 0.5 * (1.0 + s) * dq,
        Quantity::Fcp => 0.5 * (1.0 + s),
        Quantity::Fvn => 0.5 * (1.0 - s) * dq,
        Quantity::Fcn => -0.5 * (1.0 - s),
        _ => 1.0,
    }
}

/// The torque for a unit of each inertial parameter of a link, where the joint's unit twist, seen at the link's origin in
/// the link's frame, is `(z, v)`: it is `z . N + v . F`, where `F = m dv + dw x ms + w x (w x ms)` and
/// `N = J dw + w x (J w) + ms x dv`.
#[inline]
fn inertial_entries(twist: Twist, link: &LinkMotion) -> [f64; 10] {
    let Twist { angular: z, linear: v } = twist;
    let LinkMotion { w, dw, dv, .. } = *link;
    let u = cross(z, w);
    let square = |i: usize| z[i] * dw[i] + u[i] * w[i];
    let mixed = |i: usize, j: usize| z[i] * dw[j] + z[j] * dw[i] + u[i] * w[j] + u[j] * w[i];
    // v . (dw x e + w x (w x e)) = e . (v x dw + (v x w) x w), and z . (e x dv) = e . (dv x z)
    let first = add(add(cross(v, dw), cross(cross(v, w), w)), cross(dv, z));
    [square(0), mixed(0, 1), mixed(0, 2), square(1), mixed(1, 2), square(2), first[0], first[1], first[2], dot(v, dv)]
}
