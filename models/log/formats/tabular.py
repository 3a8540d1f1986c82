"""What any format's reader is asked, and tables of any lab, by a map that is given or guessed."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from realitygap.embedded_sim import Drive
from realitygap.models.log.files import checked
from realitygap.models.log.formats.guess import guess
from realitygap.models.log.formats.mapped import Map, by_map, read_map
from realitygap.models.log.measured import read_table
from realitygap.models.log.opened import parsing


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


GUESSED = Path("guessed map")
"""What a guessed map is called in a refusal."""


def read_csv_log(path: Path, asked: Asked) -> Read:
    """A CSV or Parquet file.

    Raises:
        InputError: the file or its map cannot be used, or no map can be guessed.
    """
    return by_any_map(read_table(path), path, asked)


def by_any_map(raw: pd.DataFrame, path: Path, asked: Asked) -> Read:
    """A table that was read from `path`, by the map that was given, or by a guess.

    Raises:
        InputError: the map cannot be used, or none can be guessed.
    """
    if asked.map is not None:
        chosen, folder, name, text = read_map(asked.map), asked.map.parent, asked.map.name, ""
    else:
        text = asked.guessed or guess(raw, path, drive=asked.drive, fastest=asked.fastest)
        with parsing(str(path), "columns that a map can name (--map)"):
            chosen = checked(Map, tomllib.loads(text), GUESSED, "a map")
        folder, name = path.parent, str(GUESSED)
    table = by_map(raw, chosen, path=path, folder=folder, name=name, drive=asked.drive)
    return Read(table, text)
