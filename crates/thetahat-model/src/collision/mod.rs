//! Distances of a robot's links from each other and from obstacles.
//!
//! Links are capsules: all points within a radius of a segment. They are given, or fitted around boxes, cylinders and spheres.
//! Obstacles are half-spaces, boxes and cylinders. Distances are exact for these shapes, below zero where they overlap.
//!
//! | letter | word | shape | unit |
//! | --- | --- | --- | --- |
//! | `a b r` | ends and radius of a capsule | 3, 3, 1 | m |
//! | `d` | clearance of two shapes | 1 | m |
//! | `n` | direction in which the first shape leaves the second | 3 | 1 |

mod capsule;
mod nearest;
mod obstacle;
mod scene;

pub use capsule::Capsule;
pub use obstacle::{Obstacle, ObstacleShape};
pub use scene::{Body, Clearance, Scene};
