"""Causes that move poses exactly alike, told apart by what the wheels' encoders say.

A late command and a late stamp give the same poses, and so do weak motors and slipping wheels. The
encoders are on the robot's clock and on the wheels' side of the slip: they lag behind the command
with a latency and with weak motors, and do not with a late stamp or with slip.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes, withheld
from realitygap.models.belief.cause import ALL
from realitygap.models.belief.motion import Motion
from realitygap.models.log.blocks import BLOCK_SECONDS, nth
from realitygap.models.log.tracker import NORMAL
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.predict import coarse, wheel_errors
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.engine.hypothesis import Fit, Term
from realitygap.models.naming.rules import Rules


class Twins(NamedTuple):
    """A term and its twin, both fitted to the same robots."""

    chosen: Term
    fit: Fit
    others: tuple[Term, ...]
    """Twins that remain possible."""


def tell_apart(problem: Problem, kept: Fit, term: Term) -> Twins:
    """The twin that the encoders favour, or the one whose value is possible.

    Args:
        problem: Whose robots.
        kept: The set fitted with the term.
        term: A representative of its twins, or a term without any.
    """
    rules = problem.tracks.rules
    options = {term: kept}
    for name in term.cause.twins:
        if withheld(name):
            continue
        twin = Term(causes()[name], ALL)
        fit = _instead(problem, kept, term, twin)
        if fit is not None:
            options[twin] = fit
    if len(options) == 1:
        return Twins(term, kept, ())
    first = _first(options)
    if problem.tracks.encoders is None:
        return Twins(first, options[first], tuple(t for t in options if t != first))
    losses = {
        t: _encoder_loss(problem.tracks, problem.motions(f.terms, f.coordinates))
        for t, f in options.items()
    }
    best = min(losses, key=lambda t: float(losses[t].sum()))
    others = tuple(
        t for t in options if t != best and not _clearly(losses[t] - losses[best], rules)
    )
    return Twins(best, options[best], others)


def _first(options: dict[Term, Fit]) -> Term:
    """The twin named first where nothing tells them apart: the robot's fault, not the tracker's."""
    order = ("command_latency", "clock_offset", "weak_motor", "low_friction")
    return min(options, key=lambda t: order.index(t.cause.name) if t.cause.name in order else 99)


def _instead(problem: Problem, kept: Fit, term: Term, twin: Term) -> Fit | None:
    """The set with the twin in the term's place; None where the twin cannot have such a value.

    Nothing is fitted again: poses say the same of both.
    """
    if twin.cause.as_twin is None:
        return None
    at = kept.part(term)
    terms = tuple(twin if t == term else t for t in kept.terms)
    here = kept.coordinates.copy()
    parameter = twin.cause.parameters[0]
    for group in range(problem.count):
        robot = int(np.flatnonzero(problem.groups == group)[0])
        without = problem.base[robot]
        moved = term.cause.applied(without, kept.coordinates[group, at], term.variant)
        value = twin.cause.as_twin(without, moved)
        if value is None:
            return None
        here[group, at] = parameter.coordinate(value)
    return problem.at(terms, here)


def _encoder_loss(tracks: Tracks, motions: list[Motion]) -> FloatArray:
    """(blocks,) deviance of the encoders from the wheels' predicted speeds."""
    off, rows = wheel_errors(tracks, motions)
    scale = np.maximum(NORMAL * np.median(np.abs(off), axis=0), coarse(tracks.step))
    freedom = tracks.rules.row_freedom
    loss = (freedom + 1.0) * np.log1p((off / scale) ** 2 / freedom).sum(axis=1)
    loss = loss + 2.0 * np.log(scale).sum()
    block = nth(tracks.t - tracks.t.min(), BLOCK_SECONDS) + 1e6 * tracks.row_robot
    _, label = np.unique(block[rows], return_inverse=True)
    return np.asarray(np.bincount(label, loss), dtype=np.float64)


def _clearly(lost: FloatArray, rules: Rules) -> bool:
    """Whether a loss per block is clearly above zero."""
    error = float(np.sqrt(np.sum((lost - lost.mean()) ** 2)))
    return float(lost.sum()) > max(rules.odds, rules.errors * error)
