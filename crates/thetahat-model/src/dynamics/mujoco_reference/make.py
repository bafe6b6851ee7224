"""Reference values of MuJoCo for the models in `models`: prints `values.toml`.

    pip install mujoco==4.0.0 numpy==2.4.6
    python make.py > values.toml

Each state has the mass matrix (`mj_fullM`), the bias forces (`qfrc_bias`) and the inverse dynamics (`mj_inverse`) without
contacts, limits and friction. Free joints are removed, which fixes their bodies. An equality of joints
makes one joint follow: with q = G x + q0, the values are G^T M G and G^T tau.
"""

import pathlib

import mujoco
import numpy

STATES = 2
OFF = ["CONTACT", "LIMIT", "FRICTIONLOSS", "EQUALITY"]


def fixed(path):
    spec = mujoco.MjSpec.from_file(str(path))
    for joint in list(spec.joints):
        if joint.type == mujoco.mjtJoint.mjJNT_FREE:
            spec.delete(joint)
    model = spec.compile()
    for flag in OFF:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
    return model


def equality(model, e):
    """Two joints with q1 - ref1 = constant + ratio (q2 - ref2); the second is -1 if there is none."""
    constant, ratio = model.eq_data[e][:2]
    first, second = model.eq_obj1id[e], model.eq_obj2id[e]
    if model.eq_type[e] == mujoco.mjtEq.mjEQ_TENDON:
        wraps = range(model.tendon_adr[first], model.tendon_adr[first] + 2)
        own, other = (model.wrap_prm[wrap] for wrap in wraps)
        first, second = (model.wrap_objid[wrap] for wrap in wraps)
        return first, second, constant / own, -other / own
    return first, second, constant, ratio


def coordinates(model):
    """The joints as functions of those that are free: G and q0."""
    g, q0 = numpy.eye(model.nv), numpy.zeros(model.nv)
    bound = set()
    for e in [e for e in range(model.neq) if model.eq_active0[e]]:
        first, second, constant, ratio = equality(model, e)
        bound.add(first)
        g[first] = 0
        q0[first] = model.qpos0[first] + constant
        if second >= 0:
            g[first, second] = ratio
            q0[first] -= ratio * model.qpos0[second]
    for _ in range(model.nv):
        for joint in bound:
            for leader in [leader for leader in bound if g[joint, leader] != 0]:
                ratio = g[joint, leader]
                g[joint, leader] = 0
                q0[joint] += ratio * q0[leader]
                g[joint] += ratio * g[leader]
    free = [joint for joint in range(model.nv) if joint not in bound]
    return g[:, free], q0, free


def full_mass_matrix(model, data):
    mass = numpy.zeros((model.nv, model.nv))
    try:
        mujoco.mj_fullM(model, data, mass)
    except TypeError:
        mujoco.mj_fullM(model, mass, data.qM)
    return mass


def numbers(values):
    return "[" + ", ".join(repr(float(value)) for value in numpy.ravel(values)) + "]"


def main():
    print(f"# Printed by make.py with MuJoCo {mujoco.__version__}.")
    generator = numpy.random.default_rng(7)
    for path in sorted((pathlib.Path(__file__).parent / "models").glob("*.xml")):
        model = fixed(path)
        data = mujoco.MjData(model)
        g, q0, free = coordinates(model)
        print(f"\n[[model]]\nname = \"{path.stem}\"\njoints = {len(free)}")
        print(f"frictionloss = {numbers(model.dof_frictionloss[free])}")
        for _ in range(STATES):
            q, dq, ddq = generator.normal(size=(3, len(free))).round(3)
            data.qpos[:], data.qvel[:], data.qacc[:] = g @ q + q0, g @ dq, g @ ddq
            mujoco.mj_inverse(model, data)
            print(f"[[model.state]]\nq = {numbers(q)}\ndq = {numbers(dq)}\nddq = {numbers(ddq)}")
            print(f"mass = {numbers(g.T @ full_mass_matrix(model, data) @ g)}")
            print(f"bias = {numbers(g.T @ data.qfrc_bias)}\ntau = {numbers(g.T @ data.qfrc_inverse)}")


main()
