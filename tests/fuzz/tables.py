"""Tables with wrong columns: what other programs write where a log was meant."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from hypothesis import strategies as st

VALUES: tuple[Any, ...] = (
    *(0, 1, -1, 0.5, 2**62, 2**64, 10**400, 1e15, 1e300, 1e-300, np.nan, np.inf, -np.inf),
    *(None, True, "", "a", "1", "nan", "\x1b[2J", "\U0001f600", "no-light", "light-at-nest"),
    *(b"a", [1.0], {"a": 1}, pd.Timestamp(0), pd.Timedelta(1, "s"), 1 + 2j),
)
"""What a column, or a cell of it, is filled with."""
KINDS = ("object", "str", "float32", "float16", "int8", "int64", "uint64", "bool", "complex64")
KINDS += ("category", "Int64", "boolean", "datetime64[ns]", "string")


class Change(NamedTuple):
    """One change of a table."""

    kind: str
    column: float
    row: float
    value: Any
    dtype: str


changes = st.lists(
    st.builds(
        Change,
        kind=st.sampled_from(
            (
                *("fill", "cell", "dtype", "drop", "rename", "swap", "constant", "double", "add"),
                *("rows", "once", "repeat", "reverse", "scale", "index", "none"),
            )
        ),
        column=st.floats(0.0, 1.0),
        row=st.floats(0.0, 1.0),
        value=st.sampled_from(VALUES),
        dtype=st.sampled_from(KINDS),
    ),
    min_size=1,
    max_size=3,
)
"""What is done to a table."""


def changed(table: pd.DataFrame, wanted: list[Change]) -> pd.DataFrame:
    """A table with every change that can be made to it."""
    for change in wanted:
        if not len(table.columns) or not len(table):
            break
        try:
            table = _changed(table.copy(), change)
        except (ValueError, TypeError, OverflowError):
            continue  # a table cannot be made so
    return table


def _changed(table: pd.DataFrame, change: Change) -> pd.DataFrame:
    kind, _, _, value, dtype = change
    names = list(table.columns)
    at = int(change.column * (len(names) - 1))
    row = int(change.row * (len(table) - 1))
    name = names[at]
    if kind in ("fill", "add"):
        filled = pd.Series([value] * len(table), index=table.index)
        return table.assign(**{str(name) if kind == "fill" else f"extra {value}": filled})
    if kind == "cell":
        cells = table[name].astype(object).tolist()
        cells[row] = value
        return table.assign(**{name: pd.Series(cells, index=table.index)})
    if kind == "dtype":
        return table.assign(**{name: table[name].astype(dtype)})
    if kind == "rename":
        return table.rename(columns={name: str(value)})
    if kind == "swap":
        other = names[(at + 1 + int(change.row * 5)) % len(names)]
        return table.rename(columns={name: other, other: name})
    if kind == "constant":
        return table.assign(**{name: table[name].iloc[row]})
    if kind == "double":
        return pd.concat([table, table[[name]]], axis=1)
    if kind == "scale":
        return table.assign(**{name: table[name] * (1e12 if value is None else 1e-3)})
    rows = {
        "rows": table.iloc[: row + 1],
        "once": table.iloc[row : row + 1],
        "repeat": pd.concat([table] * 2),
        "reverse": table.iloc[::-1],
        "index": table.set_index(name),
        "none": table.iloc[:0],
        "drop": table.drop(columns=[name]),
    }
    return rows[kind]
