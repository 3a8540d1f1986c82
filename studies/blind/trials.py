"""The plan of a battery: what is hidden in which run, a function of the seed alone.

A trial's draw depends on the seed and its number, so that more trials extend a battery.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Annotated, Any, Literal, get_args

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.reality.effects import catalogue
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.blind.unlisted import UNLISTED
from realitygap.studies.hidden.menu import MENU, STRANGE, Value
from realitygap.studies.run.experiment import BuildSpread, Case, Controller, RunConfig, Seed
from realitygap.studies.run.settings import checked

Kind = Literal["healthy", "single", "pair", "unlisted", "left_out", "rest"]
"""`left_out`: an effect whose cause the diagnosis must do without; `rest`: the robots of a crowd
that have nothing."""
Drawn = Literal["healthy", "single", "swarm", "pair", "unlisted"]
"""What can be asked for; `swarm`: a single effect that the whole swarm has."""
ROUND: tuple[Drawn, ...] = (
    "single", "healthy", "single", "single", "pair", "single", "unlisted", "single",
)  # fmt: skip
"""Kinds in turn; our choice: most trials go to the limits, an eighth each to the others."""
SECONDS = (120.0, 120.0, 120.0, 60.0, 240.0)
"""s of log, drawn evenly; 120 s is what the bars are stated for."""
SPAN = 4.0
"""Sizes are log-uniform from bar / SPAN to bar * SPAN."""
SWARM_SHARE = 0.2
"""Of the trials of an effect that the whole swarm can have."""
SAME_ROBOT = 0.5
"""Of the pairs in which one robot has both."""
GOLDEN = 0.6180339887498949
"""Steps by it spread any number of sizes evenly."""
PLASTIC = 0.7548776662466927
"""Steps by it spread the effects' first sizes evenly, and independently of the former."""
CONTROLLERS: tuple[Controller, ...] = ("coevolution", "search")
CASES: tuple[Case, ...] = ("light-at-nest", "light-opposite-nest", "no-light")
LIT = CASES[:2]
ENTRIES = {**MENU, **STRANGE}
EFFECTS = {**catalogue(), **UNLISTED}


class BlindConfig(BaseModel):
    """What a battery is."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    trials: Annotated[int, Field(ge=1, le=100_000)] = 200
    seed: Seed = 0
    robots: Annotated[int, Field(ge=3, le=100)] = 10
    build_spread: BuildSpread = 0.0
    """Of every run's robots."""
    engine: EngineName = DEFAULT
    rays: RaysName = DEFAULT_RAYS
    reference: str | None = None
    """Healthy reference of every diagnosis; None: the one that it finds."""
    inputs: tuple[dict[str, str], ...] = ()
    """Its files."""
    effects: tuple[str, ...] = ()
    """To draw from; none: a battery of healthy runs."""
    at_bars: bool = False
    """Hide every effect exactly at its bar, for 120 s."""
    kinds: tuple[Drawn, ...] = ()
    """Of trials, in turn; none: single ones at the bars, a round of everything otherwise."""
    leave_one_out: bool = False
    """Take the cause of each hidden effect out of the catalogue; every trial is one such."""
    crowd: Annotated[int, Field(ge=1)] = 1
    """Robots of a run that each have one effect; more give more trials from one diagnosis."""
    seconds: Annotated[
        tuple[Annotated[float, Field(ge=1.0, le=86_400.0, allow_inf_nan=False)], ...],
        Field(min_length=1),
    ] = SECONDS
    """s of log, drawn evenly; the first at the bars."""


def blind_config(**values: Any) -> BlindConfig:
    """A battery's configuration.

    Raises:
        InputError: the first value that cannot be used.
    """
    for name in values.get("effects", ()):
        if name not in MENU:
            raise InputError("--only", repr(name), nearest(name, MENU))
    for kind in values.get("kinds", ()):
        if kind not in get_args(Drawn):
            raise InputError("--kind", repr(kind), nearest(kind, get_args(Drawn)))
    config = checked(BlindConfig, values)
    if "swarm" in config.kinds and not any(MENU[name].swarm_bar for name in config.effects):
        able = ", ".join(name for name, entry in MENU.items() if entry.swarm_bar)
        raise InputError("--kind", "swarm", f"an effect among {able}")
    if "pair" in config.kinds and len(config.effects) < 2:
        raise InputError("--kind", "pair", "two effects or more to draw from")
    if config.kinds and config.leave_one_out:
        raise InputError("--kind", ", ".join(config.kinds), "nothing with --leave-one-out")
    if config.crowd > config.robots:
        raise InputError("--crowd", config.crowd, f"at most the {config.robots} robots of a run")
    return config


@dataclass(frozen=True)
class Hidden:
    """One effect as it is hidden in a trial."""

    name: str
    values: dict[str, Value]
    robots: tuple[int, ...]
    """Empty: the whole swarm, or the place."""
    size: float
    """In the unit of its menu entry; 0 where it has none."""
    multiple: float
    """Size over the bar that applies; 1 where there is no size."""

    @property
    def spec(self) -> str:
        """As `--effect` takes it."""
        items = [f"{key}={value}" for key, value in self.values.items()]
        items += [f"robot={robot}" for robot in self.robots]
        return f"{self.name}:" + ",".join(items)


@dataclass(frozen=True)
class Trial:
    """One run of the battery."""

    index: int
    kind: Kind
    seconds: float
    run: RunConfig
    hidden: tuple[Hidden, ...]
    looked_at: frozenset[int] | None = None
    """Robots that a score is about; None: all."""

    @property
    def specs(self) -> tuple[str, ...]:
        """What is hidden, as `--effect` takes it."""
        return tuple(one.spec for one in self.hidden)

    @property
    def withheld(self) -> tuple[str, ...]:
        """Causes that the diagnosis must do without."""
        return tuple(one.name for one in self.hidden) if self.kind == "left_out" else ()

    @property
    def name(self) -> str:
        """Of its file."""
        return f"{self.index:05d}"

    @property
    def made_from(self) -> dict[str, Any]:
        """All that its answer is a function of but the program."""
        return {**self.notes(), "run": self.run.model_dump(mode="json")}

    def notes(self) -> dict[str, Any]:
        """As JSON."""
        return {
            "index": self.index,
            "kind": self.kind,
            "seconds": self.seconds,
            "case": self.run.case,
            "controller": self.run.controller,
            "seed": self.run.seed,
            "hidden": [asdict(one) for one in self.hidden],
        }


def plan(config: BlindConfig) -> tuple[Trial, ...]:
    """Every trial of a battery."""
    drawn: Counter[str] = Counter()
    singles = swarms = strange = 0
    trials = []
    for index in range(config.trials):
        random = np.random.default_rng(np.random.SeedSequence(config.seed, spawn_key=(index,)))
        kind = _kind(config, index)
        if kind == "single":
            names = _singles(config, singles)
            singles += len(names)
        elif kind == "swarm":
            shared = [name for name in config.effects if MENU[name].swarm_bar]
            names = [shared[swarms % len(shared)]]
            swarms += 1
        elif kind == "left_out":
            names = [config.effects[index % len(config.effects)]]
        elif kind == "unlisted":
            names = [list(STRANGE)[strange % len(STRANGE)]]
            strange += 1
        else:
            names = _pair(config, random) if kind == "pair" else []
        hidden = _hide(config, names, kind, drawn, random)
        drawn.update(names)
        trials.append(_trial(config, index, "single" if kind == "swarm" else kind, hidden, random))
    return tuple(trials)


def _kind(config: BlindConfig, index: int) -> Drawn | Literal["left_out"]:
    if not config.effects:
        return "healthy"
    if config.leave_one_out:
        return "left_out"
    kinds = config.kinds or (("single",) if config.at_bars else ROUND)
    kind = kinds[index % len(kinds)]
    return "single" if kind == "pair" and len(config.effects) < 2 else kind


def _singles(config: BlindConfig, first: int) -> list[str]:
    """The next effect, and those after it that may sit in other robots of the same run."""
    names = [config.effects[(first + i) % len(config.effects)] for i in range(config.crowd)]
    alone = [not catalogue()[name].per_robot for name in names]
    if alone[0]:
        return names[:1]
    return names[: alone.index(True)] if any(alone) else names


def _pair(config: BlindConfig, random: np.random.Generator) -> list[str]:
    return [str(name) for name in random.choice(config.effects, 2, replace=False)]


def _hide(
    config: BlindConfig,
    names: Sequence[str],
    kind: Drawn | Literal["left_out"],
    drawn: Counter[str],
    random: np.random.Generator,
) -> tuple[Hidden, ...]:
    """Robots and sizes for the effects of a trial."""
    robots = random.choice(config.robots, config.robots, replace=False).tolist()
    if kind == "pair" and random.random() < SAME_ROBOT:
        robots[1] = robots[0]
    may_swarm = not config.at_bars and config.crowd == 1 and kind != "left_out"
    must_swarm = kind == "swarm"
    seen: Counter[str] = Counter()
    hidden = []
    for name, robot in zip(names, robots, strict=False):
        entry = ENTRIES[name]
        swarm = must_swarm or (
            bool(entry.swarm_bar) and may_swarm and random.random() < SWARM_SHARE
        )
        bar = entry.swarm_bar if swarm else entry.bar
        strong = kind in ("pair", "unlisted", "left_out")
        size = _size(config, name, bar, drawn[name] + seen[name], strong)
        seen[name] += 1
        everyone = swarm or not EFFECTS[name].per_robot
        multiple = size / bar if bar else 1.0
        values, robots_of = entry.drawn(size, random), () if everyone else (robot,)
        hidden.append(Hidden(name, values, robots_of, size, multiple))
    return tuple(hidden)


def _size(config: BlindConfig, name: str, bar: float, count: int, strong: bool) -> float:
    """The next size of an effect: around its bar, or clearly above it."""
    if config.at_bars or not bar:
        return bar
    own = list(ENTRIES).index(name) * PLASTIC  # or all effects of a crowd had the same size
    share = (own + (config.seed + count) * GOLDEN) % 1.0
    multiple = 1.5 * SPAN ** (0.5 * share) if strong else SPAN ** (2.0 * share - 1.0)
    return float(min(bar * multiple, ENTRIES[name].largest))


def _trial(
    config: BlindConfig,
    index: int,
    kind: Kind,
    hidden: tuple[Hidden, ...],
    random: np.random.Generator,
) -> Trial:
    seconds = config.seconds[0] if config.at_bars else float(random.choice(config.seconds))
    lit = any(ENTRIES[one.name].lit for one in hidden)
    run = RunConfig(
        case=LIT[random.integers(len(LIT))] if lit else CASES[random.integers(len(CASES))],
        controller=CONTROLLERS[random.integers(len(CONTROLLERS))],
        minutes=seconds / 60.0,
        robots=config.robots,
        build_spread=config.build_spread,
        seed=int(random.integers(2**31)),
        engine=config.engine,
        rays=config.rays,
    )
    return Trial(index, kind, seconds, run, hidden)
