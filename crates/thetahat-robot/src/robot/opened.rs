//! The tree of a robot with loops, and the robot of a tree whose loops are closed.

use super::{Joint, Robot, Transmission, loops::Loop};
use thetahat_ground::linear_algebra::Matrix;

impl Robot {
    /// The robot with every loop cut open: passive joints are coordinates with motors of their own.
    #[doc(hidden)]
    #[must_use]
    pub fn opened(&self) -> Self {
        let independent = self.coordinate_joints();
        let joints: Vec<Joint> = self.joints.iter().map(|joint| Joint { passive: false, ..joint.clone() }).collect();
        let opened = Self { joints, loops: Vec::new(), ..self.clone() };
        let own = opened.coordinate_joints();
        let place = |tree: usize| independent.iter().position(|&j| j == own[tree]);
        let entry = |i: usize, j: usize| match (place(i), place(j)) {
            (Some(i), Some(j)) => self.transmission.matrix().at(i, j),
            (None, None) if i == j => 1.0,
            (None | Some(_), None | Some(_)) => 0.0,
        };
        let of_motor =
            |values: &[f64], other: f64| (0..own.len()).map(|tree| place(tree).map_or(other, |i| values[i])).collect();
        let matrix = Matrix::from_fn(own.len(), own.len(), entry);
        let (offset, gain) = (of_motor(self.transmission.offset(), 0.0), of_motor(self.transmission.drive_gain(), 1.0));
        let transmission = Transmission::new(matrix, offset, gain);
        Self { transmission: transmission.unwrap_or_else(|| Transmission::direct(own.len())), ..opened }
    }

    /// Closes loops: the passive joints are no coordinates any more, and have no motors. `None` if a motor turns with both a
    /// passive joint and another.
    pub(super) fn close(&mut self, loops: Vec<Loop>, passive: &[usize]) -> Option<()> {
        let before = self.coordinate_joints();
        passive.iter().for_each(|&j| self.joints[j].passive = true);
        let left: Vec<usize> = (0..before.len()).filter(|&c| !passive.contains(&before[c])).collect();
        let is_own = |motor: &usize| self.transmission.coordinates_of(*motor).iter().all(|c| left.contains(c));
        let motors: Vec<usize> = (0..before.len()).filter(is_own).collect();
        self.transmission = self.transmission.part(&motors, &left)?;
        self.loops.extend(loops);
        Some(())
    }
}
