"""Reference values of MuJoCo for the models in `loops`, whose equalities close loops: prints `loops.toml`.

    pip install mujoco==3.4.0 numpy==2.4.6
    python make_loops.py > loops.toml

The joints without motors are solved from the others with MuJoCo's Jacobians of points (`mj_jac`, `mj_jacDot`); mass matrix
(`mj_fullM`), bias forces and inverse dynamics (`mj_rne`, with armature and damping) of the tree are projected on the others.
"""

import pathlib

import mujoco
import numpy

STATES = 4
REACH = {"palletiser": [2.0, 0.4, 0.4], "welded_bars": [0.6]}


def points(model, data):
    """Each pair of points that coincide: bodies, and places in the frame of the world."""
    for e in range(model.neq):
        first, second, of = model.eq_obj1id[e], model.eq_obj2id[e], model.eq_data[e]
        place = lambda body, point: data.xpos[body] + data.xmat[body].reshape(3, 3) @ point
        if model.eq_objtype[e] == mujoco.mjtObj.mjOBJ_SITE:
            yield model.site_bodyid[first], model.site_bodyid[second], data.site_xpos[first], data.site_xpos[second]
            continue
        if model.eq_type[e] == mujoco.mjtEq.mjEQ_CONNECT:
            yield first, second, place(first, of[:3]), place(second, of[3:6])
            continue
        turn = numpy.zeros(9)
        mujoco.mju_quat2Mat(turn, of[6:10])
        for offset in numpy.vstack([numpy.zeros(3), numpy.eye(3)]):
            on_first = of[3:6] + turn.reshape(3, 3) @ offset
            yield first, second, place(first, on_first), place(second, of[:3] + offset)


def conditions(model, data):
    """Gaps, their Jacobian, and its derivative in time."""
    gaps, jacobians, derivatives = [], [], []
    for first, second, from_point, to_point in points(model, data):
        of_ends = []
        for body, point in [(first, from_point), (second, to_point)]:
            jacobian, derivative = numpy.zeros((2, 3, model.nv))
            mujoco.mj_jac(model, data, jacobian, None, point, body)
            mujoco.mj_jacDot(model, data, derivative, None, point, body)
            of_ends.append((jacobian, derivative))
        gaps.append(to_point - from_point)
        jacobians.append(of_ends[1][0] - of_ends[0][0])
        derivatives.append(of_ends[1][1] - of_ends[0][1])
    return numpy.concatenate(gaps), numpy.vstack(jacobians), numpy.vstack(derivatives)


def place(model, data, q, dq):
    data.qpos[:], data.qvel[:] = q, dq
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_comVel(model, data)
    return conditions(model, data)


def closed(model, data, driven, q, dq):
    """All positions and velocities, G, and the accelerations where the driven joints have none."""
    passive = [j for j in range(model.nv) if j not in driven]
    solve = lambda a, b: numpy.linalg.lstsq(a, b, rcond=None)[0]
    all_q, g = model.qpos0.copy(), numpy.zeros((model.nv, len(driven)))
    for part in numpy.linspace(0, 1, 41)[1:]:
        all_q[driven] = part * q
        for _ in range(8):
            gaps, jacobian, _ = place(model, data, all_q, numpy.zeros(model.nv))
            all_q[passive] -= solve(jacobian[:, passive], gaps)
    g[driven] = numpy.eye(len(driven))
    g[passive] = -solve(jacobian[:, passive], jacobian[:, driven])
    _, _, derivative = place(model, data, all_q, g @ dq)
    drift = numpy.zeros(model.nv)
    drift[passive] = -solve(jacobian[:, passive], derivative @ g @ dq)
    return all_q, g, drift


def numbers(values):
    return "[" + ", ".join(repr(float(value)) for value in numpy.ravel(values)) + "]"


def main():
    print(f"# Printed by make_loops.py with MuJoCo {mujoco.__version__}.")
    generator = numpy.random.default_rng(7)
    for path in sorted((pathlib.Path(__file__).parent / "loops").glob("*.xml")):
        model = mujoco.MjModel.from_xml_path(str(path))
        data = mujoco.MjData(model)
        driven = [int(joint) for joint in model.actuator_trnid[:, 0]]
        print(f"\n[[model]]\nname = \"{path.stem}\"\njoints = {len(driven)}")
        print(f"frictionloss = {numbers(model.dof_frictionloss[driven])}")
        for _ in range(STATES):
            q = (generator.uniform(-1, 1, len(driven)) * REACH[path.stem]).round(3)
            dq, ddq = generator.normal(size=(2, len(driven))).round(3)
            all_q, g, drift = closed(model, data, driven, q, dq)
            mujoco.mj_makeM(model, data)
            mass, force = numpy.zeros((model.nv, model.nv)), numpy.zeros(model.nv)
            mujoco.mj_fullM(model, mass, data.qM)
            mujoco.mj_rne(model, data, 0, force)
            bias = force + mass @ drift
            tau = bias + mass @ g @ ddq + model.dof_damping.ravel()[: model.nv] * (g @ dq)
            print(f"[[model.state]]\nq = {numbers(q)}\ndq = {numbers(dq)}\nddq = {numbers(ddq)}")
            print(f"mass = {numbers(g.T @ mass @ g)}\nbias = {numbers(g.T @ bias)}\ntau = {numbers(g.T @ tau)}")


if __name__ == "__main__":
    main()
