"""What is said of the kept logs, as text that another machine gives too; what has changed in it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import realitygap as rg

LOGS = Path(__file__).parent / "logs"
ANSWERS = Path(__file__).parent / "answers"
DIGITS = 6
"""That are kept: the last ones of a double differ between libraries of linear algebra."""
CHANGING = (
    *("inputs", "versions", "log.preflight"),
    *("next_experiment.commands", "next_experiment.plan"),
)
"""Keys that name files and programs, and what a log says of itself: no part of the answer."""

TOLD = ("verdict", "causes", "unexplained")
"""Keys whose differences are told one by one; of the others it is told that they differ."""
Row = tuple[str, str, str, str]
"""Log, what is said, as it is kept, as it is now."""


def log_file(name: str) -> Path:
    """Where a log is kept."""
    return LOGS / f"{name}.parquet"


def answer_file(name: str) -> Path:
    """Where its answer is kept."""
    return ANSWERS / f"{name}.json"


def answer(name: str) -> str:
    """What is said of a log now, as its answer is kept."""
    content = dict(rg.diagnose(log_file(name)).content)
    for key in CHANGING:
        outer, _, inner = key.partition(".")
        if not inner:
            del content[outer]
        elif content[outer] is not None:
            del content[outer][inner]
    return json.dumps(rounded(content), indent=1) + "\n"


def rounded(value: Any) -> Any:
    """The same, numbers to the digits that are kept."""
    if isinstance(value, dict):
        return {name: rounded(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(inner) for inner in value]
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def differences(name: str, before: dict[str, Any], now: dict[str, Any]) -> Iterator[Row]:
    """A row for each thing that is said otherwise, the verdict first."""
    was, became = _said(before), _said(now)
    for what in {**was, **became}:
        if was.get(what) != became.get(what):
            yield name, what, was.get(what, "-"), became.get(what, "-")
    for key in {**before, **now}:
        if key not in TOLD and before.get(key) != now.get(key):
            yield name, key, "", "otherwise"


def _said(content: dict[str, Any]) -> dict[str, str]:
    """What an answer comes to, in words."""
    said = {"verdict": content["verdict"]}
    for cause in content["causes"]:
        who = _who(cause)
        said[f"{cause['name']} of {who}"] = "named" if cause["exported"] else "not exported"
        for parameter, told in cause["parameters"].items():
            interval = f" ({told['low']} to {told['high']})" if "low" in told else ""
            said[f"{cause['name']} of {who}: {parameter}"] = f"{told['value']}{interval}"
    for left in content["unexplained"]:
        follows = f"unexplained: {left['channel']} of {_who(left)} follows {left['quantity']}"
        said[follows] = f"{left['share']} of it, at {left['distance']} s.d."
    return said


def _who(found: dict[str, Any]) -> str:
    robots = found["robots"]
    return robots if isinstance(robots, str) else " ".join(map(str, robots))
