"""Inverse dynamics of other programs on exported robots, beside thetahat's: called by `.ci/export`."""

import importlib.util
import json
import logging
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pinocchio

TOLERANCE = 1e-9


class Expected:
    """What thetahat says: states of the coordinates, their torques, and how joints follow coordinates."""

    def __init__(self, path: Path) -> None:
        data = json.loads(path.read_text())
        self.gravity = np.array(data["gravity"])
        self.joints = data["joints"]
        self.q, self.dq, self.ddq, self.tau = (np.array(data["states"][k]) for k in ("q", "dq", "ddq", "tau"))
        self.frictionless_tau = np.array(data["states"]["frictionless_tau"])

    def of_joints(self, state: int):
        """Position, velocity and acceleration of each joint."""
        c = [joint["coordinate"] for joint in self.joints]
        ratio = np.array([joint["ratio"] for joint in self.joints])
        offset = np.array([joint["offset"] for joint in self.joints])
        return ratio * self.q[state, c] + offset, ratio * self.dq[state, c], ratio * self.ddq[state, c]

    def of_coordinates(self, torques) -> np.ndarray:
        """Torques of joints on coordinates."""
        tau = np.zeros(self.tau.shape[1])
        for joint, torque in zip(self.joints, torques):
            tau[joint["coordinate"]] += joint["ratio"] * torque
        return tau

    def worst(self, inverse_dynamics, expected) -> float:
        """The largest difference, relative to the largest torque of its state."""
        worst = 0.0
        for state, tau in enumerate(expected):
            found = self.of_coordinates(inverse_dynamics(*self.of_joints(state)))
            difference = np.max(np.abs(found - tau)) / np.max(np.abs(tau))
            worst = max(worst, difference if np.isfinite(difference) else np.inf)
        return worst


def of_pinocchio(path: Path, expected: Expected) -> float:
    """Rigid torques by rnea, with the damping and friction that Pinocchio has read."""
    model = pinocchio.buildModelFromXML(with_right_angles(path.read_text()))
    model.gravity.linear = expected.gravity
    data = model.createData()
    places = [model.joints[model.getJointId(joint["name"])] for joint in expected.joints]
    damping = np.asarray(model.damping)
    # Named anew in version 4.
    friction = np.asarray(model.upperDryFrictionLimit if hasattr(model, "upperDryFrictionLimit") else model.friction)

    def inverse_dynamics(q, dq, ddq):
        position, velocity, acceleration = pinocchio.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for place, angle, rate, change in zip(places, q, dq, ddq):
            # A continuous joint has its cosine and sine.
            position[place.idx_q : place.idx_q + place.nq] = [angle] if place.nq == 1 else [np.cos(angle), np.sin(angle)]
            velocity[place.idx_v], acceleration[place.idx_v] = rate, change
        tau = pinocchio.rnea(model, data, position, velocity, acceleration)
        tau = tau + damping * velocity + friction * np.sign(velocity)
        return [tau[place.idx_v] for place in places]

    return expected.worst(inverse_dynamics, expected.tau)


def with_right_angles(urdf: str) -> str:
    """A URDF whose rounded right angles, such as 1.5708, are right angles: thetahat takes them as such."""
    right = np.pi / 2

    def angle(text: str) -> str:
        value, decimals = float(text), len(text.partition(".")[2])
        nearest = round(value / right) * right
        return repr(nearest) if decimals >= 4 and abs(value - nearest) <= 10.0**-decimals else text

    return re.sub(r'rpy="([^"]*)"', lambda found: f'rpy="{" ".join(map(angle, found[1].split()))}"', urdf)


def of_mujoco(path: Path, expected: Expected) -> float:
    """mj_inverse without constraints, and friction losses by their attributes: MuJoCo makes constraints of them."""
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    places = [model.joint(joint["name"]).dofadr[0] for joint in expected.joints]
    dense = np.zeros((model.ntendon, model.nv))

    def inverse_dynamics(q, dq, ddq):
        data.qpos[places], data.qvel[places], data.qacc[places] = q, dq, ddq
        mujoco.mj_inverse(model, data)
        tau = data.qfrc_inverse + model.dof_frictionloss * np.sign(data.qvel)
        for tendon in range(model.ntendon):
            first, count = model.tendon_adr[tendon], model.tendon_num[tendon]
            dense[tendon] = 0.0
            for wrap in range(first, first + count):
                dense[tendon, model.jnt_dofadr[model.wrap_objid[wrap]]] = model.wrap_prm[wrap]
            row = dense[tendon]
            tau = tau + row * model.tendon_frictionloss[tendon] * np.sign(row @ data.qvel)
        return tau[places]

    return expected.worst(inverse_dynamics, expected.tau)


def derivatives_of_pinocchio(path: Path, expected: Expected) -> float:
    """computeRNEADerivatives beside the generated derivatives of the links' torques, relative to the largest of each block."""
    model = pinocchio.buildModelFromXML(with_right_angles(path.read_text()))
    model.gravity.linear = expected.gravity
    data = model.createData()
    places = [model.joints[model.getJointId(joint["name"])] for joint in expected.joints]
    # The rates of the joints per rate of the coordinates.
    rates = np.zeros((model.nv, expected.tau.shape[1]))
    for place, joint in zip(places, expected.joints):
        rates[place.idx_v, joint["coordinate"]] = joint["ratio"]
    generated = importlib.util.spec_from_file_location("generated", path.with_name(path.stem + "_derivatives.py"))
    module = importlib.util.module_from_spec(generated)
    generated.loader.exec_module(module)
    worst = 0.0
    for state in range(0, len(expected.tau), 10):
        position, velocity, acceleration = pinocchio.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for place, angle, rate, change in zip(places, *expected.of_joints(state)):
            position[place.idx_q : place.idx_q + place.nq] = [angle] if place.nq == 1 else [np.cos(angle), np.sin(angle)]
            velocity[place.idx_v], acceleration[place.idx_v] = rate, change
        pinocchio.computeRNEADerivatives(model, data, position, velocity, acceleration)
        # Pinocchio fills the upper triangle of the mass matrix.
        mass = np.triu(data.M) + np.triu(data.M, 1).T
        blocks = [rates.T @ block @ rates for block in (data.dtau_dq, data.dtau_dv, mass)]
        n = rates.shape[1]
        found = module.robot_torque_derivatives(expected.q[state], expected.dq[state], expected.ddq[state])
        for place, block in enumerate(blocks):
            difference = np.max(np.abs(found[:, place * n : (place + 1) * n] - block)) / np.max(np.abs(block))
            worst = max(worst, difference if np.isfinite(difference) else np.inf)
    return worst


def of_drake(path: Path, expected: Expected) -> float:
    """CalcInverseDynamics without damping; Drake reads no dry friction, and warns of it."""
    logging.getLogger("drake").setLevel(logging.ERROR)
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import MultibodyForces

    plant = MultibodyPlant(0.0)
    text = with_right_angles(path.read_text()) if path.suffix == ".urdf" else path.read_text()
    (model,) = Parser(plant).AddModelsFromString(text, path.suffix[1:])
    plant.mutable_gravity_field().set_gravity_vector(expected.gravity)
    if path.suffix == ".urdf":
        plant.WeldFrames(plant.world_frame(), plant.GetBodyByName(root_of(path), model).body_frame())
    joints = [plant.GetJointByName(joint["name"], model) for joint in expected.joints]
    for joint in joints:
        joint.set_default_damping_vector(np.zeros(1))
    plant.Finalize()
    context = plant.CreateDefaultContext()

    def inverse_dynamics(q, dq, ddq):
        change = np.zeros(plant.num_velocities())
        for joint, angle, rate, acceleration in zip(joints, q, dq, ddq):
            plant.SetPositions(context, with_entry(plant.GetPositions(context), joint.position_start(), angle))
            plant.SetVelocities(context, with_entry(plant.GetVelocities(context), joint.velocity_start(), rate))
            change[joint.velocity_start()] = acceleration
        forces = MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, forces)
        tau = plant.CalcInverseDynamics(context, change, forces)
        return [tau[joint.velocity_start()] for joint in joints]

    return expected.worst(inverse_dynamics, expected.frictionless_tau)


def with_entry(values: np.ndarray, place: int, value: float) -> np.ndarray:
    """An array with one entry replaced."""
    values = values.copy()
    values[place] = value
    return values


def root_of(path: Path) -> str:
    """The link of a URDF that is no joint's child."""
    robot = ElementTree.parse(path).getroot()
    children = {joint.find("child").get("link") for joint in robot.findall("joint")}
    return next(link.get("name") for link in robot.findall("link") if link.get("name") not in children)


def main() -> int:
    """Compares every export of a folder; one if any differs."""
    folder, failed = Path(sys.argv[1]), 0
    programs = [
        (f"Pinocchio {pinocchio.__version__}", of_pinocchio, [".urdf"]),
        (f"MuJoCo {mujoco.__version__}", of_mujoco, [".xml"]),
        (f"Pinocchio {pinocchio.__version__}, derivatives", derivatives_of_pinocchio, [".urdf"]),
    ]
    if "--drake" in sys.argv:
        programs = [("Drake", of_drake, [".urdf", ".sdf"])]
    for name, inverse_dynamics, suffixes in programs:
        for path in sorted(path for path in folder.iterdir() if path.suffix in suffixes):
            worst = inverse_dynamics(path, Expected(path.with_name(path.name + ".json")))
            failed += worst > TOLERANCE
            too_much = "" if worst <= TOLERANCE else " TOO MUCH"
            print(f"{name}, {path.name}: {worst:.1e} of the largest{too_much}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
