"""The gain over the whole catalogue: every effect hidden, named from one log, measured on others.

Effects of single robots share runs, five robots of ten having one each; lamps, wall and nest have
runs of their own. Nothing of the held-out runs (other seeds, controllers and cases) was seen by the
diagnosis, which gets one log alone.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from realitygap.models.belief.modelfile import find_model_file, read_model_file
from realitygap.models.belief.tables import load_tables
from realitygap.reality.effects import catalogue, parse_effects
from realitygap.studies.blind.examiner import LOG
from realitygap.studies.blind.record import diagnose, record
from realitygap.studies.blind.trials import Hidden
from realitygap.studies.gain.held_out import true_model
from realitygap.studies.gain.runs import (
    BEFORE,
    EXTENDED,
    HEALTHY,
    ORACLE,
    HeldOut,
    Recorded,
    measure_recorded,
    plan,
)
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.measure.gain_rows import rows_of
from realitygap.studies.plumbing.execution import Unfinished, Workers
from realitygap.studies.plumbing.manifest import Pieces, made
from realitygap.studies.plumbing.provenance import as_json_bytes
from realitygap.studies.plumbing.resumed import resumed
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import Case, RunConfig

BEGUN = "catalogue.json"
"""What a catalogue's directory was begun with."""
GROUPS = "groups"
"""Folder of its pieces."""
ANSWER, ERRORS = "answer.json", "errors.parquet"
"""Files of a piece."""
ROBOTS = 10
CROWD = 5
"""Robots of a run that each have an effect of their own."""
MINUTES = 2.0
"""Simulated, of the log that names."""
NAMING: tuple[tuple[str, Case], ...] = (
    ("coevolution", "light-at-nest"),
    ("search", "light-opposite-nest"),
)
"""Controller and case of the logs that name, in turn."""
HIDDEN_BY_NATURE = ("floor_tilt",)
"""Effects that no model has a term for: never named."""


@dataclass(frozen=True)
class Group:
    """One log that names, and the held-out runs of the same altered reality."""

    index: int
    hidden: tuple[Hidden, ...]
    naming: RunConfig
    runs: int
    minutes: float
    seed: int
    """Of the held-out runs."""

    def held_out(self, effects: tuple[str, ...]) -> list[HeldOut]:
        """The runs, with the effects or, without any, healthy."""
        return plan(effects, runs=self.runs, minutes=self.minutes, robots=ROBOTS, seed=self.seed)

    @property
    def specs(self) -> tuple[str, ...]:
        """As `--effect` takes them."""
        return tuple(one.spec for one in self.hidden)


def groups(
    names: Sequence[str], *, times: float, runs: int, minutes: float, seed: int, draws: int
) -> tuple[Group, ...]:
    """All groups; sizes are `times` the bars of the blind battery's menu."""
    own = [name for name in names if catalogue()[name].per_robot]
    crowds = [own[k : k + CROWD] for k in range(0, len(own), CROWD)]
    alone = [[name] for name in names if name not in own]
    planned = []
    for index, members in enumerate((crowds + alone) * draws):
        random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))
        robots = random.choice(ROBOTS, len(members), replace=False).tolist()
        hidden = []
        for name, robot in zip(members, robots, strict=True):
            entry = MENU[name]
            size = min(times * entry.bar, entry.largest)
            values, who = entry.drawn(size, random), (robot,) if catalogue()[name].per_robot else ()
            hidden.append(Hidden(name, values, who, size, times if entry.bar else 1.0))
        controller, case = NAMING[index % len(NAMING)]
        naming = RunConfig(
            case=case,
            controller=controller,
            minutes=MINUTES,
            robots=ROBOTS,
            seed=int(random.integers(2**31)),
        )
        planned.append(Group(index, tuple(hidden), naming, runs, minutes, seed))
    return tuple(planned)


def measure_group(group: Group) -> tuple[dict[str, Any], pd.DataFrame]:
    """Hide, name from one log, extend, measure. Executed by a worker.

    Returns:
        The diagnosis, and errors before, extended and with the true parameters.
    """
    with scratch() as given:
        record(group.naming, group.specs, given / LOG)
        answer, error = diagnose(given)
        if answer is None:
            raise RuntimeError(f"no diagnosis: {error}")
        file = read_model_file(given / "diagnosis" / "extended.toml")
        assert file.sensors is not None
        tables = load_tables(given / "diagnosis" / file.sensors.tables)
    minimal = file.model_copy(update={"extension": None})
    models = {BEFORE: minimal, EXTENDED: file}
    true = true_model(minimal, parse_effects(group.specs, ROBOTS))
    if true is not None:
        models[ORACLE] = true
    held = group.held_out(group.specs)
    drive = file.nominal_drive
    parts = [measure_recorded(Recorded(one, models, tables, drive)) for one in held]
    return answer, pd.concat(parts, ignore_index=True)


def measure_health(group: Group) -> tuple[dict[str, Any], pd.DataFrame]:
    """The healthy twins of the held-out runs, the same for every group."""
    path = find_model_file()
    file = read_model_file(path)
    assert file.sensors is not None
    tables = load_tables(path.parent / file.sensors.tables)
    held = group.held_out(())
    models, drive = {HEALTHY: file}, file.nominal_drive
    parts = [measure_recorded(Recorded(one, models, tables, drive)) for one in held]
    return {}, pd.concat(parts, ignore_index=True)


def _work(task: tuple[Group, bool]) -> tuple[dict[str, Any], pd.DataFrame]:
    group, healthy = task
    return measure_health(group) if healthy else measure_group(group)


def run_catalogue(
    planned: Sequence[Group],
    asked: Mapping[str, Any],
    out: Path,
    workers: Workers,
    say: Callable[[str], None] = lambda text: None,
) -> pd.DataFrame:
    """Measure what is missing in `out` and return a row per effect.

    Args:
        planned: What to measure.
        asked: What the groups follow from, but for how many there are.
        out: The catalogue's directory.
        workers: Where.
        say: Told in a line of what is done, and of what went wrong.

    Raises:
        InputError: `out` belongs to another catalogue or program, or is in use.
        Unfinished: the healthy runs could not be measured.
        WorkersLost: workers keep dying.
    """
    with resumed(out, BEGUN, GROUPS, "a catalogue", asked):
        pieces = Pieces(out / GROUPS, "group")
        failed = _measure(pieces, planned, workers, say)
        if HEALTHY in failed:
            raise Unfinished(f"the healthy runs could not be measured: {failed[HEALTHY]}")
        healthy = _kept(pieces, HEALTHY)[1]
        done = [group for group in planned if _name(group, False) not in failed]
        rows = [
            rows_of(
                group.hidden, group.seed, group.naming, *_kept(pieces, _name(group, False)), healthy
            )
            for group in done
        ]
    return pd.DataFrame([row for part in rows for row in part])


def _measure(
    pieces: Pieces, planned: Sequence[Group], workers: Workers, say: Callable[[str], None]
) -> dict[str, str]:
    """Measure the groups that are missing; returns errors by the name of a group that failed."""
    tasks = [(planned[0], True), *((one, False) for one in planned)]
    wanted = {_name(*task): _made_from(*task) for task in tasks}
    missing = set(pieces.missing(wanted, say))
    left = [task for task in tasks if _name(*task) in missing]
    failed = {}
    with closing(made(_work, left, workers, note=say)) as finished:
        for one in finished:
            name = _name(*one.task)
            if one.value is None:
                failed[name] = str(one.error)
                say(f"{name}: {one.error}")
                continue
            answer, table = one.value
            content = {ANSWER: as_json_bytes(answer), ERRORS: table.to_parquet()}
            pieces.keep(name, wanted[name], content)
            say(f"{name}: done")
    return failed


def _kept(pieces: Pieces, name: str) -> tuple[dict[str, Any], pd.DataFrame]:
    """A whole group's diagnosis and errors."""
    path = pieces.path(name)
    answer: dict[str, Any] = json.loads((path / ANSWER).read_bytes())
    return answer, pd.read_parquet(path / ERRORS)


def _name(group: Group, healthy: bool) -> str:
    return HEALTHY if healthy else f"group-{group.index:02d}"


def _made_from(group: Group, healthy: bool) -> dict[str, Any]:
    """All that a group's errors are a function of but the program."""
    held = {"runs": group.runs, "minutes": group.minutes, "seed": group.seed}
    if healthy:
        return held
    return {
        **held,
        "hidden": [asdict(one) for one in group.hidden],
        "naming": group.naming.model_dump(mode="json"),
    }
