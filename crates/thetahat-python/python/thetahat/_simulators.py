"""The identified robot in models of MuJoCo and Pinocchio that are in memory."""

from __future__ import annotations

import importlib
import os
import tempfile
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import ResultsError

if TYPE_CHECKING:
    from .results import Result

_TOLERANCE = 1e-4
"""Largest difference of axes (rad) and anchors (m) of the same joint in two models."""


def _module(name: str, package: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"{name} is not installed: pip install {package}") from error


def pinocchio_model(result: Result, untrusted: bool) -> Any:
    """A model of Pinocchio: kinematics from the exported URDF, inertias, rotors and friction of the result."""
    pinocchio = _module("pinocchio", "pin")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "robot.urdf")
        result.export(path, untrusted=untrusted)
        model = pinocchio.buildModelFromUrdf(path)
    named = {name: number for number, name in enumerate(model.names)}
    robot, standard = result._robot(), result.standard_parameters()
    values = dict(zip(robot.parameter_names, standard.tolist(), strict=True))
    for joint in robot.summary()["joints"]:
        place = model.idx_vs[named[joint["name"]]] if joint["name"] in named else None
        if place is None or joint.get("coordinate") is None:
            continue
        for attribute, quantity in (("armature", "ia"), ("rotorInertia", "ia"), ("damping", "fv"), ("friction", "fc")):
            _set(model, attribute, place, values.get(f"{quantity}{joint['number']}"))
    return model


def _set(model: Any, attribute: str, place: int, value: float | None) -> None:
    array = getattr(model, attribute, None)
    if array is not None and value is not None:
        array[place] = value


def into_mujoco(result: Result, model: Any, untrusted: bool) -> list[str]:
    """Write the result into a compiled model of MuJoCo; returns the remarks of the export."""
    mujoco = _module("mujoco", "mujoco")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "robot.xml")
        remarks = result.export(path, "mjcf", untrusted=untrusted)
        identified = mujoco.MjModel.from_xml_path(path)
    pairs = _joint_pairs(mujoco, identified, model)
    poses = _poses(mujoco, identified, pairs, 0), _poses(mujoco, model, pairs, 1)
    for ours, theirs in pairs:
        _require_same_axis(mujoco, model, poses, ours, theirs)
    for ours, theirs in pairs:
        _copy_joint(identified, model, ours, theirs)
        _copy_body(mujoco, identified, model, poses, (int(identified.jnt_bodyid[ours]), int(model.jnt_bodyid[theirs])))
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return remarks


def _joint_pairs(mujoco: Any, identified: Any, model: Any) -> list[tuple[int, int]]:
    """The joints of both models by their names."""
    kind, pairs = mujoco.mjtObj.mjOBJ_JOINT, []
    for ours in range(identified.njnt):
        name = mujoco.mj_id2name(identified, kind, ours)
        theirs = mujoco.mj_name2id(model, kind, name)
        if theirs < 0:
            known = [mujoco.mj_id2name(model, kind, k) or "(unnamed)" for k in range(model.njnt)]
            raise ResultsError(f"the MuJoCo model has no joint {name}; its joints are {', '.join(known)}")
        pairs.append((ours, theirs))
    return pairs


def _poses(mujoco: Any, model: Any, pairs: list[tuple[int, int]], side: int) -> Any:
    """The poses of all bodies with the robot's joints at zero."""
    data = mujoco.MjData(model)
    data.qpos[[model.jnt_qposadr[pair[side]] for pair in pairs]] = 0.0
    mujoco.mj_kinematics(model, data)
    return data


def _require_same_axis(mujoco: Any, model: Any, poses: tuple[Any, Any], ours: int, theirs: int) -> None:
    """Refuse a model whose joint is elsewhere at zero: inertias would refer to other axes."""
    axis, other = poses[0].xaxis[ours], poses[1].xaxis[theirs]
    offset = poses[1].xanchor[theirs] - poses[0].xanchor[ours]
    is_slide = model.jnt_type[theirs] == mujoco.mjtJoint.mjJNT_SLIDE
    distance = 0.0 if is_slide else float(np.linalg.norm(offset - axis * (axis @ offset)))
    if float(np.linalg.norm(axis - other)) > _TOLERANCE or distance > _TOLERANCE:
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, theirs)
        raise ResultsError(
            f"with all joints at zero, the axis of joint {name} differs between the MuJoCo model and the identified robot: "
            "identify with a description of the same zero position and base, such as Robot.from_mjcf of this model"
        )


def _copy_joint(identified: Any, model: Any, ours: int, theirs: int) -> None:
    source, target = identified.jnt_dofadr[ours], model.jnt_dofadr[theirs]
    for name in ("dof_armature", "dof_damping", "dof_frictionloss"):
        np.reshape(getattr(model, name), (model.nv, -1))[target, 0] = np.reshape(getattr(identified, name), (identified.nv, -1))[source, 0]


def _copy_body(mujoco: Any, identified: Any, model: Any, poses: tuple[Any, Any], bodies: tuple[int, int]) -> None:
    """Copy mass, centre of mass and inertia of a link; bodies fixed to it lose theirs, which the link's includes."""
    ours, theirs = bodies
    for body in range(model.nbody):
        if model.body_weldid[body] == theirs and body != theirs:
            model.body_mass[body], model.body_inertia[body] = 0.0, 0.0
    there, here = poses[1].xmat[theirs].reshape(3, 3), poses[0].xmat[ours].reshape(3, 3)
    turn, shift = there.T @ here, there.T @ (poses[0].xpos[ours] - poses[1].xpos[theirs])
    model.body_mass[theirs], model.body_inertia[theirs] = identified.body_mass[ours], identified.body_inertia[ours]
    model.body_ipos[theirs] = shift + turn @ identified.body_ipos[ours]
    rotation, quaternion = np.zeros(9), np.zeros(4)
    mujoco.mju_quat2Mat(rotation, identified.body_iquat[ours])
    mujoco.mju_mat2Quat(quaternion, (turn @ rotation.reshape(3, 3)).ravel())
    model.body_iquat[theirs] = quaternion
    model.body_sameframe[theirs], model.body_simple[theirs] = 0, 0
