"""Forward selection of causes in the senses: few, each needed, each beyond health.

At each turn every term of the swarm and of each robot is tried by one linear step; those that
promise most are fitted. A term is taken if it takes more deviance off held-out blocks than any
other and its value lies outside what healthy robots and swarms get for that very term.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.senses.glance import Promise, promises
from realitygap.models.senses.leap import Leap
from realitygap.models.senses.leftover import Left, leftovers
from realitygap.models.senses.problem import SWARM, Fit, Problem, Term
from realitygap.models.senses.reference import SenseReference, away
from realitygap.models.senses.structure import Structure

MOST_TERMS = 8
MOST_LEAPS = 6
"""Fits of a lamp that stands far from where it should."""
MOST_FITS = 4
"""Terms fitted at one turn."""
SERIOUS = 0.3
"""Of the most promising term's gain that earns a fit: one step underrates what is not linear."""
NEARLY = 0.5
"""Of either gate that a promise needs to earn a fit."""
RIVAL_SHARE = 0.5
"""Of the gain that a term needs to be looked at as a rival."""
MARGIN = 8.0
"""Held-out deviance by which a rival must be worse."""
SWARM_MARGIN = 40.0
"""The same for what all robots share. Our choice, from development logs of 240 s: what the tables
get wrong of every robot is worth 35 to a cause that can bend to it."""
MARGIN_ERRORS = 1.6
"""Standard errors, over blocks, of the same."""
MIMIC = 1.03
"""Times a cause's gain, and `MARGIN` more, by which what follows a quantity must do better for the
cause to be taken for a mimic: an exact cause does as well as anything of a parameter or two."""
COMPANION = 0.04
"""Of a stronger cause's gain that another of the same sensors needs to be named beside it: no
model of a cause is exact."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Found:
    """One term with what speaks for it."""

    term: Term
    coordinates: FloatArray
    """(p,)."""
    error: FloatArray
    """(p,) standard errors."""
    gain: float
    share: float
    """That gain relative to the deviance without it."""
    distance: float
    rivals: tuple[Term, ...] = ()
    gains: tuple[tuple[str, float], ...] = ()
    """What the terms tried at its turn took off."""


class Chosen(NamedTuple):
    """The terms that the readings need, and the fit with all of them."""

    found: list[Found]
    fit: Fit
    structure: Structure | None
    """What follows what beside the fit; None: nobody has looked."""
    promises: tuple[Promise, ...] = ()
    """Of every term, at the last turn."""


def choose(problem: Problem, reference: SenseReference, leap: Leap | None = None) -> Chosen:
    """The terms that the readings need.

    Args:
        problem: The readings.
        reference: What healthy robots read.
        leap: A lamp that stands somewhere else altogether.
    """
    leapt = {} if leap is None else _leapt(problem, leap)
    before = kept = problem.fit((), np.zeros(0))
    structure = Structure(problem, before)
    flexible = leftovers(problem, structure, reference)
    closed: list[Left] = []
    tried: dict[Term, dict[Term, float]] = {}
    last: list[Promise] = []
    while len(kept.terms) < MOST_TERMS:
        taken = {t: tried[t][t] for t in kept.terms}
        last = promises(problem, kept, private=len(problem.sight.robots) > 1)
        fits = _one_more(problem, kept, reference, closed, taken, last)
        fits |= {t: f for t, f in leapt.items() if not kept.terms}
        if not fits:
            break
        gains = {t: float((kept.held_out - f.held_out).sum()) for t, f in fits.items()}
        best = _plainest(fits, max(gains, key=lambda t: gains[t]))
        better = _better(problem, flexible, closed, kept, best, gains[best])
        if better is not None:
            closed.append(better)
            continue
        kept = fits[best]
        tried[best] = gains
        kept = _needed(problem, kept, reference, best)
    if kept.terms:
        problem.judge_anew(kept)
        kept = problem.fit(kept.terms, kept.coordinates)
    found = [_evidence(problem, kept, t, reference, tried.get(t, {})) for t in kept.terms]
    passed = [one for one in found if one is not None]
    named = [one for one in passed if not _mends(one, passed)]
    return Chosen(named, kept, structure if kept is before else None, tuple(last))


def _leapt(problem: Problem, leap: Leap) -> dict[Term, Fit]:
    """The lamp that stands somewhere else altogether, fitted from where it was first seen; readings
    that say nothing of it are left out from then on."""
    term, where = leap
    for _ in range(MOST_LEAPS):  # the nearer it is, the better is known which readings tell of it
        problem.leave_out(problem.beliefs((term,), where))
        fit = problem.fit((term,), where)
        moved, where = np.abs(fit.coordinates - where), fit.coordinates
        if (moved <= [p.step for p in term.cause.parameters]).all():
            break
    return {term: fit}


def _better(
    problem: Problem,
    flexible: Sequence[Left],
    closed: Sequence[Left],
    kept: Fit,
    best: Term,
    gain: float,
) -> Left | None:
    """What follows a quantity clearly better than the first cause tried there explains it."""
    for left in flexible:
        first = not any(left.concerns(problem, term) for term in kept.terms)
        if left in closed or not first or not left.concerns(problem, best):
            continue
        if left.gain > MIMIC * gain + MARGIN:
            return left
    return None


def _plainest(fits: dict[Term, Fit], best: Term) -> Term:
    """The term with fewest parameters among those that are not clearly worse than the best."""
    close = [t for t, f in fits.items() if t == best or not _worse(f, fits[best])]
    return min(close, key=lambda t: (t.size, t != best))


def _worse(rival: Fit, kept: Fit, margin: float = MARGIN) -> bool:
    """Whether a rival is clearly worse on held-out blocks."""
    lost = rival.held_out - kept.held_out
    error = float(np.sqrt(np.sum((lost - lost.mean()) ** 2)))
    return float(lost.sum()) >= max(margin, MARGIN_ERRORS * error)


def _one_more(
    problem: Problem,
    kept: Fit,
    reference: SenseReference,
    closed: Sequence[Left],
    taken: Mapping[Term, float],
    promised: Sequence[Promise],
) -> dict[Term, Fit]:
    """The terms that would be named beside the kept ones, fitted."""
    hopeful = [
        p
        for p in promised
        if _hopeful(p, reference)
        and not any(left.concerns(problem, p.term) for left in closed)
        and not _only_mends(p.term, p.gain / NEARLY, taken)
    ]
    if not hopeful:
        return {}
    least = SERIOUS * hopeful[0].gain
    fits = {}
    for promise in [p for p in hopeful if p.gain >= least][:MOST_FITS]:
        fit = problem.fit((*kept.terms, promise.term), promise.start)
        gain = float((kept.held_out - fit.held_out).sum())
        if _beyond(fit, promise.term, gain, reference):
            fits[promise.term] = fit
    return fits


def _hopeful(promise: Promise, reference: SenseReference) -> bool:
    swarm = promise.term.robot == SWARM
    gain, far = reference.gates(promise.term.key, swarm=swarm)
    mean, sd = _health(promise.term, reference)
    distance = away(promise.coordinates, promise.error, mean, sd)
    return promise.gain > NEARLY * gain and distance > NEARLY * far


def _health(term: Term, reference: SenseReference) -> tuple[FloatArray, FloatArray]:
    """(p,) mean and standard deviation that sound robots or swarms get, also elsewhere."""
    mean, sd = reference.spread(term.key, term.size, swarm=term.robot == SWARM)
    return mean, np.hypot(sd, [p.elsewhere for p in term.cause.parameters])


def _beyond(fit: Fit, term: Term, gain: float, reference: SenseReference) -> bool:
    """Whether a fitted term passes both gates."""
    least, far = reference.gates(term.key, swarm=term.robot == SWARM)
    return gain > least and _distance(fit, term, reference) > far


def _distance(fit: Fit, term: Term, reference: SenseReference) -> float:
    part = fit.part(term)
    error = np.sqrt(np.diag(fit.covariance)[part])
    mean, sd = _health(term, reference)
    value, sizes = fit.coordinates[part].copy(), error.copy()
    for k, parameter in enumerate(term.cause.parameters):
        # where the last number is a strength, the others only say of what
        if term.cause.starts(np.zeros((0, 2))) and parameter is not term.cause.parameters[-1]:
            sizes[k] = 0.0
    return away(value, sizes, mean, sd)


def _needed(problem: Problem, kept: Fit, reference: SenseReference, newest: Term) -> Fit:
    """Without terms that the newest makes superfluous."""
    for term in kept.terms:
        if term == newest or len(kept.terms) < 2:
            continue
        less = without(problem, kept, term)
        lost = float((less.held_out - kept.held_out).sum())
        if not _beyond(kept, term, lost, reference):
            kept = less
    return kept


def without(problem: Problem, kept: Fit, term: Term) -> Fit:
    """The set refitted without a term."""
    terms = tuple(t for t in kept.terms if t != term)
    return problem.fit(terms, np.delete(kept.coordinates, np.r_[kept.part(term)]))


def _evidence(
    problem: Problem,
    kept: Fit,
    term: Term,
    reference: SenseReference,
    tried: dict[Term, float],
) -> Found | None:
    """What speaks for a kept term; None where it is how healthy robots differ."""
    less = without(problem, kept, term)
    gain = float((less.held_out - kept.held_out).sum())
    if not _beyond(kept, term, gain, reference):
        return None
    part = kept.part(term)
    concerned = np.unique(problem.sight.block[problem.rows(term)])
    total = float(less.held_out[concerned].sum())
    ranked = sorted(((t.key, g) for t, g in tried.items()), key=lambda kg: -kg[1])
    return Found(
        term=term,
        coordinates=kept.coordinates[part],
        error=np.sqrt(np.diag(kept.covariance)[part]),
        gain=gain,
        share=gain / max(total, 1e-9),
        distance=_distance(kept, term, reference),
        rivals=_rivals(problem, kept, less, term, tried),
        gains=tuple(ranked),
    )


def _rivals(
    problem: Problem, kept: Fit, less: Fit, term: Term, tried: dict[Term, float]
) -> tuple[Term, ...]:
    """Terms that could stand in a term's place without being clearly worse."""
    own = tried.get(term, 0.0)
    margin = SWARM_MARGIN if term.robot == SWARM else MARGIN
    found = []
    for other, gain in tried.items():
        if other == term or other in kept.terms or gain < RIVAL_SHARE * own:
            continue
        if other.size > term.size:
            continue  # one that can bend further is no rival for fitting as well
        start = np.concatenate([less.coordinates, _begin(problem, less, other)])
        fit = problem.fit((*less.terms, other), start)
        if not _worse(fit, kept, margin):
            found.append(other)
    return tuple(found)


def _begin(problem: Problem, kept: Fit, term: Term) -> FloatArray:
    """(p,) coordinates at which a term's own step from a hypothesis ends."""
    found = promises(problem, kept, wanted=term)
    return found[0].coordinates if found else np.zeros(term.size)


def _mends(one: Found, all_found: list[Found]) -> bool:
    """Whether a term only mends what a stronger one of the same sensors leaves."""
    others = {other.term: other.gain for other in all_found if other is not one}
    return _only_mends(one.term, one.gain, others)


def _only_mends(term: Term, gain: float, others: Mapping[Term, float]) -> bool:
    """Whether what a term gains is small beside what others of the same sensors gain."""
    for other, theirs in others.items():
        shared = SWARM in (term.robot, other.robot) or term.robot == other.robot
        if shared and _kinds(term) & _kinds(other) and gain < COMPANION * theirs:
            return True
    return False


def _kinds(term: Term) -> set[str]:
    return {"ps", "ls"} if term.cause.kind == "both" else {term.cause.kind}
