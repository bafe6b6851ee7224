use crate::dynamics::{Adjoint, LinkAdjoint, LinkMotion, Model, Twist, Workspace};
use thetahat_ground::{
    real::Real,
    vector::{Mat3, add, constant_times, cross, dot, scale, times},
};

/// The entry of one inertial parameter on one coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct InertialEntry {
    pub(super) link: usize,
    /// Index among the coordinates that move the link.
    pub(super) place: usize,
    /// Index of the link's parameter in the order of [`crate::robot::INERTIAL`].
    pub(super) component: usize,
}

/// Entries of inertial parameters, block by block.
#[derive(Debug, Clone, Default)]
pub(super) struct InertialEntries {
    blocks: Vec<Block>,
    components: Vec<usize>,
}

/// The entries of one coordinate for the inertial parameters of one link, in the order of `components`.
#[derive(Debug, Clone, Copy)]
struct Block {
    link: usize,
    /// Index among the coordinates that move the link.
    place: usize,
    length: usize,
}

impl InertialEntries {
    /// Adds an entry. Links must rise, and entries of one link and coordinate must be consecutive.
    pub(super) fn push(&mut self, entry: InertialEntry) {
        let InertialEntry { link, place, component } = entry;
        self.components.push(component);
        match self.blocks.last_mut() {
            Some(block) if (block.link, block.place) == (link, place) => block.length += 1,
            Some(_) | None => self.blocks.push(Block { link, place, length: 1 }),
        }
    }

    /// Number of entries.
    pub(super) fn len(&self) -> usize {
        self.components.len()
    }

    /// Walks outwards over the links, in the order of the blocks, and propagates the unit twists of the coordinates.
    #[inline(always)]
    pub(super) fn evaluate<T: Real>(&self, model: &Model, workspace: &mut Workspace<T>, mut phi: &mut [T]) {
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

impl InertialEntries {
    /// Adds to an adjoint the derivatives of the sum of the entries times `weights` with respect to the motion of the links and
    /// the unit twists of the workspace, which are computed here.
    #[inline(always)]
    pub(super) fn add_slopes<T: Real>(
        &self,
        model: &Model,
        workspace: &mut Workspace<T>,
        weights: &[T],
        adjoint: &mut Adjoint<T>,
    ) {
        let (links, twists) = (&workspace.links, &mut workspace.twists);
        let Some(kind) = links.first().map(|link| link.dv[0]) else { return };
        (0..links.len()).for_each(|k| model.propagate_twists(k, links, twists));
        let (mut components, mut weights) = (&self.components[..], weights);
        for &Block { link, place, length } in &self.blocks {
            let mut body = [kind.like(0.0); 10];
            components[..length].iter().zip(weights).for_each(|(&c, &w)| body[c] = w);
            (components, weights) = (&components[length..], &weights[length..]);
            let at = model.support(link).start + place;
            let (of_twist, of_link) = match model.link_axes(link) {
                None => slopes_of_body(&body, twists[at], &links[link]),
                Some(axes) => {
                    let (twist, motion) = (twists[at].in_axes(axes), links[link].in_axes(axes));
                    let (of_twist, of_link) = slopes_of_body(&body, twist, &motion);
                    (out_of_axes(&of_twist, axes), of_link.out_of_axes(axes))
                }
            };
            adjoint.twists[at] = adjoint.twists[at].plus(&of_twist);
            adjoint.links[link] = adjoint.links[link].plus(&of_link);
        }
    }
}

/// `x_there = axes x_here` for the derivatives with respect to a twist.
#[inline(always)]
fn out_of_axes<T: Real>(twist: &Twist<T>, axes: &Mat3) -> Twist<T> {
    Twist { angular: constant_times(axes, twist.angular), linear: constant_times(axes, twist.linear) }
}

/// The derivatives of the torque of a body with these ten parameters, `z . N + v . F`, with respect to the twist `(z, v)` and
/// the motion `w, dw, dv`.
#[inline(always)]
fn slopes_of_body<T: Real>(body: &[T; 10], twist: Twist<T>, link: &LinkMotion<T>) -> (Twist<T>, LinkAdjoint<T>) {
    let [xx, xy, xz, yy, yz, zz, x, y, z, m] = *body;
    let (inertia, ms) = ([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], [x, y, z]);
    let Twist { angular: z, linear: v } = twist;
    let LinkMotion { w, dw, dv, .. } = *link;
    let momentum = times(&inertia, w);
    let (wms, vw, vms, ww) = (dot(w, ms), dot(v, w), dot(v, ms), dot(w, w));
    let force = add(add(scale(m, dv), cross(dw, ms)), add(scale(wms, w), scale(-ww, ms)));
    let moment = add(add(times(&inertia, dw), cross(w, momentum)), cross(ms, dv));
    // (z x w) . J w, and v . (w x (w x ms)) = (v . w) (w . ms) - (v . ms) (w . w).
    let gyroscopic = add(times(&inertia, cross(z, w)), cross(momentum, z));
    let centripetal = add(add(scale(wms, v), scale(vw, ms)), scale(vms * -2.0, w));
    let of_link = LinkAdjoint {
        w: add(gyroscopic, centripetal),
        dw: add(times(&inertia, z), cross(ms, v)),
        dv: add(cross(z, ms), scale(m, v)),
    };
    (Twist { angular: moment, linear: force }, of_link)
}

/// The torque for a unit of each inertial parameter of a link, if the joint's unit twist, seen at the link's origin in the
/// link's frame, is `(z, v)`: it is `z . N + v . F`, where `F = m dv + dw x ms + w x (w x ms)` and
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
