"""One log of one cell: recorded, changed as its condition says, and diagnosed by another process.

A changed log does not say what recorded it: a lab's would not, and its rows may no longer be those
of the recorder. Of a run only its log is kept, and only until the next run.
"""

from __future__ import annotations

import time
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import pandas as pd

from realitygap.models.belief.modelfile import Circle, Lamps, Point
from realitygap.reality.arena import ForagingArena
from realitygap.studies.blind.conditions.matrix import CONDITIONS, CellLog
from realitygap.studies.blind.examiner import LOG
from realitygap.studies.blind.record import Task
from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import ANONYMOUS, RunConfig, simulate


def diagnose_cell(task: Task) -> dict[str, Any]:
    """Record, change, diagnose. Executed by a worker.

    Returns:
        As `record.run_trial`.
    """
    assert isinstance(task.trial, CellLog)
    with scratch() as given:
        began = time.perf_counter()
        write_given(task.trial, given)
        recorded = time.perf_counter()
        diagnosis, error = task.diagnosed(given, ())
        return {
            "diagnosis": diagnosis,
            "error": error,
            "record_seconds": round(recorded - began, 3),
            "diagnose_seconds": round(time.perf_counter() - recorded, 3),
        }


def write_given(cell: CellLog, given: Path) -> None:
    """All that a diagnosis is given: the log, and the model if it is not the shipped one.

    Args:
        cell: Which.
        given: A directory that is there, and empty.
    """
    condition = CONDITIONS[cell.condition]
    log = _recorded(cell.run, tuple(one.spec for one in cell.hidden))
    condition.change(log, cell.random).to_parquet(given / LOG, index=False)
    if condition.arena_radius is not None:
        _told(condition.arena_radius).keep(given)


@lru_cache(maxsize=1)
def _recorded(run: RunConfig, specs: tuple[str, ...]) -> pd.DataFrame:
    """The log of a run; cells that share one come one after another."""
    with scratch() as out:
        simulate(run, specs, out, name=ANONYMOUS)
        return pd.read_parquet(out / LOG)


def _told(arena_radius: float) -> Model:
    """The shipped model in an arena of that radius (m)."""
    model = Model.load()
    assert model.file.arena is not None
    there = ForagingArena(arena_radius)
    x, y, radius = there.nest
    nest = Circle(x=x, y=y, radius=radius)
    arena = model.file.arena.model_copy(update={"radius": arena_radius, "nest": nest})
    first, _, third = (place and Point(x=place[0], y=place[1]) for place in there.lamps)
    lamps = Lamps(opposite=first, at_nest=third)
    return replace(model, file=model.file.model_copy(update={"arena": arena, "lamps": lamps}))
