"""What the answers of a matrix are worth: every log, then every cell against its bars."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from realitygap.studies.blind.conditions.matrix import CellLog
from realitygap.studies.blind.limits import share
from realitygap.studies.blind.scoring import CANNOT_TELL, Score, score
from realitygap.studies.blind.trials import Hidden

MOST_ACCUSED = 0.01
"""Of the healthy robots of a cell."""
LEAST_NAMED = 0.8
"""Of the logs of a cell in which something is hidden that the log does not silence."""
MOST_WRONG = 0.02
"""Of the logs of a cell, with a name for what its robots do not have."""
MOST_SILENCED = 0.25
"""Of the cells in which something is hidden."""
REFUSAL = "InputError: "
"""How an answer begins that refuses a log; any other failure is a crash."""
FLAGS = ("named", "wrong", "silenced", "refused", "crashed", "unexplained")


@dataclass(frozen=True)
class LogResult:
    """One log: what was hidden and what was said."""

    cell: CellLog
    score: Score
    silenced: str
    """Why the log cannot show what is hidden, as the diagnosis says; empty: it does not say so."""
    error: str
    """Why there is no diagnosis; empty: there is one."""
    said: str

    @property
    def refused(self) -> bool:
        """There is no diagnosis, and one line says why."""
        return self.error.startswith(REFUSAL) and "\n" not in self.error

    @property
    def crashed(self) -> bool:
        """There is no diagnosis, and nobody meant it so."""
        return bool(self.error) and not self.refused

    @property
    def named(self) -> bool:
        """What is hidden is named, rightly."""
        return any(self.score.right)

    @property
    def wrong(self) -> bool:
        """A name is given that is not what its robots have."""
        return bool(self.score.wrong)

    @property
    def unexplained(self) -> bool:
        """Something is said to be wrong that no known cause explains."""
        return self.score.verdict == "unexplained"

    @property
    def failing(self) -> bool:
        """Someone who mends naming should look at it."""
        missed = bool(self.cell.hidden) and not (self.named or self.silenced or self.refused)
        return self.crashed or self.wrong or missed

    def row(self) -> dict[str, Any]:
        """As a table has it."""
        return {
            "condition": self.cell.condition,
            "state": self.cell.state,
            "log": self.cell.index,
            "hidden": " ".join(one.spec for one in self.cell.hidden) or "nothing",
            "verdict": self.score.verdict,
            "healthy": 0 if self.error else self.score.healthy,
            "accused": self.score.accused,
            **{flag: bool(getattr(self, flag)) for flag in FLAGS},
            "failing": self.failing,
            "silenced_by": self.silenced,
            "said": self.said,
        }


def log_result(cell: CellLog, answer: Mapping[str, Any]) -> LogResult:
    """One log's answer against what was hidden in it."""
    diagnosis, error = answer["diagnosis"], answer["error"] or ""
    silenced = ""
    if diagnosis is not None and cell.hidden:
        silenced = silencing(cell.hidden[0], diagnosis)
    said = error if diagnosis is None else _said(diagnosis)
    return LogResult(cell, score(cell, diagnosis), silenced, error, said)


def silencing(one: Hidden, diagnosis: Mapping[str, Any]) -> str:
    """Why, by a diagnosis's own word, its log cannot show an effect of that size; empty: it could.

    The verdict is that it cannot tell; the log's pre-flight takes the cause away; it is not among
    what this log would have shown; or it would have shown only what is larger. The last does not
    count where the cause is named, or a rival: `detectable` is of what comes on top. Nor does it
    where another robot is the one that would have shown it worst.
    """
    if diagnosis["verdict"] == CANNOT_TELL:
        return "the log cannot tell"
    for entry in diagnosis["log"]["preflight"]:
        if entry["follows"] == "silences" and one.name in entry["causes"]:
            return str(entry["why"] or entry["meaning"])
    known = diagnosis["detectable"].get(one.name)
    if known is None:
        return "this cause was not looked for"
    seen = any(one.name in (c["name"], *c["alternatives"]) for c in diagnosis["causes"])
    if seen or known["robot"] not in (None, *one.robots):
        return ""
    if known["size"] is None:
        return "no size of it would have shown"
    departure = abs(float(one.values[known["parameter"]]) - float(known["null"]))
    if known["size"] > departure * (1.0 + 1e-9):
        return f"shown from {known['size']:.2g} {known['unit']} on"
    return ""


def _said(diagnosis: Mapping[str, Any]) -> str:
    """Verdict, causes with their robots and rivals, and what is unexplained, in a line."""
    parts = [str(diagnosis["verdict"])]
    for cause in diagnosis["causes"]:
        numbers = [
            f" {key} {_number(value['value'])}" for key, value in cause["parameters"].items()
        ]
        rivals = [f" or {name}" for name in cause.get("alternatives", ())]
        parts.append(
            f"{cause['name']} of {_robots(cause['robots'])}:{''.join(numbers)}{''.join(rivals)}"
        )
    for one in diagnosis.get("unexplained", ()):
        parts.append(f"unexplained {one['channel']} {one['where']}")
    return "; ".join(parts)


def _robots(robots: Any) -> str:
    return "all" if robots == "all" else ", ".join(str(robot) for robot in robots)


def _number(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def logs_table(results: Iterable[LogResult]) -> pd.DataFrame:
    """A row per log."""
    return pd.DataFrame([one.row() for one in results])


def cells_of(logs: pd.DataFrame) -> list[dict[str, Any]]:
    """Every cell: counts of logs and robots, and which bars are missed.

    Args:
        logs: Of `logs_table`.
    """
    groups = logs.groupby(["condition", "state"], sort=False)
    return [
        {"condition": str(condition), "state": str(state), **_cell(str(state), cell)}
        for (condition, state), cell in groups
    ]


def _cell(state: str, logs: pd.DataFrame) -> dict[str, Any]:
    accused, healthy = int(logs["accused"].sum()), int(logs["healthy"].sum())
    interval = share(accused, healthy)
    counts = {flag: int(logs[flag].sum()) for flag in FLAGS}
    ill = state != "healthy"
    told = ~(logs["silenced"] | logs["refused"]) | logs["named"]
    silent = ill and 2 * int(told.sum()) <= len(logs)
    named = logs.loc[told, "named"]
    misses = {
        "accused": accused > math.floor(MOST_ACCUSED * healthy),
        "wrong": counts["wrong"] > math.floor(MOST_WRONG * len(logs)),
        "missed": ill and not silent and named.sum() < LEAST_NAMED * len(named),
        "crashed": counts["crashed"] > 0,
    }
    return {
        "logs": len(logs),
        "healthy": healthy,
        "accused": accused,
        "accused_low": interval["low"],
        "accused_high": interval["high"],
        **counts,
        "is_silenced": silent,
        "misses": " ".join(name for name, missed in misses.items() if missed),
    }


def summary(cells: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """How many cells there are, how many are silenced, and how many miss which bar."""
    ill = [one for one in cells if one["state"] != "healthy"]
    missed = [word for one in cells for word in one["misses"].split()]
    return {
        "cells": len(cells),
        "passing": sum(not one["misses"] for one in cells),
        "ill": len(ill),
        "silenced": sum(one["is_silenced"] for one in ill),
        **{name: missed.count(name) for name in ("accused", "wrong", "missed", "crashed")},
    }
