"""The interpreter's lock is free while work goes on, and Ctrl-C is answered."""

import concurrent.futures
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import thetahat as th


class Ticks(threading.Thread):
    """A thread of Python that notes the times at which it runs."""

    def __init__(self):
        super().__init__(daemon=True)
        self.times, self.ended = [], False

    def run(self):
        while not self.ended:
            self.times.append(time.perf_counter())
            time.sleep(0.001)

    def within(self, work):
        self.start()
        start = time.perf_counter()
        work()
        end = time.perf_counter()
        self.ended = True
        self.join()
        return end - start, [t for t in self.times if start < t < end]


def states(samples):
    robot = th.testing.arm()
    return robot, np.random.default_rng(0).normal(size=(3, samples, robot.n))


@pytest.mark.parametrize("what", ["regressor", "identify"])
def test_python_goes_on_while_the_library_works(what, twin):
    robot, motion = states(400_000)
    if what == "regressor":
        took, ticks = Ticks().within(lambda: robot.regressor(*motion))
    else:
        took, ticks = Ticks().within(lambda: th.identify(robot, twin.recording, cutoff_hz=40, decimation=10))
    # Ten times a second at the least; with the lock held there is no tick at all.
    assert len(ticks) > 10 * took, (took, len(ticks))


def test_two_threads_overlap():
    robot, motion = states(300_000)

    def work(_):
        start = time.thread_time(), time.perf_counter()
        robot.inverse_dynamics(*motion)
        return start[1], time.perf_counter()

    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        (start_1, end_1), (start_2, end_2) = pool.map(work, range(2))
    both = min(end_1, end_2) - max(start_1, start_2)
    # One after the other, they would not overlap at all.
    assert both > 0.5 * min(end_1 - start_1, end_2 - start_2)


def test_threads_do_not_change_results(twin):
    def estimates(_):
        return th.identify(twin.robot, twin.recording, cutoff_hz=40, decimation=10)["idim-ls"].estimates

    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        first, *others = pool.map(estimates, range(3))
    for other in others:
        np.testing.assert_array_equal(first, other)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("what", ["regressor", "identify", "estimator"])
def test_ctrl_c_is_answered_within_a_second(what):
    # Shells start jobs in the background with SIGINT ignored, and Python leaves that so.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        ctrl_c_is_answered_within_a_second(what)
    finally:
        signal.signal(signal.SIGINT, before)


def ctrl_c_is_answered_within_a_second(what):
    if what == "regressor":
        robot, motion = states(8_000_000)
        work = lambda: robot.inverse_dynamics(*motion)  # noqa: E731
    elif what == "estimator":
        twin = th.testing.twin(seconds=5)
        own = {"slow": lambda regression: time.sleep(3)}
        work = lambda: th.identify(twin.robot, twin.recording, estimators=own, cutoff_hz=40, decimation=10)  # noqa: E731
    else:
        long = th.testing.twin(seconds=300)
        work = lambda: th.identify(long.robot, long.recording, methods=["clie"], controller=long.controller)  # noqa: E731
    begun = time.perf_counter()
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        work()
    assert time.perf_counter() - begun < 0.2 + 1.0


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_program_ends_in_order_after_ctrl_c_in_an_estimator():
    program = """
import os, signal, threading, time
import thetahat as th

signal.signal(signal.SIGINT, signal.default_int_handler)

def endless(regression):
    threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
    while True:
        time.sleep(0.001)

twin = th.testing.twin(seconds=5)
try:
    th.identify(twin.robot, twin.recording, estimators={"endless": endless}, cutoff_hz=40, decimation=10)
except KeyboardInterrupt:
    print("interrupted")
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "interrupted\n", "")
