"""One experiment: a swarm forages in reality, its robots evolving on board, all of it logged.

A run is a function of (configuration, seed). One SeedSequence is spawned by purpose: the world, the
controllers' streams, the robots' evolution, the moments they are switched on, how they are built.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from realitygap.embedded_sim import CONTROL_STEP, SCENARIOS, Behaviour, PointModel
from realitygap.embedded_sim.breeding import Breeder, CoEvolution, Fixed
from realitygap.embedded_sim.genome import GENOMES, PAPER, Bounding, Genome, reading
from realitygap.embedded_sim.onboard import Swarm
from realitygap.embedded_sim.probes import PREFIX, probe
from realitygap.reality import constants as k
from realitygap.reality.arena import ForagingArena
from realitygap.reality.effects import parse_effects
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.hardware import Build, lamp_power
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.reality.world import World
from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.provenance import versions, write_json
from realitygap.studies.run.manoeuvre import Manoeuvre
from realitygap.studies.run.recorder import Recorder, RunTables
from realitygap.studies.run.wider import widened

if TYPE_CHECKING:
    from realitygap.reality.effects import Effect

Case = Literal[
    "no-light",
    "light-at-nest",
    "light-opposite-nest",
    "at-nest-to-opposite",
    "opposite-to-at-nest",
]
OPPOSITE, NONE, AT_NEST = (SCENARIOS.index(name) for name in ("opposite", "none", "at_nest"))

ANONYMOUS = "log"
"""Name of a run whose log is diagnosed by somebody who must not know what kind of run it is."""

HALVES: dict[Case, tuple[int, int]] = {
    "no-light": (NONE, NONE),
    "light-at-nest": (AT_NEST, AT_NEST),
    "light-opposite-nest": (OPPOSITE, OPPOSITE),
    "at-nest-to-opposite": (AT_NEST, OPPOSITE),
    "opposite-to-at-nest": (OPPOSITE, AT_NEST),
}
"""Lamp scenario in the first and second half of a run (paper, III-A, III-I)."""

GenomeName = Literal["paper", "continuous"]

Controller = Literal[
    "coevolution",
    "search",
    "positive-phototaxis",
    "negative-phototaxis",
    "to-and-fro",
    "half-to-and-fro",
    "most-to-and-fro",
]


def _known_probe(controller: str) -> str:
    """A controller `probe:NAME`, if there is such a manoeuvre."""
    if not controller.startswith(PREFIX):
        raise ValueError(f"a controller or {PREFIX}NAME")
    return PREFIX + probe(controller.removeprefix(PREFIX)).name


FIXED_GENOMES: dict[str, tuple[float, float]] = {
    "search": (0.5, 0.5),
    "positive-phototaxis": (0.9, 0.5),
    "negative-phototaxis": (0.1, 0.5),
}
"""The fixed optimal controllers (III-I): phototaxis while carrying food, search otherwise."""

FIXED_SWARMS: dict[str, tuple[tuple[float, float], ...]] = {
    **{name: (genome,) for name, genome in FIXED_GENOMES.items()},
    "to-and-fro": ((0.9, 0.1),),
    "half-to-and-fro": (FIXED_GENOMES["positive-phototaxis"], (0.9, 0.1)),
    "most-to-and-fro": (*(FIXED_GENOMES["positive-phototaxis"], (0.9, 0.1)) * 3, *[(0.9, 0.1)] * 4),
}
"""Every fixed controller: genomes dealt to the robots by turns. `to-and-fro` approaches the light
with food and leaves it without; of `half-to-and-fro` every second robot does, of `most-to-and-fro`
seven of ten."""

Minutes = Annotated[float, Field(gt=0.0, le=1440.0, allow_inf_nan=False)]
"""Simulated; at most a day."""
Robots = Annotated[int, Field(ge=1, le=100)]
"""More do not find room in the nominal arena."""
MOST_ROBOTS = 1000
"""In a wider one; our choice: five times as many as were tried."""
Seed = Annotated[int, Field(ge=0, le=2**63 - 1)]
BuildSpread = Annotated[float, Field(ge=0.0, le=0.1, allow_inf_nan=False)]
"""Relative s.d.; at most a tenth, so that no part comes near nothing."""
Trials = Annotated[int, Field(ge=1, le=1000)]
"""Embedded trials per genome."""

RADIO_STEPS = round(k.RADIO_PERIOD / CONTROL_STEP)


class RunConfig(BaseModel):
    """Everything a run depends on, but for what is hidden in it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    case: Case = "light-at-nest"
    controller: Controller | Annotated[str, AfterValidator(_known_probe)] = "coevolution"
    minutes: Minutes = 60.0
    robots: Annotated[int, Field(ge=1, le=MOST_ROBOTS)] = 10
    seed: Seed = 0
    model: str | None = None
    """Model file on board; None: the shipped nominal e-puck."""
    reading: str = "default"
    trials: Trials = 1
    genome: GenomeName = "paper"
    """What co-evolves of a controller; a fixed one has no genes that do."""
    samples: bool = True
    environment_sd: Annotated[float, Field(gt=0.0, le=10.0)] | None = None
    """s.d. of S0's mutation; None: as the reading has it."""
    bounding: Bounding | None = None
    """Rule for genes out of range; None: as the reading has it."""
    lamp_range: Annotated[float, Field(ge=0.1, le=10.0)] | None = None
    """m from the lamp at which its contrast fades; None: the nominal lamp."""
    build_spread: BuildSpread = 0.0
    """By how much robots of this make differ; 0: they are all alike."""
    engine: EngineName = DEFAULT
    """Of the world's physics."""
    rays: RaysName = DEFAULT_RAYS
    arena_radius: Annotated[float, Field(ge=0.4, le=10.0)] = k.ARENA_RADIUS
    """m; nest and lamps move with the wall, and food stays as dense. At least, so that food finds
    room beside the nest."""

    @property
    def steps(self) -> int:
        """Control steps, at least one."""
        return max(1, round(self.minutes * 60.0 / CONTROL_STEP))


def simulate(
    config: RunConfig,
    effects: tuple[str, ...],
    out: Path,
    progress: Callable[[int], None] = lambda step: None,
    unlisted: Mapping[str, Effect] = MappingProxyType({}),
    name: str | None = None,
    model: Model | None = None,
) -> dict[str, float]:
    """Run one experiment and write its files into an existing directory.

    Args:
        config: What to run.
        effects: SPECs of what to hide in reality.
        out: Directory for the tables, `run.json` and `truth.json`.
        progress: Called with the number of control steps done, about once a simulated second.
        unlisted: Effects that may be hidden though the catalogue lacks them.
        name: Of the run in its tables; None: case, controller and seed.
        model: On board; None: as the configuration says.

    Returns:
        Totals: deposits, radio messages, wall seconds.

    Raises:
        InputError: an effect, model or reading that cannot be used.
        Diverged: the physics or the point model left the finite numbers; says where.
    """
    began = time.perf_counter()
    hidden = parse_effects(effects, config.robots, unlisted)
    believed = model or Model.load(config.model)
    arena = ForagingArena(config.arena_radius)
    # refused if wrong, whoever is to use it
    models = [widened(model, arena) for model in believed.on_board(config.robots)]
    inputs = believed.entries()
    behaviour = Behaviour()
    world_seed, swarm_seed, evolution_seed, start_seed, build_seed = np.random.SeedSequence(
        config.seed
    ).spawn(5)
    build = Build.drawn(config.robots, config.build_spread, build_seed)
    swarm: Swarm | Manoeuvre
    if config.controller.startswith(PREFIX):
        swarm = Manoeuvre(
            config.controller.removeprefix(PREFIX),
            config.robots,
            models[0],
        )
    else:
        breeder = _breeder(config, models, behaviour, evolution_seed)
        starts = np.random.default_rng(start_seed).uniform(0.0, k.START_WITHIN, config.robots)
        start_steps = np.minimum(np.round(starts / CONTROL_STEP), config.steps - 1)
        swarm = Swarm(
            swarm_seed,
            breeder=breeder,
            behaviour=behaviour,
            start_steps=start_steps.astype(np.int64),
        )
    world = World(
        config.robots,
        world_seed,
        effects=hidden,
        poses=swarm.starts if isinstance(swarm, Manoeuvre) else None,
        lamp_power=_lamp_power(config),
        build=build,
        engine=config.engine,
        rays=config.rays,
        arena=arena,
    )
    try:
        run = name or run_name(config)
        with Recorder(
            out, config.case, run, config.robots, config.samples, engine=config.engine
        ) as recorder:
            _loop(config, world, swarm, recorder, progress)
            messages = world.radio.messages
            tables = recorder.finish(swarm, _genome(config))
    finally:
        world.close()
    totals = {
        "deposits": float(len(tables.deposits)),
        "radio_messages": float(messages),
        "wall_seconds": time.perf_counter() - began,
    }
    write_json(out / "truth.json", {"effects": [one.truth() for one in hidden], **build.truth()})
    _write_notes(out, config, inputs, totals)
    return totals


def run_name(config: RunConfig) -> str:
    """Name of a run in its tables."""
    return f"{config.case}-{config.controller}-{config.seed}"


def _breeder(
    config: RunConfig,
    models: list[PointModel],
    behaviour: Behaviour,
    seed: np.random.SeedSequence,
) -> Breeder:
    if config.controller in FIXED_SWARMS:
        return Fixed(*FIXED_SWARMS[config.controller])
    if config.lamp_range is not None:  # a lab would capture its tables from this lamp
        brighter = _lamp_power(config) / k.LAMP_POWER
        models = [replace(model, lamp_gain=model.lamp_gain * brighter) for model in models]
    return CoEvolution(
        seed.spawn(config.robots),
        models=models,
        behaviour=behaviour,
        reading=reading(
            config.reading, environment_sd=config.environment_sd, bounding=config.bounding
        ),
        trials=config.trials,
        genome=_genome(config),
    )


def _genome(config: RunConfig) -> Genome:
    """What a robot's controllers are made of."""
    return PAPER if config.controller in FIXED_SWARMS else GENOMES[config.genome]


def _lamp_power(config: RunConfig) -> float:
    """Counts m^2 of the run's lamp."""
    return k.LAMP_POWER if config.lamp_range is None else lamp_power(config.lamp_range)


def _loop(
    config: RunConfig,
    world: World,
    swarm: Swarm | Manoeuvre,
    recorder: Recorder,
    progress: Callable[[int], None],
) -> None:
    """The 40 ms loop: sense, control, record, act."""
    first, second = HALVES[config.case]
    half = config.steps // 2
    world.light.set_scenario(first)
    scenario = first
    tracker = world.tracker
    for step in range(config.steps):
        if step == half and second != first:
            world.light.set_scenario(second)
            scenario = second
        world.sense()
        if isinstance(swarm, Manoeuvre):
            tracker.locate(swarm.carrying)
            swarm.follow(tracker.poses)
        else:
            _forage(step, world, swarm)
        recorder.sample(step, world, swarm, scenario)
        world.act(swarm.commands)
        if step % 25 == 0:
            progress(step)
    progress(config.steps)
    if isinstance(swarm, Swarm):
        swarm.finish(config.steps)


def _forage(step: int, world: World, swarm: Swarm) -> None:
    """The controllers answer what is sensed; food and radio take their course."""
    tracker = world.tracker
    tracker.locate(swarm.carrying)
    swarm.step(step, world.infrared.counts, world.light.counts, tracker.on_food, tracker.on_nest)
    if swarm.picked.any():
        for robot in np.flatnonzero(swarm.picked).tolist():
            world.replace_food(robot)
    if step % RADIO_STEPS == 0:
        world.radio.exchange(world.poses, swarm.active)
        swarm.hear(world.radio.heard, step)


def _write_notes(
    out: Path,
    config: RunConfig,
    inputs: list[dict[str, str]],
    totals: dict[str, float],
) -> None:
    write_json(
        out / "run.json",
        {
            "schema": 1,
            "config": config.model_dump(),
            "seed": config.seed,
            "inputs": inputs,
            "versions": versions(),
            **totals,
        },
    )


__all__ = ["FIXED_GENOMES", "HALVES", "Case", "Controller", "RunConfig", "RunTables", "simulate"]
