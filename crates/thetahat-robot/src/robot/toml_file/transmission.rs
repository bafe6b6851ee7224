use super::{bounds::is_nearly_singular, file::TransmissionEntry, reader::Reader};
use crate::robot::{Joint, JointKind, LARGEST, RobotError, Transmission};
use thetahat_ground::{linear_algebra::Matrix, one_or_each::OneOrEach};

impl Reader<'_> {
    /// The transmission to the coordinates of `joints`; missing entries are taken from `before`.
    pub(super) fn transmission(
        &self,
        entry: TransmissionEntry,
        joints: &[Joint],
        before: &Transmission,
    ) -> Result<Transmission, RobotError> {
        let kinds: Vec<JointKind> = joints.iter().filter(|j| j.has_coordinate()).map(|j| j.kind).collect();
        let n = kinds.len();
        let line = entry.matrix.as_ref().map_or(1, |matrix| self.line(matrix.span()));
        let rows = match entry.matrix {
            Some(matrix) => self.rows(matrix.into_inner(), n)?,
            None => (0..n).map(|i| (0..n).map(|j| before.matrix().at(i, j)).collect()).collect(),
        };
        let offset = match (&entry.offset_deg, &entry.offset_m) {
            (None, None) => before.offset().to_vec(),
            (Some(_), _) | (None, Some(_)) => self.offsets(entry.offset_deg, entry.offset_m, &kinds)?,
        };
        let drive_gain = self.list("drive_gain", entry.drive_gain, n, 1.0)?;
        if let Some(gain) = drive_gain.iter().find(|g| **g == 0.0) {
            return Err(self.value("[transmission] drive_gain", "numbers other than zero", &gain.to_string()));
        }
        let singular = |reason| RobotError::SingularTransmission { path: self.path.to_owned(), line, reason };
        if let Some(row) = rows.iter().position(|row| row.iter().all(|v| *v == 0.0)) {
            return Err(singular(format!("row {} is zero", row + 1)));
        }
        let matrix = Matrix::from_fn(n, n, |i, j| rows[i][j]);
        if is_nearly_singular(&matrix) {
            return Err(singular("its rows depend on one another".to_owned()));
        }
        Transmission::new(matrix, offset, drive_gain)
            .ok_or_else(|| singular("its rows depend on one another".to_owned()))
    }

    fn rows(&self, rows: Vec<Vec<f64>>, n: usize) -> Result<Vec<Vec<f64>>, RobotError> {
        self.count("[transmission] matrix", n, rows.len())?;
        for (i, row) in rows.iter().enumerate() {
            self.count(&format!("[transmission] matrix, row {}", i + 1), n, row.len())?;
        }
        self.check_finite("[transmission] matrix", rows.iter().flatten().copied())?;
        match rows.iter().flatten().find(|v| v.abs() > LARGEST) {
            None => Ok(rows),
            Some(v) => Err(self.value("[transmission] matrix", "motor per joint positions up to 1e9", &v.to_string())),
        }
    }

    fn offsets(
        &self,
        degrees: Option<OneOrEach<f64>>,
        lengths: Option<OneOrEach<f64>>,
        kinds: &[JointKind],
    ) -> Result<Vec<f64>, RobotError> {
        let degrees = self.list("offset_deg", degrees, kinds.len(), 0.0)?;
        let lengths = self.list("offset_m", lengths, kinds.len(), 0.0)?;
        let wrong = |of: JointKind, offset: &[f64]| kinds.iter().zip(offset).any(|(k, o)| *k == of && *o != 0.0);
        if wrong(JointKind::Prismatic, &degrees) {
            let expected = "zero for prismatic joints (use offset_m)";
            return Err(self.value("[transmission] offset_deg", expected, "not zero"));
        }
        if wrong(JointKind::Revolute, &lengths) {
            return Err(self.value("[transmission] offset_m", "zero for revolute joints (use offset_deg)", "not zero"));
        }
        Ok(degrees.iter().zip(&lengths).map(|(deg, m)| deg.to_radians() + m).collect())
    }

    fn list(&self, key: &str, given: Option<OneOrEach<f64>>, n: usize, default: f64) -> Result<Vec<f64>, RobotError> {
        let key = format!("[transmission] {key}");
        let list = given.unwrap_or(OneOrEach::One(default)).to_list(n);
        self.count(&key, n, list.len())?;
        self.check_finite(&key, list.iter().copied())?;
        Ok(list)
    }
}
