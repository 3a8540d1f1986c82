"""What a reader of a lab's format is asked for, and what it hands over."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from realitygap.embedded_sim import Drive


@dataclass(frozen=True, kw_only=True)
class Asked:
    """How to read a source."""

    drive: Drive
    """The nominal geometry: it turns ticks, speeds of a rim and of a body into a wheel's."""
    fastest: float | None = None
    """rad/s, most a wheel of this robot turns; None: nobody has said which robot it is."""
    map: Path | None = None
    """Which column or topic is what (TOML); None: it is guessed."""
    guessed: str = ""
    """The map guessed from a source before, which holds for those that follow."""
    commands: Path | None = None
    """A file of commands, where the source has poses alone."""


class Read(NamedTuple):
    """A source that was read."""

    table: pd.DataFrame
    """With columns of the measured log."""
    guessed: str = ""
    """The map it was read by, as TOML, if it was guessed."""
