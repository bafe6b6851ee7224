use super::{
    factors::{JointRows, KeptRows, Segment, coarsened},
    identity::Identity,
    value::{Reduction, most_segments},
};
use thetahat_estimation::regression::{BlockKey, Regression, RowLayout};
use thetahat_ground::linear_algebra::Matrix;

/// The regression of a reduction. Where its rows are triangular factors, X, Z and y were projected on the same orthonormal
/// columns, so that estimates, residual sums and covariances are the same as from all rows.
pub(super) struct Compressed {
    /// y, and X with all base columns.
    pub regression: Regression,
    /// Z with all base columns, where there are instruments.
    pub z: Option<Matrix>,
}

impl Compressed {
    /// With one factor for each joint and recording.
    pub(super) fn whole(reduction: &Reduction) -> Self {
        Self::with_segments(reduction, 1)
    }

    /// With the rows of every recording in the order of an identification, where all are kept; else with the factors of the
    /// segments of each.
    pub(super) fn of(reduction: &Reduction) -> Self {
        let all_rows = |kept: &KeptRows| match kept {
            KeptRows::All(rows) => Some(rows.clone()),
            KeptRows::Factors(_) => None,
        };
        match reduction.recordings.iter().map(|r| all_rows(&r.kept)).collect::<Option<Vec<JointRows>>>() {
            Some(recordings) => Self::of_rows(&reduction.identity, &recordings),
            None => Self::with_segments(reduction, most_segments(reduction.recordings.len())),
        }
    }

    fn with_segments(reduction: &Reduction, most: usize) -> Self {
        let coarse = |kept: &KeptRows| coarsened(kept.segments().into_owned(), most);
        let segments: Vec<Vec<Segment>> = reduction.recordings.iter().map(|r| coarse(&r.kept)).collect();
        Self::of_segments(&reduction.identity, &segments)
    }

    fn of_rows(identity: &Identity, recordings: &[JointRows]) -> Self {
        let (mut measured, mut instruments, mut y) = (Vec::new(), Vec::new(), Vec::new());
        let rows: Vec<usize> = recordings.iter().map(|r| r.rows.first().map_or(0, Matrix::rows)).collect();
        let layout = RowLayout::new(identity.joints.len(), &rows);
        let mut shares = Vec::with_capacity(layout.len());
        for (joint, acting) in identity.acting.iter().enumerate() {
            for recording in recordings {
                let factor = Factor { matrix: &recording.rows[joint], acting };
                instruments.extend(factor.z(identity.parameters.len()));
                measured.push(factor.x(identity.parameters.len()));
                y.extend_from_slice(factor.y());
                match &recording.shares {
                    Some(of_joints) => shares.extend_from_slice(&of_joints[joint]),
                    None => shares.resize(y.len(), 1.0),
                }
            }
        }
        let is_masked = recordings.iter().any(|r| r.shares.is_some());
        let layout = layout.with_shares(is_masked.then_some(shares));
        let z = (instruments.len() == measured.len()).then(|| stacked(&instruments));
        Self { regression: Regression::new(stacked(&measured), y, layout), z }
    }

    fn of_segments(identity: &Identity, recordings: &[Vec<Segment>]) -> Self {
        let (mut measured, mut instruments, mut y) = (Vec::new(), Vec::new(), Vec::new());
        let mut layout = RowLayout::empty(identity.joints.len(), recordings.len());
        let (mut represented, mut stretch) = (vec![0.0; identity.joints.len()], 0);
        for (recording, segments) in recordings.iter().enumerate() {
            for segment in segments {
                for (joint, factor) in segment.factors.iter().enumerate() {
                    let factor = Factor { matrix: factor, acting: &identity.acting[joint] };
                    instruments.extend(factor.z(identity.parameters.len()));
                    measured.push(factor.x(identity.parameters.len()));
                    y.extend_from_slice(factor.y());
                    layout.push(BlockKey { joint, recording, stretch }, factor.matrix.rows());
                }
                represented.iter_mut().zip(&segment.counted).for_each(|(sum, counted)| *sum += counted);
                stretch += 1;
            }
        }
        let z = (instruments.len() == measured.len()).then(|| stacked(&instruments));
        Self { regression: Regression::of_factors(stacked(&measured), y, layout, represented), z }
    }
}

fn stacked(parts: &[Matrix]) -> Matrix {
    Matrix::stack(&parts.iter().collect::<Vec<_>>())
}

/// The factor of `[X y]`, or of `[Z X y]`, of one joint.
struct Factor<'a> {
    matrix: &'a Matrix,
    /// The base columns that it holds.
    acting: &'a [usize],
}

impl Factor<'_> {
    fn x_start(&self) -> usize {
        self.matrix.columns() - 1 - self.acting.len()
    }

    fn x(&self, columns: usize) -> Matrix {
        self.spread(self.x_start(), columns)
    }

    fn z(&self, columns: usize) -> Option<Matrix> {
        (self.x_start() > 0).then(|| self.spread(0, columns))
    }

    fn y(&self) -> &[f64] {
        self.matrix.column(self.matrix.columns() - 1)
    }

    /// The columns from `first` on at their places among all base columns.
    fn spread(&self, first: usize, columns: usize) -> Matrix {
        let mut matrix = Matrix::zeros(self.matrix.rows(), columns);
        for (c, &column) in self.acting.iter().enumerate() {
            matrix.column_mut(column).copy_from_slice(self.matrix.column(first + c));
        }
        matrix
    }
}
