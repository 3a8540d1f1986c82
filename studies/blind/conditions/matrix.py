"""The matrix: every condition by name, and the cells that follow from a configuration.

A cell is one condition under which one log was made, healthy or ill. Logs of the same run and the
same thing hidden are shared by all conditions that change the log alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.reality.effects import catalogue
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.blind.conditions import changes as c
from realitygap.studies.blind.limits import LENGTH
from realitygap.studies.blind.trials import CONTROLLERS, LIT, Hidden, Trial
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.run.experiment import RunConfig, Seed
from realitygap.studies.run.settings import checked

ILL = {
    "motion": "wheel_radius_mismatch",
    "sensor": "ir_rotation",
    "light": "lamp_intensity",
}
"""What is hidden at its bar, by the kind of cell; our choice: of each kind one that logs as they
are recorded always show."""
STATES = ("healthy", *ILL)
SECONDS = LENGTH
"""s of log, as the bars are stated for."""
ROBOTS = 10


@dataclass(frozen=True)
class LogCondition:
    """One way in which logs come out of laboratories."""

    name: str
    meaning: str
    """In a few words."""
    change: c.Change = c.unchanged
    """Of the log."""
    run: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    """Fields of `RunConfig` that are otherwise."""
    arena_radius: float | None = None
    """m that the diagnosis is told; None: it has the shipped model."""


def _arena(radius: float) -> tuple[LogCondition, LogCondition]:
    name, run = f"arena-{radius:g}", {"arena_radius": radius}
    told = f"a wall of {radius:g} m radius"
    return (
        LogCondition(name, f"{told}, as the model has it", run=run, arena_radius=radius),
        LogCondition(f"{name}-unknown", f"{told}; the model has 0.6 m", run=run),
    )


def _robots(number: int) -> LogCondition:
    return LogCondition(f"robots-{number}", f"{number} robots", run={"robots": number})


CONDITIONS: Mapping[str, LogCondition] = {
    one.name: one
    for one in (
        LogCondition("as-recorded", "nothing but that nobody says what recorded it"),
        LogCondition("row-of-2", "every second row", c.every_nth(2)),
        LogCondition("row-of-4", "every fourth row", c.every_nth(4)),
        LogCondition("rate-10", "interpolated to 10 Hz", c.resampled(10.0)),
        LogCondition("rate-12.5", "interpolated to 12.5 Hz", c.resampled(12.5)),
        LogCondition("rate-20", "interpolated to 20 Hz", c.resampled(20.0)),
        LogCondition("rate-50", "interpolated to 50 Hz", c.resampled(50.0)),
        LogCondition("pose-of-2", "a pose in every second row only", c.pose_every(2)),
        LogCondition("pose-of-5", "a pose in every fifth row only", c.pose_every(5)),
        LogCondition("held-2", "every second pose repeats the one before", c.held(2)),
        LogCondition("average-3", "poses averaged over 3 rows, centred", c.averaged(3)),
        LogCondition("average-5", "poses averaged over 5 rows, centred", c.averaged(5)),
        LogCondition(
            "filter-80", "a causal filter of poses, first order, 80 ms", c.lowpassed(0.08)
        ),
        LogCondition("noise-2", "twice the tracker's noise", c.noisier(2.0)),
        LogCondition("noise-4", "four times the tracker's noise", c.noisier(4.0)),
        LogCondition("outliers", "2 % of poses thrown by 0.1 m and 1 rad", c.outliers(0.02)),
        LogCondition(
            "quantised", "in steps of 1 mm and 1 degree", c.quantised(1e-3, math.radians(1))
        ),
        LogCondition("jitter", "stamps off by 5 ms", c.jittered(0.005)),
        LogCondition("merge-nearest", "the nearest command for each pose", c.merged("nearest")),
        LogCondition("merge-backward", "the last command for each pose", c.merged("backward")),
        LogCondition("clock-rate", "a tracker's clock faster by 0.1 %", c.tracker_fast(1e-3)),
        LogCondition("turned-37", "a frame turned by 37 degrees", c.framed(math.radians(37.0))),
        LogCondition("turned-90", "a frame turned by 90 degrees", c.framed(math.pi / 2.0)),
        LogCondition("shifted", "a frame shifted by 2 m along x", c.framed(shift=(2.0, 0.0))),
        LogCondition("scaled", "a tracker whose metre is 1 % short", c.framed(scale=1.01)),
        *_arena(0.5),
        *_arena(0.8),
        *(_robots(number) for number in (1, 2, 3, 6, 15)),
        LogCondition("half-unlogged", "every second robot is not in the log", c.without_odd_robots),
        *(LogCondition(f"seconds-{s}", f"the first {s} s", c.first(s)) for s in (10, 20, 40)),
        LogCondition("no-sensors", "no sensors", c.without("ps", "ls", "food", "nest")),
        LogCondition("no-encoders", "no encoders", c.without("wheel_")),
        LogCondition("no-yaw", "positions without yaw", c.without("yaw")),
        LogCondition("build-0.5", "parts that differ by 0.5 %", run={"build_spread": 0.005}),
        LogCondition("build-1", "parts that differ by 1 %", run={"build_spread": 0.01}),
    )
}
"""By name; 120 s and ten robots where nothing else is said."""


class MatrixConfig(BaseModel):
    """What a matrix is."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    trials: Annotated[int, Field(ge=1, le=10_000)] = 10
    """Logs of each cell."""
    seed: Seed = 0
    engine: EngineName = DEFAULT
    rays: RaysName = DEFAULT_RAYS
    reference: str | None = None
    """Healthy reference of every diagnosis; None: the one that it finds."""
    inputs: tuple[dict[str, str], ...] = ()
    """Its files."""
    conditions: Annotated[tuple[str, ...], Field(exclude=True)] = tuple(CONDITIONS)
    """Not among what a directory was begun with: others may be added."""


def matrix_config(**values: Any) -> MatrixConfig:
    """A matrix's configuration.

    Raises:
        InputError: the first value that cannot be used.
    """
    for name in values.get("conditions", ()):
        if name not in CONDITIONS:
            raise InputError("--only", repr(name), nearest(name, CONDITIONS))
    return checked(MatrixConfig, values)


@dataclass(frozen=True)
class CellLog(Trial):
    """One log of one cell."""

    condition: str = ""
    state: str = ""
    """Of `STATES`."""

    @property
    def name(self) -> str:
        """Of its file."""
        return f"{self.condition}-{self.state}-{self.index:03d}"

    @property
    def random(self) -> np.random.Generator:
        """Of what the condition draws: a function of the run's seed and the condition's name."""
        key = tuple(self.condition.encode())
        return np.random.default_rng(np.random.SeedSequence(self.run.seed, spawn_key=key))

    def notes(self) -> dict[str, Any]:
        """As JSON."""
        return {**super().notes(), "condition": self.condition, "state": self.state}


def plan(config: MatrixConfig) -> tuple[CellLog, ...]:
    """Every log of a matrix, those of one run together.

    Each is a function of the seed, its number and its names: more conditions or logs change none.
    """
    chosen = [CONDITIONS[name] for name in dict.fromkeys(config.conditions)]
    runs: dict[tuple[tuple[str, Any], ...], list[LogCondition]] = {}
    for one in chosen:
        runs.setdefault(tuple(one.run.items()), []).append(one)
    return tuple(
        _cell(config, index, state, one)
        for index in range(config.trials)
        for state in STATES
        for sharing in runs.values()
        for one in sharing
    )


def _cell(config: MatrixConfig, index: int, state: str, condition: LogCondition) -> CellLog:
    """Controller, lamp, seed, the ill robot and what it has are those of all logs of a number."""
    random = np.random.default_rng(np.random.SeedSequence(config.seed, spawn_key=(index,)))
    run = RunConfig(
        **{
            "case": LIT[random.integers(len(LIT))],
            "controller": CONTROLLERS[random.integers(len(CONTROLLERS))],
            "minutes": SECONDS / 60.0,
            "robots": ROBOTS,
            "seed": int(random.integers(2**31)),
            "engine": config.engine,
            "rays": config.rays,
            **condition.run,
        }
    )
    ill = 2 * int(random.random() * math.ceil(run.robots / 2))  # even: logged where half are not
    hidden = {kind: _at_bar(name, ill, random) for kind, name in ILL.items()}
    logged = range(0, run.robots, 2) if condition.change is c.without_odd_robots else None
    return CellLog(
        index=index,
        kind="healthy" if state == "healthy" else "single",
        seconds=SECONDS,
        run=run,
        hidden=(hidden[state],) if state in hidden else (),
        looked_at=None if logged is None else frozenset(logged),
        condition=condition.name,
        state=state,
    )


def _at_bar(name: str, robot: int, random: np.random.Generator) -> Hidden:
    """An effect of that robot, or of the place, as large as must be named."""
    entry = MENU[name]
    robots = (robot,) if catalogue()[name].per_robot else ()
    return Hidden(name, entry.drawn(entry.bar, random), robots, entry.bar, 1.0)
