"""What the demo hides: drawn from the seed, sealed, read again at the end."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from realitygap.reality import constants as k
from realitygap.studies.blind.trials import Hidden
from realitygap.studies.hidden.menu import MENU, Value
from realitygap.studies.plumbing.provenance import write_json
from realitygap.studies.run.experiment import Case, RunConfig

DRAW = 5
"""Spawn key of the draw, our choice: with it the default seed draws what changes food most."""


@dataclass(frozen=True)
class Draw:
    """One effect as the demo hides it, in the whole swarm or the place."""

    case: Case
    low: float
    high: float
    """Size, in the unit of the blind battery's menu; drawn evenly between both."""
    values: Callable[[float, np.random.Generator], Mapping[str, Value]]
    plainly: str
    """For a reader who knows nothing of simulators."""


def _window(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    """On the wall, at most 15 degrees from the nest."""
    angle = random.uniform(-1.0, 1.0) * math.radians(15.0)
    return {
        "x": round(k.ARENA_RADIUS * math.cos(angle), 3),
        "y": round(k.ARENA_RADIUS * math.sin(angle), 3),
        "intensity": round(size, 2),
    }


def _one_wheel(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    limit = round(k.WHEEL_SPEED_MAX * (1.0 - size), 2)
    return {"limit": limit, "wheel": str(random.choice(("left", "right")))}


def _either_way(key: str, nominal: float) -> Callable[..., Mapping[str, Value]]:
    def values(size: float, random: np.random.Generator) -> Mapping[str, Value]:
        return {key: round(nominal + float(random.choice((-1.0, 1.0))) * size, 3)}

    return values


MENU_OF_THE_DEMO: Mapping[str, Draw] = {
    "second_lamp": Draw(
        case="light-opposite-nest",
        low=1.5,
        high=3.0,
        values=_window,
        plainly="a second light shines near the nest, like a window nobody told the robots of",
    ),
    "wheel_radius_mismatch": Draw(
        case="light-at-nest",
        low=0.08,
        high=0.16,
        values=_either_way("ratio", 1.0),
        plainly="every robot's right wheel differs from the left one, so straight on is a curve",
    ),
    "motor_saturation": Draw(
        case="light-at-nest",
        low=0.45,
        high=0.6,
        values=_one_wheel,
        plainly="one motor of every robot cannot turn as fast as it is told to",
    ),
    "command_latency": Draw(
        case="light-at-nest",
        low=0.12,
        high=0.3,
        values=lambda size, random: {"seconds": round(size, 3)},
        plainly="every command reaches the motors late",
    ),
    "ir_rotation": Draw(
        case="light-at-nest",
        low=0.35,
        high=0.9,
        values=_either_way("angle", 0.0),
        plainly="the ring of sensors is mounted turned on every robot",
    ),
}
"""Effects that are far above their bars and change what robots do. Ranges are our choice."""


@dataclass(frozen=True)
class Secret:
    """What is hidden in all runs of one demo."""

    case: Case
    hidden: Hidden

    @property
    def effects(self) -> tuple[str, ...]:
        """As a run takes them."""
        return (self.hidden.spec,)

    @property
    def plainly(self) -> str:
        """In words."""
        return MENU_OF_THE_DEMO[self.hidden.name].plainly


def draw(seed: int) -> Secret:
    """The effect and its values; a function of the seed."""
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(DRAW,)))
    names = list(MENU_OF_THE_DEMO)
    name = names[int(random.integers(len(names)))]
    one, entry = MENU_OF_THE_DEMO[name], MENU[name]
    size = float(random.uniform(one.low, one.high))
    values = dict(one.values(size, random))
    return Secret(one.case, Hidden(name, values, (), size, size / (entry.swarm_bar or entry.bar)))


def run_seed(seed: int, index: int) -> int:
    """Seed of a demo's run; below 2**32, so that `realitygap run --seed` repeats it."""
    words = np.random.SeedSequence(seed, spawn_key=(0, index)).generate_state(1, np.uint32)
    return int(words[0])


def seal(secret: Secret, config: RunConfig, path: Path) -> str:
    """Write what is hidden and how a run with it is repeated; returns the file's SHA-256."""
    content = {
        "effects": [
            {"name": secret.hidden.name, "robots": "all", "parameters": secret.hidden.values}
        ],
        "spec": secret.hidden.spec,
        "case": config.case,
        "seed": config.seed,
    }
    write_json(path, content)
    return hashlib.sha256(path.read_bytes()).hexdigest()


def unseal(path: Path, digest: str) -> dict[str, Any]:
    """Read the sealed file.

    Raises:
        RuntimeError: it is not what was sealed.
    """
    content = path.read_bytes()
    if hashlib.sha256(content).hexdigest() != digest:
        raise RuntimeError(f"{path}: changed since it was sealed")
    found: dict[str, Any] = json.loads(content)
    return found
