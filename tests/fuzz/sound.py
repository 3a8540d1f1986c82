"""What a reader is, and the sound log that most files are made of."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any, NamedTuple

import pandas as pd

from realitygap.embedded_sim import Drive
from tests.models.small import driven_log

DRIVE = Drive()
ROWS = 40


class Reader(NamedTuple):
    """One reader."""

    read: Callable[[Any], object]
    """Of a directory, or, without files, of a text or of words."""
    files: Callable[[], dict[str, bytes]] = dict
    """Sound ones."""
    damaged: tuple[str, ...] = ()
    """Which of them are damaged."""
    table: str = ""
    """Of these the one that is a table, whose columns are damaged too."""


def table() -> pd.DataFrame:
    """A small measured log."""
    motion = driven_log(3, rows=ROWS, position_noise=5e-4, heading_noise=5e-3)
    return motion.assign(case="no-light", food=False, ps0=3.0)


def as_csv(frame: pd.DataFrame) -> bytes:
    return frame.to_csv(index=False).encode("utf-8", "surrogatepass")


def as_parquet(frame: pd.DataFrame) -> bytes:
    out = io.BytesIO()
    frame.to_parquet(out)
    return out.getvalue()
