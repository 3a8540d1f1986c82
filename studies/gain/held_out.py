"""Which runs a gain is measured in, and by which models.

With effects, fresh runs of the altered reality and their healthy twins; without, those of the logs
that the extension was not named from. Logs of robots known to be sound stand beside either.

What was hidden is known where somebody says so: from SPECs, or from the `truth.json` beside a run.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pandas as pd
from pydantic import ValidationError

from realitygap.embedded_sim.errors import InputError
from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.named import numbered
from realitygap.models.log.opened import json_values, parsing
from realitygap.models.log.schema import coerce
from realitygap.reality.effects import HiddenEffect, catalogue, parse_effects
from realitygap.reality.effects.spec import parse, spec_of
from realitygap.studies.gain.request import Compared, GainRequest
from realitygap.studies.gain.runs import HEALTHY, Given, HeldOut, Recorded, plan
from realitygap.studies.hidden.shares import oracle
from realitygap.studies.inputs.logs import Source, log_hash, read_logs
from realitygap.studies.inputs.placed import placed
from realitygap.studies.run.settings import run_config

TRUTH = "truth.json"
EXPECTED = "the truth.json of a run"
ANY = 10**9
"""More robots than a run can have: which of them there are is not in the file."""


def hidden_in(run: Path) -> tuple[HiddenEffect, ...] | None:
    """What a run's `truth.json` says; None where there is none, as in a lab, or where it tells of
    something that no catalogue lists.

    Raises:
        InputError: it is no such file.
    """
    path = run / TRUTH
    if not os.path.lexists(path):
        return None
    told = json_values(path, EXPECTED)
    with parsing(str(path), EXPECTED):
        effects = list(told["effects"])
        if any(one["name"] not in catalogue() for one in effects):
            return None
        try:
            return tuple(parse(spec_of(one), catalogue(), ANY) for one in effects)
        except InputError as error:
            raise InputError(str(path), error, EXPECTED) from None


def told(hidden: Sequence[HiddenEffect]) -> str:
    """What is hidden as one line, the same for the same."""
    return json.dumps([one.truth() for one in hidden], sort_keys=True)


def concerned(hidden: Sequence[HiddenEffect]) -> set[int] | None:
    """Robots that something was hidden in; None: all of them."""
    if any(not one.robots for one in hidden):
        return None
    return {robot for one in hidden for robot in one.robots}


def true_model(plain: ModelFile, hidden: Sequence[HiddenEffect]) -> ModelFile | None:
    """The model with the true parameters; None where the point model has no term for an effect, or
    none of that size."""
    causes = [every_cause().get(one.effect.name) for one in hidden]
    if any(cause is None or not cause.identifiable for cause in causes):
        return None
    try:
        return plain.model_copy(update={"extension": oracle(hidden)})
    except ValidationError:
        return None


ROBOTS = 10
"""Of a recorded run, where no log says how many there are."""


@dataclass(frozen=True)
class Chosen:
    """What is measured."""

    tasks: tuple[Recorded | Given, ...]
    runs: list[dict[str, Any]]
    """What `gain.json` says of the held-out runs."""
    judged: frozenset[int] | None
    """Robots named or truly altered; None: all."""
    oracle: bool
    """Whether a model with the true parameters is among the models."""


def choose(request: GainRequest, models: Compared) -> Chosen:
    """The runs, each with its models.

    Raises:
        InputError: a log or effect cannot be used, or nothing is held out.
    """
    held, naming = _apart(request.logs, models.file)
    chosen = _fresh(request, models, naming) if request.effects else _of_logs(request, models, held)
    return replace(chosen, tasks=(*chosen.tasks, *_sound(request.healthy, models)))


def _fresh(request: GainRequest, models: Compared, naming: Sequence[Source]) -> Chosen:
    """Fresh runs and their healthy twins."""
    robots = _robots(request.logs)
    hidden = parse_effects(request.effects, robots)
    _check_truth(naming, hidden)
    true, judged = true_model(models.plain, hidden), _judged(models, hidden)
    if request.runs < 1:
        raise InputError("--runs", request.runs, "at least 1")
    run_config(minutes=request.minutes, robots=robots, seed=request.seed)
    models.check_robots(range(robots))
    settings: dict[str, Any] = {
        "runs": request.runs,
        "minutes": request.minutes,
        "robots": robots,
        "seed": request.seed,
        "engine": request.engine,
        "rays": request.rays,
    }
    altered, twins = plan(request.effects, judged=judged, **settings), plan((), **settings)
    drive = models.file.nominal_drive
    tasks = [Recorded(run, models.named(true), models.tables, drive) for run in altered]
    tasks += [Recorded(run, {HEALTHY: models.plain}, models.tables, drive) for run in twins]
    seen = [_kind(one.path) for one in naming]
    return Chosen((*tasks,), [_notes(run, seen) for run in altered], judged, true is not None)


def _of_logs(request: GainRequest, models: Compared, held: Sequence[Source]) -> Chosen:
    """A lab's runs; the truth is known where it lies beside them."""
    if not held:
        raise InputError(
            "--log",
            ", ".join(one.name for one in request.logs),
            "a log that the extension was not named from, or --effect to record fresh runs",
        )
    truths = [_hidden_in(one) for one in held]
    known = truths[0] if all(one == truths[0] for one in truths) else None
    true = None if known is None else true_model(models.plain, known)
    judged = _judged(models, known or ())
    logs = _read(held, models)
    given = _given(held, logs, models, true, judged)
    models.check_robots({int(robot) for task in given for robot in task.table["robot"].unique()})
    runs = [
        {"run": one.name, "notes": list(log.notes)} for one, log in zip(held, logs, strict=True)
    ]
    return Chosen((*given,), runs, judged, true is not None)


def _apart(logs: Sequence[Source], file: ModelFile) -> tuple[list[Source], list[Source]]:
    """The logs that the extension was not named from, and those it was."""
    digests = [log_hash(one, "--log") for one in logs]
    named_from = "" if file.extension is None else file.extension.log
    if log_hash(logs, "--log") == named_from:
        return [], list(logs)
    both = list(zip(logs, digests, strict=True))
    return (
        [one for one, digest in both if digest != named_from],
        [one for one, digest in both if digest == named_from],
    )


def _robots(logs: Sequence[Source]) -> int:
    """How many robots a recorded run must have for the logs' robots to exist."""
    tables = [one.table() for one in logs]
    known = [t.assign(robot=numbered(t["robot"])[0]) for t in tables if "robot" in t]
    return max((int(coerce(t)["robot"].max()) + 1 for t in known), default=ROBOTS)


def _check_truth(naming: Sequence[Source], hidden: Sequence[HiddenEffect]) -> None:
    """Refuse effects other than those of the run that the extension was named from."""
    for one in naming:
        truth = _hidden_in(one)
        if truth is not None and told(truth) != told(hidden):
            expected = f"what was hidden in {one.name}: {told(truth)}"
            raise InputError("--effect", told(hidden), expected)


def _hidden_in(log: Source) -> tuple[HiddenEffect, ...] | None:
    """What was hidden in a log, where somebody knows."""
    return None if log.path is None else hidden_in(log.path)


def _judged(models: Compared, hidden: Sequence[HiddenEffect]) -> frozenset[int] | None:
    """Robots named or truly altered; None: all."""
    true, named = concerned(hidden), models.robots
    if true is None or named is None or not (true | named):
        return None
    return frozenset(true | named)


def _kind(run: Path | None) -> tuple[str, str] | None:
    """Controller and case of a run's directory; None of a mere log."""
    path = None if run is None else run / "run.json"
    if path is None or not path.is_file():
        return None
    expected = "the run.json of a run"
    content = json_values(path, expected)
    with parsing(str(path), expected):
        return str(content["config"]["controller"]), str(content["config"]["case"])


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
    held: Sequence[Source],
    logs: Sequence[MeasuredLog],
    models: Compared,
    true: ModelFile | None,
    judged: frozenset[int] | None,
) -> list[Given]:
    """A lab's runs; robots that nothing was named of are the healthy ones."""
    drive = models.file.nominal_drive
    tasks = []
    for name, table in _runs(held, logs):
        tasks.append(Given(name, table, models.named(true), models.tables, drive, judged))
        sound = set(table["robot"].unique().tolist()) - (judged or set())
        if judged is not None and sound:
            plain, rest = {HEALTHY: models.plain}, frozenset(sound)
            tasks.append(Given(name, table, plain, models.tables, drive, rest))
    return tasks


def _sound(healthy: Sequence[Source], models: Compared) -> list[Given]:
    """Runs of robots known to be sound."""
    drive, plain = models.file.nominal_drive, {HEALTHY: models.plain}
    return [
        Given(f"healthy {name}", table, plain, models.tables, drive, None)
        for name, table in _runs(healthy, _read(healthy, models))
    ]


def _read(logs: Sequence[Source], models: Compared) -> list[MeasuredLog]:
    """Some logs, each in the frame of the model's arena."""
    read = (read_logs(one, models.file) for one in logs)
    return [placed(log, models.plain, models.tables) for log in read]


def _runs(
    sources: Sequence[Source], logs: Sequence[MeasuredLog]
) -> Iterator[tuple[str, pd.DataFrame]]:
    """Every run of some logs, by name; logs of one name are told apart by their places."""
    short = [one.name if one.path is None else one.path.name for one in sources]
    for number, (log, called) in enumerate(zip(logs, short, strict=True), start=1):
        names = log.frame["run"].astype(str)
        called = f"{number}/{called}" if short.count(called) > 1 else called
        for name, part in log.frame.groupby(names, sort=False):
            yield (f"{called}/{name}" if names.nunique() > 1 else called), part
