"""The gain of an extended model: every model measured in every held-out run, and weighed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from realitygap.models.modelfile import ModelFile
from realitygap.studies.execution import Workers, completed
from realitygap.studies.gain.compared import read_compared
from realitygap.studies.gain.food import FILE, read_transfer
from realitygap.studies.gain.held_out import choose
from realitygap.studies.gain.request import GainRequest
from realitygap.studies.gain.runs import HEALTHY, Given, Recorded, measure_given, measure_recorded
from realitygap.studies.gain.weigh import weigh
from realitygap.studies.provenance import file_read, log_read, model_read, versions

SCHEMA = 1


class GainFailed(RuntimeError):
    """A held-out run could not be recorded or measured."""


@dataclass(frozen=True, eq=False)
class Gain:
    """What was measured."""

    content: dict[str, Any]
    """Of `gain.json`."""
    table: pd.DataFrame
    """As `prediction_errors`, with the run."""


def measure_gain(request: GainRequest, reach: Callable[[float], None] = lambda done: None) -> Gain:
    """Measure the prediction gain.

    Args:
        request: Of what.
        reach: Called with the share that is done.

    Raises:
        InputError: a log, model or effect cannot be used, or nothing is held out.
        GainFailed: a run could not be recorded.
    """
    models = read_compared(request.extended)
    food = None if request.transfer is None else read_transfer(request.transfer)
    chosen = choose(request, models)
    table = _collect(chosen.tasks, request.jobs, reach)
    source = "recorded" if request.effects else "logs"
    content = {
        "schema": SCHEMA,
        "extended": _provenance(models.file),
        "held_out": {"source": source, "runs": chosen.runs, "robots": _listed(chosen.judged)},
        "oracle": chosen.oracle,
        "healthy": "twins" if request.effects else _healthy_source(table, request.healthy),
        "errors": weigh(table, seed=request.seed),
        "by_run": _by_run(table),
        "transfer": food,
        "inputs": _inputs(request),
        "command": request.command,
        "versions": versions(),
    }
    return Gain(content, table)


def _inputs(request: GainRequest) -> list[dict[str, str]]:
    """The files that a gain is a function of."""
    read = [log_read("--log", path) for path in request.logs]
    read += model_read(request.extended, "--extended")
    read += [log_read("--healthy", path) for path in request.healthy]
    read += [file_read("--transfer", request.transfer / FILE)] if request.transfer else []
    return read


def _collect(
    tasks: Sequence[Recorded | Given], jobs: int | None, reach: Callable[[float], None]
) -> pd.DataFrame:
    """Measure every run, on every core; in the order of the tasks."""
    found: dict[int, pd.DataFrame] = {}
    numbered = list(enumerate(tasks))
    with closing(completed(_measure, numbered, Workers.chosen(jobs, None))) as finished:
        for one in finished:
            number, task = one.task
            if one.value is None:
                name = task.run.name if task.run is not None else "of a log"
                raise GainFailed(f"run {name}: {one.error}")
            found[number] = one.value
            reach(len(found) / len(tasks))
    return pd.concat([found[number] for number, _ in numbered], ignore_index=True)


def _measure(task: tuple[int, Recorded | Given]) -> pd.DataFrame:
    one = task[1]
    return measure_recorded(one) if isinstance(one, Recorded) else measure_given(one)


def _healthy_source(table: pd.DataFrame, healthy: Sequence[Path]) -> str | None:
    """Where the healthy level comes from."""
    if healthy:
        return "logs"
    return "other robots" if (table["model"] == HEALTHY).any() else None


def _listed(robots: frozenset[int] | None) -> list[int] | str:
    return "all" if robots is None else sorted(robots)


def _provenance(file: ModelFile) -> dict[str, Any]:
    assert file.extension is not None
    return {"name": file.name, **file.extension.model_dump(mode="json", exclude_none=True)}


def _by_run(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Mean error per run, channel and model: motion at every horizon, senses as a whole."""
    rows = table.replace({"channel": {f"{k}{i}": k for k in ("ps", "ls") for i in range(8)}})
    keys = ["run", "kind", "channel", "horizon", "unit"]
    sums = rows.groupby([*keys, "model"], sort=False)[["total", "number"]].sum()
    mean = (sums["total"] / sums["number"]).unstack("model").reset_index()
    entries = []
    for row in mean.to_dict("records"):
        known = {k: v for k, v in row.items() if not (isinstance(v, float) and np.isnan(v))}
        entries.append(known | {"horizon": row["horizon"] or None})
    return entries
