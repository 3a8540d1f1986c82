"""How pages and notebooks draw: one look, whatever was drawn before."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
import seaborn as sns
from matplotlib.figure import Figure

DPI = 120
HALF = 5.4
"""inches: a picture of half the page's width, which a phone shows whole."""


@contextmanager
def themed() -> Iterator[None]:
    """Draw in our look, and leave the settings of whoever imports this program as they were."""
    with mpl.rc_context():
        mpl.rcdefaults()
        sns.set_theme(style="whitegrid", font_scale=0.85)
        yield


def canvas(width: float, height: float) -> Figure:
    """An empty picture in inches."""
    return Figure(figsize=(width, height), layout="constrained")


def save(figure: Figure, path: Path) -> None:
    """A PNG whose bytes depend on the picture alone."""
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
