"""Simulate: one experiment, its files and its tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from realitygap.reality.constants import ARENA_RADIUS
from realitygap.reality.engine import DEFAULT, engine_name
from realitygap.reality.rays import DEFAULT_RAYS, rays_name
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.pages.notebook import Telling, new_axes
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run import experiment
from realitygap.studies.run.altered import MODEL
from realitygap.studies.run.experiment import RunConfig
from realitygap.studies.run.settings import run_config

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from realitygap.studies.inputs.logs import Log

FILE = "run.json"
TABLES = ("generations", "deposits", "samples")


@dataclass(frozen=True, eq=False, repr=False)
class RunResult(Telling):
    """What a swarm did: its tables are read when they are asked for."""

    config: RunConfig
    """What was run; what was hidden in it is not among it."""
    totals: Mapping[str, float]
    """`deposits`, `radio_messages`, `wall_seconds` (s)."""
    path: Path | None
    """Where the files are; None: nowhere, the tables are in memory."""
    held: Mapping[str, pd.DataFrame] = field(default_factory=dict, repr=False)
    """Tables in memory, by name."""

    @property
    def generations(self) -> pd.DataFrame:
        """A row per robot and generation: what it believed, ran and achieved (docs/files.md)."""
        return self._table("generations")

    @property
    def deposits(self) -> pd.DataFrame:
        """A row per item brought to the nest: `robot`, `t` and `t_pickup` (s), `generation`."""
        return self._table("deposits")

    @property
    def samples(self) -> pd.DataFrame:
        """The measured log, a row per robot and 40 ms, in SI units.

        Raises:
            KeyError: the run kept no samples.
        """
        return self._table("samples")

    def log(self, model: AnyModel = None) -> Log:
        """The measured log for `diagnose` and `measure_gap`, by a model; the e-puck if absent.

        Raises:
            InputError: the run was too short to tell anything.
            KeyError: the run kept no samples.
        """
        from realitygap.studies.inputs.imported import read_log  # every format: a run needs none

        if self.path is None:
            return read_log(self.samples, model=model)
        return read_log(self.path, model=model)

    def _table(self, name: str) -> pd.DataFrame:
        if self.path is None:
            return self.held[name]
        path = self.path / f"{name}.parquet"
        if not path.exists():
            raise KeyError(name)
        return pd.read_parquet(path)

    def table_told(self) -> pd.DataFrame | None:
        """As `Telling`: fitness in simulation and reality, by generation."""
        try:
            table = self.generations
        except KeyError:
            return None
        means = table.groupby("generation")[["fitness_sim", "fitness_real"]].mean()
        return means.reset_index()

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the robots' last minute over arena, nest and lamp.

        Args:
            axes: To draw into; new ones if absent.

        Raises:
            KeyError: the run kept no samples.
        """
        from realitygap.studies.run.picture import draw_arena

        axes = new_axes(axes)
        draw_arena(axes, self.samples, self.config.case)
        return axes

    def told(self) -> tuple[str, str, str]:
        of = self.config
        text = f"{of.robots} robots for {of.minutes:g} min, {of.case}, {of.controller}, seed "
        text += f"{of.seed}: items brought to the nest: {self.totals['deposits']:.0f}."
        where = "" if self.path is None else f" ({self.path})"
        return f"Run{where}", text, ".generations .deposits .samples .log()"


def simulate(
    *,
    case: str = "light-at-nest",
    controller: str = "coevolution",
    minutes: float = 60.0,
    robots: int = 10,
    seed: int = 0,
    effects: Sequence[str] = (),
    model: AnyModel = None,
    reading: str = "default",
    trials: int = 1,
    genome: str = "paper",
    build_spread: float = 0.0,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    arena_radius: float = ARENA_RADIUS,
    samples: bool = True,
    out: Path | str | None = None,
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> RunResult:
    """Let a swarm forage in the pybullet world, as `realitygap run`.

    Args:
        case: Where the lamp stands: no-light, light-at-nest, light-opposite-nest,
            at-nest-to-opposite or opposite-to-at-nest.
        controller: coevolution, a fixed controller, or a manoeuvre `probe:NAME`.
        minutes: Simulated, at most a day.
        robots: At most 1000; 100 find room in the nominal arena.
        seed: Everything random follows from it.
        effects: SPECs (`NAME:key=value,...`) of what to hide in reality; see `effects()`.
        model: On board; the e-puck if absent.
        reading: Of the paper: default, literal, neutral, reflect or wrap.
        trials: Embedded trials per genome.
        genome: paper or continuous.
        build_spread: Relative standard deviation by which robots' parts differ from nominal.
        engine: Physics of the world: pybullet, pybullet-strict or mujoco (the extra [mujoco]).
        rays: Who answers what infrared meets: engine, or closed (exact).
        arena_radius: m; nest and lamps move out with the wall, and food stays as dense.
        samples: Keep the measured log.
        out: Directory for the tables, run.json and, apart, truth.json; None: tables in memory.
        force: Replace a run that is there.
        reach: Called with the share that is done, from 0 to 1, about once a simulated second.

    Raises:
        InputError: a value, effect or model that cannot be used, or `out` cannot.
        Diverged: the physics or the point model left the finite numbers; says where.
    """
    on_board = Model.load(model)
    config = run_config(
        case=case,
        controller=controller,
        minutes=minutes,
        robots=robots,
        seed=seed,
        model=MODEL if on_board.path is None else on_board.given,
        reading=reading,
        trials=trials,
        genome=genome,
        build_spread=build_spread,
        engine=engine_name(engine),
        rays=rays_name(rays),
        arena_radius=arena_radius,
        samples=samples,
    )
    with _place(out, force) as part:
        totals = experiment.simulate(
            config,
            tuple(effects),
            part,
            lambda step: reach(step / config.steps),
            model=on_board,
        )
        held = {} if out is not None else _read(part)
    return RunResult(config, totals, None if out is None else Path(out), held)


@contextmanager
def _place(out: Path | str | None, force: bool) -> Iterator[Path]:
    """Where the files are written: a new directory, or one that is gone afterwards."""
    if out is None:
        with scratch() as part:
            yield part
    else:
        with whole_directory(Path(out), force=force, holds=(FILE,)) as part:
            yield part


def _read(folder: Path) -> dict[str, Any]:
    """The tables in a run's directory."""
    paths = {name: folder / f"{name}.parquet" for name in TABLES}
    return {name: pd.read_parquet(path) for name, path in paths.items() if path.exists()}
