"""Reference values of MuJoCo for the models in `loops`, whose equalities close loops: prints `loops.toml`.

    pip install mujoco==3.4.0 numpy==2.4.6
    python make_loops.py > loops.toml

The joints without motors are solved from the others with MuJoCo's Jacobians of points (`mj_jac`, `mj_jacDot`); mass matrix
(`mj_mulM`), bias forces and inverse dynamics (`mj_rne`, with armature and damping) of the tree are projected on the others.
"""

import pathlib

import mujoco
import numpy

STATES, WAVE = 4, 0.2
REACH = {"ankle": [0.35] * 2, "delta": [0.5] * 3, "palletiser": [2.0, 0.4, 0.4], "welded_bars": [0.6]}


def points(model, data):
    """Each pair of points that coincide, or keep a distance: bodies, places in the frame of the world, and the distance."""
    for e in range(model.neq):
        first, second, of = model.eq_obj1id[e], model.eq_obj2id[e], model.eq_data[e]
        if model.eq_type[e] == mujoco.mjtEq.mjEQ_TENDON:
            start = model.tendon_adr[first]
            sites = model.wrap_objid[start : start + 2]
            yield *model.site_bodyid[sites], *data.site_xpos[sites], model.tendon_length0[first] + of[0]
            continue
        place = lambda body, point: data.xpos[body] + data.xmat[body].reshape(3, 3) @ point
        if model.eq_objtype[e] == mujoco.mjtObj.mjOBJ_SITE:
            yield model.site_bodyid[first], model.site_bodyid[second], data.site_xpos[first], data.site_xpos[second], None
            continue
        if model.eq_type[e] == mujoco.mjtEq.mjEQ_CONNECT:
            yield first, second, place(first, of[:3]), place(second, of[3:6]), None
            continue
        turn = numpy.zeros(9)
        mujoco.mju_quat2Mat(turn, of[6:10])
        for offset in numpy.vstack([numpy.zeros(3), numpy.eye(3)]):
            on_first = of[3:6] + turn.reshape(3, 3) @ offset
            yield first, second, place(first, on_first), place(second, of[:3] + offset), None


def conditions(model, data):
    """Gaps, their Jacobian, and its derivative in time."""
    gaps, jacobians, derivatives = [], [], []
    for first, second, from_point, to_point, distance in points(model, data):
        of_ends = []
        for body, point in [(first, from_point), (second, to_point)]:
            jacobian, derivative = numpy.zeros((2, 3, model.nv))
            mujoco.mj_jac(model, data, jacobian, None, point, body)
            mujoco.mj_jacDot(model, data, derivative, None, point, body)
            of_ends.append((jacobian, derivative))
        between, (jacobian, derivative) = to_point - from_point, numpy.subtract(of_ends[1], of_ends[0])
        if distance is not None:
            derivative = (between @ derivative + (jacobian @ data.qvel) @ jacobian)[None] / distance
            jacobian, between = (between @ jacobian)[None] / distance, [(between @ between / distance - distance) / 2]
        gaps.append(between)
        jacobians.append(jacobian)
        derivatives.append(derivative)
    return numpy.concatenate(gaps), numpy.vstack(jacobians), numpy.vstack(derivatives)


def place(model, data, q, dq):
    data.qpos[:], data.qvel[:] = q, dq
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_comVel(model, data)
    return conditions(model, data)


def near(model, data, all_q, driven, dq):
    """Closes the loops from positions near by, in place; G, and the accelerations where the driven joints have none."""
    passive = numpy.setdiff1d(numpy.arange(model.nv), driven)
    solve = lambda a, b: numpy.linalg.lstsq(a, b, rcond=None)[0]
    for _ in range(20):
        gaps, jacobian, _ = place(model, data, all_q, numpy.zeros(model.nv))
        step = solve(jacobian[:, passive], gaps)
        all_q[passive] -= step
        if numpy.abs(step).max() < 1e-12:
            break
    g, drift = numpy.zeros((model.nv, len(driven))), numpy.zeros(model.nv)
    g[driven] = numpy.eye(len(driven))
    g[passive] = -solve(jacobian[:, passive], jacobian[:, driven])
    v = g @ dq
    _, _, derivative = place(model, data, all_q, v)
    drift[passive] = -solve(jacobian[:, passive], derivative @ v)
    return g, drift


def closed(model, data, driven, q):
    """All positions along the straight way from the pose of the model, in which the loops are closed."""
    all_q = model.qpos0.copy()
    for part in numpy.linspace(0, 1, 41)[1:]:
        all_q[driven] = part * q
        near(model, data, all_q, driven, numpy.zeros(len(driven)))
    return all_q


def full_mass_matrix(model, data):
    """By products, since the arguments of `mj_fullM` differ between versions."""
    mass = numpy.zeros((model.nv, model.nv))
    for row, unit in zip(mass, numpy.eye(model.nv)):
        mujoco.mj_mulM(model, data, row, unit)
    return mass


def dynamics(model, data, driven, all_q, dq):
    """Mass matrix and bias forces of the driven joints, and G."""
    g, drift = near(model, data, all_q, driven, dq)
    mujoco.mj_makeM(model, data)
    mass, force = full_mass_matrix(model, data), numpy.zeros(model.nv)
    mujoco.mj_rne(model, data, 0, force)
    return g.T @ mass @ g, g.T @ (force + mass @ drift), g


def damped(model, g, dq):
    return g.T @ (model.dof_damping.ravel()[: model.nv] * (g @ dq))


def simulated(model, data, driven, all_q, stiffness, damping):
    """Positions and velocities after 1 s in a PD loop around a wave of 1 Hz, by Runge-Kutta's steps of 1 ms."""
    start, h = all_q[driven].copy(), 1e-3

    def slope(t, state):
        q, dq = numpy.split(state, 2)
        all_q[driven] = q
        mass, bias, g = dynamics(model, data, driven, all_q, dq)
        torques = stiffness * (start + WAVE * numpy.sin(2 * numpy.pi * t) - q) - damping * dq
        return numpy.concatenate([dq, numpy.linalg.solve(mass, torques - bias - damped(model, g, dq))])

    state = numpy.concatenate([start, 0 * start])
    for k in range(1000):
        a = slope(k * h, state)
        b = slope(k * h + h / 2, state + h / 2 * a)
        c = slope(k * h + h / 2, state + h / 2 * b)
        d = slope(k * h + h, state + h * c)
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
    return state


def numbers(values):
    return "[" + ", ".join(repr(float(value)) for value in numpy.ravel(values)) + "]"


def main():
    print(f"# Printed by make_loops.py with MuJoCo {mujoco.__version__}.")
    for path in sorted((pathlib.Path(__file__).parent / "loops").glob("*.xml")):
        model = mujoco.MjModel.from_xml_path(str(path))
        data, generator = mujoco.MjData(model), numpy.random.default_rng(7)
        driven = [int(joint) for joint in model.actuator_trnid[:, 0]]
        print(f"\n[[model]]\nname = \"{path.stem}\"\njoints = {len(driven)}")
        print(f"frictionloss = {numbers(model.dof_frictionloss[driven])}")
        for _ in range(STATES):
            q = (generator.uniform(-1, 1, len(driven)) * REACH[path.stem.removesuffix("_rods")]).round(3)
            dq, ddq = generator.normal(size=(2, len(driven))).round(3)
            all_q = closed(model, data, driven, q)
            mass, bias, g = dynamics(model, data, driven, all_q, dq)
            print(f"[[model.state]]\nq = {numbers(q)}\ndq = {numbers(dq)}\nddq = {numbers(ddq)}")
            print(f"mass = {numbers(mass)}\nbias = {numbers(bias)}\ntau = {numbers(bias + mass @ ddq + damped(model, g, dq))}")
        stiffness, damping = (numpy.diag(mass) * factor for factor in [(4 * numpy.pi) ** 2, 8 * numpy.pi])
        state = simulated(model, data, driven, all_q, stiffness, damping)
        print(f"[model.simulation]\nq = {numbers(q)}\nstiffness = {numbers(stiffness)}\ndamping = {numbers(damping)}")
        print(f"end = {numbers(state)}")


if __name__ == "__main__":
    main()
