"""The pictures of what is left in the readings: which quantity, which robot, how it looks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import seaborn as sns

from realitygap.models.naming.channels.senses.diagnose import SenseExamination
from realitygap.models.naming.channels.senses.readings import CHANGES, KINDS
from realitygap.studies.pages.drawing import canvas, save


def far_from_health(senses: SenseExamination) -> pd.DataFrame:
    """Standard deviations from health: `channel`, `quantity`, `robot`, `z`."""
    rows = []
    for key, far in senses.away.items():
        channel, change, quantity = key.split("/", 2)
        if senses.found is not None and channel in KINDS and change in CHANGES:
            plain = quantity.partition(" ")[0].replace("_", " ")
            robots = zip(senses.found.state.tracks.robots, far, strict=True)
            rows += [(channel, plain, robot, float(z)) for robot, z in robots]
    return pd.DataFrame(rows, columns=["channel", "quantity", "robot", "z"])


def draw_left(table: pd.DataFrame, path: Path) -> None:
    """The largest distance from health of the terms of each quantity, per robot and channel."""
    shown = [channel for channel in KINDS if (table["channel"] == channel).any()]
    figure = canvas(10, 5.0)
    for axis, channel in zip(np.atleast_1d(figure.subplots(1, len(shown))), shown, strict=True):
        mine = table[table["channel"] == channel]
        grid = mine.pivot_table(index="quantity", columns="robot", values="z", aggfunc="max")
        sns.heatmap(grid, vmin=0.0, vmax=10.0, cmap="rocket_r", ax=axis, linewidths=0.5)
        axis.set(ylabel="", xlabel="robot", title=channel)
    save(figure, path)
