"""The pictures of what is left in the readings: which quantity, which robot, how it looks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure

from realitygap.models.senses.diagnose import SenseExamination
from realitygap.models.senses.structure import KINDS

DPI = 100


def far_from_health(senses: SenseExamination) -> pd.DataFrame:
    """Standard deviations from health: `channel`, `quantity`, `robot`, `z`."""
    if senses.sight is None or senses.reference is None:
        return pd.DataFrame(columns=["channel", "quantity", "robot", "z"])
    rows = []
    for one in senses.structure:
        health = senses.reference.health(one.key)
        if health is None:
            continue
        far = np.abs(one.size - health.mean) / np.hypot(one.error, health.sd)
        rows += [
            (one.channel, one.quantity.replace("_", " "), robot, float(z))
            for robot, z in zip(senses.sight.robots, far, strict=True)
            if np.isfinite(z)
        ]
    return pd.DataFrame(rows, columns=["channel", "quantity", "robot", "z"])


def draw_left(table: pd.DataFrame, path: Path) -> None:
    """The largest distance from health of the terms of each quantity, per robot and channel."""
    shown = [channel for channel in KINDS if (table["channel"] == channel).any()]
    sns.set_theme(style="whitegrid", font_scale=0.85)
    figure = Figure(figsize=(10, 5.0), layout="constrained")
    for axis, channel in zip(np.atleast_1d(figure.subplots(1, len(shown))), shown, strict=True):
        mine = table[table["channel"] == channel]
        grid = mine.pivot_table(index="quantity", columns="robot", values="z", aggfunc="max")
        sns.heatmap(grid, vmin=0.0, vmax=10.0, cmap="rocket_r", ax=axis, linewidths=0.5)
        axis.set(ylabel="", xlabel="robot", title=channel)
    figure.savefig(path, dpi=DPI, metadata={"Software": ""})
