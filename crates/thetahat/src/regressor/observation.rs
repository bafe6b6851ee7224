use crate::{
    dynamics::{LinkMotion, Model, Sign, Twist, Workspace},
    real::Real,
    robot::{INERTIAL, Parameter, Quantity},
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
        let kernel = OneSample { regressor: self, model, motion: [q, dq, ddq], sign, workspace, phi };
        pulp::Arch::new().dispatch(kernel);
    }

    /// The same of samples side by side.
    #[inline(always)]
    pub(super) fn evaluate_of<T: Real>(
        &self,
        model: &Model,
        [q, dq, ddq]: [&[T]; 3],
        sign: Sign,
        workspace: &mut Workspace<T>,
        phi: &mut [T],
    ) {
        model.propagate_motion(q, dq, ddq, &mut workspace.links);
        let (inertial, others) = phi.split_at_mut(self.components.len());
        self.evaluate_inertial(model, workspace, inertial);
        for (value, &(joint, term)) in others.iter_mut().zip(&self.others) {
            *value = match term {
                Term::Motor { quantity, motor } => motor_entry(model, (quantity, motor), joint, (dq, ddq), sign),
                Term::Joint { quantity, ratio } => {
                    joint_entry(quantity, dq[joint] * ratio, ddq[joint] * ratio, sign) * ratio
                }
                Term::Inertial { .. } => value.like(0.0),
            };
        }
    }

    /// Walks outwards over the links, as the blocks are ordered, and carries the unit twists of the coordinates along.
    #[inline(always)]
    fn evaluate_inertial<T: Real>(&self, model: &Model, workspace: &mut Workspace<T>, mut phi: &mut [T]) {
        let (links, twists) = (&workspace.links, &mut workspace.twists);
        let (mut reached, mut start, mut axes) = (0, 0, None);
        let Some(&(mut motion)) = links.first() else { return };
        let mut components = &self.components[..];
        for &Block { link, place, length } in &self.blocks {
            if reached <= link {
                for k in reached..=link {
                    model.propagate_twists(k, links, twists);
                }
                reached = link + 1;
                start = model.support(link).start;
                axes = model.link_axes(link);
                motion = match axes {
                    None => links[link],
                    Some(axes) => links[link].in_axes(axes),
                };
            }
            let twist = twists[start + place];
            let twist = match axes {
                None => twist,
                Some(axes) => twist.in_axes(axes),
            };
            let entries = inertial_entries(twist, &motion);
            let (values, rest) = phi.split_at_mut(length);
            let (chosen, others) = components.split_at(length);
            for (value, &c) in values.iter_mut().zip(chosen) {
                *value = entries[c];
            }
            (phi, components) = (rest, others);
        }
    }
}

/// One sample, compiled for the machine's instructions.
struct OneSample<'a> {
    regressor: &'a Regressor,
    model: &'a Model,
    motion: [&'a [f64]; 3],
    sign: Sign,
    workspace: &'a mut Workspace,
    phi: &'a mut [f64],
}

impl pulp::WithSimd for OneSample<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.regressor.evaluate_of(self.model, self.motion, self.sign, self.workspace, self.phi);
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

#[inline(always)]
fn motor_entry<T: Real>(
    model: &Model,
    (quantity, motor): (Quantity, usize),
    joint: usize,
    (dq, ddq): (&[T], &[T]),
    sign: Sign,
) -> T {
    let motor = &model.coupled_motors()[motor];
    let own = motor.weights.iter().find(|(j, _)| *j == joint).map_or(0.0, |(_, w)| *w);
    match quantity {
        Quantity::Iam => (motor.rate(ddq) - ddq[joint] * own) * own,
        Quantity::Fvm => (motor.rate(dq) - dq[joint] * own) * own,
        _ => sign.of_each(motor.rate(dq)) * own,
    }
}

#[inline(always)]
fn joint_entry<T: Real>(quantity: Quantity, dq: T, ddq: T, sign: Sign) -> T {
    let (s, one) = (sign.of_each(dq), dq.like(1.0));
    match quantity {
        Quantity::Ia => ddq,
        Quantity::Fv => dq,
        Quantity::Fc => s,
        Quantity::Fvp => (one + s) * 0.5 * dq,
        Quantity::Fcp => (one + s) * 0.5,
        Quantity::Fvn => (one - s) * 0.5 * dq,
        Quantity::Fcn => (one - s) * -0.5,
        _ => one,
    }
}

/// The torque for a unit of each inertial parameter of a link, where the joint's unit twist, seen at the link's origin in
/// the link's frame, is `(z, v)`: it is `z . N + v . F`, where `F = m dv + dw x ms + w x (w x ms)` and
/// `N = J dw + w x (J w) + ms x dv`.
#[inline(always)]
fn inertial_entries<T: Real>(twist: Twist<T>, link: &LinkMotion<T>) -> [T; 10] {
    let Twist { angular: z, linear: v } = twist;
    let LinkMotion { w, dw, dv, .. } = *link;
    let u = cross(z, w);
    let square = |i: usize| z[i] * dw[i] + u[i] * w[i];
    let mixed = |i: usize, j: usize| z[i] * dw[j] + z[j] * dw[i] + u[i] * w[j] + u[j] * w[i];
    // v . (dw x e + w x (w x e)) = e . (v x dw + (v x w) x w), and z . (e x dv) = e . (dv x z)
    let first = add(add(cross(v, dw), cross(cross(v, w), w)), cross(dv, z));
    [square(0), mixed(0, 1), mixed(0, 2), square(1), mixed(1, 2), square(2), first[0], first[1], first[2], dot(v, dv)]
}
