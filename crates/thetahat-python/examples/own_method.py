"""A method and a friction law of one's own, between the pieces of thetahat: ridge regression with friction in the cube of the
velocity."""

import numpy as np
from numpy.typing import NDArray

import thetahat as th

Array = NDArray[np.float64]


def ridge(matrix: Array, y: Array, weight: float) -> Array:
    """Least squares that are drawn to zero, column by column in units of the column."""
    scale = np.linalg.norm(matrix, axis=0)
    rows = np.vstack([matrix / scale, weight * np.eye(len(scale))])
    solution = np.linalg.lstsq(rows, np.concatenate([y, np.zeros(len(scale))]), rcond=None)[0]
    return np.asarray(solution / scale, dtype=np.float64)


def main() -> None:
    twin = th.testing.twin(seconds=10, seed=1)
    motion = th.band_pass(twin.recording.position, 1000, 40)
    torque = twin.recording.torque
    assert torque is not None
    matrix = th.observation_matrix(twin.robot, *motion, decimation=10)
    y = th.measurement_vector(torque, decimation=10)
    # A column of one's own goes through the same filter: one joint's rows, zeros in the other's.
    cube = th.decimate(motion.velocity[:, 0] ** 3, 10)
    column = np.concatenate([cube, np.zeros_like(cube)])
    theta = ridge(np.column_stack([matrix, column]), y, weight=1e-4)
    for parameter, value in zip(twin.robot.base_parameters, theta, strict=False):
        print(f"{parameter.name:5} {value:9.4f} {parameter.unit}")
    print(f"cube  {theta[-1]:9.4f} N m s^3/rad^3, true 0")


if __name__ == "__main__":
    main()
