"""From a search to what stands: the causes needed, their evidence, and what is left unknown.

A log may be unable to tell a cause from one that it is confusable with, whatever the fit says. Runs
differ: tyres wear, clocks are set anew, markers are put on again. A cause counts as told from
another only if it still shows when the other may have a value of its own in every run. Circles of
one radius fail for wheels of two sizes and the distance between them, in whatever direction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.fitter import Fitter, Refined
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Mask
from realitygap.models.naming.engine.loudest import given, of_a_moment, without_loudest
from realitygap.models.naming.engine.marginal import freed
from realitygap.models.naming.engine.search import contenders, fitted_with, offers, possible, search
from realitygap.models.naming.engine.state import SWARM, Kept, State, with_kept
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.findings import Evidence, Follows, Named
from realitygap.models.naming.rules import Rules


def inseparable(
    fitter: Fitter, terms: Sequence[Term], fit: Refined, term: Term
) -> tuple[Term, ...]:
    """Terms not in a set that the log cannot tell from one of it.

    Args:
        fitter: Of the robots concerned.
        terms: The set.
        fit: Of it.
        term: One of it.
    """
    if not term.cause.confusable_with:
        return ()
    own, given = fitter.changes(terms, fit.coordinates, term)
    alone = _left(own, given)
    names = {t.cause.name for t in terms}
    found = []
    for item in fitter.state.items:
        other = item.term
        if (
            other is None
            or item.dose is not None
            or len(item.columns) > 1
            or (other.cause.place and fitter.scope != SWARM)
            or other.cause.name not in term.cause.confusable_with
            or other.cause.name in names
        ):
            continue
        each = fitter.by_run(item.columns[0])
        if alone > fitter.state.rules.inflation * _left(own, np.hstack([given, each])):
            found.append(other)
    return tuple(found)


def _left(own: FloatArray, columns: FloatArray) -> float:
    """Sum of squares that a least-squares fit of the columns leaves."""
    length = np.linalg.norm(columns, axis=0)
    columns = columns[:, length > 0.0] / length[length > 0.0]
    fitted = columns @ np.linalg.lstsq(columns, own, rcond=None)[0]
    return float(np.sum((own - fitted) ** 2))


class Judged(NamedTuple):
    """The causes of one scope after the search, with what each is worth."""

    terms: tuple[Term, ...]
    fit: Refined
    gains: tuple[float, ...]


def settle(state: State, gates: Gates, known: Mask) -> tuple[State, dict[int, Judged]]:
    """The state with its causes judged, searched again where one taken early turned out to be
    superfluous: what was taken beside it answered to what it left."""
    for again in reversed(range(state.rules.again + 1)):
        misled, found = False, {}
        for scope in sorted(state.kept):
            before = sum(one.item.term is not None for one in state.of(scope))
            state, found[scope] = judge(state, scope, gates)
            if len(found[scope].terms) < before and again:
                causes = [one for one in state.of(scope) if one.item.term is not None]
                state, misled = with_kept(state, scope, causes), True
        if not misled:
            break
        state = search(state, gates, known)
    return state, found


def judge(state: State, scope: int, gates: Gates) -> tuple[State, Judged]:
    """The causes of a scope that are needed, fitted together for the last time."""
    while True:
        kept = state.of(scope)
        causes = [one for one in kept if one.item.term is not None]
        fitter = Fitter(Weighed(state), scope)
        terms = [one.item.of for one in causes]
        fit = fitter.fit(terms, [one.coordinates for one in causes])
        if fit is None or not causes:
            none = Refined((), np.zeros((0, 0)), 0.0) if fit is None else fit
            return state, Judged((), none, ())
        gains, lacking = [], []
        for k, one in enumerate(causes):
            rest = [*causes[:k], *causes[k + 1 :]]
            without = fitter.fit([o.item.of for o in rest], [o.coordinates for o in rest])
            lost = np.inf if without is None else without.square - fit.square
            gains.append(lost - state.rules.price * (len(one.coordinates) - 1))
            lacking.append(without)
        drop = int(np.argmin(gains))
        if gains[drop] >= _needed(causes, gains, drop, gates, state.rules):
            judged = Judged(tuple(terms), fit, tuple(gains))
            alone = [
                k
                for k, without in enumerate(lacking)
                if without is not None and _on_one_window(fitter, judged, k, without, gates)
            ]
            if not alone:
                return _at(state, scope, _moved(kept, fit)), judged
            drop = alone[0]
        less = [one for one in kept if one is not causes[drop]]
        state = with_kept(state, scope, less)


def _moved(kept: Sequence[Kept], fit: Refined) -> list[Kept]:
    """What is kept, its causes where a fit has them."""
    fitted = iter(fit.coordinates)
    return [
        one if one.item.term is None else one._replace(coordinates=next(fitted)) for one in kept
    ]


def _on_one_window(fitter: Fitter, judged: Judged, k: int, without: Refined, gates: Gates) -> bool:
    """Whether a cause passes its gate with the window that says most of it, and not else."""
    terms, fit, gain = judged.terms, judged.fit, judged.gains[k]
    rest = [*terms[:k], *terms[k + 1 :]]
    change = of_a_moment(
        fitter.state,
        fitter.scope,
        fitter.losses(rest, without.coordinates) - fitter.losses(terms, fit.coordinates),
    )
    if gain - float(change.max()) >= gates.cause:  # a window takes away what it gave, or less
        return False
    less = Fitter(Weighed(without_loudest(fitter.state, fitter.scope, change)), fitter.scope)
    one, other = less.fit(terms, fit.coordinates), less.fit(rest, without.coordinates)
    if one is None or other is None:
        return False
    price = fitter.state.rules.price * (len(fit.coordinates[k]) - 1)
    return other.square - one.square - price < gates.cause


def _at(state: State, scope: int, kept: list[Kept]) -> State:
    """The state with the last step of a fit, for which nothing is made anew."""
    return replace(state, kept={**state.kept, scope: tuple(kept)})


def _needed(
    causes: Sequence[Kept], gains: Sequence[float], k: int, gates: Gates, rules: Rules
) -> float:
    """Gain that a cause needs beside the others."""
    own = causes[k].item.of.cause.family
    kin = [
        g
        for one, g in zip(causes, gains, strict=True)
        if one is not causes[k] and own and one.item.of.cause.family == own
    ]
    return max(gates.cause, rules.mended * max(kin, default=0.0))


def evidence_of(
    weighed: Weighed,
    scope: int,
    judged: Judged,
    k: int,
    covariance: FloatArray,
    known: Mask,
) -> Evidence:
    """What speaks for one cause, and what could stand in its place."""
    term, gain, rules = judged.terms[k], judged.gains[k], weighed.state.rules
    fitter = Fitter(weighed, scope)
    rest = [t for t in judged.terms if t is not term]
    others = [c for t, c in zip(judged.terms, judged.fit.coordinates, strict=True) if t is not term]
    score = fitter.scores(rest, others)
    listed = [
        one
        for one in offers(score, possible(weighed.state, scope), known, rules)
        if one.item.term is not None
        and one.item.term.cause.name not in {t.cause.name for t in judged.terms}
    ]
    rivals, tried = [], {term.key: gain}
    losses = fitter.losses(judged.terms, judged.fit.coordinates)
    for offer in contenders(listed, rules, gain):
        other = offer.item.of
        fit = fitted_with(fitter, rest, others, offer)
        if fit is None:
            continue
        lost = fit.square - judged.fit.square
        price = rules.price * (len(other.cause.parameters) - len(term.cause.parameters))
        tried[other.key] = gain - lost - price
        change = fitter.by_block(fitter.losses([*rest, other], fit.coordinates) - losses)
        bends = len(other.cause.parameters) > len(term.cause.parameters)
        # one that can bend further is no rival for doing nearly as well
        if lost + price <= (0.0 if bends else _margin(change, gain, rules)):
            rivals.append(other)
    rivals += [t for t in inseparable(fitter, judged.terms, judged.fit, term) if t not in rivals]
    return Evidence(
        term=term,
        coordinates=judged.fit.coordinates[k],
        covariance=covariance,
        gain=gain,
        share=fitter.held_out(judged.terms, judged.fit.coordinates, k),
        distance=float(np.sqrt(max(gain, 0.0))),
        rivals=tuple(rivals),
        gains=tuple(sorted(tried.items(), key=lambda kg: -kg[1])),
    )


def _margin(change: FloatArray, gain: float, rules: Rules) -> float:
    """Deviance by which a rival may be worse, given (blocks,) by how much each block is."""
    if not len(change):
        return rules.odds
    error = float(np.sqrt(np.sum((change - change.mean()) ** 2)))
    return max(rules.odds, min(rules.errors * error, rules.clearly * gain))


def following(weighed: Weighed, scope: int, named: float, gates: Gates) -> list[Follows]:
    """Flexible terms of a scope that matter beside its causes."""
    state = weighed.state
    members = state.members(scope)
    plain = [one.item for one in state.of(scope) if one.item.term is None]
    found = []
    for item in plain:
        others = [c for o in plain if o is not item for c in o.columns]
        gain, step, square = _told(weighed, scope, others, item.columns)
        needed = max(gates.flexible, state.rules.mended * named)
        change = given(state, scope, item.columns, step)
        if gain - float(change.max()) <= needed < gain:
            less = Weighed(without_loudest(state, scope, change))
            if _told(less, scope, others, item.columns)[0] <= needed:
                continue
        if gain <= needed:
            continue
        found.append(
            Follows(
                channel=item.channel,
                quantity=item.quantity,
                robots=tuple(state.tracks.robots[k] for k in members),
                whole_swarm=scope == SWARM and len(state.robots) >= state.rules.least_swarm,
                distance=float(np.sqrt(gain)),
                gain=gain,
                share=gain / max(square, gain),
            )
        )
    return found


def _told(
    weighed: Weighed, scope: int, others: Sequence[int], columns: Sequence[int]
) -> tuple[float, FloatArray, float]:
    """Gain of some columns beside others that are free, (q,) their step, and the deviance."""
    score = freed(weighed.with_flexible(scope), np.array(others, dtype=np.int64))
    at = list(columns)
    own, pull = score.information[np.ix_(at, at)], score.slope[at]
    step = np.linalg.lstsq(own, pull, rcond=None)[0]
    return float(pull @ step), np.asarray(step), score.square


def standing(named: list[Named], follows: list[Follows], rules: Rules) -> list[Named]:
    """Names that are not much weaker than something unknown in their robots.

    What a whole swarm shares may be in one robot more than in others, up to all of it.
    """
    unknown: dict[int, float] = {}
    for one in follows:
        for robot in one.robots:
            unknown[robot] = max(unknown.get(robot, 0.0), one.gain)
    return [
        one
        for one in named
        if one.evidence.gain > rules.beside * max(unknown.get(robot, 0.0) for robot in one.robots)
    ]
