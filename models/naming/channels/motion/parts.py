"""Parts of a log by what a robot was doing: starting, fast or slow, turning or straight, when."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.channels.motion.tracks import Tracks

Mask = npt.NDArray[np.bool_]

PARTS = {
    "start": "in the first second after a start",
    "speed": "in fast motion",
    "turning": "in sharp turns",
    "turn_side": "in turns to the left",
    "change": "after changes of command",
    "time": "late in the log",
    "run": "in the later runs",
    "heading x": "facing along x",
    "heading y": "facing along y",
    "heading axis": "facing along x or against it",
    "place x": "at larger x",
    "place y": "at larger y",
}
"""Parts of a log, in words."""


def parts(tracks: Tracks) -> dict[str, Mask]:
    """(windows,) which windows are in each part."""
    about = {name: tracks.about[:, k] for k, name in enumerate(tracks.columns)}
    count = np.diff(np.append(tracks.first, len(tracks.rows)))

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(np.nan_to_num(values)[tracks.rows], tracks.first) / count)

    def upper(values: FloatArray) -> Mask:
        seen = mean(values)
        return np.asarray(seen > np.median(seen))

    return {
        "start": mean((tracks.since_start <= tracks.rules.started).astype(np.float64)) > 0.5,
        "speed": upper(np.abs(about["speed"])),
        "turning": upper(np.abs(about["turn"])),
        "turn_side": mean(about["turn"]) > 0.0,
        "change": upper(about["change"]),
        "time": upper(about["time"]),
        "run": upper(tracks.row_segment.astype(np.float64)),
        "heading x": mean(np.cos(about["heading"])) > 0.0,
        "heading y": mean(np.sin(about["heading"])) > 0.0,
        "heading axis": mean(np.cos(2.0 * about["heading"])) > 0.0,
        "place x": upper(about["x"]),
        "place y": upper(about["y"]),
    }
