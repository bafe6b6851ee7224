//! The scene of a design file.

use crate::design::{
    error::DesignError,
    text::{
        collision_options::{CapsuleOptions, CollisionOptions, ObstacleOptions},
        description::Design,
    },
};
use thetahat_ground::vector::{IDENTITY, Mat3, Vec3, norm, scale};
use thetahat_model::{
    collision::{Body, Capsule, Obstacle, ObstacleShape, Scene},
    dynamics::Model,
    robot::{Joint, LinkPart, RobotSource},
};

/// The shapes of a design, and the links without a known shape.
#[derive(Debug, Clone)]
pub(in crate::design) struct Surroundings {
    pub(in crate::design) scene: Scene,
    /// Links whose collision shape is a mesh, and that no capsule covers.
    pub(in crate::design) uncovered: Vec<String>,
}

const METRES: f64 = 1e-3;

impl Design {
    /// The scene of the design, where it has one.
    pub(in crate::design) fn surroundings(&self, model: &Model) -> Result<Option<Surroundings>, DesignError> {
        let Some(options) = &self.file.collision else { return Ok(None) };
        let parts = self.parts()?;
        let mut bodies = Vec::new();
        let mut uncovered = Vec::new();
        for part in &parts {
            if options.capsules.iter().any(|capsule| capsule.link == part.name) {
                continue;
            }
            for shape in &part.shapes {
                match &shape.solid {
                    Some(solid) => bodies.push(Body {
                        link: part.name.clone(),
                        carrier: part.carrier,
                        capsule: Capsule::around(solid).placed(&shape.rotation, shape.origin),
                    }),
                    None => uncovered.push(part.name.clone()),
                }
            }
        }
        for (k, capsule) in options.capsules.iter().enumerate() {
            bodies.push(self.body(&parts, capsule, k)?);
        }
        uncovered.dedup();
        let expected = "capsules of links: the description has no box, cylinder or sphere as a <collision> shape";
        self.require(!bodies.is_empty(), "[collision] capsules", expected, "none")?;
        let obstacles =
            options.obstacles.iter().enumerate().map(|(k, o)| self.obstacle(o, k)).collect::<Result<Vec<_>, _>>()?;
        self.require_names(options, &bodies, &obstacles)?;
        let scene = Scene::new(model, bodies, obstacles, &options.ignore);
        let expected = "shapes that can meet: obstacles, or capsules of links that are no neighbours";
        self.require(scene.pairs() > 0, "[collision]", expected, "none")?;
        Ok(Some(Surroundings { scene, uncovered }))
    }

    /// The links of the URDF, or the links moved by the joints of a TOML.
    fn parts(&self) -> Result<Vec<LinkPart>, DesignError> {
        let source = RobotSource::read(&self.robot_path)?;
        if let Some(text) = source.urdf_text() {
            return Ok(self.robot.parts_of_urdf(text, &self.robot_path)?);
        }
        let part = |(k, joint): (usize, &Joint)| LinkPart {
            name: joint.name.clone(),
            carrier: Some(k),
            is_carrier: true,
            own: [0.0; 10],
            in_carrier: [0.0; 10],
            placement: (IDENTITY, [0.0; 3]),
            shapes: Vec::new(),
        };
        Ok(self.robot.joints.iter().enumerate().map(part).collect())
    }

    fn body(&self, parts: &[LinkPart], capsule: &CapsuleOptions, number: usize) -> Result<Body, DesignError> {
        let key = |of: &str| format!("[collision] capsules, the {}. {of}", number + 1);
        let names = || parts.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = parts.iter().find(|part| part.name == capsule.link);
        let part = found.ok_or_else(|| self.value(&key("link"), &format!("one of {}", names()), &capsule.link))?;
        self.require_length(&key("radius"), capsule.radius)?;
        let ends = [capsule.from, capsule.to];
        for value in ends.iter().flatten() {
            self.require(value.is_finite(), &key("end"), "finite numbers", value)?;
        }
        let own = Capsule { ends: ends.map(|end| scale(METRES, end)), radius: METRES * capsule.radius };
        let (rotation, origin) = &part.placement;
        Ok(Body { link: part.name.clone(), carrier: part.carrier, capsule: own.placed(rotation, *origin) })
    }

    fn obstacle(&self, options: &ObstacleOptions, number: usize) -> Result<Obstacle, DesignError> {
        let key = |of: &str| format!("[collision] obstacles, the {}. {of}", number + 1);
        Ok(match options {
            ObstacleOptions::Plane { name, point, normal } => {
                let length = norm(*normal);
                self.require_length(&key("normal"), length)?;
                let normal = scale(1.0 / length, *normal);
                let offset = METRES * thetahat_ground::vector::dot(normal, *point);
                self.require(offset.is_finite(), &key("point"), "finite numbers", offset)?;
                Obstacle { name: name.clone(), shape: ObstacleShape::HalfSpace { normal, offset } }
            }
            ObstacleOptions::Box { name, centre, edges, rpy } => {
                edges.iter().try_for_each(|edge| self.require_length(&key("edges"), *edge))?;
                let (rotation, centre) = self.frame(&key("centre"), *centre, *rpy)?;
                let half = scale(0.5 * METRES, *edges);
                Obstacle { name: name.clone(), shape: ObstacleShape::Box { rotation, centre, half } }
            }
            ObstacleOptions::Cylinder { name, centre, radius, length, rpy } => {
                self.require_length(&key("radius"), *radius)?;
                self.require_length(&key("length"), *length)?;
                let (rotation, centre) = self.frame(&key("centre"), *centre, *rpy)?;
                let (radius, half) = (METRES * radius, 0.5 * METRES * length);
                Obstacle { name: name.clone(), shape: ObstacleShape::Cylinder { rotation, centre, radius, half } }
            }
        })
    }

    fn frame(&self, key: &str, centre: Vec3, rpy: Vec3) -> Result<(Mat3, Vec3), DesignError> {
        for value in centre.iter().chain(&rpy) {
            self.require(value.is_finite(), key, "finite numbers, as in rpy", value)?;
        }
        Ok((thetahat_model::robot::roll_pitch_yaw(rpy.map(f64::to_radians)), scale(METRES, centre)))
    }

    fn require_length(&self, key: &str, length: f64) -> Result<(), DesignError> {
        self.require(length > 0.0 && length.is_finite(), key, "a finite length above zero", length)
    }

    /// Requires that names that may touch exist.
    fn require_names(
        &self,
        options: &CollisionOptions,
        bodies: &[Body],
        obstacles: &[Obstacle],
    ) -> Result<(), DesignError> {
        let mut names: Vec<&str> = bodies.iter().map(|b| b.link.as_str()).collect();
        names.dedup();
        names.extend(obstacles.iter().map(|o| o.name.as_str()));
        for name in options.ignore.iter().flatten() {
            let expected = format!("names among {}", names.join(", "));
            self.require(names.contains(&name.as_str()), "[collision] ignore", &expected, name)?;
        }
        Ok(())
    }

    /// The posture from which the robot comes, rad or m.
    pub(in crate::design) fn home_posture(&self) -> Option<Vec<f64>> {
        self.file.collision.as_ref()?.home.as_ref().map(|home| self.posture(home))
    }
}
