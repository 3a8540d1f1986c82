"""The held-out runs: recorded in the altered reality, or a lab's; each is measured where it is.

A recorded run has a healthy twin: the same seed, case and controller with nothing hidden. What the
minimal model gets wrong of the twin is the level that an extension can reach.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from realitygap.embedded_sim.model import Drive
from realitygap.embedded_sim.tables import Tables
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.measured import MeasuredLog, make_log, read_log
from realitygap.models.naming.claims.prediction import prediction_errors
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import Case, RunConfig, simulate

KINDS: tuple[tuple[str, Case], ...] = (
    ("search", "no-light"),
    ("coevolution", "light-at-nest"),
    ("positive-phototaxis", "light-at-nest"),
    ("coevolution", "light-opposite-nest"),
    ("search", "light-opposite-nest"),
    ("probe:tour", "light-at-nest"),
)
"""Controllers and cases of the recorded runs, in turn: whatever an extension was named from, most
of them are another, and one is a manoeuvre that no forager makes."""
BEFORE, HEALTHY, EXTENDED, ORACLE = "before", "healthy", "extended", "oracle"


@dataclass(frozen=True)
class HeldOut:
    """One run to be recorded."""

    index: int
    config: RunConfig
    effects: tuple[str, ...]
    """SPECs of the altered reality; none: the healthy twin."""
    robots: frozenset[int] | None
    """Whose errors are kept; None: all."""

    @property
    def name(self) -> str:
        """In tables."""
        return f"{self.index:02d}"


@dataclass(frozen=True)
class Recorded:
    """A run to record, and the models to measure in it."""

    run: HeldOut
    models: dict[str, ModelFile]
    tables: Tables | None
    drive: Drive


@dataclass(frozen=True)
class Given:
    """One run of a lab's log, and the models to measure in it."""

    name: str
    table: pd.DataFrame
    models: dict[str, ModelFile]
    tables: Tables | None
    drive: Drive
    robots: frozenset[int] | None
    run: HeldOut | None = None


def plan(
    effects: tuple[str, ...],
    *,
    runs: int,
    minutes: float,
    robots: int,
    seed: int,
    engine: EngineName = DEFAULT,
    rays: RaysName = DEFAULT_RAYS,
    judged: frozenset[int] | None = None,
) -> list[HeldOut]:
    """Runs to record; seeds follow from `seed` and the number, not from the effects."""
    planned = []
    for index in range(runs):
        controller, case = KINDS[index % len(KINDS)]
        own = np.random.SeedSequence(seed, spawn_key=(index,)).generate_state(1, np.uint32)[0]
        config = RunConfig(
            case=case,
            controller=controller,
            minutes=minutes,
            robots=robots,
            seed=int(own),
            engine=engine,
            rays=rays,
        )
        planned.append(HeldOut(index, config, effects, judged))
    return planned


def measure_recorded(task: Recorded) -> pd.DataFrame:
    """Record a run, measure every model in it and forget it. Executed by a worker."""
    with scratch() as room:
        simulate(task.run.config, task.run.effects, room)
        log = read_log(room, drive=task.drive)
    return _kept(log, task.models, task.tables, task.run.robots, task.run.name)


def measure_given(task: Given) -> pd.DataFrame:
    """Measure every model in a run that a lab has recorded. Executed by a worker."""
    log = make_log(task.table, drive=task.drive)
    return _kept(log, task.models, task.tables, task.robots, task.name)


def _kept(
    log: MeasuredLog,
    models: dict[str, ModelFile],
    tables: Tables | None,
    robots: frozenset[int] | None,
    name: str,
) -> pd.DataFrame:
    """Errors of the robots that are judged."""
    table = prediction_errors(log, models, tables)
    if robots is not None:
        table = table[table["robot"].isin(robots)]
    return table.assign(run=name)
