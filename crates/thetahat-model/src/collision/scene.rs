use super::{
    capsule::{Capsule, placed},
    nearest::of_capsules,
    obstacle::Obstacle,
};
use crate::dynamics::{JointFrame, Model};
use thetahat_ground::vector::{Vec3, scale};

/// A capsule that a link carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name of the link.
    pub link: String,
    /// The joint that moves it; none for a body fixed to the base.
    pub carrier: Option<usize>,
    /// The capsule in the joint's frame.
    pub capsule: Capsule,
}

/// The robot's capsules, the obstacles, and the pairs that must stay apart.
#[derive(Debug, Clone)]
pub struct Scene {
    model: Model,
    bodies: Vec<Body>,
    obstacles: Vec<Obstacle>,
    pairs: Vec<Pair>,
}

/// Two shapes that must stay apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pair {
    /// Two bodies.
    Bodies(usize, usize),
    /// A body and an obstacle.
    Obstacle(usize, usize),
}

/// The distance of two shapes.
#[derive(Debug, Clone, PartialEq)]
pub struct Clearance {
    /// Their distance, m; below zero where they overlap.
    pub distance: f64,
    /// Its derivatives with respect to the coordinates, m/rad or 1.
    pub slopes: Vec<f64>,
}

impl Scene {
    /// Bodies of a robot and obstacles.
    ///
    /// Bodies of one link and of a link and its carrier may touch, and so may the pairs named in `ignored`.
    #[must_use]
    pub fn new(model: &Model, bodies: Vec<Body>, obstacles: Vec<Obstacle>, ignored: &[[String; 2]]) -> Self {
        let may_touch = |a: &str, b: &str| {
            ignored.iter().any(|[first, second]| (first == a && second == b) || (first == b && second == a))
        };
        let carrier = |joint: Option<usize>| joint.and_then(|joint| model.carrier(joint));
        let are_neighbours = |a: &Body, b: &Body| {
            a.carrier == b.carrier
                || (a.carrier.is_some() && carrier(a.carrier) == b.carrier)
                || (b.carrier.is_some() && carrier(b.carrier) == a.carrier)
        };
        let mut pairs = Vec::new();
        for (i, first) in bodies.iter().enumerate() {
            for (j, second) in bodies.iter().enumerate().skip(i + 1) {
                if !are_neighbours(first, second) && !may_touch(&first.link, &second.link) {
                    pairs.push(Pair::Bodies(i, j));
                }
            }
            let moves = first.carrier.is_some();
            let apart = |obstacle: &&Obstacle| moves && !may_touch(&first.link, &obstacle.name);
            let numbered = obstacles.iter().enumerate().filter(|(_, obstacle)| apart(obstacle));
            pairs.extend(numbered.map(|(k, _)| Pair::Obstacle(i, k)));
        }
        Self { model: model.clone(), bodies, obstacles, pairs }
    }

    /// Number of pairs that must stay apart.
    #[must_use]
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Names of a pair.
    #[must_use]
    pub fn names(&self, pair: usize) -> [&str; 2] {
        match self.pairs[pair] {
            Pair::Bodies(i, j) => [&self.bodies[i].link, &self.bodies[j].link],
            Pair::Obstacle(i, k) => [&self.bodies[i].link, &self.obstacles[k].name],
        }
    }

    /// The capsules with the names of their links in the frame of the base at the coordinates `q`.
    #[must_use]
    pub fn capsules(&self, q: &[f64]) -> Vec<(&str, Capsule)> {
        let frames = self.model.frames(q);
        self.bodies.iter().map(|body| (body.link.as_str(), in_base(body, &frames))).collect()
    }

    /// The distance of every pair at the coordinates `q`, m.
    #[must_use]
    pub fn distances(&self, q: &[f64]) -> Vec<f64> {
        let frames = self.model.frames(q);
        let capsules: Vec<Capsule> = self.bodies.iter().map(|body| in_base(body, &frames)).collect();
        let of = |pair: &Pair| match *pair {
            Pair::Bodies(i, j) => of_capsules(&capsules[i], &capsules[j]).0,
            Pair::Obstacle(i, k) => self.obstacles[k].shape.clearance(&capsules[i]).0,
        };
        self.pairs.iter().map(of).collect()
    }

    /// The distance of one pair at the coordinates `q`, with its derivatives.
    #[must_use]
    pub fn clearance(&self, pair: usize, q: &[f64]) -> Clearance {
        let frames = self.model.frames(q);
        let capsule = |i: usize| in_base(&self.bodies[i], &frames);
        let mut slopes = vec![0.0; q.len()];
        let mut add = |body: usize, point: Vec3, direction: Vec3| {
            if let Some(joint) = self.bodies[body].carrier {
                self.model.add_point_slopes(&frames, joint, point, direction, &mut slopes);
            }
        };
        let distance = match self.pairs[pair] {
            Pair::Bodies(i, j) => {
                let (distance, points, direction) = of_capsules(&capsule(i), &capsule(j));
                add(i, points[0], direction);
                add(j, points[1], scale(-1.0, direction));
                distance
            }
            Pair::Obstacle(i, k) => {
                let (distance, point, direction) = self.obstacles[k].shape.clearance(&capsule(i));
                add(i, point, direction);
                distance
            }
        };
        Clearance { distance, slopes }
    }
}

fn in_base(body: &Body, frames: &[JointFrame]) -> Capsule {
    match body.carrier {
        None => body.capsule,
        Some(joint) => {
            let JointFrame { rotation, origin } = &frames[joint];
            let ends = body.capsule.ends.map(|end| placed(rotation, *origin, end));
            Capsule { ends, radius: body.capsule.radius }
        }
    }
}
