//! Recursive Newton-Euler on pseudo-inertias.
//!
//! A point `r` of a link accelerates by `dv + A r`, `A = [dw]x + [w]x^2`, so that a link needs the force `F = A l + m dv` and
//! the moments `M = A L + dv l^T`, whose antisymmetric part is the torque. The column of `A` along a revolute joint's axis is
//! that of the link before, rotated: a point on the axis does not turn with the joint.

use super::{
    expression::{Expression, Matrix, Vector, add, cross, dot, times},
    inertia::PseudoInertia,
    joints::{Chain, Joint},
};

/// The motion of a link in its frame, lengths in the chain's unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion<'g> {
    pub(super) w: Vector<'g>,
    pub(super) dw: Vector<'g>,
    /// Acceleration per unit of position.
    pub(super) a: Matrix<'g>,
    /// `zz - yy`, `xx - zz` and `yy - xx` of `a`.
    pub(super) differences: Vector<'g>,
    /// `wy wz`, `wx wz` and `wx wy`.
    pub(super) products: Vector<'g>,
    /// Acceleration of the origin, less gravity.
    pub(super) dv: Vector<'g>,
    /// Whether the origin is known to be fixed.
    rests: bool,
    /// The turn of its joint, in the joint's own axes.
    pub(super) turn: Option<Turn<'g>>,
}

/// The quantities that a revolute joint turns.
#[derive(Debug, Clone, Copy)]
pub(super) struct BeforeTurn<'g> {
    /// Angular velocity of the link before.
    pub(super) w: Vector<'g>,
    /// The product of `a` and the joint's axis, the same before and after the joint.
    pub(super) column: Vector<'g>,
}

/// The turn of a revolute joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn<'g> {
    /// In the joint's tilted frame.
    pub(super) tilted: BeforeTurn<'g>,
    /// Before the turn of the first of the parallel joints of which it is the last, except for the components along z.
    pub(super) level: BeforeTurn<'g>,
    /// Acceleration of the foot of its axis, less gravity, in the tilted frame and in its own.
    pub(super) dv_at_foot: [Vector<'g>; 2],
    /// Whether the foot never moves.
    pub(super) foot_rests: bool,
}

impl<'g> Turn<'g> {
    /// Angular velocity and column in the joint's own frame.
    ///
    /// One turn for all parallel joints costs an additional turn: it pays if both vectors have one component in the plane.
    fn turned(&self, joint: &Joint<'g>) -> [Vector<'g>; 2] {
        let has_one = |x: Vector<'g>| x[0].is_zero() != x[1].is_zero();
        let at_once = joint.is_parallel() && has_one(self.level.w) && has_one(self.level.column);
        let turned = |x: Vector<'g>, level| if at_once { joint.turned_at_once(x, level) } else { joint.turned(x) };
        [turned(self.tilted.w, self.level.w), turned(self.tilted.column, self.level.column)]
    }
}

/// Velocities and accelerations of the coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rates<'a, 'g> {
    pub(super) dq: &'a [Expression<'g>],
    pub(super) ddq: &'a [Expression<'g>],
    /// Whether gravity acts.
    pub(super) with_gravity: bool,
}

impl<'g> Motion<'g> {
    fn at_rest(chain: &Chain<'g>, with_gravity: bool) -> Self {
        let gravity = chain.gravity.map(|g| if with_gravity { -g } else { 0.0 });
        let none = chain.none();
        let dv = chain.builder.constants(gravity);
        Self { w: none, dw: none, a: [none; 3], differences: none, products: none, dv, rests: true, turn: None }
    }

    /// The motion from angular velocity and acceleration, `a` and `dv`.
    pub(super) fn new([w, dw]: [Vector<'g>; 2], a: Matrix<'g>, dv: Vector<'g>) -> Self {
        let differences = [a[2][2] - a[1][1], a[0][0] - a[2][2], a[1][1] - a[0][0]];
        Self { w, dw, a, differences, products: [w[1] * w[2], w[0] * w[2], w[0] * w[1]], dv, rests: false, turn: None }
    }

    /// The motion of a joint's link.
    fn next(&self, chain: &Chain<'g>, joint: &Joint<'g>, rates: Rates<'_, 'g>) -> Self {
        let column = joint.axis_column(&self.a, chain.builder);
        let shift = times(&self.a, joint.foot);
        let foot_rests = self.rests && shift.iter().all(|entry| entry.is_zero());
        let foot = joint.tilted(add(self.dv, shift));
        let dv_at_foot = [foot, joint.turned(foot)];
        let rates = [joint.rate(rates.dq), joint.rate(rates.ddq)];
        if joint.is_revolute {
            let tilted = BeforeTurn { w: joint.tilted(self.w), column };
            let level = self.turn.filter(|_| joint.is_parallel()).map_or(tilted, |turn| turn.level);
            self.turned(joint, rates, Turn { tilted, level, dv_at_foot, foot_rests })
        } else {
            let dv = add(dv_at_foot[1], joint.turned(column).map(|entry| entry * joint.along));
            self.slid(joint, rates, dv)
        }
    }

    /// The motion of a revolute joint's link.
    fn turned(&self, joint: &Joint<'g>, [dq, ddq]: [Expression<'g>; 2], turn: Turn<'g>) -> Self {
        let [[x, y, z], column] = turn.turned(joint);
        let shift = column.map(|entry| entry * joint.along);
        let rests = turn.foot_rests && shift.iter().all(|entry| entry.is_zero());
        let dv = add(turn.dv_at_foot[1], shift);
        let z = z + dq;
        let dz = joint.tilted(self.dw)[2] + ddq;
        let [xz, yz, zz] = column;
        let (xx2, zz2) = (x * x, z * z);
        let yy = -(xx2 + zz2);
        let products = [y * z, x * z, x * y];
        let (dx, dy) = (products[0] - yz, xz - products[1]);
        let (zz_yy, xx_zz) = (zz - yy, xx2 - zz2);
        let differences = [zz_yy, xx_zz, -(zz_yy + xx_zz)];
        let a = [
            [zz + differences[1], products[2] - dz, xz],
            [products[2] + dz, yy, yz],
            [products[1] - dy, products[0] + dx, zz],
        ];
        Self { w: [x, y, z], dw: [dx, dy, dz], a, differences, products, dv, rests, turn: Some(turn) }
    }

    fn slid(&self, joint: &Joint<'g>, [dq, ddq]: [Expression<'g>; 2], dv: Vector<'g>) -> Self {
        let twice = dq * 2.0;
        let w = joint.seen(self.w);
        let dv = [dv[0] + w[1] * twice, dv[1] - w[0] * twice, dv[2] + ddq];
        Self::new([w, joint.seen(self.dw)], joint.seen_matrix(&self.a), dv)
    }

    /// The force and the moment about the origin that accelerate a link.
    fn wrench(&self, link: &PseudoInertia<'g>) -> Wrench<'g> {
        let force = [0, 1, 2].map(|i| dot(self.a[i], link.first) + link.mass * self.dv[i]);
        Wrench { force, moment: [0, 1, 2].map(|i| self.moment(link, i)) }
    }

    /// `M_kj - M_jk` of the axes j and k that follow axis i cyclically.
    fn moment(&self, link: &PseudoInertia<'g>, i: usize) -> Expression<'g> {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let (a, second, first) = (&self.a, &link.second, link.first);
        let turning = a[k][i] * second[i][j] - a[j][i] * second[i][k] + self.differences[i] * second[j][k];
        turning + (a[k][j] * second[j][j] - a[j][k] * second[k][k]) + (self.dv[k] * first[j] - self.dv[j] * first[k])
    }
}

/// Force, and moment about a frame's origin, in that frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wrench<'g> {
    pub(super) force: Vector<'g>,
    pub(super) moment: Vector<'g>,
}

impl<'g> Wrench<'g> {
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self { force: add(self.force, other.force), moment: add(self.moment, other.moment) }
    }

    /// The wrench about the origin of the frame before.
    pub(super) fn moved_to_parent(&self, joint: &Joint<'g>) -> Self {
        let force = joint.seen_back(self.force);
        let [x, y, z] = self.moment;
        let at_foot = [x - joint.along * self.force[1], y + joint.along * self.force[0], z];
        Self { force, moment: add(joint.seen_back(at_foot), cross(joint.foot, force)) }
    }

    /// The torque or force of the joint's drive.
    pub(super) fn along(&self, joint: &Joint<'g>) -> Expression<'g> {
        if joint.is_revolute { self.moment[2] } else { self.force[2] }
    }
}

/// The motion of each link.
pub(super) fn motions<'g>(chain: &Chain<'g>, rates: Rates<'_, 'g>) -> Vec<Motion<'g>> {
    let mut motions: Vec<Motion<'g>> = Vec::with_capacity(chain.joints.len());
    for joint in &chain.joints {
        let before = joint.parent.map_or_else(|| Motion::at_rest(chain, rates.with_gravity), |p| motions[p]);
        motions.push(before.next(chain, joint, rates));
    }
    motions
}

/// The torques on the coordinates that move the links.
pub(super) fn link_torques<'g>(
    chain: &Chain<'g>,
    links: &[PseudoInertia<'g>],
    rates: Rates<'_, 'g>,
) -> Vec<Expression<'g>> {
    let motions = motions(chain, rates);
    let mut wrenches: Vec<Wrench<'g>> = motions.iter().zip(links).map(|(motion, link)| motion.wrench(link)).collect();
    let mut torques = vec![chain.builder.zero(); chain.coordinates];
    for (j, joint) in chain.inwards() {
        torques[joint.coordinate] = torques[joint.coordinate] + wrenches[j].along(joint) * joint.ratio;
        if let Some(parent) = joint.parent {
            wrenches[parent] = wrenches[parent].plus(&wrenches[j].moved_to_parent(joint));
        }
    }
    torques
}
