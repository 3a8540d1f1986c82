"""LeRobot data sets: Parquet tables of episodes whose states and actions are lists of numbers.

A data set is a directory with `meta/info.json` and `data/**/*.parquet`; a single Parquet file will
do, too. Every number of a list becomes a column of its own: `observation.state.x` where the info
names it, else `observation.state.0`. Which column is what is then said by a map, or guessed, as of
any table. Episodes become runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from realitygap.embedded_sim import InputError
from realitygap.models.log.formats.tabular import Asked, Read, by_any_map
from realitygap.models.log.opened import json_values, opened, parsing
from realitygap.models.log.table_files import LESS, MOST_BYTES, MOST_CELLS, MOST_COLUMNS

EXPECTED = "a LeRobot data set (meta/info.json and data/*.parquet), or one of its Parquet files"
EPISODE = "episode_index"


def read_lerobot(path: Path, asked: Asked) -> Read:
    """A data set.

    Raises:
        InputError: it cannot be read, its map cannot be used, or none can be guessed.
    """
    names: dict[str, list[str]] = {}
    files = [path]
    if path.is_dir():
        names = _names(path / "meta" / "info.json")
        files = sorted(path.glob("data/**/*.parquet"))
        if not files:
            raise InputError("SOURCE", path, EXPECTED)
    parts, cells = [], 0
    for file in files:
        part = _table(file, names)
        cells += part.size
        if cells > MOST_CELLS:
            raise InputError(str(path), f"more than {MOST_CELLS} numbers", LESS)
        parts.append(part)
    raw = pd.concat(parts, ignore_index=True)
    read = by_any_map(raw, path, asked)
    if "run" in read.table or EPISODE not in raw or len(read.table) != len(raw):
        return read
    return read._replace(table=read.table.assign(run=raw[EPISODE].astype(str)))


def _names(path: Path) -> dict[str, list[str]]:
    """What the info calls the numbers of each list."""
    info = json_values(path, EXPECTED)
    features = info.get("features", {}) if isinstance(info, Mapping) else {}
    found = {}
    for name, feature in features.items() if isinstance(features, Mapping) else ():
        given = feature.get("names") if isinstance(feature, Mapping) else None
        if isinstance(given, Mapping) and len(given) == 1:  # as {"motors": [...]}
            given = next(iter(given.values()))
        if isinstance(given, list) and all(isinstance(one, str) for one in given):
            found[str(name)] = given
    return found


def _table(path: Path, names: Mapping[str, list[str]]) -> pd.DataFrame:
    """One file, every list spread over columns."""
    with opened(path, EXPECTED, most=MOST_BYTES) as file, parsing(str(path), EXPECTED):
        whole = pq.ParquetFile(file)
        about = whole.metadata
        size = sum(about.row_group(k).total_byte_size for k in range(about.num_row_groups))
        if size > MOST_BYTES or about.num_rows * about.num_columns > MOST_CELLS:
            raise InputError(str(path), f"{about.num_rows} rows, {size} bytes", LESS)
        wanted = [f.name for f in whole.schema_arrow if _numeric(_inner(f.type))]
        table = whole.read(columns=wanted)
        columns: dict[str, Any] = {}
        for name in table.column_names:
            values = table.column(name)
            if not _is_list(values.type):
                columns[name] = values.to_numpy()
                continue
            spread = _spread(values)
            if len(columns) + spread.shape[1] > MOST_COLUMNS:
                raise InputError(str(path), f"more than {MOST_COLUMNS} columns", LESS)
            given = names.get(name, [])
            fit = len(given) == spread.shape[1]
            for k in range(spread.shape[1]):
                columns[f"{name}.{given[k] if fit else k}"] = spread[:, k]
        return pd.DataFrame(columns)


def _spread(values: Any) -> np.ndarray[Any, Any]:
    """(rows, numbers) of a column of lists of one length."""
    whole = values.combine_chunks()
    lengths = whole.value_lengths().to_numpy(zero_copy_only=False)
    if not len(lengths) or (lengths != lengths[0]).any():
        return np.zeros((len(lengths), 0))
    flat = whole.flatten().to_numpy(zero_copy_only=False)
    return np.asarray(flat).reshape(len(lengths), -1)


def _is_list(kind: Any) -> bool:
    lists = (pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list)
    return any(one(kind) for one in lists)


def _inner(kind: Any) -> Any:
    return kind.value_type if _is_list(kind) else kind


def _numeric(kind: Any) -> bool:
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind))
