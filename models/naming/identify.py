"""From tracks to named causes: search, then weigh each cause by what is lost without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Motion
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.fitted import Fitted, Told
from realitygap.models.identify.hypothesis import Term
from realitygap.models.identify.threshold import bracket
from realitygap.models.identify.tracks import Tracks
from realitygap.models.identify.twins import Twins, tell_apart
from realitygap.models.identify.value import Value, told, values
from realitygap.models.naming.columns import Mask
from realitygap.models.naming.everywhere import uneven
from realitygap.models.naming.findings import Evidence, Follows, Identified, Named, Uneven
from realitygap.models.naming.fitter import Fitter, Refined
from realitygap.models.naming.marginal import freed
from realitygap.models.naming.robot import robots_of
from realitygap.models.naming.search import contenders, fitted_with, offers, search
from realitygap.models.naming.seen import away, least_seen
from realitygap.models.naming.separable import inseparable
from realitygap.models.naming.state import SWARM, Kept, State, refusing, with_kept
from realitygap.models.naming.threads import one_thread
from realitygap.models.naming.weighed import Weighed
from realitygap.models.reference import Gates, Reference
from realitygap.models.rules import Rules


class _Judged(NamedTuple):
    """The causes of one scope after the search, with what each is worth."""

    terms: tuple[Term, ...]
    fit: Refined
    gains: tuple[float, ...]


@one_thread
def identify(tracks: Tracks, reference: Reference, believed: Sequence[Motion]) -> Identified:
    """Name what is wrong with the whole swarm and with each robot.

    Args:
        tracks: The log's.
        reference: What healthy robots do.
        believed: The model's motion of each robot.
    """
    free = np.unique(tracks.robot)
    found = _of_free(tracks.only(free), reference, [believed[k] for k in free])
    if len(free) == len(believed):
        return found
    base = [reference.motion(motion) for motion in believed]
    explained = base.copy()
    for k, motion in zip(free.tolist(), found.explained, strict=True):
        explained[k] = motion

    def spread(values: dict[str, FloatArray]) -> dict[str, FloatArray]:
        """Over all robots; nothing is known of those that were never free."""
        whole = {key: np.full((len(base), *one.shape[1:]), np.nan) for key, one in values.items()}
        for key, one in values.items():
            whole[key][free] = one
        return whole

    return replace(
        found,
        base=tuple(base),
        explained=tuple(explained),
        away=spread(found.away),
        least=spread(found.least),
    )


def _of_free(tracks: Tracks, reference: Reference, believed: Sequence[Motion]) -> Identified:
    """The same of robots that all have windows."""
    base = tuple(reference.motion(motion) for motion in believed)
    start = State(tracks, base, tuple(robots_of(tracks, base)), reference.learned)
    names = start.robots[0].made.names
    known = reference.knows(names)
    gates = reference.gates.under(tracks.rules).of(len(tracks.first))
    state, judged, strange = _even(start, gates, known)
    found: list[Named] = []
    follows: list[Follows] = []
    fits: list[Fitted] = []
    for scope in sorted(judged):
        own, left, fit = _told(state, scope, judged[scope], reference, known)
        found += own
        follows += left
        fits += [fit] if fit is not None else []
    weighed = Weighed(state)
    return Identified(
        named=tuple(_beside(found, follows, tracks.rules)),
        follows=tuple(follows),
        uneven=tuple(strange),
        base=base,
        explained=tuple(state.motion(k, {}) for k in range(len(base))),
        fits=tuple(fits),
        away=away(weighed),
        least=least_seen(weighed, gates, known),
    )


def _even(
    state: State, gates: Gates, known: Mask
) -> tuple[State, dict[int, _Judged], list[Uneven]]:
    """What stands after all causes that are of different sizes in parts of the log are refused."""
    strange: list[Uneven] = []
    while True:  # every round refuses a cause in a scope, of which there are finitely many
        state, judged = _settled(search(state, gates, known), gates, known)
        found = []
        for scope, one in judged.items():
            fitter = Fitter(Weighed(state), scope)
            robots = tuple(state.tracks.robots[k] for k in state.members(scope))
            for term in one.terms:
                where = uneven(fitter, one.terms, one.fit.coordinates, term)
                if where is not None:
                    found.append((scope, Uneven(term, robots, scope == SWARM, where)))
        if not found:
            return state, judged, strange
        scope, worst = max(found, key=lambda each: each[1].where.gain)
        strange.append(worst)
        kept = [one for one in state.of(scope) if one.item.term != worst.term]
        state = refusing(with_kept(state, scope, kept), scope, worst.term.key)


def _settled(state: State, gates: Gates, known: Mask) -> tuple[State, dict[int, _Judged]]:
    """The state with its causes judged, searched again where one taken early turned out to be
    superfluous: what was taken beside it answered to what it left."""
    for again in reversed(range(state.rules.again + 1)):
        misled, found = False, {}
        for scope in sorted(state.kept):
            before = sum(one.item.term is not None for one in state.of(scope))
            state, found[scope] = _judged(state, scope, gates)
            if len(found[scope].terms) < before and again:
                causes = [one for one in state.of(scope) if one.item.term is not None]
                state, misled = with_kept(state, scope, causes), True
        if not misled:
            break
        state = search(state, gates, known)
    return state, found


def _judged(state: State, scope: int, gates: Gates) -> tuple[State, _Judged]:
    """The causes of a scope that are needed, fitted together for the last time."""
    while True:
        kept = state.of(scope)
        causes = [one for one in kept if one.item.term is not None]
        fitter = Fitter(Weighed(state), scope)
        terms = [one.item.of for one in causes]
        fit = fitter.fit(terms, [one.coordinates for one in causes])
        if fit is None or not causes:
            none = Refined((), np.zeros((0, 0)), 0.0) if fit is None else fit
            return state, _Judged((), none, ())
        gains = []
        for k, one in enumerate(causes):
            rest = [*causes[:k], *causes[k + 1 :]]
            without = fitter.fit([o.item.of for o in rest], [o.coordinates for o in rest])
            lost = np.inf if without is None else without.square - fit.square
            gains.append(lost - state.rules.price * (len(one.coordinates) - 1))
        weakest = int(np.argmin(gains))
        if gains[weakest] >= _needed(causes, gains, weakest, gates, state.rules):
            fitted = iter(fit.coordinates)
            moved = [
                one if one.item.term is None else one._replace(coordinates=next(fitted))
                for one in kept
            ]
            return _at(state, scope, moved), _Judged(tuple(terms), fit, tuple(gains))
        less = [one for one in kept if one is not causes[weakest]]
        state = with_kept(state, scope, less)


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


def _told(
    state: State, scope: int, judged: _Judged, reference: Reference, known: Mask
) -> tuple[list[Named], list[Follows], Fitted | None]:
    """Names, what follows something, and the fit behind them."""
    weighed = Weighed(state)
    gates = reference.gates.under(state.rules).of(len(state.tracks.first))
    follows = _follows(weighed, scope, sum(judged.gains), gates)
    if not judged.terms:
        return [], follows, None
    members = state.members(scope)
    tracks = state.tracks.only(members)
    base = [state.motion(k, {scope: ()}) for k in members]
    problem = Problem(tracks, base, groups=np.zeros(len(members), dtype=np.int64))
    fit = problem.at(judged.terms, np.concatenate(judged.fit.coordinates)[None])
    problem.scale = problem.spread(fit.residual)
    named, each = [], []
    rest = fit
    begin = 0
    for k, term in enumerate(judged.terms):
        size = len(term.cause.parameters)
        part = slice(begin, begin + size)
        begin += size
        apart = tell_apart(problem, rest, term)
        rest = apart.fit
        covariance = judged.fit.covariance[part, part]
        mean = reference.mean(term)
        each.append(Told(term, apart.chosen, mean, np.zeros(size), 0.0))
        evidence = _evidence(weighed, scope, judged, k, covariance, known)
        named.append(
            Named(
                term=apart.chosen,
                robots=tracks.robots,
                whole_swarm=scope == SWARM,
                values=_values(weighed, scope, judged, k, apart, covariance),
                given=_given(apart.chosen, base[0]),
                evidence=evidence,
                twins=apart.others,
            )
        )
    fitted = Fitted(problem=problem, fit=rest, told=tuple(each), believed=rest.terms)
    return named, follows, fitted


def _values(
    weighed: Weighed, scope: int, judged: _Judged, k: int, apart: Twins, covariance: FloatArray
) -> tuple[Value, ...]:
    """A cause's parameters with intervals."""
    term, state = apart.chosen, weighed.state
    commands = state.tracks.only(state.members(scope)).commands
    if term.cause.smooth:
        at = apart.fit.part(term)
        none = np.zeros(len(term.cause.parameters))
        coordinates = apart.fit.coordinates[0, at]
        return values(term, coordinates, covariance, commands, none, none)
    found = list(judged.fit.coordinates)
    fitter = Fitter(weighed, scope)

    def deviance(threshold: float) -> float:
        found[k] = np.array([threshold])
        return fitter.square(judged.terms, found)

    edges = bracket(commands, float(judged.fit.coordinates[k][0]), deviance, state.rules.odds)
    return (told(term.cause.parameters[0], edges.mean, edges.low, edges.high),)


def _evidence(
    weighed: Weighed,
    scope: int,
    judged: _Judged,
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
        for one in offers(score, weighed.state.items, known, rules)
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
        price = rules.price * (len(offer.step) - len(term.cause.parameters))
        tried[other.key] = gain - lost - price
        change = fitter.losses([*rest, other], fit.coordinates) - losses
        if lost + price <= _margin(change, weighed.state.tracks, scope, gain):
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


def _margin(change: FloatArray, tracks: Tracks, scope: int, gain: float) -> float:
    """Deviance by which a rival may be worse, given (windows,) by how much each window is."""
    rules = tracks.rules
    some = tracks if scope == SWARM else tracks.only([scope])
    by_block = np.bincount(some.block, change)
    error = float(np.sqrt(np.sum((by_block - by_block.mean()) ** 2)))
    return max(rules.odds, min(rules.errors * error, rules.clearly * gain))


def _given(term: Term, healthy: Motion) -> tuple[Value, ...]:
    """What a term's values are told against."""
    if term.cause.told_against is None:
        return ()
    pairs = zip(term.cause.given, term.cause.told_against(healthy).tolist(), strict=True)
    return tuple(told(p, value, value, value) for p, value in pairs)


def _follows(weighed: Weighed, scope: int, named: float, gates: Gates) -> list[Follows]:
    """Flexible terms of a scope that matter beside its causes."""
    state = weighed.state
    members = state.members(scope)
    plain = [one.item for one in state.of(scope) if one.item.term is None]
    found = []
    for item in plain:
        others = [c for o in plain if o is not item for c in o.columns]
        score = freed(weighed.with_flexible(scope), np.array(others, dtype=np.int64))
        at = list(item.columns)
        own, pull = score.information[np.ix_(at, at)], score.slope[at]
        gain = float(pull @ np.linalg.lstsq(own, pull, rcond=None)[0])
        if gain <= max(gates.flexible, state.rules.mended * named):
            continue
        found.append(
            Follows(
                channel=item.channel,
                quantity=item.quantity,
                robots=tuple(state.tracks.robots[k] for k in members),
                whole_swarm=scope == SWARM,
                distance=float(np.sqrt(gain)),
                gain=gain,
                share=gain / max(score.square, gain),
            )
        )
    return found


def _beside(named: list[Named], follows: list[Follows], rules: Rules) -> list[Named]:
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
