"""Storage of parts and results: a folder, or objects below an ``s3://`` prefix. Both are written atomically."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib
import json
import os
import pathlib
import tempfile
import uuid
from collections.abc import Iterator, Mapping, Sequence
from concurrent import futures
from typing import Any

from .. import _thetahat
from ..errors import EngineError, ReportError

_REMOTE = "s3://"
# Number of first bytes that contain a mark.
_HEAD = 512
# Objects read in parallel.
_AT_ONCE = 32


def is_remote(place: str) -> bool:
    """Whether a place is a prefix of objects rather than a folder."""
    return place.startswith(_REMOTE)


def content_name(*content: object) -> str:
    """A name derived from content and the version of thetahat: 32 hexadecimal digits."""
    text = json.dumps([_thetahat.VERSION, *content], sort_keys=True, default=os.fspath)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


class Store:
    """Files by name. It can be pickled: workers open it for themselves.

    Parameters
    ----------
    place : path or str
        A folder that all workers can access, or ``s3://bucket/prefix``, with pyarrow's options after a question mark.
    """

    def __init__(self, place: str | os.PathLike[str]) -> None:
        self.place = os.fspath(place)
        self._system: Any = None
        if is_remote(self.place):
            self._system, self._root = _remote(self.place)
        else:
            self._root = os.path.abspath(self.place)

    def __reduce__(self) -> tuple[type[Store], tuple[str]]:
        return Store, (self.place if self._system else self._root,)

    def __str__(self) -> str:
        return self.place

    def read(self, name: str) -> bytes:
        """The content of a file."""
        if self._system:
            with self._system.open_input_stream(self._path(name)) as stream:
                return bytes(stream.read())
        return pathlib.Path(self._path(name)).read_bytes()

    def write(self, name: str, content: bytes) -> None:
        """Write a file atomically: readers find the old one or the new one."""
        if self._system:
            # An object exists once its upload is complete.
            with self._system.open_output_stream(self._path(name)) as stream:
                stream.write(content)
            return
        path = pathlib.Path(self._path(name))
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = path.with_name(f".{path.name}.{uuid.uuid4().hex}.part")
        try:
            temporary.write_bytes(content)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)

    def names(self, folder: str) -> set[str]:
        """The names of the files in a folder."""
        if self._system:
            chosen = _pyarrow_fs(self.place).FileSelector(self._path(folder), allow_not_found=True)
            return {f"{folder}/{info.base_name}" for info in self._system.get_file_info(chosen) if info.is_file}
        try:
            entries = list(os.scandir(self._path(folder)))
        except FileNotFoundError:
            return set()
        return {f"{folder}/{entry.name}" for entry in entries if entry.is_file() and not entry.name.startswith(".")}

    def stamps(self, names: Sequence[str]) -> list[tuple[str, int, int]]:
        """Name, size and time of change of the objects that exist."""
        infos = self._system.get_file_info([self._path(name) for name in names]) if names else []
        return [(name, info.size, info.mtime_ns) for name, info in zip(names, infos, strict=True) if info.is_file]

    def delete(self, name: str) -> None:
        """Delete a file."""
        if self._system:
            self._system.delete_file(self._path(name))
        else:
            os.unlink(self._path(name))

    def read_all(self, names: Sequence[str]) -> Iterator[bytes]:
        """The content of files, in their order; objects are read in parallel."""
        if not self._system:
            yield from map(self.read, names)
            return
        with futures.ThreadPoolExecutor(_AT_ONCE) as pool:
            for first in range(0, len(names), 8 * _AT_ONCE):
                yield from pool.map(self.read, names[first : first + 8 * _AT_ONCE])

    def require_ours(self, marks: Mapping[str, str]) -> None:
        """Refuse to replace files that thetahat did not write: its own have these marks among their first characters."""
        there = {name.rsplit("/", 1)[-1] for name in self.names("")}
        for name, mark in marks.items():
            if name in there and mark.encode() not in self.read(name)[:_HEAD]:
                raise ReportError(
                    f"{self.place}/{name}: exists and was not written by thetahat; take another place, or delete it"
                )

    def require(self, names: Sequence[str]) -> None:
        """Refuse to continue without the files that a worker has written."""
        missing = [name for name in names if not self._system and not os.path.exists(self._path(name))]
        if missing:
            raise EngineError(
                f"{self.place}: a worker wrote {missing[0]}, which does not exist here: workers have another folder of that name; "
                "use a folder that all of them share, or s3://"
            )

    @contextlib.contextmanager
    def as_folder(self, *files: str, parts: str) -> Iterator[str]:
        """The store as a local folder: itself, or a copy of some files and of all parts, which is copied back."""
        if not self._system:
            yield self._root
            return
        with tempfile.TemporaryDirectory() as folder:
            copy = Store(folder)
            self._bring(copy, files, parts)
            yield folder
            self.send(folder, *files)
            for name in self.names(parts) - copy.names(parts):
                self.delete(name)

    def send(self, folder: str, *files: str) -> None:
        """Copy files of a local folder to another store."""
        if self._system:
            for name in files:
                path = pathlib.Path(folder, name)
                if path.exists():
                    self.write(name, path.read_bytes())

    def bring_parts(self, folder: str, parts: str) -> None:
        """Copy the parts that a local folder does not have."""
        if self._system:
            copy = Store(folder)
            missing = sorted(self.names(parts) - copy.names(parts))
            for name, content in zip(missing, self.read_all(missing), strict=True):
                copy.write(name, content)

    def _bring(self, copy: Store, files: tuple[str, ...], parts: str) -> None:
        there = {name.rsplit("/", 1)[-1] for name in self.names("")}
        for name in files:
            if name in there:
                copy.write(name, self.read(name))
        self.bring_parts(copy.place, parts)

    def _path(self, name: str) -> str:
        return f"{self._root}/{name}" if name else self._root


@functools.lru_cache(maxsize=8)
def _remote(place: str) -> tuple[Any, str]:
    """The file system of a place, created once per process, and the path in it."""
    system, root = _pyarrow_fs(place).FileSystem.from_uri(place)
    return system, root.rstrip("/")


def _pyarrow_fs(place: str) -> Any:
    try:
        return importlib.import_module("pyarrow.fs")
    except ImportError as missing:
        raise EngineError(f'{place}: needs pyarrow: pip install "thetahat[s3]"') from missing
