"""Where a robot was seen, where its model said it would be, and where the extended one does."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.gap.believed import motions, replay_believed
from realitygap.models.gap.conditions import conditions, never_touching
from realitygap.models.gap.motion_gap import throughout
from realitygap.models.gap.replay import HORIZONS, errors, windows
from realitygap.models.log.frames import Rows, Windows, motion, moved
from realitygap.models.log.measured import MeasuredLog
from realitygap.studies.pages.drawing import HALF, canvas, save

AHEAD = ("20 s", "5 s", "1 s")
"""Lengths of stretches, the first of which the log has some is taken."""
AROUND = 60.0
"""s of the track drawn before and after the worst stretch; our choice: more is a tangle."""
COLOURS = {"measured": "#333333", "predicted": "#c0392b", "corrected": "#1f77b4"}
STYLES = {"measured": "-", "predicted": "--", "corrected": "-."}


@dataclass(frozen=True, eq=False)
class Tracks2D:
    """Paths of one robot around the stretch in which its model was furthest off."""

    robot: int
    run: str
    seconds: float
    """Length of a stretch: predictions begin anew at a measured pose so often."""
    table: pd.DataFrame
    """A row per moment: `t` (s), `stretch`, and `x`, `y` (m) of every path, as `measured_x`."""
    worst: int
    """Number of the stretch."""
    free: bool
    """Whether nothing was touched in it."""
    off: dict[str, float]
    """m at its end, of `predicted` and `corrected`."""


def worst_tracks(
    log: MeasuredLog, before: ModelFile, after: ModelFile, robots: set[int]
) -> Tracks2D | None:
    """The paths, of one of some robots (empty: of any); None: no stretch is long enough.

    Args:
        log: Measured.
        before: The model as it was.
        after: The extended one.
        robots: Whom the causes concern.
    """
    of_row = log.frame["robot"].to_numpy(dtype=np.int64)
    free = never_touching(conditions(log, before), log.tracked)
    for horizon in AHEAD:
        pairs = windows(log, HORIZONS[horizon], apart=True)
        mine = np.isin(of_row[pairs.first], sorted(robots)) if robots else of_row[pairs.first] >= 0
        for ok in (mine & throughout(free, pairs), mine & (horizon == AHEAD[-1])):
            if ok.any():
                some = Windows(pairs.first[ok], pairs.last[ok])
                return _of(log, before, after, some, HORIZONS[horizon], free)
    return None


def _of(
    log: MeasuredLog,
    before: ModelFile,
    after: ModelFile,
    pairs: Windows,
    seconds: float,
    free: np.typing.NDArray[np.bool_],
) -> Tracks2D:
    replayed = {
        name: replay_believed(log, motions(log, file))
        for name, file in (("predicted", before), ("corrected", after))
    }
    off = {n: np.hypot(*errors(log.poses, r, pairs)[:, :2].T) for n, r in replayed.items()}
    most = int(np.argmax(off["predicted"]))
    first = int(pairs.first[most])
    same = log.segment[pairs.first] == log.segment[first]
    near = same & (np.abs(log.t[pairs.first] - log.t[first]) <= AROUND)
    parts = []
    for k in np.flatnonzero(near).tolist():
        rows = np.arange(pairs.first[k], pairs.last[k] + 1)
        rows = rows[log.tracked[rows]]
        paths = {n: _path(log.poses, r, rows) for n, r in replayed.items()}
        paths["measured"] = log.poses[rows]
        columns = {f"{n}_{c}": p[:, j] for n, p in paths.items() for j, c in enumerate("xy")}
        parts.append(pd.DataFrame({"t": log.t[rows], "stretch": k, **columns}))
    return Tracks2D(
        robot=int(log.frame["robot"].iloc[first]),
        run=str(log.frame["run"].iloc[first]),
        seconds=seconds,
        table=pd.concat(parts, ignore_index=True),
        worst=most,
        free=bool(free[first : int(pairs.last[most]) + 1].all()),
        off={name: float(value[most]) for name, value in off.items()},
    )


def _path(measured: FloatArray, replayed: FloatArray, rows: Rows) -> FloatArray:
    """(rows, 3) where a replay goes from the first of the measured poses."""
    begin = np.full(len(rows), rows[0])
    return moved(measured[begin], motion(replayed, Windows(begin, rows)))


def shown_paths(found: Tracks2D) -> list[str]:
    """Which paths differ enough to be drawn: without a correction two lie on one another."""
    same = found.off["predicted"] == found.off["corrected"]
    return ["measured", "predicted"] + ([] if same else ["corrected"])


def draw_tracks(found: Tracks2D, axes: Axes, *, enlarged: bool) -> None:
    """Draw the paths over one another: all of them, or the worst stretch alone."""
    table = found.table
    worst = table[table["stretch"] == found.worst]
    for name in shown_paths(found):
        for k, (_, part) in enumerate((worst if enlarged else table).groupby("stretch")):
            axes.plot(
                part[f"{name}_x"],
                part[f"{name}_y"],
                STYLES[name],
                color=COLOURS[name],
                linewidth=1.8 if enlarged else 1.0,
                label=name if k == 0 else None,
            )
    if enlarged:
        axes.plot(worst["measured_x"].iloc[0], worst["measured_y"].iloc[0], "o", color="#333333")
    else:
        axes.plot(worst["measured_x"], worst["measured_y"], color="#f0c420", linewidth=6, zorder=0)
    axes.set(xlabel="x (m)", ylabel="y (m)")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(fontsize=8)


def track_figures(found: Tracks2D, whole: Path, enlarged: Path) -> None:
    """Write both pictures."""
    for path, large in ((whole, False), (enlarged, True)):
        figure = canvas(HALF, 4.2)
        draw_tracks(found, figure.subplots(), enlarged=large)
        save(figure, path)
