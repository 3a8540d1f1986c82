"""The gain of an extended model: every model measured in every held-out run, and weighed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from realitygap.models.belief.extension import Extension
from realitygap.models.belief.modelfile import ModelFile
from realitygap.reality.engine import DEFAULT, engine_name
from realitygap.reality.rays import DEFAULT_RAYS, rays_name
from realitygap.studies.gain.food import FILE as FOOD
from realitygap.studies.gain.food import read_transfer
from realitygap.studies.gain.held_out import choose
from realitygap.studies.gain.request import GainRequest, compared
from realitygap.studies.gain.result import FILE, GainResult
from realitygap.studies.gain.runs import HEALTHY, Given, Recorded, measure_given, measure_recorded
from realitygap.studies.gain.weigh import weigh
from realitygap.studies.gain.words import summary
from realitygap.studies.inputs.logs import AnyLog, sources
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.plumbing.execution import Workers, completed
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.provenance import file_read, versions

SCHEMA = 1


class GainFailed(RuntimeError):
    """A held-out run could not be recorded or measured."""


def gain(
    log: AnyLog,
    extended: AnyModel,
    *,
    effects: Sequence[str] = (),
    healthy: AnyLog = (),
    transfer: Path | str | None = None,
    runs: int = 6,
    minutes: float = 2.0,
    seed: int = 0,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    jobs: int | None = None,
    out: Path | str | None = None,
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> GainResult:
    """Measure how well an extended model predicts runs that nothing was named from.

    Args:
        log: Measured logs, as `read_log` takes them. Those that the extension was not named from
            are held out; with `effects` they only say which run it was named from.
        extended: The extended model of a diagnosis.
        effects: SPECs of what was hidden: fresh runs are recorded with them.
        healthy: Logs of sound robots, for the level that can be reached.
        transfer: Directory of a finished `study.transfer`: the gain in food, beside.
        runs: How many to record.
        minutes: Simulated, of each.
        seed: Everything random follows from it.
        engine: Physics of the fresh runs' world: pybullet, pybullet-strict or mujoco.
        rays: Who answers what infrared meets: engine, or closed.
        jobs: Processes; all cores if absent.
        out: Directory to write everything into as well, as `write` does; claimed before any work.
        force: Replace a gain that is there.
        reach: Called with the share that is done, from 0 to 1.

    Raises:
        InputError: a log, model or effect cannot be used, nothing is held out, or `out` cannot.
        GainFailed: a run could not be recorded or measured.
    """
    holds, world = (FILE,), engine_name(engine, needed=bool(effects))
    place = nullcontext() if out is None else whole_directory(Path(out), force=force, holds=holds)
    with place as part:
        request = GainRequest(
            logs=sources(log),
            extended=Model.load(extended),
            effects=tuple(effects),
            healthy=sources(healthy),
            transfer=None if transfer is None else Path(transfer),
            runs=runs,
            minutes=minutes,
            seed=seed,
            engine=world,
            rays=rays_name(rays),
            jobs=jobs,
        )
        found = measure(request, reach)
        if part is not None:
            found.keep(part)
    return found


def measure(request: GainRequest, reach: Callable[[float], None]) -> GainResult:
    """Measure what is asked; `reach` as `gain`."""
    models = compared(request.extended)
    food = None if request.transfer is None else read_transfer(request.transfer)
    chosen = choose(request, models)
    table = _collect(chosen.tasks, request.jobs, reach)
    source = "recorded" if request.effects else "logs"
    content = {
        "schema": SCHEMA,
        "extended": _provenance(models.file),
        "held_out": {
            "source": source,
            "runs": chosen.runs,
            "robots": _listed(chosen.judged, models.file),
        },
        "oracle": chosen.oracle,
        "healthy": "twins" if request.effects else _healthy_source(table, bool(request.healthy)),
        "errors": weigh(table, seed=request.seed),
        "by_run": _by_run(table),
        "transfer": food,
        "inputs": _inputs(request),
        "command": request.command,
        "versions": versions(),
    }
    return GainResult(content | {"summary": summary(content)}, table)


def _inputs(request: GainRequest) -> list[dict[str, str]]:
    """The files that a gain is a function of."""
    read = [log.entry("--log") for log in request.logs]
    read += request.extended.entries("--extended")
    read += [log.entry("--healthy") for log in request.healthy]
    return read + ([file_read("--transfer", request.transfer / FOOD)] if request.transfer else [])


def _collect(
    tasks: Sequence[Recorded | Given], jobs: int | None, reach: Callable[[float], None]
) -> pd.DataFrame:
    """Measure every run, on every core; in the order of the tasks.

    Logs hold no world, whose engine would have to be kept apart: with one job they need no process.
    """
    found: dict[int, pd.DataFrame] = {}
    numbered = list(enumerate(tasks))
    if jobs == 1 and all(isinstance(task, Given) for task in tasks):
        return pd.concat([_measure(one) for one in numbered], ignore_index=True)
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


def _healthy_source(table: pd.DataFrame, healthy: bool) -> str | None:
    """Where the healthy level comes from."""
    if healthy:
        return "logs"
    return "other robots" if (table["model"] == HEALTHY).any() else None


def _listed(robots: frozenset[int] | None, file: ModelFile) -> list[int | str] | str:
    names = (file.extension or Extension()).called
    return "all" if robots is None else [names.key(robot) for robot in sorted(robots)]


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
