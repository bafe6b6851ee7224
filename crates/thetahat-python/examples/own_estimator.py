"""Your own estimator next to those of thetahat: Huber's M-estimator, which is robust to outliers of the torques."""

import numpy as np
from numpy.typing import NDArray

import thetahat as th

Array = NDArray[np.float64]

THRESHOLD = 1.345  # deviations, beyond which a row has a smaller weight


def huber(regression: th.Regression) -> Array:
    """Iteratively reweighted least squares: rows with larger residuals get smaller weights."""
    X, y = regression.X, regression.y
    weights = np.ones_like(y)
    theta: Array = np.zeros(X.shape[1])
    for _ in range(50):
        before = theta
        theta = np.asarray(np.linalg.lstsq(X * weights[:, np.newaxis], y * weights, rcond=None)[0], dtype=np.float64)
        residual = np.abs(y - X @ theta)
        scale = max(float(np.median(residual)) / 0.6745, 1e-12)
        weights = np.sqrt(np.minimum(1.0, THRESHOLD * scale / np.maximum(residual, 1e-12)))
        if np.allclose(before, theta, rtol=1e-8, atol=0.0):
            break
    return theta


def main() -> None:
    twin = th.testing.twin(seconds=10, seed=1)
    log = twin.recording
    assert log.torque is not None
    torque = log.torque.copy()
    torque[3000:3060] += 5.0  # somebody leaned on the arm
    disturbed = th.Recording(sample_rate_hz=1000, position=log.position, torque=torque)
    result = th.identify(twin.robot, disturbed, estimators={"huber": huber}, cutoff_hz=40, decimation=10)
    print(f"verdict: {result.verdict}")
    for name, true in twin.truth.items():
        ls, own = result["idim-ls"][name].estimate, result["huber"][name].estimate
        print(f"{name:5} idim-ls {ls:9.4f}  huber {own:9.4f}  true {true:9.4f}")


if __name__ == "__main__":
    main()
