use crate::{
    dynamics::{LinkMotion, Model, Sign, Vec3, Workspace, add, cross, dot},
    robot::{INERTIAL, Parameter, Quantity},
    series::Series,
};

/// One entry of `phi` that is not zero by structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// The joint, from zero: the row of `phi`.
    pub joint: usize,
    /// The place of the parameter in the list that the regressor was made for: the column of `phi`.
    pub column: usize,
}

/// Computes chosen columns of `phi`, entry by entry.
#[derive(Debug, Clone)]
pub struct Regressor {
    entries: Vec<Entry>,
    terms: Vec<Term>,
    columns: usize,
}

/// What an entry is computed from.
#[derive(Debug, Clone, Copy)]
enum Term {
    /// Inertial parameter `component` (in the order of [`INERTIAL`]) of `link`.
    Inertial {
        link: usize,
        component: usize,
    },
    Joint(Quantity),
    /// Cross term of a coupled motor: the row's joint and another, with weights.
    Motor {
        quantity: Quantity,
        motor: usize,
    },
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
        // Entries of one joint and link together, so that the kernel computes a joint's view of a link once.
        placed.sort_by_key(|(entry, term)| (block_of(term), entry.joint));
        let (entries, terms) = placed.into_iter().unzip();
        Self { entries, terms, columns: indices.len() }
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
        let mut block = None;
        let mut inertial = [0.0; 10];
        for ((value, entry), term) in phi.iter_mut().zip(&self.entries).zip(&self.terms) {
            *value = match *term {
                Term::Inertial { link, component } => {
                    if block != Some((entry.joint, link)) {
                        block = Some((entry.joint, link));
                        inertial = inertial_entries(model, &workspace.links, entry.joint, link);
                    }
                    inertial[component]
                }
                Term::Joint(quantity) => joint_entry(quantity, dq[entry.joint], ddq[entry.joint], sign),
                Term::Motor { quantity, motor } => {
                    let motor = &model.coupled_motors()[motor];
                    let own = motor.weights.iter().find(|(j, _)| *j == entry.joint).map_or(0.0, |(_, w)| *w);
                    match quantity {
                        Quantity::Iam => own * (motor.velocity(ddq) - own * ddq[entry.joint]),
                        Quantity::Fvm => own * (motor.velocity(dq) - own * dq[entry.joint]),
                        _ => own * sign.of(motor.velocity(dq)),
                    }
                }
            };
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
        (0..=own).map(|joint| (joint, Term::Inertial { link: own, component })).collect()
    } else if quantity.is_coupled_motor() {
        let place = model.coupled_motors().iter().position(|m| m.motor == own);
        let motor = place.map(|motor| (motor, &model.coupled_motors()[motor].weights));
        motor
            .into_iter()
            .flat_map(|(motor, weights)| weights.iter().map(move |&(j, _)| (j, Term::Motor { quantity, motor })))
            .collect()
    } else {
        vec![(own, Term::Joint(quantity))]
    };
    terms.into_iter()
}

fn block_of(term: &Term) -> usize {
    match term {
        Term::Inertial { link, .. } => *link,
        Term::Joint(_) | Term::Motor { .. } => usize::MAX,
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

/// The torque of joint `joint` for a unit of each inertial parameter of `link`.
///
/// With the joint's unit twist seen at the link's origin, in the link's frame, `(z, v)`: the torque is
/// `z . N + v . F`, where `F = m dv + dw x ms + w x (w x ms)` and `N = J dw + w x (J w) + ms x dv`.
#[inline]
fn inertial_entries(model: &Model, links: &[LinkMotion], joint: usize, link: usize) -> [f64; 10] {
    let (z, v) = unit_twist(model, links, joint, link);
    let LinkMotion { w, dw, dv, .. } = links[link];
    let u = cross(z, w);
    let square = |i: usize| z[i] * dw[i] + u[i] * w[i];
    let mixed = |i: usize, j: usize| z[i] * dw[j] + z[j] * dw[i] + u[i] * w[j] + u[j] * w[i];
    // v . (dw x e + w x (w x e)) = e . (v x dw + (v x w) x w), and z . (e x dv) = e . (dv x z)
    let first = add(add(cross(v, dw), cross(cross(v, w), w)), cross(dv, z));
    [square(0), mixed(0, 1), mixed(0, 2), square(1), mixed(1, 2), square(2), first[0], first[1], first[2], dot(v, dv)]
}

/// Angular and linear velocity at the origin of `link`, in its frame, for a unit velocity of `joint`.
#[inline]
fn unit_twist(model: &Model, links: &[LinkMotion], joint: usize, link: usize) -> (Vec3, Vec3) {
    const Z: Vec3 = [0.0, 0.0, 1.0];
    const ZERO: Vec3 = [0.0; 3];
    let mut twist = if model.is_revolute(joint) { (Z, ZERO) } else { (ZERO, Z) };
    for frame in &links[joint + 1..=link] {
        let v = add(twist.1, cross(twist.0, frame.p));
        twist = (frame.r.transpose_times(twist.0), frame.r.transpose_times(v));
    }
    twist
}
