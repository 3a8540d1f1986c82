"""Leave-one-out: an effect of the catalogue is hidden, and the diagnosis must do without its cause.

Every effect becomes an unknown, of which everything else is known. The battery's menu says which
measured quantities such an unknown follows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from realitygap.studies.blind.limits import share
from realitygap.studies.blind.scoring import Score
from realitygap.studies.blind.trials import Trial


def quantity_right(
    follows: frozenset[str], trial: Trial, diagnosis: Mapping[str, Any] | None
) -> bool:
    """Whether what is said to be unexplained, of robots that have it, follows the right thing."""
    robots = {robot for one in trial.hidden for robot in one.robots}
    return any(
        one.get("quantity") in follows
        for one in (() if diagnosis is None else diagnosis.get("unexplained", ()))
        if one.get("robots", "all") == "all" or not robots or robots & set(one["robots"])
    )


def unknowns(scored: Sequence[tuple[Score, bool]]) -> dict[str, Any]:
    """How effects without a name fare: (score, whether the quantity is right) of each."""
    return {
        "flagged_unexplained": _share([s.verdict == "unexplained" for s, _ in scored]),
        "wrong_name_alone": _share(
            [bool(s.wrong) and s.verdict != "unexplained" for s, _ in scored]
        ),
        "quantity_right": _share([right for _, right in scored]),
    }


def _share(flags: Sequence[bool]) -> dict[str, float | int | None]:
    return share(sum(flags), len(flags))
