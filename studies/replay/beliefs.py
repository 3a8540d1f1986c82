"""What robots believed of the lamp while they were recorded, out of their runs' files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
import pandas as pd

from realitygap.studies.fitness_gap.generations import find_generations, read_generations
from realitygap.studies.inputs.logs import Log


class Believed(NamedTuple):
    """One robot's S0 in one generation."""

    begin: float
    """s, as in the log."""
    end: float
    third: int
    """0: the lamp opposite the nest, 1: none, 2: at the nest."""
    s0: float
    """NaN: not told."""


Beliefs: TypeAlias = Mapping[str, Sequence[Believed]]
"""By robot, in order of time."""


def beliefs_of(log: Log) -> dict[str, dict[str, list[Believed]]]:
    """By run and robot; empty for logs that are not the directories of runs.

    Raises:
        InputError: a directory's table of generations cannot be used.
    """
    found: dict[str, dict[str, list[Believed]]] = {}
    for k, source in enumerate(log.sources):
        path = None if source.path is None else find_generations(source.path)
        if path is None:
            continue
        table = read_generations(path).dropna(subset=["t_start", "t_end", "s0_third"])
        prefix = f"{k + 1}/" if len(log.sources) > 1 else ""
        table = table.sort_values("t_start")
        s0 = pd.to_numeric(table.get("s0", np.nan), errors="coerce")
        table = table.assign(s0=np.asarray(s0, dtype=float))
        names = (prefix + table["run"], table["robot"].astype(str))
        numbers = (table[name].tolist() for name in ("t_start", "t_end", "s0_third", "s0"))
        for run, robot, begin, end, third, value in zip(*names, *numbers, strict=True):
            of_robot = found.setdefault(run, {}).setdefault(robot, [])
            of_robot.append(Believed(begin, end, int(third), value))
    return found
