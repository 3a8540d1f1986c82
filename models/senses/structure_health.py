"""What healthy robots and swarms get for every flexible term, and for the family of all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.senses.reference import Structure, gate_of

LEAST_LOGS = 3
"""Healthy logs that a term must show in."""
LEAST_SWARM = 3

Sizes = Mapping[str, FloatArray]
"""By key (robots, 2): size and error, NaN where nothing tells."""


def of_healthy(logs: Sequence[Sizes]) -> tuple[dict[str, Structure], float]:
    """Every term's health, and how far the most conspicuous term of a healthy log reaches.

    The latter is in multiples of that term's own gate, with each log judged by the others: the
    largest over all logs.
    """
    keys = sorted({key for log in logs for key in log})
    whole = {key: band for key in keys if (band := _band([log[key] for log in logs if key in log]))}
    reached = 0.0
    for k, log in enumerate(logs):
        others = [*logs[:k], *logs[k + 1 :]]
        for key, rows in log.items():
            band = _band([one[key] for one in others if key in one])
            if band is not None and key in whole:
                reached = max(reached, _reach(rows, band))
    return whole, reached


def _band(logs: Sequence[FloatArray]) -> Structure | None:
    """Spread of robots and of swarms beyond their own errors; None: too few logs."""
    known = [rows[np.isfinite(rows).all(axis=1)] for rows in logs]
    known = [rows for rows in known if len(rows)]
    if len(known) < LEAST_LOGS:
        return None
    rows = np.concatenate(known)
    pooled = np.array([pool(one[:, 0], one[:, 1]) for one in known if len(one) >= LEAST_SWARM])
    mean = pool(rows[:, 0], rows[:, 1])[0]
    sd, far = _beyond(rows - [mean, 0.0])
    swarm_sd, swarm_far = _beyond(pooled - [mean, 0.0]) if len(pooled) else (0.0, 0.0)
    return Structure(mean=mean, sd=sd, swarm_sd=swarm_sd, farthest=far, swarm_farthest=swarm_far)


def _beyond(rows: FloatArray) -> tuple[float, float]:
    """Spread of (n, 2) values beyond their own errors, and the farthest of them."""
    weight = 1.0 / rows[:, 1] ** 2
    own = len(rows) / float(weight.sum())
    total = float((weight * rows[:, 0] ** 2).sum() / weight.sum())
    sd = float(np.sqrt(max(total - own, own / 9.0)))
    return sd, float(np.max(np.abs(rows[:, 0]) / np.hypot(rows[:, 1], sd)))


def _reach(rows: FloatArray, band: Structure) -> float:
    """Multiples of the gate that a healthy log's robots and swarm reach."""
    known = rows[np.isfinite(rows).all(axis=1)]
    if not len(known):
        return 0.0
    far = np.abs(known[:, 0] - band.mean) / np.hypot(known[:, 1], band.sd)
    reached = float(far.max()) / gate_of(band, swarm=False)
    if len(known) >= LEAST_SWARM:
        mean, error = pool(known[:, 0], known[:, 1])
        far_swarm = abs(mean - band.mean) / np.hypot(error, band.swarm_sd)
        reached = max(reached, float(far_swarm) / gate_of(band, swarm=True))
    return reached


def pool(size: FloatArray, error: FloatArray) -> tuple[float, float]:
    """What several robots say together: their mean weighted by certainty, and its error."""
    weight = 1.0 / np.maximum(error, 1e-12) ** 2
    return float((weight * size).sum() / weight.sum()), float(1.0 / np.sqrt(weight.sum()))
