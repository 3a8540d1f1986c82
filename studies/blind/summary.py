"""`blind.json`: every score of a battery, from its trials.

Leave-one-out: an effect of the catalogue is hidden, and the diagnosis must do without its cause.
Every effect becomes an unknown, of which everything else is known. The battery's menu says which
measured quantities such an unknown follows.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from realitygap.studies.blind.directory import BlindDirectory
from realitygap.studies.blind.limits import LENGTH, detection_limit, share
from realitygap.studies.blind.scoring import CANNOT_TELL, Score, of_robots, outcome, score
from realitygap.studies.blind.trials import ENTRIES, BlindConfig, Trial
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.plumbing.provenance import versions


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
        "flagged_unexplained": _share_of([s.verdict == "unexplained" for s, _ in scored]),
        "wrong_name_alone": _share_of(
            [bool(s.wrong) and s.verdict != "unexplained" for s, _ in scored]
        ),
        "quantity_right": _share_of([right for _, right in scored]),
    }


def _share_of(flags: Sequence[bool]) -> dict[str, float | int | None]:
    return share(sum(flags), len(flags))


SCHEMA = 1
ABSTAINED = ("ambiguous", "unexplained", "nothing_wrong", CANNOT_TELL, "failed")
"""Outcomes that give no name."""


@dataclass(frozen=True)
class Result:
    """A trial, its score, and what it took."""

    trial: Trial
    score: Score
    error: str | None
    seconds: float
    """Wall time of the diagnosis."""
    unexplained: tuple[str, ...]
    """What the diagnosis says of what it cannot name."""
    quantity_right: bool
    """Of an effect without a name: it is said to follow what it follows."""


def results(directory: BlindDirectory[BlindConfig]) -> list[Result]:
    """All finished trials, scored; a crowd is one result per robot with an effect, and the rest."""
    found = []
    for trial, answer in directory.answers():
        if trial.kind == "single" and len(trial.hidden) > 1:
            found += [_result(part, answer, said) for part, said in _parts(trial, answer)]
        else:
            found.append(_result(trial, answer, answer["diagnosis"]))
    return found


def _result(trial: Trial, answer: dict[str, Any], said: dict[str, Any] | None) -> Result:
    unexplained = () if said is None else said.get("unexplained", ())
    return Result(
        trial,
        score(trial, said),
        answer["error"],
        float(answer["diagnose_seconds"]),
        tuple(f"{one['channel']} {one['where']}" for one in unexplained),
        bool(trial.hidden) and quantity_right(_follows(trial), trial, said),
    )


def _follows(trial: Trial) -> frozenset[str]:
    """Measured quantities that tell a trial's effect."""
    return frozenset(ENTRIES[trial.hidden[0].name].follows.split())


def _parts(trial: Trial, answer: dict[str, Any]) -> list[tuple[Trial, dict[str, Any] | None]]:
    """A crowd's robots, each with what is said of it, and those with nothing."""
    whole = answer["diagnosis"]
    everyone = set(range(trial.run.robots))
    parts: list[tuple[Trial, set[int]]] = []
    for one in trial.hidden:
        parts.append(
            (replace(trial, hidden=(one,), looked_at=frozenset(one.robots)), set(one.robots))
        )
        everyone -= set(one.robots)
    rest = replace(trial, kind="rest", hidden=(), looked_at=frozenset(everyone))
    parts.append((rest, everyone))
    return [
        (part, None if whole is None else of_robots(whole, robots, swarm=part is rest))
        for part, robots in parts
    ]


def summarise(directory: BlindDirectory[BlindConfig]) -> dict[str, Any]:
    """The content of `blind.json`."""
    done = results(directory)
    singles = [r for r in done if r.trial.kind == "single"]
    pairs = [r for r in done if r.trial.kind == "pair"]
    healthy = [r for r in done if r.trial.kind == "healthy"]
    strange = [r for r in done if r.trial.kind == "unlisted"]
    left_out = [r for r in done if r.trial.kind == "left_out"]
    listed = [r for r in done if r.trial.kind not in ("unlisted", "left_out")]
    names = [name for name in MENU if name in directory.config.effects]
    return {
        "schema": SCHEMA,
        "config": directory.config.model_dump(mode="json"),
        "versions": versions(),
        "trials": len({r.trial.index for r in done}),
        "failed": sorted({f"{r.trial.name}: {r.error}" for r in done if r.error}),
        "diagnose_seconds": _times(done),
        "healthy_runs": {
            "robots_accused": share(
                sum(r.score.accused for r in healthy), sum(r.score.healthy for r in healthy)
            ),
            "unexplained": _share(r.score.verdict == "unexplained" for r in healthy),
            "nothing_wrong": _share(r.score.verdict == "nothing_wrong" for r in healthy),
            "cannot_tell": _share(r.score.verdict == CANNOT_TELL for r in healthy),
        },
        "healthy_robots_accused": share(
            sum(r.score.accused for r in listed), sum(r.score.healthy for r in listed)
        ),
        "wrong_names": _wrong(listed),
        "coverage": _share(inside for r in listed for inside in r.score.inside),
        "confusion": _confusion(names, singles, healthy),
        "effects": {name: _effect(name, singles, directory.config.seed) for name in names},
        "unlisted": {
            **unknowns([(r.score, r.quantity_right) for r in strange]),
            "answers": [
                {"hidden": _told(r), "follows": ENTRIES[_names(r)[0]].follows, "answer": _said(r)}
                for r in strange
            ],
        },
        "leave_one_out": {
            **unknowns([(r.score, r.quantity_right) for r in left_out]),
            "by_effect": {
                name: unknowns([(r.score, r.quantity_right) for r in left_out if name in _names(r)])
                for name in names
            },
            "answers": [{"hidden": _told(r), "answer": _said(r)} for r in left_out],
        },
        "pairs": {
            "exact": _share(r.score.exact for r in pairs),
            "by_pair": {
                " + ".join(key): _share(r.score.exact for r in pairs if _names(r) == key)
                for key in sorted({_names(r) for r in pairs})
            },
        },
    }


def _share(flags: Any) -> dict[str, float | int | None]:
    found = [bool(flag) for flag in flags]
    return share(sum(found), len(found))


def _names(result: Result) -> tuple[str, ...]:
    return tuple(sorted(one.name for one in result.trial.hidden))


def _times(done: Sequence[Result]) -> dict[str, float] | None:
    if not done:
        return None
    seconds = [r.seconds for r in done]
    return {"median": round(float(np.median(seconds)), 2), "largest": round(max(seconds), 2)}


def _wrong(done: Sequence[Result]) -> dict[str, Any]:
    """Names given that are not true, among all names given, and which."""
    right = sum(sum(r.score.right) for r in done)
    wrong = [(r, name) for r in done for name in r.score.wrong]
    return {
        **share(len(wrong), right + len(wrong)),
        "which": [f"{r.trial.name}: {name} for {_told(r)}" for r, name in wrong],
    }


def _told(result: Result) -> str:
    """What was hidden, in words."""
    hidden = result.trial.hidden
    return " and ".join(f"{one.name} at {one.multiple:.2g} bars" for one in hidden) or "nothing"


def _said(result: Result) -> str:
    """Verdict, names that are not true, and what is said to be unexplained."""
    return "; ".join((result.score.verdict, *result.score.wrong, *result.unexplained))


def _confusion(
    names: Sequence[str], singles: Sequence[Result], healthy: Sequence[Result]
) -> dict[str, dict[str, int]]:
    """Rows: what was hidden; columns: what was answered."""
    rows: dict[str, Counter[str]] = {name: Counter() for name in names}
    rows["nothing"] = Counter()
    for r in (*singles, *healthy):
        rows[r.trial.hidden[0].name if r.trial.hidden else "nothing"][
            outcome(r.trial, r.score)
        ] += 1
    return {name: dict(sorted(row.items())) for name, row in rows.items()}


def _effect(name: str, singles: Sequence[Result], seed: int) -> dict[str, Any]:
    """How one effect fares: in a robot (or the place), and in the whole swarm."""
    entry = MENU[name]
    mine = [r for r in singles if r.trial.hidden[0].name == name]
    swarm_bar = entry.swarm_bar
    alone = [r for r in mine if r.trial.hidden[0].robots or not swarm_bar]
    swarm = [r for r in mine if not r.trial.hidden[0].robots and swarm_bar]
    found = {"unit": entry.unit, "bar": entry.bar, **_scores(alone, entry.bar, seed)}
    if swarm:
        found["whole_swarm"] = {"bar": swarm_bar, **_scores(swarm, swarm_bar, seed)}
    return found


def _scores(mine: Sequence[Result], bar: float, seed: int) -> dict[str, Any]:
    """Shares over all sizes, at and above the bar, and the limit."""
    hidden = [r.trial.hidden[0] for r in mine]
    right = [r.score.right[0] for r in mine]
    strong = [
        hit
        for hit, one, r in zip(right, hidden, mine, strict=True)
        if one.multiple >= 0.999 and r.trial.seconds >= LENGTH
    ]
    found: dict[str, Any] = {
        "named": _share(right),
        "named_from_bar_on": _share(strong),
        "ambiguous": _share(any(r.score.among) for r in mine),
        "abstained": _share(outcome(r.trial, r.score) in ABSTAINED for r in mine),
        "wrong": _share(bool(r.score.wrong) for r in mine),
        "coverage": _share(inside for r in mine for inside in r.score.inside),
        "limit": None,
    }
    if bar and len({one.multiple for one in hidden}) > 1:
        found["limit"] = _limit(mine, bar, seed)
    return found


def _limit(mine: Sequence[Result], bar: float, seed: int) -> dict[str, Any] | None:
    """Size named in 95 % of trials, in the effect's unit."""
    limit = detection_limit(
        [r.trial.hidden[0].multiple for r in mine],
        [r.trial.seconds for r in mine],
        [r.score.right[0] for r in mine],
        np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(len(mine), 1))),
    )
    if limit is None:
        return None
    return {
        "value": round(bar * limit.value, 8),
        "low": round(bar * limit.low, 8),
        "high": round(bar * limit.high, 8),
        "seconds": LENGTH,
        "per_doubling_of_the_log": round(limit.per_doubling, 3),
        "beyond_sizes_tried": limit.beyond,
    }
