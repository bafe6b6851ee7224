//! Matrices and series to and from those of other crates, each by a feature of its name. Rows of a series are samples.

#[cfg(any(feature = "faer", feature = "nalgebra", feature = "ndarray"))]
use crate::{linear_algebra::Matrix, series::Series};

/// Conversions in both directions, given how the other matrix is made of a function of row and column, and read.
#[cfg(any(feature = "faer", feature = "nalgebra", feature = "ndarray"))]
macro_rules! conversions {
    ($owned:ty, $view:ty, $from_fn:expr) => {
        impl From<$view> for Matrix {
            fn from(other: $view) -> Self {
                Self::from_fn(other.nrows(), other.ncols(), |i, j| other[(i, j)])
            }
        }

        impl From<$view> for Series {
            fn from(other: $view) -> Self {
                let mut series = Self::zeros(other.nrows(), other.ncols());
                for k in 0..other.nrows() {
                    series.sample_mut(k).iter_mut().enumerate().for_each(|(c, value)| *value = other[(k, c)]);
                }
                series
            }
        }

        impl From<&Matrix> for $owned {
            fn from(matrix: &Matrix) -> Self {
                $from_fn(matrix.rows(), matrix.columns(), &|i, j| matrix.at(i, j))
            }
        }

        impl From<&Series> for $owned {
            fn from(series: &Series) -> Self {
                $from_fn(series.len(), series.channels(), &|k, c| series.sample(k)[c])
            }
        }
    };
}

/// What an entry of a matrix is.
#[cfg(any(feature = "faer", feature = "nalgebra", feature = "ndarray"))]
type Entry<'a> = &'a dyn Fn(usize, usize) -> f64;

#[cfg(feature = "faer")]
conversions!(faer::Mat<f64>, faer::MatRef<'_, f64>, |rows, columns, at: Entry<'_>| faer::Mat::from_fn(
    rows, columns, at
));

#[cfg(feature = "nalgebra")]
conversions!(nalgebra::DMatrix<f64>, &nalgebra::DMatrix<f64>, |rows, columns, at: Entry<'_>| {
    nalgebra::DMatrix::from_fn(rows, columns, at)
});

#[cfg(feature = "ndarray")]
conversions!(ndarray::Array2<f64>, ndarray::ArrayView2<'_, f64>, |rows, columns, at: Entry<'_>| {
    ndarray::Array2::from_shape_fn((rows, columns), |(i, j)| at(i, j))
});

#[cfg(all(test, feature = "faer", feature = "nalgebra", feature = "ndarray"))]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_the_same() {
        let matrix = Matrix::from_fn(3, 2, |i, j| (10 * i + j) as f64);
        let series = Series::from_values(2, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        assert_eq!(Matrix::from(faer::Mat::from(&matrix).as_ref()), matrix);
        assert_eq!(Matrix::from(&nalgebra::DMatrix::from(&matrix)), matrix);
        assert_eq!(Matrix::from(ndarray::Array2::from(&matrix).view()), matrix);
        assert_eq!(Series::from(faer::Mat::from(&series).as_ref()), series);
        assert_eq!(Series::from(&nalgebra::DMatrix::from(&series)), series);
        let array = ndarray::Array2::from(&series);
        assert_eq!(array[(1, 0)], 3.0);
        assert_eq!(Series::from(array.view()), series);
    }
}
