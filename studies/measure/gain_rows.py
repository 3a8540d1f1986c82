"""A row of the catalogue: where an effect shows most, and what naming it was worth there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from realitygap.reality.effects import catalogue
from realitygap.studies.blind.trials import Hidden
from realitygap.studies.gain.runs import BEFORE, EXTENDED, HEALTHY, ORACLE
from realitygap.studies.gain.weigh import weigh
from realitygap.studies.run.experiment import RunConfig

MOTION = (("position", "1 s"), ("heading", "1 s"))
CHANNELS: dict[str, tuple[tuple[str, str | None], ...]] = {
    "motion": MOTION,
    "infrared": (("infrared", None),),
    "light": (("light", None),),
    "task": (("nest", None),),
}
"""Where effects of a kind show, but for these:"""
ELSEWHERE: dict[str, tuple[tuple[str, str | None], ...]] = {
    "ir_noise": (("infrared noise", None),),
    "ir_rotation": (("infrared", None), ("light", None)),
}


def rows_of(
    hidden: Sequence[Hidden],
    seed: int,
    naming: RunConfig,
    answer: dict[str, Any],
    table: pd.DataFrame,
    healthy: pd.DataFrame,
) -> list[dict[str, Any]]:
    """One row per effect of a group.

    Args:
        hidden: The effects.
        seed: Of the intervals.
        naming: The run whose log named.
        answer: Its diagnosis.
        table: Errors in the held-out runs.
        healthy: Errors in their healthy twins.
    """
    rows = []
    for one in hidden:
        mine = table[table["robot"].isin(one.robots)] if one.robots else table
        errors = {
            (e["channel"], e["horizon"]): e
            for e in weigh(pd.concat([mine, healthy], ignore_index=True), seed=seed)
        }
        kind = catalogue()[one.name].kind
        candidates = [c for c in ELSEWHERE.get(one.name, CHANNELS[kind]) if c in errors]
        sensor = str(one.values.get("sensor", "all"))
        if sensor != "all":
            candidates.append((f"{'ps' if kind == 'infrared' else 'ls'}{sensor}", None))
        shows = max(candidates, key=lambda c: _excess(errors[c]))
        found = errors[shows]
        rows.append(
            {
                "effect": one.name,
                "hidden": _short(one),
                "answer": _answer(one, answer),
                "channel": " ".join(filter(None, shows)),
                "unit": found["unit"],
                **{m: _value(found[m]) for m in (BEFORE, HEALTHY, EXTENDED, ORACLE)},
                **_interval("over_healthy", found["over_healthy"]),
                **_interval("closed", found["closed"]),
                **{
                    f"{channel}_1s": _value(errors[channel, horizon]["over_healthy"])
                    for channel, horizon in MOTION
                },
                "naming": f"{naming.controller} {naming.case} {naming.seed}",
            }
        )
    return rows


def _short(one: Hidden) -> str:
    """Values and robots, to three digits."""
    values = [f"{k} {v if isinstance(v, str) else format(v, '.3g')}" for k, v in one.values.items()]
    return ", ".join([*values, *(f"robot {robot}" for robot in one.robots)])


def _excess(entry: dict[str, Any]) -> float:
    """How many times the healthy error the minimal model makes."""
    if entry[HEALTHY] is None or not entry[HEALTHY]["value"]:
        return float(entry[BEFORE]["value"] > 0)
    return float(entry[BEFORE]["value"] / entry[HEALTHY]["value"])


def _value(estimate: dict[str, float] | None) -> float:
    return np.nan if estimate is None else estimate["value"]


def _interval(name: str, estimate: dict[str, float] | None) -> dict[str, float]:
    keys = {"value": name, "low": f"{name}_low", "high": f"{name}_high"}
    return {to: np.nan if estimate is None else estimate[at] for at, to in keys.items()}


def _answer(one: Hidden, answer: dict[str, Any]) -> str:
    """What the diagnosis said of the robots that an effect was hidden in."""
    said = [
        cause
        for cause in answer["causes"]
        if cause["robots"] == "all" or not one.robots or set(one.robots) & set(cause["robots"])
    ]
    names = [cause["name"] for cause in said]
    if one.name not in names:
        rivals = [c["name"] for c in said if one.name in c["alternatives"]]
        return f"{rivals[0]} or it" if rivals else "as " + " + ".join(names) if names else "nothing"
    own = next(cause for cause in said if cause["name"] == one.name)
    with_rivals = f", or {' or '.join(own['alternatives'])}" if own["alternatives"] else ""
    beside = [name for name in names if name != one.name]
    return "named" + with_rivals + (f" + {' + '.join(beside)}" if beside else "")
