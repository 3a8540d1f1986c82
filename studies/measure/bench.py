"""Benchmarks: `realitygap measure bench`, or `make bench`.

Ratios of things timed in one process, so that they hold on a slower or busier machine; absolute
figures stand beside them. It is the processor's time that counts, on one core: what others do on
the machine matters less. Medians over repeats where repeats are cheap.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from realitygap.embedded_sim import CONTROL_STEP, Behaviour, PointModel, evaluate, replay
from realitygap.embedded_sim.breeding import CoEvolution
from realitygap.embedded_sim.onboard import Swarm
from realitygap.embedded_sim.simulator import FORMS, Form, has_form
from realitygap.models import load_model, read_model_file
from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.reality.engine import DEFAULT, EngineName, engine_class, engine_name
from realitygap.reality.rays import DEFAULT_RAYS, RaysName, rays_name
from realitygap.reality.senses import Infrared, Light, Tracker
from realitygap.reality.world import World
from realitygap.studies.measure.convergence import search_commands
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.provenance import versions, write_json
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import RunConfig, simulate
from realitygap.studies.run.recorder import Recorder
from realitygap.studies.run.settings import run_config

ROBOTS = 10
PARTS: tuple[tuple[str, Any, str], ...] = (
    ("infrared", Infrared, "sense"),
    ("light", Light, "sense"),
    ("tracker", Tracker, "measure"),
    ("controllers and evolution", Swarm, "step"),
    ("of which evolution", CoEvolution, "_generation"),
    ("recording", Recorder, "sample"),
)
"""What a run's time is split into, beside the physics: name, class, method."""


@contextmanager
def clocked(spent: dict[str, float], engine: EngineName) -> Iterator[None]:
    """Add up the seconds spent in each of `PARTS` and in an engine while the block runs."""
    parts = (("physics", engine_class(engine), "advance"), *PARTS)
    originals = [(owner, name, getattr(owner, name)) for _, owner, name in parts]

    def clock(part: str, original: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*args: Any, **kwargs: Any) -> Any:
            began = time.process_time()
            result = original(*args, **kwargs)
            spent[part] = spent.get(part, 0.0) + time.process_time() - began
            return result

        return timed

    for (part, _, _), (owner, name, original) in zip(parts, originals, strict=True):
        setattr(owner, name, clock(part, original))
    try:
        yield
    finally:
        for owner, name, original in originals:
            setattr(owner, name, original)


def _config(minutes: float, engine: str, rays: str) -> RunConfig:
    world = {"engine": engine_name(engine), "rays": rays_name(rays)}
    return run_config(minutes=minutes, robots=ROBOTS, seed=1, **world)


def co_evolution(
    minutes: float, engine: EngineName, rays: RaysName = DEFAULT_RAYS
) -> tuple[float, dict[str, float]]:
    """Simulated seconds per second of a whole run, and the share of time of each part."""
    config = _config(minutes, engine, rays)
    spent: dict[str, float] = {}
    began = time.process_time()
    with scratch() as out:
        simulate(config, (), Path(out))
    plain = time.process_time() - began
    began = time.process_time()
    with scratch() as out, clocked(spent, engine):
        simulate(config, (), Path(out))
    total = time.process_time() - began
    return minutes * 60.0 / plain, {part: seconds / total for part, seconds in spent.items()}


def bare_stepping(minutes: float, engine: EngineName) -> float:
    """Simulated seconds per second of the same bodies, driven about, nothing else."""
    world = World(ROBOTS, np.random.SeedSequence(1), engine=engine)
    random = np.random.default_rng(1)
    seconds = minutes * 60.0
    commands = [search_commands(seconds, random) for _ in range(ROBOTS)]
    schedule = np.array(
        [np.repeat([c[1:] for c in own], [c[0] for c in own], 0) for own in commands]
    )
    began = time.process_time()
    for step in range(schedule.shape[1]):
        world.act(schedule[:, step])
    took = time.process_time() - began
    world.close()
    return seconds / took


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
        parameters |= {p.name: ParameterValue(value=p.high) for p in cause.given}
        named.append(NamedCause(name=name, word=cause.variants[-1], parameters=parameters))
    extended = model.model_copy(update={"extension": Extension(causes=tuple(named))})
    return extended.point_model(load_model().tables)


def extended_over_minimal(extended: PointModel, *, form: Form = "best", repeats: int = 15) -> float:
    """Time of a robot-step of an extended model over that of the minimal model.

    Median over repeats in which both are timed one after the other.
    """
    return median(
        embedded(1, model=extended, form=form) / embedded(1, form=form) for _ in range(repeats)
    )


def replayed(model: PointModel, repeats: int = 7) -> float:
    """ns per row of a replay: ten robots of ten minutes, a row every 40 ms."""
    robots, rows = 10, 15000
    random = np.random.default_rng(1)
    commands = np.repeat(random.uniform(-6.0, 6.0, (robots * rows // 25, 2)), 25, axis=0)
    t = np.tile(CONTROL_STEP * np.arange(rows), robots)
    start = rows * np.arange(robots + 1)
    took = []
    for _ in range(repeats):
        began = time.process_time()
        replay(t, commands, start, np.zeros((robots, 3)), drive=model.drive)
        took.append(time.process_time() - began)
    return 1e9 * median(took) / (robots * rows)


def command(*words: str, repeats: int = 5) -> float:
    """s of processor time, user's and system's, of one command in a fresh process; median."""
    took = []
    for _ in range(repeats):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        with scratch() as out:
            line = [word.replace("OUT", str(out)) for word in words]
            subprocess.run(
                [sys.executable, "-c", "from realitygap.studies.cli import main; main()", *line],
                check=True,
                stdout=subprocess.DEVNULL,
            )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        took.append(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    return median(took)


def point_model() -> dict[str, float]:
    """Everything about the embedded simulator, by its name in the JSON."""
    every = every_term()
    alone = replace(every, senses=replace(every.senses, second_lamp=None))
    figures = {f"embedded_{form}_ns": embedded(form=form) for form in FORMS if has_form(form)}
    for name, model in (("extended", every), ("extended_one_lamp", alone)):
        for form in ("best", "one_by_one"):
            figures[f"{name}_over_minimal_{form}"] = extended_over_minimal(model, form=form)
    figures["replay_minimal_ns"] = replayed(load_model())
    figures["replay_extended_ns"] = replayed(every)
    return figures


def embedded(repeats: int = 7, *, model: PointModel | None = None, form: Form = "best") -> float:
    """ns per robot-step of the embedded simulator: all nine controllers under all three lamps.

    Median of the processor's time over repeats.
    """
    thirds = (0.1, 0.5, 0.9)
    genomes = np.tile([(g0, g1) for g0 in thirds for g1 in thirds], (45, 1))
    trials = len(genomes)
    random = np.random.default_rng(1)
    seeds = random.integers(0, 2**32, (trials, 4), dtype=np.uint32)
    scenarios = np.arange(trials) // 9 % 3
    model, behaviour = model or load_model(), Behaviour()
    took = []
    for _ in range(repeats):
        began = time.process_time()
        evaluate(genomes, scenarios, seeds, model=model, behaviour=behaviour, form=form)
        took.append(time.process_time() - began)
    return 1e9 * median(took) / trials / (60.0 / CONTROL_STEP)


def bench(
    out: Path,
    *,
    minutes: float = 5.0,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> dict[str, Any]:
    """Time reality, bare physics and the embedded simulator in one process.

    Args:
        out: The file (JSON).
        minutes: Simulated, of the long runs.
        engine: Physics of the world: pybullet, pybullet-strict or mujoco.
        rays: Who answers what infrared meets: engine, or closed.
        force: Replace figures that are there.
        reach: Called with the share that is done, from 0 to 1.

    Returns:
        The content of the file: figures by name, and `shares` of a run's time by part.

    Raises:
        InputError: `minutes`, `engine` or `rays` cannot be used, or `out` cannot be written.
    """
    asked = _config(minutes, engine, rays)  # refused before anything is timed
    name = asked.engine
    with whole_file(out, force=force) as part:
        figures = point_model()
        reach(0.25)
        figures["help_cpu_seconds"] = command("--help")
        world = ("--engine", name, "--rays", asked.rays)
        run = ("run", "--minutes", "0.1", *world, "--quiet", "--out", "OUT/run")
        figures["short_run_cpu_seconds"] = command(*run)
        reach(0.5)
        bare = bare_stepping(minutes, name)
        reach(0.75)
        speed, shares = co_evolution(minutes, name, asked.rays)
        reach(1.0)
        figures |= {
            "co_evolution_times_real_time": speed,
            "bare_stepping_times_real_time": bare,
            "run_over_bare": bare / speed,
        }
        content = {"schema": 1, **figures, "shares": shares, "minutes": minutes, "robots": ROBOTS}
        content |= {"engine": name, "rays": asked.rays, "versions": versions()}
        write_json(part, content)
    return content
