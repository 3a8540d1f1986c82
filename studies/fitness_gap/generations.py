"""Which generations tell of the gap in fitness, and under which light each lived."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.embedded_sim import CONTROL_STEP, InputError
from realitygap.embedded_sim.onboard import GENERATION_STEPS
from realitygap.models.log.opened import parsing
from realitygap.models.log.table_files import read_parquet
from realitygap.studies.run.experiment import HALVES

COLUMNS = (
    *("run", "robot", "generation", "t_start", "t_end", "case"),
    *("s0_third", "fitness_sim", "fitness_real"),
)


WHOLE = ("robot", "generation")
NUMBERS = ("t_start", "t_end", "s0_third", "fitness_sim", "fitness_real")


def find_generations(source: Path) -> Path | None:
    """The `generations.parquet` of a run's or a study's directory, if there is one."""
    path = source / "generations.parquet"
    return path if os.path.exists(path) else None


def read_generations(path: Path) -> pd.DataFrame:
    """A table of generations.

    Raises:
        InputError: not such a table, columns are missing, or hold something else.
    """
    table = read_parquet(path, "a table of generations")
    missing = [name for name in COLUMNS if name not in table]
    if missing:
        raise InputError(str(path), f"no column {missing[0]}", f"columns {', '.join(COLUMNS)}")
    if table["run"].isna().any():
        raise InputError(str(path), "rows without a run", "a run in each row")
    with parsing(str(path), f"numbers in {', '.join((*WHOLE, *NUMBERS))}"):
        numbers = {name: pd.to_numeric(table[name]).astype(float) for name in NUMBERS}
        if any(np.isinf(column).any() for column in numbers.values()):
            raise InputError(str(path), "infinite values", "numbers")
        whole = {name: table[name].astype("int64") for name in WHOLE}
        return table.assign(run=table["run"].astype(str), **whole, **numbers)


def whole(generations: pd.DataFrame) -> pd.Series[bool]:
    """Which generations the end of the run did not cut short."""
    lived = generations["t_end"] - generations["t_start"]
    return lived > (GENERATION_STEPS - 1) * CONTROL_STEP


def scenario(generations: pd.DataFrame, half: float | pd.Series[float]) -> pd.Series[float]:
    """The scenario each generation lived under; NaN: unknown, or the lamp moved within it.

    Args:
        generations: With `case`, `t_start` and `t_end`.
        half: s, when the lamp moves where it does.
    """
    case = generations["case"].astype(str)
    first, second = (case.map({name: pair[k] for name, pair in HALVES.items()}) for k in (0, 1))
    before, after = generations["t_end"] <= half, generations["t_start"] >= half
    moved = first.where(before, second.where(after))
    return first.where(first == second, moved).astype(float)
