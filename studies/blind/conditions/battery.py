"""The matrix from beginning to end: the logs that are missing, then the cells and the page.

Each log is recorded, changed as its condition says, and diagnosed by another process. A changed log
does not say what recorded it: a lab's would not, and its rows may no longer be those of the
recorder. Of a run only its log is kept, and only until the next run.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import pandas as pd

from realitygap.models.belief.modelfile import Circle, Lamps, Point
from realitygap.reality.arena import ForagingArena
from realitygap.reality.engine import DEFAULT
from realitygap.reality.rays import DEFAULT_RAYS
from realitygap.studies.blind.conditions.matrix import CONDITIONS, CellLog, MatrixConfig, plan
from realitygap.studies.blind.conditions.page import write_pages
from realitygap.studies.blind.conditions.scores import cells_of, log_result, logs_table, summary
from realitygap.studies.blind.directory import BlindDirectory, do_missing
from realitygap.studies.blind.examiner import LOG, ask
from realitygap.studies.blind.record import Diagnosed, Task, answered
from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.provenance import commit, versions, write_json
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.plumbing.typed import option, typed
from realitygap.studies.run.experiment import ANONYMOUS, RunConfig, simulate


def diagnose_cell(task: Task) -> dict[str, Any]:
    """Record, change, diagnose: see `answered`. Executed by a worker."""
    assert isinstance(task.trial, CellLog)
    return answered(task, partial(write_given, task.trial))


def write_given(cell: CellLog, given: Path) -> None:
    """All that a diagnosis is given: the log, and the model if it is not the shipped one.

    Args:
        cell: Which.
        given: A directory that is there, and empty.
    """
    condition = CONDITIONS[cell.condition]
    log = _recorded(cell.run, cell.specs)
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


SCHEMA = 1


def run_matrix(
    config: MatrixConfig,
    out: Path,
    workers: Workers,
    *,
    quiet: bool = False,
    diagnosed: Diagnosed | None = None,
) -> dict[str, Any]:
    """Run or resume a matrix in `out`; returns the content of `conditions.json`.

    Args:
        config: Which conditions, how many logs.
        out: Its directory; conditions and logs that are there stay as they are.
        workers: Where logs are recorded and diagnosed.
        quiet: Say nothing.
        diagnosed: What diagnoses the log in a directory; importable; `ask` if absent.

    Raises:
        InputError: `out` cannot be used.
        TrialsFailed: logs could not be recorded; a failed diagnosis is a result.
        WorkersLost: workers keep dying.
    """
    planned = plan(config)
    with BlindDirectory(out, config, planned).held() as directory:
        who = diagnosed or partial(ask, reference=config.reference)
        do_missing(directory, workers, quiet, who, diagnose_cell)
        answers = [answer for _, answer in directory.answers()]
        logs = logs_table(map(log_result, planned, answers))
        cells = cells_of(logs)
        content = {
            "schema": SCHEMA,
            "config": config.model_dump(mode="json"),
            "command": _command(config),
            "commit": commit(),
            "versions": versions(),
            "summary": summary(cells),
            "cells": cells,
        }
        with whole_file(out / "conditions.json", force=True) as part:
            write_json(part, content)
        for name, table in (("cells.csv", pd.DataFrame(cells)), ("logs.csv", logs)):
            with whole_file(out / name, force=True) as part:
                table.to_csv(part, index=False)
        write_pages(out, content, logs)
    return content


def _command(config: MatrixConfig) -> str:
    """What a user would type."""
    only = () if len(config.conditions) == len(CONDITIONS) else config.conditions
    words: list[object] = ["realitygap", "blind", "--conditions", "--trials", config.trials]
    words += ["--seed", config.seed, *option("--only", only)]
    words += ["--engine", config.engine] if config.engine != DEFAULT else []
    words += ["--reference", config.reference] if config.reference else []
    return typed(*words, *(["--rays", config.rays] if config.rays != DEFAULT_RAYS else []))
