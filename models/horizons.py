"""Error against horizon: how far the point model is off after a step, 0.4, 1, 5 and 20 seconds."""

from __future__ import annotations

import numpy as np
import pandas as pd

from embedded_sim import PointModel
from models.log import MeasuredLog
from models.replay import HORIZONS, errors, replay_log, windows


def horizon_errors(log: MeasuredLog, model: PointModel) -> pd.DataFrame:
    """One row per horizon, run and robot: windows, and quantiles of position and heading error.

    Columns: horizon, seconds (median length), run, robot, windows, then for `position` (m) and
    `heading` (rad) the median and the 95 % quantile of the absolute error. Medians, because one to
    four per cent of a tracker's samples are gross failures. Horizons longer than the
    log are absent.
    """
    replayed, measured = replay_log(log, model.drive), log.poses
    rows = []
    for name, length in HORIZONS.items():
        pairs = windows(log, length)
        if not len(pairs.first):
            continue
        error = errors(measured, replayed, pairs)
        table = pd.DataFrame(
            {
                "segment": log.segment[pairs.first],
                "seconds": log.t[pairs.last] - log.t[pairs.first],
                "position": np.hypot(error[:, 0], error[:, 1]),
                "heading": np.abs(error[:, 2]),
            }
        )
        by = table.groupby("segment")
        rows.append(
            pd.DataFrame(
                {
                    "horizon": name,
                    "seconds": by["seconds"].median(),
                    "windows": by.size(),
                    **{
                        f"{channel}_{label}": by[channel].quantile(q)
                        for channel in ("position", "heading")
                        for label, q in (("median", 0.5), ("p95", 0.95))
                    },
                }
            ).join(log.segments)
        )
    return pd.concat(rows, ignore_index=True) if rows else pd.DataFrame()
