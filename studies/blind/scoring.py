"""What a diagnosis is worth, once what was hidden is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from realitygap.studies.blind.trials import Hidden, Trial
from realitygap.studies.hidden.shares import as_told

CANNOT_TELL = "cannot_tell"
"""The verdict on a log that could not have shown what might be wrong."""
MOST = 0.8
"""Of the robots: naming a swarm-wide cause for so many of them is naming it; our choice."""


@dataclass(frozen=True)
class NamedAnswer:
    """A cause that a diagnosis names."""

    name: str
    robots: frozenset[int]
    swarm: bool
    """Named for the whole swarm."""
    rivals: tuple[str, ...]
    """Others that the data cannot tell from it; the name is then only a candidate."""
    exported: bool
    """It stands in the extended model; if not, the diagnosis saw it and does not rely on it."""
    parameters: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Score:
    """One trial's result."""

    verdict: str
    """Of the diagnosis, or `failed`."""
    right: tuple[bool, ...]
    """Per hidden effect: named, for the robots that have it."""
    among: tuple[bool, ...]
    """Per hidden effect: not named, but among the candidates of an ambiguous cause."""
    wrong: tuple[str, ...]
    """Names given that are not what any of their robots has."""
    healthy: int
    """Robots with nothing hidden in them or in all; none where the log could not tell."""
    accused: int
    """Of these, those that a cause is named for."""
    inside: tuple[bool, ...]
    """Per parameter of a rightly named effect: its interval holds the truth."""

    @property
    def exact(self) -> bool:
        """Everything named, and nothing else."""
        return all(self.right) and not self.wrong and not self.accused


def score(trial: Trial, diagnosis: Mapping[str, Any] | None) -> Score:
    """Compare a diagnosis with what was hidden; no diagnosis counts as one that says nothing."""
    robots = trial.run.robots
    verdict = "failed" if diagnosis is None else str(diagnosis["verdict"])
    causes = [] if diagnosis is None else named(diagnosis, robots)
    right, among = [], []
    inside: list[bool] = []
    for one in trial.hidden:
        found = next((c for c in causes if _right(one, c, robots)), None)
        right.append(found is not None)
        among.append(found is None and any(_among(one, c) for c in causes))
        if found is not None:
            inside += _inside(one, found)
    affected = {robot for one in trial.hidden for robot in one.robots}
    everywhere = any(not one.robots for one in trial.hidden)
    looked_at = set(range(robots)) if trial.looked_at is None else set(trial.looked_at)
    silent = verdict == CANNOT_TELL and not causes  # neither accuses nor acquits
    healthy = set() if everywhere or silent else looked_at - affected
    accused = {robot for cause in causes for robot in cause.robots if robot in healthy}
    return Score(
        verdict=verdict,
        right=tuple(right),
        among=tuple(among),
        wrong=tuple(c.name for c in causes if not _true(c, trial.hidden)),
        healthy=len(healthy),
        accused=len(accused),
        inside=tuple(inside),
    )


def of_robots(
    diagnosis: Mapping[str, Any], robots: set[int], *, swarm: bool = True
) -> dict[str, Any]:
    """What a diagnosis says of some robots: its causes and verdict as if they were all there is.

    Causes of the whole swarm are among them only if `swarm`: each is said once.
    """
    causes = []
    for cause in diagnosis["causes"]:
        if cause["robots"] == "all":
            causes += [cause] if swarm else []
        elif robots & set(cause["robots"]):
            causes.append({**cause, "robots": sorted(robots & set(cause["robots"]))})
    unexplained = [
        one
        for one in diagnosis.get("unexplained", ())
        if one.get("robots", "all") == "all" or robots & set(one["robots"])
    ]
    verdict = diagnosis["verdict"]
    if verdict == "unexplained" and not unexplained:
        verdict = "ambiguous"  # if any cause has rivals
    if verdict not in ("unexplained", CANNOT_TELL) and not causes:
        verdict = "nothing_wrong"
    return {"verdict": verdict, "causes": causes, "unexplained": unexplained}


def named(diagnosis: Mapping[str, Any], robots: int) -> list[NamedAnswer]:
    """The causes of a `diagnosis.json`, with their rivals: these decide, whatever the verdict."""
    causes = []
    for cause in diagnosis["causes"]:
        swarm = cause["robots"] == "all"
        causes.append(
            NamedAnswer(
                name=str(cause["name"]),
                robots=frozenset(range(robots) if swarm else cause["robots"]),
                swarm=swarm,
                rivals=tuple(str(name) for name in cause.get("alternatives", ())),
                exported=bool(cause.get("exported", True)),
                parameters=cause["parameters"],
            )
        )
    return causes


def outcome(trial: Trial, result: Score) -> str:
    """One word for a trial with at most one effect: a name, or the verdict that gives none."""
    if trial.hidden and result.right[0] and not result.wrong:
        return trial.hidden[0].name
    if result.wrong:
        return result.wrong[0]
    return "ambiguous" if any(result.among) else result.verdict


def _right(one: Hidden, cause: NamedAnswer, robots: int) -> bool:
    """Named, unambiguously, for the robots that have it and no others, and relied on."""
    if cause.rivals or not cause.exported or not _is(one, cause) or cause.name != one.name:
        return False
    if one.robots:
        return cause.robots == set(one.robots)
    return cause.swarm or len(cause.robots) >= MOST * robots


def _among(one: Hidden, cause: NamedAnswer) -> bool:
    """One of the candidates for a robot that has it."""
    return _is(one, cause) and any(_has(one, robot) for robot in cause.robots)


def _true(cause: NamedAnswer, hidden: Sequence[Hidden]) -> bool:
    """No lie: each of its robots has it, or something of a class that holds it."""
    return bool(cause.robots) and all(
        any(_has(one, robot) and _is(one, cause) for one in hidden) for robot in cause.robots
    )


def _has(one: Hidden, robot: int) -> bool:
    return not one.robots or robot in one.robots


def _is(one: Hidden, cause: NamedAnswer) -> bool:
    """A cause's name, or a rival's, is an effect's; its own with the right wheel or sensor."""
    if cause.name == one.name:
        return _same_words(one, cause)
    return one.name in cause.rivals


def _same_words(one: Hidden, cause: NamedAnswer) -> bool:
    """Which wheel or sensor, where the diagnosis says so."""
    return all(
        str(cause.parameters[key]["value"]) == value
        for key, value in one.values.items()
        if isinstance(value, str) and key in cause.parameters
    )


def _inside(one: Hidden, cause: NamedAnswer) -> Sequence[bool]:
    """Whether the intervals of the numbers hold what was hidden."""
    told = as_told(one.name, one.values)
    numbers = {key: value for key, value in told.items() if isinstance(value, float)}
    return [
        float(cause.parameters[key]["low"]) <= value <= float(cause.parameters[key]["high"])
        for key, value in numbers.items()
        if key in cause.parameters and cause.parameters[key].get("low") is not None
    ]
