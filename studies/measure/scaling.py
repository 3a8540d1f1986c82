"""How a run's cost grows: `realitygap measure scaling`; docs/scaling.png and its CSV.

Processor time, so that a busy machine matters little; every run in a process of its own, so that
its peak of memory is its own.
"""

from __future__ import annotations

import multiprocessing
import resource
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.studies.plumbing.execution import tie_to_parent
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import RunConfig, simulate
from realitygap.studies.run.settings import run_config

ROBOTS = (1, 2, 5, 10, 20, 35, 50, 75, 100)
"""More than a hundred find no room in the arena: 200 e-pucks are two thirds of its floor."""
MINUTES = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0)


def cost(config: RunConfig) -> dict[str, float]:
    """s of processor time that a run takes, and MB of memory that the process takes at most."""
    with scratch() as out:
        began = time.process_time()
        simulate(config, (), out)
        seconds = time.process_time() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0  # Linux counts kB
    return {
        "robots": config.robots,
        "minutes": config.minutes,
        "cpu_seconds": round(seconds, 3),
        "peak_mb": round(peak, 1),
    }


def measure(robots_for: float, reach: Callable[[float], None]) -> pd.DataFrame:
    """A row per run: some against the number of robots, some against minutes."""
    configs = [run_config(robots=robots, minutes=robots_for, seed=1) for robots in ROBOTS]
    configs += [RunConfig(robots=10, minutes=minutes, seed=1) for minutes in MINUTES]
    against = ["robots"] * len(ROBOTS) + ["minutes"] * len(MINUTES)
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
    drawn, axes = plt.subplots(1, 3, figsize=(10.0, 3.2), layout="constrained")
    for ax, against in zip(axes, ("robots", "minutes"), strict=False):
        own = table[table["against"] == against]
        start, slope, worst = line(own[against], own["cpu_seconds"])
        ax.plot(own[against], own["cpu_seconds"], "o")
        ends = np.array([0.0, own[against].max()])
        ax.plot(ends, start + slope * ends, "-", color="0.5")
        ax.set(xlabel=against, ylabel="processor time (s)")
        ax.set_title(f"{start:.2f} s + {slope:.3g} s each, within {100 * worst:.0f} %")
    own = table[table["against"] == "minutes"]
    axes[2].plot(own["minutes"], own["peak_mb"], "o-")
    top = 1.25 * own["peak_mb"].max()
    axes[2].set(xlabel="minutes", ylabel="peak memory (MB)", ylim=(0.0, top))
    drawn.savefig(file, dpi=150)
    plt.close(drawn)


def scaling(
    out: Path,
    *,
    minutes: float = 1.0,
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> pd.DataFrame:
    """Measure the cost of runs, and draw it.

    Args:
        out: Directory of scaling.csv and scaling.png.
        minutes: Simulated, of the runs against the number of robots.
        force: Replace what is there.
        reach: Called with the share that is done, from 0 to 1.

    Returns:
        A row per run: `against` (robots or minutes), `robots`, `minutes`, `cpu_seconds` (s) and
        `peak_mb` (MB).

    Raises:
        InputError: `minutes` cannot be used, or `out` cannot be written.
    """
    with whole_directory(out, force=force, holds=("scaling.csv",)) as part:
        table = measure(minutes, reach)
        table.to_csv(part / "scaling.csv", index=False)
        figure(table, part / "scaling.png")
    return table
