"""Error against horizon: how far the point model is off after a step, 0.4, 1, 5 and 20 seconds."""

from __future__ import annotations

import numpy as np
import pandas as pd

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.replay import HORIZONS, errors, windows
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise, window_noise

QUANTILES = {"median": 0.5, "p95": 0.95}
COLUMNS = {"position": "m", "heading": "rad"}


def horizon_errors(log: MeasuredLog, replayed: FloatArray, noise: PoseNoise) -> pd.DataFrame:
    """One row per horizon, run and robot: windows, and quantiles of position and heading error.

    All windows are taken, one from every row. Columns: horizon, seconds (median length), windows,
    for `position` (m) and `heading` (rad) the median and the 95 % quantile of the absolute error
    and the median that tracker noise alone would give (`_noise`), run, robot. Medians, because one
    to four per cent of a tracker's samples are gross failures. Horizons longer than the log are
    absent.

    Args:
        log: The measured log.
        replayed: (rows, 3) its commands through the model.
        noise: The tracker's.
    """
    measured = log.poses
    rng = np.random.default_rng(np.random.SeedSequence(0))
    parts = []
    for name, length in HORIZONS.items():
        pairs = windows(log, length)
        if not len(pairs.first):
            continue
        error = errors(measured, replayed, pairs)
        noisy = window_noise(measured, pairs, noise) * rng.normal(size=error.shape)
        table = pd.DataFrame(
            {
                "segment": log.segment[pairs.first],
                "seconds": log.t[pairs.last] - log.t[pairs.first],
                "position": np.hypot(error[:, 0], error[:, 1]),
                "heading": np.abs(error[:, 2]),
                "position_noise": np.hypot(noisy[:, 0], noisy[:, 1]),
                "heading_noise": np.abs(noisy[:, 2]),
            }
        )
        by = table.groupby("segment")
        quantiles = {
            f"{channel}_{label}": by[channel].quantile(q)
            for channel in COLUMNS
            for label, q in QUANTILES.items()
        }
        noises = {f"{channel}_noise": by[f"{channel}_noise"].median() for channel in COLUMNS}
        part = pd.DataFrame({"seconds": by["seconds"].median(), "windows": by.size()})
        parts.append(part.assign(horizon=name, **quantiles, **noises).join(log.segments))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()
