"""How pages and notebooks draw: one look, whatever was drawn before."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
import matplotlib.style
import numpy as np
import pandas as pd
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure

DPI = 120
HALF = 5.4
"""inches: a picture of half the page's width, which a phone shows whole."""

TEXT, SMALL = 10.2, 9.35
"""points of letters."""
COLOURS = ("#4c72b0", "#dd8452", "#55a868", "#c44e52", "#8172b3", "#937860", "#da8bc3", "#8c8c8c")
LOOK = {
    **dict.fromkeys(("font.size", "axes.labelsize", "axes.titlesize"), TEXT),
    **dict.fromkeys(("legend.fontsize", "xtick.labelsize", "ytick.labelsize"), SMALL),
    **{"axes.linewidth": 1.25, "grid.linewidth": 1.0, "legend.frameon": True},
    **{"patch.edgecolor": "w", "patch.force_edgecolor": True, "patch.facecolor": "C0"},
    "axes.prop_cycle": cycler(color=COLOURS),
}
"""seaborn's, which takes half a second to import; only pages that draw with it wait for it."""


@contextmanager
def themed() -> Iterator[None]:
    """Draw in our look, and leave the settings of whoever imports this program as they were."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.style.use(["seaborn-v0_8-whitegrid", LOOK])
        yield


def canvas(width: float, height: float) -> Figure:
    """An empty picture in inches."""
    return Figure(figsize=(width, height), layout="constrained")


def save(figure: Figure, path: Path) -> None:
    """A PNG whose bytes depend on the picture alone."""
    figure.savefig(path, dpi=DPI, metadata={"Software": None})


def heat(axes: Axes, grid: pd.DataFrame, most: float) -> None:
    """Draw a table of numbers from 0 to `most` as colours, its names beside it."""
    cells = axes.pcolormesh(
        grid.to_numpy(), vmin=0.0, vmax=most, cmap="magma_r", edgecolors="w", linewidth=0.5
    )
    axes.set_xticks(np.arange(grid.shape[1]) + 0.5, [str(name) for name in grid.columns])
    axes.set_yticks(np.arange(grid.shape[0]) + 0.5, [str(name) for name in grid.index])
    axes.invert_yaxis()
    axes.grid(visible=False)
    axes.figure.colorbar(cells, ax=axes)
