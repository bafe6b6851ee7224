"""Seconds per call of Pinocchio's algorithms on the TX40: `python pinocchio_calls.py TX40.urdf`.

Prints one line per algorithm: name, seconds per call, and seconds of the same call with a model that has no joint, which is
the way from Python into the library and back. Each is the fastest of several rounds.
"""
import sys
import time

import numpy as np
import pinocchio as pin

ROUNDS, CALLS = 7, 20_000


def fastest(call):
    def once():
        start = time.perf_counter()
        for _ in range(CALLS):
            call()
        return (time.perf_counter() - start) / CALLS

    return min(once() for _ in range(ROUNDS))


def calls(model):
    data, rng = model.createData(), np.random.default_rng(1)
    q, v, a = (rng.uniform(-1, 1, model.nq) for _ in range(3))
    return {
        "regressor": lambda: pin.computeJointTorqueRegressor(model, data, q, v, a),
        "rnea": lambda: pin.rnea(model, data, q, v, a),
        "aba": lambda: pin.aba(model, data, q, v, a),
        "crba": lambda: pin.crba(model, data, q),
    }


robot, nothing = calls(pin.buildModelFromUrdf(sys.argv[1])), calls(pin.Model())
for name in robot:
    print(name, fastest(robot[name]), fastest(nothing[name]))
