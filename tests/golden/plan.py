"""Which logs are kept, and how each is made: a function of its name.

Every effect of the catalogue at four times its bar in one robot, causes that a whole swarm has,
two causes in one robot, what no catalogue lists, and healthy robots in every kind of run. Most logs
have just the columns that their effect shows in, so that they stay small.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from realitygap.studies.blind.trials import EFFECTS, ENTRIES, Hidden, Trial
from realitygap.studies.hidden.menu import MENU, STRANGE
from realitygap.studies.run.experiment import RunConfig

SEED = 14
ROBOTS = 3
"""The fewest that are judged as a swarm."""
ILL = 1
"""The robot with an effect of its own."""
SECONDS = 50.0
"""s of log; our choice: a robot moves freely for the 30 s of them that a small cause needs."""
BARS = 4.0
"""Times its bar that an effect is hidden at."""
INFRARED = tuple(f"ps{k}" for k in range(8))
LIGHT = tuple(f"ls{k}" for k in range(8))
TASK = ("food", "nest")
WHEELS = ("wheel_left", "wheel_right")
ALL = (*INFRARED, *LIGHT, *TASK, *WHEELS)
SHOWN = {"motion": (), "infrared": INFRARED, "light": LIGHT, "task": TASK}
"""Columns, beside poses and commands, that a kind of effect shows in."""

PAIRS = (
    ("wheel_radius_mismatch", "command_latency"),
    ("wheel_radius_scale", "tracker_yaw_offset"),
    ("wheel_separation", "motor_lag"),
    ("motor_saturation", "clock_offset"),
    ("wheel_separation", "motor_dead_zone"),
    ("weak_motor", "wheel_radius_mismatch"),
    ("wheel_radius_mismatch", "ir_gain"),
    ("ir_rotation", "ir_offset"),
)
"""Two in one robot: near in what they do, and far apart."""
HEALTHY = (
    ("search", "no-light", ()),
    ("search", "light-at-nest", ALL),
    ("coevolution", "light-opposite-nest", ALL),
    ("positive-phototaxis", "light-at-nest", LIGHT),
    ("negative-phototaxis", "light-opposite-nest", LIGHT),
    ("to-and-fro", "at-nest-to-opposite", TASK),
    ("half-to-and-fro", "opposite-to-at-nest", INFRARED),
    ("probe:tour", "light-at-nest", INFRARED),
    ("probe:spins", "no-light", ()),
)
"""Controller, case and columns of runs with nothing hidden."""


@dataclass(frozen=True)
class Kept:
    """One log."""

    name: str
    trial: Trial
    columns: tuple[str, ...]
    """Beside poses and commands."""


def plan() -> dict[str, Kept]:
    """Every log by name."""
    kept = [*_hidden(), *_healthy()]
    return {one.name: one for one in kept}


def _hidden() -> Iterator[Kept]:
    for name in MENU:
        yield _kept(f"single-{name}", (name,))
    for name, entry in MENU.items():
        if entry.swarm_bar and EFFECTS[name].per_robot:
            yield _kept(f"swarm-{name}", (name,), swarm=True)
    for pair in PAIRS:
        yield _kept(f"pair-{'-'.join(pair)}", pair)
    for name in STRANGE:
        yield _kept(f"unlisted-{name}", (name,))


def _healthy() -> Iterator[Kept]:
    for controller, case, columns in HEALTHY:
        name = f"healthy-{controller.replace(':', '-')}-{case}"
        run = {"controller": controller, "case": case, "seed": _seed(name)}
        yield Kept(name, _trial(run, ()), columns)


def _kept(name: str, effects: tuple[str, ...], *, swarm: bool = False) -> Kept:
    """A log with these hidden."""
    random = np.random.default_rng(_seed(name))
    lit = any(ENTRIES[effect].lit for effect in effects)
    run = {
        "controller": "search",
        "case": "light-at-nest" if lit else "no-light",
        "seed": int(random.integers(2**31)),
    }
    hidden = tuple(_hide(effect, random, swarm=swarm) for effect in effects)
    shown = {column for effect in effects for column in SHOWN[EFFECTS[effect].kind]}
    return Kept(name, _trial(run, hidden), tuple(column for column in ALL if column in shown))


def _hide(effect: str, random: np.random.Generator, *, swarm: bool) -> Hidden:
    entry = ENTRIES[effect]
    bar = entry.swarm_bar if swarm else entry.bar
    size = min(BARS * bar, entry.largest)
    values = {
        key: float(value) if isinstance(value, int | float) else str(value)
        for key, value in entry.values(size, random).items()
    }
    robots = () if swarm or not EFFECTS[effect].per_robot else (ILL,)
    return Hidden(effect, values, robots, size, BARS)


def _trial(run: dict[str, object], hidden: tuple[Hidden, ...]) -> Trial:
    config = RunConfig.model_validate({"minutes": SECONDS / 60.0, "robots": ROBOTS, **run})
    return Trial(0, "single" if hidden else "healthy", SECONDS, config, hidden)


def _seed(name: str) -> int:
    """Of a log: another log in the plan changes none."""
    return int(np.random.SeedSequence([SEED, zlib.crc32(name.encode())]).generate_state(1)[0])
