"""From tracks to named causes: what the whole swarm shares first, then each robot by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Motion
from realitygap.models.identify.choice import Choice, Evidence, Mimic
from realitygap.models.identify.feigned import believable, feigned
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.fitted import Fitted, Key, Told
from realitygap.models.identify.hypothesis import Term
from realitygap.models.identify.measure import strength
from realitygap.models.identify.screen import Glance, glance
from realitygap.models.identify.select import FAMILY, choose
from realitygap.models.identify.tracks import Tracks
from realitygap.models.identify.twins import tell_apart
from realitygap.models.identify.value import Value, told
from realitygap.models.reference import Reference

LEAST_SWARM = 3
"""Robots that make a swarm: of two, neither says which one differs."""
ALIKE = 5.0
"""Standard deviations within which a robot shares the swarm's value."""
DEVIANTS = 0.2
"""Most of the robots that may not share it."""
MEDIAN_ERROR = 1.2533
"""Standard error of a median of normal values, relative to a mean's."""
NORMAL = 1.4826
SUSPICIOUS = 0.6
"""Of the distance that a name needs, seen at a first glance, that earns a robot full fits."""

Robots = tuple[int, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Named:
    """A cause, for whom, how large, why, and what else it could be."""

    term: Term
    robots: Robots
    """Ids of the robots that have it."""
    whole_swarm: bool
    values: tuple[Value, ...]
    given: tuple[Value, ...] = ()
    """What they are told against, such as a healthy robot's acceleration."""
    evidence: Evidence
    twins: tuple[Term, ...]
    """Causes that act exactly alike on what this log holds."""
    exported: bool = True
    """Whether the extended model holds it."""
    why: str = ""
    """Why not, where it does not."""

    @property
    def key(self) -> Key:
        """Of its values in parts of the log."""
        return self.evidence.term, self.robots


@dataclass(frozen=True, eq=False, kw_only=True)
class Identified:
    """What was found in one log."""

    named: tuple[Named, ...]
    base: tuple[Motion, ...]
    """(robots,) healthy motion of each robot."""
    explained: tuple[Motion, ...]
    """(robots,) motion with every term kept, but for mimics."""
    looked_at: Robots
    """Ids of the robots that were worth full fits."""
    choices: dict[int, Choice]
    """Each such robot's selection, by index into the tracks' robots."""
    shared: Choice | None
    """The selection for the robots that share something."""
    mimics: dict[int, tuple[Mimic, ...]]
    """By the same index, causes that only mimic something unknown."""
    fits: tuple[Fitted, ...]
    """That the names were taken from: what the swarm shares first, then robot by robot."""


def identify(tracks: Tracks, reference: Reference, believed: Sequence[Motion]) -> Identified:
    """Name what is wrong with the whole swarm and with each robot.

    Args:
        tracks: The log's.
        reference: What healthy robots do.
        believed: The model's motion of each robot.
    """
    base = [reference.motion(motion) for motion in believed]
    seen = glance(Problem(tracks, base))
    named: list[Named] = []
    explained = list(base)
    mimics: dict[int, tuple[Mimic, ...]] = {}
    fits: list[Fitted] = []
    shared = None
    sharing = _sharing(tracks, seen, reference)
    if sharing is not None:
        found = _swarm(tracks, base, reference, sharing)
        if found is not None:
            named, explained, shared, fit = found
            fits.append(fit)
            mimics = dict.fromkeys(np.flatnonzero(sharing).tolist(), shared.mimics)
            seen = glance(Problem(tracks, explained))
    choices = {}
    for k in _suspects(tracks, seen, reference):
        alone = Problem(tracks.only([k]), [explained[k]])
        common = tuple(one.term for one in named if tracks.robots[k] in one.robots)
        choice = choose(alone, reference, shared=common)
        new, fit, mimicked = _names(alone, choice, reference, swarm=False)
        each = _each(named, tracks.robots[k])
        named += [one for one in new if one.evidence.gain >= FAMILY * each]
        explained[k] = fit.motions[0]
        fits.append(fit)
        mimics[k] = mimics.get(k, ()) + mimicked
        choices[k] = choice
    return Identified(
        named=tuple(named),
        base=tuple(base),
        explained=tuple(explained),
        looked_at=tuple(tracks.robots[k] for k in choices),
        choices=choices,
        shared=shared,
        mimics={k: found for k, found in mimics.items() if found},
        fits=tuple(fit for fit in fits if fit.told),
    )


def _each(named: Sequence[Named], robot: int) -> float:
    """Deviance that what a swarm shares takes off one of its robots."""
    shared = [one for one in named if len(one.robots) > 1 and robot in one.robots]
    return sum(one.evidence.gain / len(one.robots) for one in shared)


def _swarm(
    tracks: Tracks,
    base: Sequence[Motion],
    reference: Reference,
    sharing: npt.NDArray[np.bool_],
) -> tuple[list[Named], list[Motion], Choice, Fitted] | None:
    """Names shared by the swarm, each robot's motion with them, the selection behind them, its fit.

    None where nothing is shared.
    """
    chosen = np.flatnonzero(sharing).tolist()
    some = tracks.only(chosen)
    problem = Problem(some, [base[k] for k in chosen], groups=np.zeros(len(chosen), dtype=int))
    choice = choose(problem, reference, swarm=True)
    said = [*choice.named, *(mimic.evidence for mimic in choice.mimics)]
    if not said or not all(_common(problem, choice, one) for one in said):
        return None
    named, fit, mimics = _names(problem, choice, reference, swarm=bool(sharing.all()))
    explained = list(base)
    for k, motion in zip(chosen, fit.motions, strict=True):
        explained[k] = motion
    return named, explained, replace(choice, mimics=mimics), fit


def _common(problem: Problem, choice: Choice, evidence: Evidence) -> bool:
    """Whether nearly every robot, not a few for all, is better off with a shared term."""
    fit = choice.fit
    rest = tuple(t for t in fit.terms if t != evidence.term)
    at = fit.part(evidence.term)
    without = problem.fit(rest, [np.delete(fit.coordinates, np.r_[at], axis=1)])
    robots = len(problem.tracks.robots)
    gain = np.bincount(problem.tracks.robot, problem.gain(without, fit), robots)
    return float((gain > 0.0).mean()) >= 1.0 - DEVIANTS


def _names(
    problem: Problem, choice: Choice, reference: Reference, *, swarm: bool
) -> tuple[list[Named], Fitted, tuple[Mimic, ...]]:
    """The choice's evidence with values and twins, the fit behind them, and what only mimics."""
    fit = choice.fit
    swapped = {}
    for evidence in choice.named:
        apart = tell_apart(problem, fit, evidence.term)
        swapped[evidence.term] = apart
        fit = apart.fit
    group = len(problem.tracks.robots) > 1
    believed, mimics = believable(problem, choice, swapped, reference)
    each = []
    for evidence in believed:
        twins = swapped[evidence.term]
        size = len(twins.chosen.cause.parameters)
        mean, sd = reference.spread(evidence.term.key, size, swarm=group)
        if twins.chosen != evidence.term:  # the healthy mean is in the representative's coordinate
            mean = np.zeros(size)
        extra = feigned(twins, [swapped[o.term] for o in believed if o is not evidence])
        each.append(Told(evidence.term, twins.chosen, mean, sd, extra))
    poor = {mimic.evidence.term for mimic in mimics}
    terms = tuple(term for term in fit.terms if term not in poor)
    fitted = Fitted(problem=problem, fit=fit, told=tuple(each), believed=terms)
    named = [
        Named(
            term=one.term,
            robots=problem.tracks.robots,
            whole_swarm=swarm,
            values=fitted.values_of(one),
            given=_given(one.term, problem.base[0]),
            evidence=evidence,
            twins=swapped[evidence.term].others,
        )
        for one, evidence in zip(each, believed, strict=True)
    ]
    return named, fitted, mimics


def _given(term: Term, healthy: Motion) -> tuple[Value, ...]:
    """What a term's values are told against."""
    if term.cause.told_against is None:
        return ()
    pairs = zip(term.cause.given, term.cause.told_against(healthy).tolist(), strict=True)
    return tuple(told(p, value, value, value) for p, value in pairs)


def _sharing(
    tracks: Tracks, seen: Sequence[Glance], reference: Reference
) -> npt.NDArray[np.bool_] | None:
    """(robots,) who shares the most conspicuous difference from health; None: nothing is shared."""
    robots = len(tracks.robots)
    if robots < LEAST_SWARM:
        return None
    best, most = None, SUSPICIOUS
    for one in seen:
        value, error, spread, swarm_spread = _strengths(one, reference, tracks)
        middle = float(np.median(value))
        wide = max(NORMAL * float(np.median(np.abs(value - middle))), float(np.median(error)))
        sure = np.hypot(MEDIAN_ERROR * np.hypot(wide, spread) / np.sqrt(robots), swarm_spread)
        far = abs(middle) / max(sure, 1e-12) / reference.gate(one.term.key, swarm=True)
        total = np.sqrt(error**2 + spread**2 + wide**2 / robots)
        alike = np.abs(value - middle) <= ALIKE * total
        differ = np.abs(value) > ALIKE * total
        shared = alike & (differ | (np.abs(value - middle) < np.abs(value)))
        if far > most and (~shared).mean() <= DEVIANTS:
            best, most = alike, far
    return best


def _strengths(
    one: Glance, reference: Reference, tracks: Tracks
) -> tuple[FloatArray, FloatArray, float, float]:
    """Per robot a term's strength less the healthy one, its error, and the healthy spreads."""
    k = int(np.argmax(np.abs(one.unit)))
    size = len(one.unit)
    _, sd = reference.spread(one.term.key, size)
    swarm_mean, swarm_sd = reference.spread(one.term.key, size, swarm=True)
    if all(np.isfinite(p.null) for p in one.term.cause.parameters):
        unit = float(one.unit[k])
    else:
        unit = float(strength(one.term, one.unit[None], tracks.commands)[0, k])
    value = one.dose * unit - float(swarm_mean[k])
    return value, np.abs(one.error * unit), float(sd[k]), float(swarm_sd[k])


def _suspects(tracks: Tracks, seen: Sequence[Glance], reference: Reference) -> list[int]:
    """Indices of the robots for which some term promises a gain and a value beyond health."""
    suspect = np.zeros(len(tracks.robots), dtype=bool)
    for one in seen:
        value, error, spread, _ = _strengths(one, reference, tracks)
        away = np.abs(value) / np.sqrt(error**2 + spread**2 + 1e-24)
        far = away > SUSPICIOUS * reference.gate(one.term.key)
        suspect |= (one.gain > reference.gates.gain) & (far | (not one.term.cause.smooth))
    return [int(k) for k in np.flatnonzero(suspect)]
