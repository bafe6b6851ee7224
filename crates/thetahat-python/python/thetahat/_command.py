"""The command line inside the process, and files for it."""

from __future__ import annotations

import json
import os
import re
import sys
import tempfile
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from . import _thetahat
from .errors import CommandError
from .robot import Robot

_ERROR = 2
_lock = threading.Lock()


class Output(NamedTuple):
    """The output of a command."""

    code: int
    """0 good; 1 finished, but the verdict is do-not-use."""
    text: str
    """What it printed."""
    remarks: str
    """What it printed as remarks and progress."""


def run(*arguments: str | os.PathLike[str] | float) -> Output:
    """Run the command and return its output.

    Raises
    ------
    CommandError
        With the text of the command's error.
    """
    texts = ["thetahat", *(os.fspath(a) if isinstance(a, (str, os.PathLike)) else repr(a) for a in arguments)]
    # The standard output belongs to the process: commands run one after another.
    with _lock, tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        with _redirected(1, out), _redirected(2, err):
            code = _thetahat.command(texts)
        text, remarks = _content(out), _content(err)
    if code == _ERROR:
        raise CommandError(_in_words_of_the_package(remarks))
    return Output(code, text, remarks)


@contextmanager
def _redirected(descriptor: int, file: IO[bytes]) -> Iterator[None]:
    """Write what the process prints there into a file."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    kept = os.dup(descriptor)
    try:
        os.dup2(file.fileno(), descriptor)
        yield
    finally:
        os.dup2(kept, descriptor)
        os.close(kept)


def _content(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode(errors="replace")


def _in_words_of_the_package(remarks: str) -> str:
    """The error of a command, with arguments instead of options."""
    text = remarks[remarks.find("error: ") :].removeprefix("error: ").strip()
    # Files that the package made for the command have no place that helps a reader.
    text = re.sub(re.escape(os.path.join(tempfile.gettempdir(), "tmp")) + r"\w+[/\\]", "", text)
    text = re.sub(r"--(force|untrusted)\b", r"\1=True", text)
    return re.sub(r"--([a-z][a-z-]*)", lambda option: option[1].replace("-", "_"), text)


def options(**values: Any) -> list[str]:
    """Options of the command; those that are None or False are left out, True has no value."""
    found: list[str] = []
    for key, value in values.items():
        if value is None or value is False:
            continue
        found.append("--" + key.replace("_", "-"))
        if value is not True:
            found.append(",".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value))
    return found


def robot_file(robot: Robot, folder: Path) -> Path:
    """The description of a robot as a file; its locked joints are not in it."""
    text = robot._native.text()
    path = folder / ("robot.urdf" if text.lstrip().startswith("<") else "robot.toml")
    path.write_text(text)
    return path


def locked_of(robot: Robot) -> dict[str, float]:
    """The joints that were locked when the robot was read."""
    state: tuple[Any, ...] = robot._native.__reduce__()[1]  # type: ignore[assignment]
    return dict(state[2]) if isinstance(state[2], Mapping) else {}


def toml(table: Mapping[str, Any]) -> str:
    """A table as TOML, each value on a line."""
    return "".join(f"{_key(key)} = {_value(value)}\n" for key, value in table.items() if value is not None)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else json.dumps(key)


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items() if v is not None) + " }"
    if isinstance(value, (np.ndarray, np.generic)):
        return _value(value.tolist())
    if isinstance(value, Sequence) and not isinstance(value, str):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, (bool, str, os.PathLike)):
        return json.dumps(os.fspath(value) if isinstance(value, os.PathLike) else value, ensure_ascii=False)
    if isinstance(value, (int, float)):
        return repr(value)
    raise TypeError(f"a table of settings holds a {type(value).__name__}; expected numbers, texts, lists and tables")
