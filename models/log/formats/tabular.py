"""Tables of any lab, by their user's map or by one that is guessed."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pandas as pd

from realitygap.models.log.files import checked
from realitygap.models.log.formats.asked import Asked, Read
from realitygap.models.log.formats.guess import guess
from realitygap.models.log.formats.mapped import Map, by_map, read_map
from realitygap.models.log.measured import read_table
from realitygap.models.log.opened import parsing

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
