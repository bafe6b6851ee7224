"""What Python costs: `python crates/thetahat-python/benchmarks/speed.py DATA`, where DATA holds `tx40/`, in the checkout.

The same work by the library without Python (the study `arrays`) and, for the regressor, by
Pinocchio's function in a loop of Python, where `pin` is installed. The best of several times counts.
"""

import pathlib
import subprocess
import sys
import time
import tomllib

import numpy as np

import thetahat as th

SAMPLES, TIMES = 45_000, 20


def best(work, times=TIMES):
    seconds = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def import_seconds():
    code = "import time; s = time.perf_counter(); import thetahat; print(time.perf_counter() - s)"
    return min(float(subprocess.check_output([sys.executable, "-c", code])) for _ in range(10))


def library(data):
    subprocess.run(["cargo", "build", "--quiet", "--release", "--package", "thetahat", "--example", "studies"], check=True)
    lines = subprocess.check_output(["target/release/examples/studies", "arrays", str(data)], text=True).split("\n")
    return {name: float(seconds) for name, seconds in (line.split() for line in lines if line)}


def pinocchio_loop(motion):
    try:
        import pinocchio as pin
    except ImportError:
        return None
    model = pin.buildModelFromUrdf(str(pathlib.Path("robots/seven_axes.urdf")))
    reduced = pin.buildReducedModel(model, [model.njoints - 1], pin.neutral(model))
    data = reduced.createData()

    def loop():
        rows = np.empty((SAMPLES, 6, 60))
        for k in range(SAMPLES):
            rows[k] = pin.computeJointTorqueRegressor(reduced, data, motion[k], motion[k], motion[k])
        return rows

    return best(loop, 3)


def identification(data):
    """The paper's recording through arrays, and IDIM-LS with its settings."""
    robot = th.Robot.from_toml("robots/tx40.toml")
    columns = [np.loadtxt(data / "tx40" / name, delimiter=",", skiprows=1, ndmin=2) for name in ("pos_read_data.csv", "curr_data.csv")]
    log = th.Recording(
        sample_rate_hz=5000,
        position=robot.joint_positions(columns[0]),
        torque=robot.joint_torques(columns[1]),
        geared=True,
    )
    tables = tomllib.loads(pathlib.Path("experiments/tx40_paper.toml").read_text())
    keys = ("signal", "parameters", "controller", "simulation")
    settings = {key: tables[key] for key in keys}
    return lambda: th.identify(robot, log, cutoff_hz=50, decimation=100, estimation={"start": "cad"}, **settings)


def main():
    data = pathlib.Path(sys.argv[1])
    robot = th.Robot.from_toml("robots/tx40.toml")
    motion = np.sin(0.37 * np.arange(SAMPLES)[:, None] + np.arange(6))
    out = robot.regressor(motion, motion, motion)
    ours = {
        "regressor": best(lambda: robot.regressor(motion, motion, motion, out=out)),
        "regressor_new": best(lambda: robot.regressor(motion, motion, motion)),
        "inverse_dynamics": best(lambda: robot.inverse_dynamics(motion, motion, motion)),
        "identify_ls": best(identification(data)),
    }
    without, loop = library(data), pinocchio_loop(motion)
    print(f"import: {import_seconds():.3f} s")
    for name, seconds in ours.items():
        print(f"{name}: {1e3 * seconds:.1f} ms; without Python {1e3 * without[name]:.1f} ms, {seconds / without[name]:.2f} times")
    print(f"regressor, only the entries that can differ from zero, without Python: {1e3 * without['regressor_entries']:.1f} ms")
    if loop is not None:
        links = [robot.parameter_names[k] for k in th.pinocchio.columns(robot)]
        same = best(lambda: robot.regressor(motion, motion, motion, parameters=links))
        print(f"regressor of the links' {len(links)} parameters over {SAMPLES} states: {1e3 * same:.1f} ms")
        print(f"the same by a loop over Pinocchio: {1e3 * loop:.1f} ms, {loop / same:.1f} times as long")


if __name__ == "__main__":
    main()
