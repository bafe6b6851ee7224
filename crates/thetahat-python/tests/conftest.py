"""What the tests share: a twin and its results, the checkout, and data that may be absent."""

import os
import pathlib

import pytest

import thetahat as th

CHECKOUT = pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def checkout() -> pathlib.Path:
    """The folder of the checkout."""
    return CHECKOUT


@pytest.fixture(scope="session")
def shared() -> pathlib.Path:
    """The folder of recorded data, beside the checkout or at THETAHAT_SHARED."""
    folder = pathlib.Path(os.environ.get("THETAHAT_SHARED", CHECKOUT.parent / "shared"))
    if not folder.is_dir():
        pytest.skip(f"no recorded data at {folder}")
    return folder


@pytest.fixture(scope="session")
def twin() -> th.testing.Twin:
    """A simulated arm, recorded."""
    return th.testing.twin(seconds=10, seed=1)


@pytest.fixture(scope="session")
def result(twin: th.testing.Twin) -> th.Result:
    """What is identified from it."""
    return th.identify(
        twin.robot,
        twin.recording,
        methods=["idim-ls", "idim-iv"],
        controller=twin.controller,
        cutoff_hz=40,
        decimation=10,
    )
