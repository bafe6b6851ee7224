"""Your own method and friction law, with the building blocks of thetahat: ridge regression, with friction proportional to the cube of the
first joint's velocity."""

import numpy as np
from numpy.typing import NDArray

import thetahat as th

Array = NDArray[np.float64]

RATE_HZ = 1000
DECIMATION = 10
ENDS = 200
AT_REST = 0.1  # rad/s: below it, the sign of Coulomb friction is not known


def ridge(matrix: Array, y: Array, weight: float) -> Array:
    """Least squares regularized towards zero, each column in its own units."""
    scale = np.linalg.norm(matrix, axis=0)
    rows = np.vstack([matrix / scale, weight * np.eye(len(scale))])
    solution = np.linalg.lstsq(rows, np.concatenate([y, np.zeros(len(scale))]), rcond=None)[0]
    return np.asarray(solution / scale, dtype=np.float64)


def main() -> None:
    twin = th.testing.twin(seconds=10, seed=1)
    motion = th.band_pass(twin.recording.position, RATE_HZ, 40)
    phi = twin.robot.regressor(*motion, parameters="base")
    cube = np.zeros((*phi.shape[:2], 1))
    cube[:, 0, 0] = motion.velocity[:, 0] ** 3
    phi = np.concatenate([phi, cube], axis=2)
    # Samples near rest and at the ends of the filter are left out on both sides; then both are decimated in the same way.
    moving = np.abs(motion.velocity) > AT_REST
    moving[:ENDS] = moving[-ENDS:] = False
    assert twin.recording.torque is not None
    y = th.decimate(twin.recording.torque * moving, DECIMATION)
    rows = th.decimate((phi * moving[:, :, np.newaxis]).reshape(len(phi), -1), DECIMATION)
    theta = ridge(rows.reshape(-1, phi.shape[2]), y.reshape(-1), weight=1e-6)
    truth = [*twin.truth.items(), ("cube", 0.0)]
    for (name, true), value in zip(truth, theta, strict=True):
        print(f"{name:5} {value:9.4f}  true {true:9.4f}")


if __name__ == "__main__":
    main()
