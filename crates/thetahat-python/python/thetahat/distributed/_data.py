"""Storage of recordings: a folder that all workers can access, or objects below an ``s3://`` prefix, which each worker downloads
while it needs them."""

from __future__ import annotations

import contextlib
import os
import pathlib
import tempfile
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from .. import _thetahat
from ..errors import RecordingError
from ._store import Store, is_remote

# The path of an experiment's objects before a worker has downloaded them: no file exists there.
_NOWHERE = os.path.abspath(os.path.join(os.sep, "nowhere", "thetahat-objects"))


class Data(NamedTuple):
    """The recordings of an experiment."""

    place: str
    """A folder, or ``s3://bucket/prefix`` with pyarrow's options after a question mark."""
    objects: tuple[str, ...] = ()
    """Names of the objects below the prefix; empty for a folder."""

    @contextlib.contextmanager
    def as_folder(self) -> Iterator[str]:
        """A folder of this machine with the recordings.

        Raises
        ------
        RecordingError
            For an object that cannot be read.
        """
        if not is_remote(self.place):
            yield self.place
            return
        store = Store(self.place)
        with tempfile.TemporaryDirectory() as folder:
            for name in self.objects:
                path = pathlib.Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                try:
                    path.write_bytes(store.read(name))
                except OSError as error:
                    raise RecordingError(f"{_shown(self.place)}/{name}: cannot be read: {error}") from error
            yield folder

    def in_words(self, text: str, folder: str) -> str:
        """A message with the place instead of the folder of :meth:`as_folder`."""
        return text.replace(folder, _shown(self.place)) if is_remote(self.place) else text


class Described(NamedTuple):
    """An experiment with its recordings, for workers."""

    texts: _thetahat.ExperimentTexts
    data: Data
    stamps: list[tuple[str, int, int]]
    """Identifies its files without reading them: path, size and time of change."""
    recordings: int


def described(path: str, data: str, robot: str | None) -> Described:
    """An experiment with its recordings at a place."""
    if not is_remote(data):
        texts, files, recordings = _thetahat.experiment_texts(path, data, robot)
        return Described(texts, Data(data), stamps(files), recordings)
    texts, files, recordings = _thetahat.experiment_texts(path, _NOWHERE, robot)
    below = f"{_NOWHERE}{os.sep}"
    names = sorted({str(file).removeprefix(below).replace(os.sep, "/") for file in files if str(file).startswith(below)})
    other_files = [file for file in files if not str(file).startswith(below)]
    of_objects = [(f"{data}/{name}", size, changed) for name, size, changed in Store(data).stamps(names)]
    return Described(texts, Data(data, tuple(names)), stamps(other_files) + of_objects, recordings)


def _shown(place: str) -> str:
    """A place without options and keys."""
    scheme, _, rest = place.partition("://")
    return f"{scheme}://{rest.partition('?')[0].rpartition('@')[2]}"


def stamps(files: Sequence[str | os.PathLike[str]]) -> list[tuple[str, int, int]]:
    """Path, size and time of change of the files that exist."""
    found = [(os.path.abspath(file), os.stat(file)) for file in sorted(str(file) for file in files) if os.path.exists(file)]
    return [(path, state.st_size, state.st_mtime_ns) for path, state in found]
