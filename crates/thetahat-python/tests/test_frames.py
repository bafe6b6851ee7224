"""Frames of pandas as recordings, and recordings as frames, parts and figures."""

import numpy as np
import pytest

import thetahat as th

pandas = pytest.importorskip("pandas")

N = 400
T = np.arange(N) / 200
Q = np.column_stack([np.sin(T), np.cos(T)])
TAU = 3 * Q + 1
DQ = np.column_stack([np.cos(T), -np.sin(T)])


@pytest.fixture(scope="module")
def robot():
    return th.testing.arm()


def frame(time="time_s", **names):
    columns = {time: T}
    for signal, array in (("position", Q), ("torque", TAU)):
        pattern = names.get(signal, "{joint}_" + signal)
        columns |= {pattern.format(joint=joint): array[:, k] for k, joint in reversed(list(enumerate(["shoulder", "elbow"])))}
    return pandas.DataFrame(columns)


def same(log):
    np.testing.assert_allclose(log.position, Q, atol=1e-12)
    np.testing.assert_allclose(log.torque, TAU, atol=1e-12)
    assert log.sample_rate_hz == pytest.approx(200)
    assert log.joints == ("shoulder", "elbow")


@pytest.mark.parametrize(
    "names",
    [
        {},
        {"torque": "{joint}_effort"},
        {"position": "position_{joint}", "torque": "effort_{joint}"},
        {"position": "{joint}.position", "torque": "{joint}.effort"},
        {"position": "{joint} Pos (rad)", "torque": "{joint} Trq (Nm)"},
        {"position": "{joint}Position", "torque": "{joint}Torque"},
        {"time": "t"},
    ],
)
def test_columns_are_recognised_by_joints_and_words(robot, names):
    same(th.Recording.from_dataframe(frame(**names), robot=robot))


def test_types_of_pandas_are_numbers(robot):
    same(th.Recording.from_dataframe(frame().convert_dtypes(), robot=robot))
    pytest.importorskip("pyarrow")
    same(th.Recording.from_dataframe(frame().convert_dtypes(dtype_backend="pyarrow"), robot=robot))


@pytest.mark.parametrize("kind", ["dates", "zone", "durations", "index", "text"])
def test_dates_are_times(robot, kind):
    table = frame().drop(columns="time_s")
    dates = pandas.Timestamp("2026-03-01") + pandas.to_timedelta(T, unit="s")
    if kind == "index":
        table.index = dates
    elif kind == "text":
        table["stamp"] = [date.isoformat() for date in dates]
    elif kind == "durations":
        table["time"] = pandas.to_timedelta(T, unit="s")
    else:
        table["time"] = dates.tz_localize("UTC") if kind == "zone" else dates
    same(th.Recording.from_dataframe(table, robot=robot))


def test_columns_of_arrays_have_a_column_for_each_joint(robot):
    same(th.Recording.from_dataframe(pandas.DataFrame({"time": T, "position": list(Q), "effort": TAU.tolist()}), robot=robot))
    ragged = pandas.DataFrame({"time": T, "position": [row[: 1 + k % 2] for k, row in enumerate(Q)], "effort": list(TAU)})
    with pytest.raises(th.RecordingError, match="arrays in column position have different lengths, 1 to 2"):
        th.Recording.from_dataframe(ragged, robot=robot)


def test_joint_states_of_ros_are_in_the_order_of_their_names(robot):
    seconds = np.floor(T).astype(int)
    table = pandas.DataFrame({
        "header.stamp.sec": seconds + 1_700_000_000,
        "header.stamp.nanosec": np.round((T - seconds) * 1e9).astype(int),
        "name": [["elbow", "shoulder"]] * N,
        "position": list(Q[:, ::-1]),
        "effort": list(TAU[:, ::-1]),
    })
    same(th.Recording.from_dataframe(table, robot=robot))
    table.at[3, "name"] = ["shoulder", "elbow"]
    with pytest.raises(th.RecordingError, match="names in column name change"):
        th.Recording.from_dataframe(table, robot=robot)


def test_levels_of_columns_are_joined(robot):
    parts = {joint: pandas.DataFrame({"position": Q[:, k], "effort": TAU[:, k]}) for k, joint in enumerate(["shoulder", "elbow"])}
    same(th.Recording.from_dataframe(pandas.concat({"time": pandas.DataFrame({"": T}), **parts}, axis=1), robot=robot))


def test_rows_without_a_time_are_refused(robot):
    table = frame()
    table.loc[7, "time_s"] = np.nan
    with pytest.raises(th.RecordingError, match="time_s has no value in row 7"):
        th.Recording.from_dataframe(table, robot=robot)


def test_columns_can_be_named_and_frames_given_to_identify(robot, twin):
    table = frame(position="{joint}_x", torque="{joint}_y").assign(note="text")
    position, torque = ["shoulder_x", "elbow_x"], ["shoulder_y", "elbow_y"]
    units = {"position_unit": "rad", "torque_unit": "N m"}
    same(th.Recording.from_dataframe(table, robot=robot, position=position, torque=torque, **units))
    with pytest.raises(th.RecordingError, match="the frame has no numeric column note"):
        th.Recording.from_dataframe(table, robot=robot, position=["note", "elbow_x"], torque=torque)
    log = twin.recording
    result = th.identify(twin.robot, log.to_pandas(), cutoff_hz=40, decimation=10)
    arrays = th.identify(twin.robot, log, cutoff_hz=40, decimation=10)
    np.testing.assert_allclose(result["idim-ls"].estimates, arrays["idim-ls"].estimates, rtol=1e-6, atol=1e-9)


def test_what_is_no_recording_is_refused(robot):
    with pytest.raises(TypeError, match=r"frame must be a pandas\.DataFrame, and is int 3"):
        th.Recording.from_dataframe(3, robot=robot)
    with pytest.raises(th.RecordingError, match="no rows"):
        th.Recording.from_dataframe(frame()[:0], robot=robot)
    with pytest.raises(th.RecordingError, match="^the frame: the columns of the position"):
        th.Recording.from_dataframe(pandas.DataFrame({"time": T, "a": T, "b": T}), robot=robot)


def test_a_recording_is_a_frame_and_comes_back(robot):
    log = th.Recording(time=T, position=Q, torque=TAU, velocity=DQ, joints=robot.joints, channels={"temperature": T})
    table = log.to_pandas()
    assert list(table) == [
        "time_s",
        *(f"{joint}_{signal}" for signal in ("position", "velocity", "torque") for joint in ("shoulder", "elbow")),
        "temperature",
    ]
    back = th.Recording.from_dataframe(table, robot=robot)
    same(back)
    np.testing.assert_allclose(back.velocity, DQ)
    assert list(th.Recording(sample_rate_hz=200, position=Q).to_pandas()) == ["time_s", "position_1", "position_2"]


def test_parts_are_recordings(robot):
    log = th.Recording(time=T, position=Q, torque=TAU, channels={"x": T}, gaps=[(10, 20), (90, 120)])
    part = log[100:300]
    assert len(part) == 200 and part.time[0] == T[100] and part.gaps == [(0, 20)]
    np.testing.assert_array_equal(part.torque, TAU[100:300])
    np.testing.assert_array_equal(part.channels["x"][:, 0], T[100:300])
    rated = th.Recording(sample_rate_hz=200, position=Q, window_s=(1.0, None))[100:]
    assert rated.window_s == (0.5, None) and rated.times()[0] == 0
    assert len(log[-50:]) == 50
    for key, error in ((3, TypeError), (slice(0, 9, 2), ValueError), (slice(9, 9), ValueError)):
        with pytest.raises(error, match="recording|samples"):
            log[key]


def test_recordings_are_plotted():
    pytest.importorskip("matplotlib")
    figure = th.Recording(time=T, position=Q, torque=TAU).plot()
    assert len(figure.axes) == 2 and len(figure.axes[1].lines) == 2
    assert figure._repr_png_().startswith(b"\x89PNG")
