"""Benchmarks: `python -m studies.bench [--minutes M] [--out FILE]`, or `make bench`.

Ratios of things timed in one process, so that they hold on a slower or busier machine; absolute
figures stand beside them. Medians over repeats where repeats are cheap.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import numpy as np
import typer

from embedded_sim import CONTROL_STEP, Behaviour, PointModel, evaluate
from embedded_sim.breeding import CoEvolution
from embedded_sim.onboard import Swarm
from models import load_model, read_model_file
from models.catalogue import every_cause
from models.extension import Extension, NamedCause, ParameterValue
from reality.engine import Engine
from reality.senses import Infrared, Light, Tracker
from reality.world import World
from studies.convergence import search_commands
from studies.experiment import RunConfig, simulate
from studies.progress import Progress
from studies.provenance import versions, write_json
from studies.recorder import Recorder

ROBOTS = 10
PARTS: tuple[tuple[str, Any, str], ...] = (
    ("physics", Engine, "advance"),
    ("infrared", Infrared, "sense"),
    ("light", Light, "sense"),
    ("tracker", Tracker, "measure"),
    ("controllers and evolution", Swarm, "step"),
    ("of which evolution", CoEvolution, "_generation"),
    ("recording", Recorder, "sample"),
)
"""What a run's time is split into: name, class, method."""


@contextmanager
def clocked(spent: dict[str, float]) -> Iterator[None]:
    """Add up the seconds spent in each of `PARTS` while the block runs."""
    originals = [(owner, name, getattr(owner, name)) for _, owner, name in PARTS]

    def clock(part: str, original: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*args: Any, **kwargs: Any) -> Any:
            began = time.perf_counter()
            result = original(*args, **kwargs)
            spent[part] = spent.get(part, 0.0) + time.perf_counter() - began
            return result

        return timed

    for (part, _, _), (owner, name, original) in zip(PARTS, originals, strict=True):
        setattr(owner, name, clock(part, original))
    try:
        yield
    finally:
        for owner, name, original in originals:
            setattr(owner, name, original)


def co_evolution(minutes: float) -> tuple[float, dict[str, float]]:
    """Simulated seconds per second of a whole run, and the share of time of each part."""
    config = RunConfig(minutes=minutes, robots=ROBOTS, seed=1)
    spent: dict[str, float] = {}
    with TemporaryDirectory() as out:
        plain = simulate(config, (), Path(out))["wall_seconds"]
    with TemporaryDirectory() as out, clocked(spent):
        total = simulate(config, (), Path(out))["wall_seconds"]
    return minutes * 60.0 / plain, {part: seconds / total for part, seconds in spent.items()}


def bare_stepping(minutes: float) -> float:
    """Simulated seconds per second of the same bodies, driven about, nothing else."""
    world = World(ROBOTS, np.random.SeedSequence(1))
    random = np.random.default_rng(1)
    seconds = minutes * 60.0
    commands = [search_commands(seconds, random) for _ in range(ROBOTS)]
    schedule = np.array(
        [np.repeat([c[1:] for c in own], [c[0] for c in own], 0) for own in commands]
    )
    began = time.perf_counter()
    for step in range(schedule.shape[1]):
        world.act(schedule[:, step])
    wall = time.perf_counter() - began
    world.close()
    return seconds / wall


ACTIVE = {"motor_saturation": (5.9,), "motor_dead_zone": (0.3,), "second_lamp": (0.3, 0.4, 0.2)}
"""Values of causes that three steps from their null would leave without effect."""


def every_term() -> PointModel:
    """The e-puck's point model with every cause of the catalogue at once, each mild."""
    model = read_model_file()
    named = []
    for name, cause in every_cause().items():
        values = ACTIVE.get(name, [p.value(3.0 * p.step * (p.sign or 1)) for p in cause.parameters])
        parameters = {
            p.name: ParameterValue(value=value)
            for p, value in zip(cause.parameters, values, strict=True)
        }
        named.append(NamedCause(name=name, word=cause.variants[-1], parameters=parameters))
    extended = model.model_copy(update={"extension": Extension(causes=tuple(named))})
    return extended.point_model(load_model().tables)


def extended_over_minimal(repeats: int = 15) -> float:
    """Time of a robot-step with every term active over that of the minimal model.

    Median over repeats in which both are timed one after the other.
    """
    extended = every_term()
    return median(embedded(1, model=extended) / embedded(1) for _ in range(repeats))


def embedded(repeats: int = 7, *, model: PointModel | None = None) -> float:
    """ns per robot-step of the embedded simulator: all nine controllers under all three lamps."""
    thirds = (0.1, 0.5, 0.9)
    genomes = np.tile([(g0, g1) for g0 in thirds for g1 in thirds], (45, 1))
    trials = len(genomes)
    random = np.random.default_rng(1)
    seeds = random.integers(0, 2**32, (trials, 4), dtype=np.uint32)
    scenarios = np.arange(trials) // 9 % 3
    model, behaviour = model or load_model(), Behaviour()
    took = []
    for _ in range(repeats):
        began = time.perf_counter()
        evaluate(genomes, scenarios, seeds, model=model, behaviour=behaviour)
        took.append(time.perf_counter() - began)
    return 1e9 * median(took) / trials / (60.0 / CONTROL_STEP)


def main(
    minutes: Annotated[float, typer.Option(help="Simulated minutes of the long runs.")] = 5.0,
    out: Annotated[Path, typer.Option(help="JSON to write.")] = Path("out/bench.json"),
) -> None:
    """Time reality, bare physics and the embedded simulator in one process."""
    with Progress("bench", 3.0, quiet=False) as shown:
        nanoseconds, price = embedded(), extended_over_minimal()
        shown.reach(1)
        bare = bare_stepping(minutes)
        shown.reach(2)
        speed, shares = co_evolution(minutes)
        shown.reach(3)
    shown.say(f"embedded simulator, everything: {nanoseconds:.0f} ns per robot-step")
    shown.say(f"the same with every term of an extension: {price:.2f} times as long")
    shown.say(f"{ROBOTS} robots co-evolving: {speed:.1f} times real time")
    shown.say(f"the same bodies, bare stepSimulation: {bare:.1f} times real time")
    shown.say(f"a whole run costs {bare / speed:.2f} times bare stepping; its time goes to")
    for part, share in shares.items():
        shown.say(f"  {part}: {100.0 * share:.1f} %")
    out.parent.mkdir(parents=True, exist_ok=True)
    write_json(
        out,
        {
            "schema": 1,
            "embedded_ns_per_robot_step": nanoseconds,
            "extended_over_minimal": price,
            "co_evolution_times_real_time": speed,
            "bare_stepping_times_real_time": bare,
            "run_over_bare": bare / speed,
            "shares": shares,
            "minutes": minutes,
            "robots": ROBOTS,
            "versions": versions(),
        },
    )


if __name__ == "__main__":
    typer.run(main)
