"""How a run's cost grows: `realitygap measure scaling`; docs/scaling.png and its CSV.

Processor time, so that a busy machine matters little; every run in a process of its own, so that
its peak of memory is its own.
"""

from __future__ import annotations

import math
import multiprocessing
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from realitygap.reality import constants as k
from realitygap.reality.engine import DEFAULT, engine_name
from realitygap.reality.rays import DEFAULT_RAYS, rays_name
from realitygap.studies.plumbing.execution import tie_to_parent
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import RunConfig, simulate
from realitygap.studies.run.settings import run_config

ROBOTS = (1, 2, 5, 10, 20, 35, 50, 75, 100)
"""More than a hundred find no room in the arena: 200 e-pucks are two thirds of its floor."""
ALIKE = (10, 20, 40, 100, 200)
"""Robots in arenas that grow with them, so that each has as much floor as one of ten."""
MINUTES = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0)


def cost(config: RunConfig) -> dict[str, float]:
    """s of processor time that a run takes, and MB of memory that the process takes at most."""
    with scratch() as out:
        began = time.process_time()
        simulate(config, (), out)
        seconds = time.process_time() - began
    # what `resource` says of a process begins with the memory of the one that began it
    status = Path("/proc/self/status").read_text(encoding="ascii")
    peak = float(status.partition("VmHWM:")[2].split()[0]) / 1024.0  # kB
    return {
        "robots": config.robots,
        "minutes": config.minutes,
        "arena_radius": round(config.arena_radius, 3),
        "cpu_seconds": round(seconds, 3),
        "peak_mb": round(peak, 1),
    }


def measure(
    robots_for: float, world: dict[str, Any], reach: Callable[[float], None]
) -> pd.DataFrame:
    """A row per run: some against robots, some against robots as dense, some against minutes."""
    configs = [run_config(robots=robots, minutes=robots_for, seed=1, **world) for robots in ROBOTS]
    for robots in ALIKE:
        radius = k.ARENA_RADIUS * math.sqrt(robots / ALIKE[0])
        configs.append(
            run_config(robots=robots, minutes=robots_for, seed=1, arena_radius=radius, **world)
        )
    configs += [run_config(robots=10, minutes=minutes, seed=1, **world) for minutes in MINUTES]
    against = ["robots"] * len(ROBOTS) + ["density"] * len(ALIKE) + ["minutes"] * len(MINUTES)
    rows = []
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(
        1, mp_context=spawn, max_tasks_per_child=1, initializer=tie_to_parent
    ) as one:
        for done, (config, axis) in enumerate(zip(configs, against, strict=True), 1):
            rows.append({"against": axis, **one.submit(cost, config).result()})
            reach(done / len(configs))
    return pd.DataFrame(rows)


def line(x: pd.Series, y: pd.Series) -> tuple[float, float, float]:
    """Intercept and slope of the straight line of least relative error; largest relative error."""
    design = np.column_stack([np.ones(len(x)), x]) / y.to_numpy()[:, None]
    (start, slope), *_ = np.linalg.lstsq(design, np.ones(len(x)), rcond=None)
    worst = float(np.abs((start + slope * x) / y - 1.0).max())
    return float(start), float(slope), worst


def figure(table: pd.DataFrame, file: Path) -> None:
    """Processor time against robots and minutes, with lines, and memory against minutes."""
    import matplotlib.pyplot as plt
    import seaborn as sns

    sns.set_theme(style="whitegrid", context="paper")
    drawn, axes = plt.subplots(1, 4, figsize=(13.0, 3.2), layout="constrained")
    drawn_against = {"robots": "robots", "density": "robots", "minutes": "minutes"}
    for ax, (against, column) in zip(axes, drawn_against.items(), strict=False):
        own = table[table["against"] == against]
        start, slope, worst = line(own[column], own["cpu_seconds"])
        ax.plot(own[column], own["cpu_seconds"], "o")
        ends = np.array([0.0, own[column].max()])
        ax.plot(ends, start + slope * ends, "-", color="0.5")
        dense = ", equally dense" if against == "density" else ""
        ax.set(xlabel=column + dense, ylabel="processor time (s)")
        ax.set_title(f"{start:.2f} s + {slope:.3g} s each, within {100 * worst:.0f} %")
    own = table[table["against"] == "minutes"]
    axes[3].plot(own["minutes"], own["peak_mb"], "o-")
    top = 1.25 * own["peak_mb"].max()
    axes[3].set(xlabel="minutes", ylabel="peak memory (MB)", ylim=(0.0, top))
    drawn.savefig(file, dpi=150)
    plt.close(drawn)


def scaling(
    out: Path,
    *,
    minutes: float = 1.0,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> pd.DataFrame:
    """Measure the cost of runs, and draw it.

    Args:
        out: Directory of scaling.csv and scaling.png.
        minutes: Simulated, of the runs against the number of robots.
        engine: Physics of the world: pybullet, pybullet-strict or mujoco.
        rays: Who answers what infrared meets: engine, or closed.
        force: Replace what is there.
        reach: Called with the share that is done, from 0 to 1.

    Returns:
        A row per run: `against` (robots; density: robots in arenas that grow with them; minutes),
        `robots`, `minutes`, `arena_radius` (m), `cpu_seconds` (s) and `peak_mb` (MB).

    Raises:
        InputError: `minutes`, `engine` or `rays` cannot be used, or `out` cannot be written.
    """
    world = {"engine": engine_name(engine), "rays": rays_name(rays)}
    run_config(minutes=minutes, **world)  # refused before anything is timed
    with whole_directory(out, force=force, holds=("scaling.csv",)) as part:
        table = measure(minutes, world, reach)
        table.to_csv(part / "scaling.csv", index=False)
        figure(table, part / "scaling.png")
    return table
