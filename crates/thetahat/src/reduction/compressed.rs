use super::{
    factors::{Segment, coarsened},
    identity::Identity,
    value::Reduction,
};
use thetahat_estimation::regression::{BlockKey, Regression, RowLayout};
use thetahat_ground::linear_algebra::Matrix;

/// The regression whose rows are the factors of a reduction. X, Z and y were projected on the same orthonormal columns,
/// so estimates, residual sums and covariances are the same as from all rows.
pub(super) struct Compressed {
    /// y, and X with all base columns.
    pub regression: Regression,
    /// Z with all base columns, where there are instruments.
    pub z: Option<Matrix>,
}

impl Compressed {
    /// With one factor for each joint and recording.
    pub(super) fn whole(reduction: &Reduction) -> Self {
        let whole = |segments: &[Segment]| coarsened(segments.to_vec(), 1);
        let segments: Vec<Vec<Segment>> = reduction.recordings.iter().map(|r| whole(&r.segments)).collect();
        Self::of(&reduction.identity, &segments.iter().map(|s| &s[..]).collect::<Vec<_>>())
    }

    /// With every segment by itself.
    pub(super) fn in_segments(reduction: &Reduction) -> Self {
        let segments: Vec<&[Segment]> = reduction.recordings.iter().map(|r| &r.segments[..]).collect();
        Self::of(&reduction.identity, &segments)
    }

    fn of(identity: &Identity, recordings: &[&[Segment]]) -> Self {
        let (mut measured, mut instruments, mut y) = (Vec::new(), Vec::new(), Vec::new());
        let mut layout = RowLayout::empty(identity.joints.len(), recordings.len());
        let (mut represented, mut stretch) = (vec![0.0; identity.joints.len()], 0);
        for (recording, segments) in recordings.iter().enumerate() {
            for segment in *segments {
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
        let stack = |parts: &[Matrix]| Matrix::stack(&parts.iter().collect::<Vec<_>>());
        let z = (instruments.len() == measured.len()).then(|| stack(&instruments));
        let regression = Regression { represented, ..Regression::new(stack(&measured), y, layout) };
        Self { regression, z }
    }
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
