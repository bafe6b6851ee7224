"""Progress of long work: by tqdm if it is installed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = Callable[[str], object]


@contextmanager
def reporting(progress: bool | Progress) -> Iterator[Progress | None]:
    """The receiver of progress: nothing, a callable, or a line of tqdm."""
    if callable(progress):
        yield progress
    elif not progress:
        yield None
    else:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            yield lambda stage: print(stage, file=sys.stderr)
            return
        with tqdm(bar_format="{elapsed} {desc}") as line:
            yield line.set_description_str
