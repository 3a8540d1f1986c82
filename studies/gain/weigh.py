"""From errors by run to gains: means, bootstrap intervals over runs, the share of the gap closed.

The *reducible gap* is what the minimal model gets wrong beyond what it gets wrong of healthy
robots in like situations. It is closed to the share (before - extended) / (before - healthy).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.replay import HORIZONS
from realitygap.studies.gain.runs import BEFORE, EXTENDED, HEALTHY, ORACLE

RESAMPLED = 2000
"""Bootstrap samples; intervals are their 2.5 and 97.5 % quantiles."""
LEAST_RUNS = 4
"""Runs from which whole runs are resampled; of fewer, the 5 s blocks of each robot."""
MODELS = (BEFORE, HEALTHY, EXTENDED, ORACLE)
KEYS = ["kind", "channel", "horizon"]
KINDS = ("motion", "ps", "ls", "noise", "nest")
SENSES = {"ps": "infrared", "ls": "light"}
"""Kinds whose eight channels are also taken together, under these names."""
HORIZON = "1 s"
"""At which motion is judged first."""


@dataclass(frozen=True)
class Estimate:
    """A value with its 95 % interval; `draws` are the bootstrap's."""

    value: float
    draws: FloatArray

    def as_json(self) -> dict[str, float] | None:
        """Value, low, high; None where it does not exist."""
        known = self.draws[np.isfinite(self.draws)]
        if not np.isfinite(self.value) or not len(known):
            return None
        low, high = np.quantile(known, (0.025, 0.975))
        return {"value": float(self.value), "low": float(low), "high": float(high)}


def weigh(table: pd.DataFrame, *, seed: int = 0) -> list[dict[str, Any]]:
    """The entries of `errors` in `gain.json`.

    Args:
        table: Of `prediction_errors`, with `run` and models of `MODELS`; a twin has the name of
            the run whose twin it is.
        seed: Of the bootstrap.
    """
    both = pd.concat([table, *_together(table)], ignore_index=True)
    names, both["unit_of"] = np.unique(_units(both), return_inverse=True)
    rng = np.random.default_rng(seed)
    picks = rng.integers(0, len(names), (RESAMPLED, len(names)))
    entries = []
    for (kind, channel, horizon), part in both.groupby(KEYS, sort=False):
        found = {
            str(name): _mean(rows, picks)
            for name, rows in part.groupby("model", sort=False)
            if rows["number"].sum()
        }
        if HEALTHY in found and BEFORE in found:
            healthy, judged = (part[part["model"] == name] for name in (HEALTHY, BEFORE))
            found[HEALTHY] = _alike(healthy, judged, picks)
        if BEFORE in found:
            labels = {"kind": kind, "channel": channel, "horizon": horizon or None}
            number = int(part.loc[part["model"] == BEFORE, "number"].sum())
            entries.append({**labels, "unit": part["unit"].iloc[0], "number": number, **_of(found)})
    return sorted(entries, key=_rank)


def _together(table: pd.DataFrame) -> list[pd.DataFrame]:
    """All channels of a sense as one."""
    return [
        table[table["kind"] == kind].assign(channel=name)
        for kind, name in SENSES.items()
        if (table["kind"] == kind).any()
    ]


def _units(table: pd.DataFrame) -> pd.Series[str]:
    """What is resampled as a whole."""
    if table["run"].nunique() >= LEAST_RUNS:
        return table["run"].astype(str)
    run, robot, block = (table[name].astype(str) for name in ("run", "robot", "block"))
    return run + "/" + robot + "/" + block


def _mean(rows: pd.DataFrame, picks: npt.NDArray[np.int64]) -> Estimate:
    """Mean error, and the same of every bootstrap sample."""
    index, size = rows["unit_of"].to_numpy(), picks.shape[1]
    total = np.bincount(index, rows["total"], size)
    number = np.bincount(index, rows["number"], size)
    with np.errstate(invalid="ignore", divide="ignore"):
        draws = total[picks].sum(axis=1) / number[picks].sum(axis=1)
    return Estimate(float(total.sum() / number.sum()), draws)


def _alike(healthy: pd.DataFrame, judged: pd.DataFrame, picks: npt.NDArray[np.int64]) -> Estimate:
    """Mean error of healthy robots in situations as frequent as they are for the robots judged.

    Situations in which no healthy robot was are left out.
    """
    weight = judged.groupby("stratum")["number"].sum()
    parts = dict(iter(healthy.groupby("stratum")))
    means = [_mean(rows, picks) for rows in parts.values()]
    share = np.array([weight.get(stratum, 0) for stratum in parts], dtype=float)
    if not share.any():
        return _mean(healthy, picks)
    draws = np.array([one.draws for one in means])
    known = np.where(np.isfinite(draws), share[:, None], 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        drawn = (known * np.nan_to_num(draws)).sum(axis=0) / known.sum(axis=0)
    value = float(share @ np.array([one.value for one in means]) / share.sum())
    return Estimate(value, drawn)


def _of(found: dict[str, Estimate]) -> dict[str, Any]:
    """Errors by model, and what can be said of them together."""
    told: dict[str, Any] = {
        name: found[name].as_json() if name in found else None for name in MODELS
    }
    before, after, healthy = (found.get(name) for name in (BEFORE, EXTENDED, HEALTHY))
    told |= {"reducible": None, "closed": None, "over_healthy": None, "remains": None}
    if after is None or before is None or healthy is None:
        return told
    with np.errstate(invalid="ignore", divide="ignore"):
        reducible = Estimate(before.value - healthy.value, before.draws - healthy.draws)
        told["reducible"] = reducible.as_json()
        ratio = Estimate(after.value / max(healthy.value, 1e-300), after.draws / healthy.draws)
        told["over_healthy"] = ratio.as_json()
        remains = Estimate(after.value - healthy.value, after.draws - healthy.draws)
        told["remains"] = remains.as_json()
        if told["reducible"] is not None and told["reducible"]["low"] > 0.0:
            gain = before.value - after.value, before.draws - after.draws
            share = Estimate(gain[0] / reducible.value, gain[1] / reducible.draws)
            told["closed"] = share.as_json()
    return told


def _rank(entry: dict[str, Any]) -> tuple[Any, ...]:
    """Motion before senses, what is judged first before the rest, all sensors before each."""
    kind, channel, horizon = (entry[key] for key in KEYS)
    order = list(HORIZONS).index(horizon) if horizon else 0
    alone = kind in SENSES and channel not in SENSES.values()
    return KINDS.index(kind), horizon != HORIZON, order, alone, channel != "position", channel


def entry(errors: list[dict[str, Any]], channel: str, horizon: str | None = None) -> dict[str, Any]:
    """The entry of a channel.

    Raises:
        KeyError: there is none.
    """
    for one in errors:
        if one["channel"] == channel and one["horizon"] == horizon:
            return one
    raise KeyError((channel, horizon))
