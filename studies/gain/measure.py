"""From an extended model to its gain: which runs are held out, what is measured in them."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from embedded_sim.errors import InputError
from embedded_sim.model import Drive
from embedded_sim.tables import Tables
from models.diagnosis import file_hash
from models.log import SAMPLES, read_log, read_table
from models.modelfile import ModelFile, find_model_file, read_model_file
from models.tables import load_tables
from reality.effects import Hidden, parse_effects
from studies.execution import Workers, completed
from studies.gain.food import read_transfer
from studies.gain.runs import (
    BEFORE,
    EXTENDED,
    HEALTHY,
    ORACLE,
    Given,
    HeldOut,
    Recorded,
    measure_given,
    measure_recorded,
    plan,
)
from studies.gain.truth import concerned, hidden_in, told, true_model
from studies.gain.weigh import weigh
from studies.provenance import versions

SCHEMA = 1
ROBOTS = 10
"""Of a recorded run, where no log says how many there are."""


class GainFailed(RuntimeError):
    """A held-out run could not be recorded or measured."""


@dataclass(frozen=True, kw_only=True)
class GainRequest:
    """What to measure."""

    logs: tuple[Path, ...]
    extended: str
    effects: tuple[str, ...] = ()
    healthy: tuple[Path, ...] = ()
    transfer: Path | None = None
    runs: int = 6
    minutes: float = 2.0
    seed: int = 0
    jobs: int | None = None

    @property
    def command(self) -> str:
        """What a user would type."""
        words = ["realitygap gain", *(f"--log {path}" for path in self.logs)]
        words += [f"--extended {self.extended}"]
        words += [f"--effect {one}" for one in self.effects]
        words += [f"--healthy {path}" for path in self.healthy]
        words += [f"--transfer {self.transfer}"] if self.transfer else []
        if self.effects:
            words += [f"--runs {self.runs} --minutes {self.minutes:g} --seed {self.seed}"]
        return " ".join(words)


@dataclass(frozen=True, eq=False)
class Gain:
    """What was measured."""

    content: dict[str, Any]
    """Of `gain.json`."""
    table: pd.DataFrame
    """As `prediction_errors`, with the run."""


@dataclass(frozen=True)
class _Models:
    """The models that are compared."""

    file: ModelFile
    plain: ModelFile
    tables: Tables | None

    def named(self, true: ModelFile | None) -> dict[str, ModelFile]:
        """By name; the minimal one first."""
        both = {BEFORE: self.plain, EXTENDED: self.file}
        return both if true is None else {**both, ORACLE: true}

    @property
    def robots(self) -> frozenset[int] | None:
        """Robots that the extension concerns; None: all."""
        causes = () if self.file.extension is None else self.file.extension.causes
        if any(cause.robots == "all" for cause in causes):
            return None
        return frozenset(int(robot) for cause in causes for robot in cause.robots)


def measure_gain(request: GainRequest, reach: Callable[[float], None] = lambda done: None) -> Gain:
    """Measure the prediction gain.

    Args:
        request: Of what.
        reach: Called with the share that is done.

    Raises:
        InputError: a log, model or effect cannot be used, or nothing is held out.
        GainFailed: a run could not be recorded.
    """
    models = _read(request.extended)
    food = None if request.transfer is None else read_transfer(request.transfer)
    held, naming = _apart(request.logs, models.file)
    if request.effects:
        robots = _robots(request.logs)
        hidden = parse_effects(request.effects, robots)
        _check_truth(naming, hidden)
        true, judged = true_model(models.plain, hidden), _judged(models, hidden)
        tasks, runs = _to_record(request, models, true, judged, robots, naming)
    else:
        if not held:
            raise InputError(
                "--log",
                ", ".join(map(str, request.logs)),
                "a log that the extension was not named from, or --effect to record fresh runs",
            )
        truths = [hidden_in(path) for path in held]
        known = truths[0] if all(one == truths[0] for one in truths) else None
        true = None if known is None else true_model(models.plain, known)
        judged = _judged(models, known or ())
        tasks, runs = _given(held, models, true, judged), [{"run": str(path)} for path in held]
        present = {int(r) for t in tasks if isinstance(t, Given) for r in t.table["robot"].unique()}
        _check_robots(models, present, request.extended)
    tasks += _sound(request.healthy, models)
    table = _collect(tasks, request.jobs, reach)
    source = "recorded" if request.effects else "logs"
    content = {
        "schema": SCHEMA,
        "extended": _provenance(models.file),
        "held_out": {"source": source, "runs": runs, "robots": _listed(judged)},
        "oracle": true is not None,
        "healthy": "twins" if request.effects else _healthy_source(table, request.healthy),
        "errors": weigh(table, seed=request.seed),
        "by_run": _by_run(table),
        "transfer": food,
        "command": request.command,
        "versions": versions(),
    }
    return Gain(content, table)


def _read(extended: str) -> _Models:
    path = find_model_file(extended)
    file = read_model_file(path)
    if file.extension is None:
        raise InputError("--extended", path, "a model with a table [extension], as of diagnose")
    tables = None if file.sensors is None else load_tables(path.parent / file.sensors.tables)
    return _Models(file, file.model_copy(update={"extension": None}), tables)


def _apart(logs: Sequence[Path], file: ModelFile) -> tuple[list[Path], list[Path]]:
    """The logs that the extension was not named from, and those it was."""
    files = [path / SAMPLES if path.is_dir() else path for path in logs]
    for path, source in zip(logs, files, strict=True):
        if not source.is_file():
            raise InputError(
                "--log", path, "an existing .parquet or .csv file, or a run's directory"
            )
    named_from = "" if file.extension is None else file.extension.log
    if file_hash(files) == named_from:
        return [], list(logs)
    naming = [p for p, f in zip(logs, files, strict=True) if file_hash([f]) == named_from]
    return [path for path in logs if path not in naming], naming


def _robots(logs: Sequence[Path]) -> int:
    """How many robots a recorded run must have for the logs' robots to exist."""
    tables = [read_table(path) for path in logs]
    return max((int(t["robot"].max()) + 1 for t in tables if "robot" in t), default=ROBOTS)


def _check_truth(naming: Sequence[Path], hidden: Sequence[Hidden]) -> None:
    """Refuse effects other than those of the run that the extension was named from."""
    for path in naming:
        truth = hidden_in(path)
        if truth is not None and told(truth) != told(hidden):
            raise InputError("--effect", told(hidden), f"what was hidden in {path}: {told(truth)}")


def _judged(models: _Models, hidden: Sequence[Hidden]) -> frozenset[int] | None:
    """Robots named or truly altered; None: all."""
    true, named = concerned(hidden), models.robots
    if true is None or named is None or not (true | named):
        return None
    return frozenset(true | named)


def _to_record(
    request: GainRequest,
    models: _Models,
    true: ModelFile | None,
    judged: frozenset[int] | None,
    robots: int,
    naming: Sequence[Path],
) -> tuple[list[Recorded | Given], list[dict[str, Any]]]:
    """Fresh runs and their healthy twins, and what to say of them."""
    if request.runs < 1:
        raise InputError("--runs", request.runs, "at least 1")
    _check_robots(models, range(robots), request.extended)
    settings: dict[str, Any] = {
        "runs": request.runs,
        "minutes": request.minutes,
        "robots": robots,
        "seed": request.seed,
    }
    altered, twins = plan(request.effects, judged=judged, **settings), plan((), **settings)
    drive = models.file.nominal_drive
    tasks: list[Recorded | Given] = [
        Recorded(run, models.named(true), models.tables, drive) for run in altered
    ]
    tasks += [Recorded(run, {HEALTHY: models.plain}, models.tables, drive) for run in twins]
    seen = [_kind(path) for path in naming]
    return tasks, [_notes(run, seen) for run in altered]


def _check_robots(models: _Models, known: Collection[int], extended: str) -> None:
    """Refuse an extension of robots that are in no run."""
    if models.file.extension is not None:
        models.file.extension.check_robots(known, find_model_file(extended).name)


def _kind(run: Path) -> tuple[str, str] | None:
    """Controller and case of a run's directory; None of a mere log."""
    path = run / "run.json"
    if not path.is_file():
        return None
    config = json.loads(path.read_text(encoding="utf-8"))["config"]
    return config["controller"], config["case"]


def _notes(run: HeldOut, seen: Sequence[tuple[str, str] | None]) -> dict[str, Any]:
    """What `gain.json` says of a recorded run."""
    config = run.config
    known = seen and None not in seen
    return {
        "run": run.name,
        "controller": config.controller,
        "case": config.case,
        "minutes": config.minutes,
        "seed": config.seed,
        "like_the_naming_run": (config.controller, config.case) in seen if known else None,
    }


def _given(
    held: Sequence[Path],
    models: _Models,
    true: ModelFile | None,
    judged: frozenset[int] | None,
) -> list[Recorded | Given]:
    """A lab's runs; robots that nothing was named of are the healthy ones."""
    drive = models.file.nominal_drive
    tasks: list[Recorded | Given] = []
    for name, table in _runs(held, drive):
        tasks.append(Given(name, table, models.named(true), models.tables, drive, judged))
        sound = set(table["robot"].unique().tolist()) - (judged or set())
        if judged is not None and sound:
            plain, rest = {HEALTHY: models.plain}, frozenset(sound)
            tasks.append(Given(name, table, plain, models.tables, drive, rest))
    return tasks


def _sound(healthy: Sequence[Path], models: _Models) -> list[Recorded | Given]:
    """Runs of robots known to be sound."""
    drive, plain = models.file.nominal_drive, {HEALTHY: models.plain}
    return [
        Given(f"healthy {name}", table, plain, models.tables, drive, None)
        for name, table in _runs(healthy, drive)
    ]


def _runs(logs: Sequence[Path], drive: Drive) -> list[tuple[str, pd.DataFrame]]:
    """Every run of some logs, by name."""
    runs = []
    for path in logs:
        table = read_log(path, drive=drive).frame
        names = table["run"].astype(str)
        for name, part in table.groupby(names, sort=False):
            label = f"{path.name}/{name}" if names.nunique() > 1 else path.name
            runs.append((label, part))
    return runs


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
