"""A run in one picture: where the robots went, what they brought home, what they believed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
from matplotlib.patches import Circle

from realitygap.reality import constants as k
from realitygap.reality.hardware import NOMINAL
from realitygap.studies.pages.drawing import canvas, save, themed
from realitygap.studies.run.experiment import HALVES, Case

THIRDS = ("light opposite nest", "no light", "light at nest")
"""What each third of S0 says of the world (paper, Fig. 5)."""
COLOURS = ("#4c72b0", "#8c8c8c", "#dd8452")
TRACK_SECONDS = 60.0
"""s of tracks drawn, from the end of the run: more is a tangle."""


def draw_run(
    run: Path,
    case: Case,
    picture: Path,
    *,
    hidden: Sequence[tuple[float, float]] = (),
    most: float | None = None,
) -> None:
    """Draw a finished run directory.

    Args:
        run: Directory with samples, deposits and generations.
        case: The run's case.
        picture: PNG to write.
        hidden: Places (m) of lamps that the robots' simulators did not know.
        most: Items per minute that the axis of food goes to; as many as there are if absent.
    """
    samples = pd.read_parquet(run / "samples.parquet", columns=["robot", "t", "x", "y"])
    generations = pd.read_parquet(run / "generations.parquet")
    with themed():
        figure = canvas(15, 5)
        arena, food, belief = figure.subplots(1, 3)
        draw_arena(arena, samples, case, hidden)
        _food(food, items_per_minute(run), most)
        _belief(belief, generations)
        save(figure, picture)


def items_per_minute(run: Path) -> npt.NDArray[np.int64]:
    """(minutes,) items that a run brought to the nest, by minute."""
    times = pd.read_parquet(run / "samples.parquet", columns=["t"])["t"]
    edges = np.arange(np.ceil(float(times.max()) / 60.0) + 1.0)
    deposits = pd.read_parquet(run / "deposits.parquet", columns=["t"])["t"]
    return np.histogram(deposits / 60.0, bins=edges)[0]


def draw_arena(
    axes: Any, samples: pd.DataFrame, case: Case, hidden: Sequence[tuple[float, float]] = ()
) -> None:
    """Tracks over the arena, nest and lamps."""
    end = samples["t"].max()
    for _, track in samples[samples["t"] > end - TRACK_SECONDS].groupby("robot"):
        axes.plot(track["x"], track["y"], linewidth=0.8, alpha=0.8)
    axes.add_patch(Circle((0, 0), k.ARENA_RADIUS, fill=False, color="black", linewidth=2))
    axes.add_patch(Circle(k.NEST[:2], k.NEST[2], color="#55a868", alpha=0.25, label="nest"))
    lamp = NOMINAL.lamps[HALVES[case][1]]
    if lamp is not None:
        axes.plot(*lamp, marker="*", markersize=22, color="gold", markeredgecolor="black")
        axes.annotate("lamp", lamp, textcoords="offset points", xytext=(2, 14))
    for place in hidden:
        axes.plot(*place, marker="*", markersize=22, color="none", markeredgecolor="#c0392b")
        axes.annotate(
            "hidden", place, textcoords="offset points", xytext=(-16, -24), color="#c0392b"
        )
    axes.annotate("nest", (k.NEST[0], k.NEST[1] + 0.13), ha="center", color="#2f6b41")
    axes.set(
        aspect="equal",
        xlim=(-0.68, 0.72),
        ylim=(-0.68, 0.68),
        xlabel="x (m)",
        ylabel="y (m)",
        title=f"The robots' last {TRACK_SECONDS:.0f} s",
    )


def _food(axes: Any, counts: npt.NDArray[np.int64], most: float | None) -> None:
    """Items brought to the nest, by minute."""
    axes.bar(np.arange(len(counts)) + 0.5, counts, width=0.9, color="#55a868")
    axes.set_ylim(0.0, 1.05 * max(counts.max() if most is None else most, 1.0))
    axes.set(xlabel="time (min)", ylabel="items per minute", title="Food brought to the nest")


def _belief(axes: Any, generations: pd.DataFrame) -> None:
    """Share of robots whose S0 lies in each third, by generation."""
    known = generations.dropna(subset=["s0_third"]).astype({"s0_third": int})
    shares = (
        known.groupby("generation")["s0_third"]
        .value_counts(normalize=True)
        .unstack(fill_value=0)
        .reindex(columns=range(3), fill_value=0.0)
    )
    axes.stackplot(
        shares.index,
        shares.to_numpy(dtype=float).T,
        labels=THIRDS,
        colors=COLOURS,
        alpha=0.85,
        step="mid",
    )
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, frameon=False)
    axes.set(
        xlabel="generation (60 s each)",
        ylabel="share of robots",
        ylim=(0.0, 1.0),
        title="What their simulators believe (S0)",
    )
