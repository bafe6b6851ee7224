"""Writes floating.toml: generalised forces of MuJoCo of models with a free joint, in the coordinates x y z yaw pitch roll and the joints'.

    python make_floating.py [MODEL.xml]    # prints those of another model

MuJoCo's velocity of a free joint is along the world's axes, and its angular velocity along the body's.
"""

import sys
from pathlib import Path

import mujoco
import numpy as np

FOLDER = Path(__file__).resolve().parent
STATES = 4


def turn(pitch, roll):
    """The angular velocity along the body's axes per yaw, pitch and roll."""
    sp, cp, sr, cr = np.sin(pitch), np.cos(pitch), np.sin(roll), np.cos(roll)
    return np.array([[-sp, 0, 1], [sr * cp, cr, 0], [cr * cp, -sr, 0]])


def turn_rate(pitch, roll, dpitch, droll):
    sp, cp, sr, cr = np.sin(pitch), np.cos(pitch), np.sin(roll), np.cos(roll)
    return np.array([
        [-cp * dpitch, 0, 0],
        [cr * cp * droll - sr * sp * dpitch, -sr * droll, 0],
        [-sr * cp * droll - cr * sp * dpitch, -cr * droll, 0],
    ])


def quaternion(yaw, pitch, roll):
    found, part = np.array([1.0, 0, 0, 0]), np.zeros(4)
    for axis, angle in [([0, 0, 1.0], yaw), ([0, 1.0, 0], pitch), ([1.0, 0, 0], roll)]:
        mujoco.mju_axisAngle2Quat(part, np.array(axis), angle)
        before = found.copy()
        mujoco.mju_mulQuat(found, before, part)
    return found


def torques(model, q, dq, ddq):
    data = mujoco.MjData(model)
    between = np.eye(model.nv)
    between[3:6, 3:6] = turn(q[4], q[5])
    drift = np.zeros(model.nv)
    drift[3:6] = turn_rate(q[4], q[5], dq[4], dq[5]) @ dq[3:6]
    data.qpos[:] = np.concatenate([q[:3], quaternion(*q[3:6]), q[6:]])
    data.qvel[:], data.qacc[:] = between @ dq, between @ ddq + drift
    mujoco.mj_inverse(model, data)
    return between.T @ data.qfrc_inverse


def states(path: Path) -> str:
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    generator = np.random.default_rng(1)
    text = f'[[model]]\nname = "{path.stem}"\n'
    for _ in range(STATES):
        q, dq, ddq = (scale * generator.normal(size=model.nv) for scale in [0.5, 2.0, 10.0])
        for name, values in [("q", q), ("dq", dq), ("ddq", ddq), ("tau", torques(model, q, dq, ddq))]:
            text += ("[[model.state]]\n" if name == "q" else "") + f"{name} = {[float(v) for v in values]}\n"
    return text


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(states(Path(sys.argv[1])))
    else:
        head = f"# MuJoCo {mujoco.__version__}, by make_floating.py\n"
        (FOLDER / "floating.toml").write_text(head + states(FOLDER / "floating/quadruped.xml"))
