"""From tracks to named causes: search, then weigh each cause by what is lost without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.everywhere import uneven
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.fitted import Fitted, ToldValue
from realitygap.models.naming.channels.motion.recorded import recorded
from realitygap.models.naming.channels.motion.recording import unsure
from realitygap.models.naming.channels.motion.robot import robots_of
from realitygap.models.naming.channels.motion.timing import timed
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.channels.motion.twins import Twins, tell_apart
from realitygap.models.naming.engine.differing import differing
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.information import inverted
from realitygap.models.naming.engine.items import Mask
from realitygap.models.naming.engine.search import search
from realitygap.models.naming.engine.seen import away, least_seen
from realitygap.models.naming.engine.state import SWARM, State, refusing, with_kept
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.engine.threshold import bracket
from realitygap.models.naming.engine.value import Value, told, values
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.findings import Follows, Identified, Named, Uneven
from realitygap.models.naming.health.reference import Reference
from realitygap.models.naming.verdict import Judged, evidence_of, following, settle, standing


@one_thread
def identify(
    tracks: Tracks, reference: Reference, believed: Sequence[Motion], *, alike: bool = True
) -> Identified:
    """Name what is wrong with the whole swarm and with each robot.

    Args:
        tracks: The log's.
        reference: What healthy robots do.
        believed: The model's motion of each robot.
        alike: Whether the log was recorded as those of the reference were.
    """
    free = np.unique(tracks.robot)
    found = _of_free(tracks.only(free), reference, [believed[k] for k in free], alike)
    if len(free) == len(believed):
        return found
    base = [reference.motion(motion) for motion in believed]
    explained = base.copy()
    for own, all_robots in ((found.base, base), (found.explained, explained)):
        for k, motion in zip(free.tolist(), own, strict=True):
            all_robots[k] = motion

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


def _of_free(
    tracks: Tracks, reference: Reference, believed: Sequence[Motion], alike: bool
) -> Identified:
    """The same of robots that all have windows."""
    base = tuple(reference.motion(motion) for motion in believed)
    foreign = reference.robots > 0 and not alike
    recording: tuple[Value, ...] = ()
    if foreign:
        base, recording = recorded(tracks, base, reference.learned)
    robots = tuple(robots_of(tracks, base))
    unsure_of = unsure(tracks.step, robots[0].names, tracks.rules) if foreign else {}
    between = timed(robots[0].names, robots[0].scatter) if foreign else {}
    start = State(tracks, base, robots, reference.learned, unsure=unsure_of, between=between)
    if foreign:
        start = differing(start)
    names = start.robots[0].names
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
        named=tuple(standing(found, follows, tracks.rules)),
        follows=tuple(follows),
        uneven=tuple(strange),
        alike=alike,
        recording=recording,
        base=base,
        explained=tuple(state.motion(k, {}) for k in range(len(base))),
        fits=tuple(fits),
        away=away(weighed),
        least=least_seen(weighed, gates, known),
        state=state,
    )


def _even(state: State, gates: Gates, known: Mask) -> tuple[State, dict[int, Judged], list[Uneven]]:
    """What stands after all causes that are of different sizes in parts of the log are refused."""
    strange: list[Uneven] = []
    while True:  # every round refuses a cause in a scope, of which there are finitely many
        state, judged = settle(search(state, gates, known), gates, known)
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


def _told(
    state: State, scope: int, judged: Judged, reference: Reference, known: Mask
) -> tuple[list[Named], list[Follows], Fitted | None]:
    """Names, what follows something, and the fit behind them."""
    weighed = Weighed(state)
    gates = reference.gates.under(state.rules).of(len(state.tracks.first))
    left = following(weighed, scope, sum(judged.gains), gates)
    if not judged.terms:
        return [], left, None
    members = state.members(scope)
    tracks = state.tracks.only(members)
    base = [state.motion(k, {scope: ()}) for k in members]
    problem = Problem(tracks, base, groups=np.zeros(len(members), dtype=np.int64))
    fit = problem.at(judged.terms, np.concatenate(judged.fit.coordinates)[None])
    problem.scale = problem.spread(fit.residual)
    named, each = [], []
    means = _healthy(weighed, members, judged.terms)
    rest = fit
    begin = 0
    for k, term in enumerate(judged.terms):
        size = len(term.cause.parameters)
        part = slice(begin, begin + size)
        begin += size
        apart = tell_apart(problem, rest, term)
        rest = apart.fit
        covariance = judged.fit.covariance[part, part]
        each.append(ToldValue(term, apart.chosen, means[k]))
        evidence = evidence_of(weighed, scope, judged, k, covariance, known)
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
    return named, left, fitted


def _healthy(weighed: Weighed, members: Sequence[int], terms: Sequence[Term]) -> list[FloatArray]:
    """(p,) per term, what fits of nothing but these terms find in healthy robots: what these are in
    the mean beyond the reference's motion, as far as the terms can show it."""
    robots = weighed.state.robots
    names, prior = robots[0].names, weighed.prior
    information = np.sum([robots[k].information for k in members], axis=0)
    called = [[f"{term.key}.{p.name}" for p in term.cause.parameters] for term in terms]
    at = np.array([names.index(n) for own in called for n in own if n in names], dtype=np.int64)
    if not len(at):
        return [np.zeros(len(own)) for own in called]
    pull = information[np.ix_(at, prior.at)] @ prior.mean
    found = inverted(information[np.ix_(at, at)]).step(pull)
    by_name = {names[column]: float(size) for column, size in zip(at, found, strict=True)}
    return [np.array([by_name.get(name, 0.0) for name in own]) for own in called]


def _values(
    weighed: Weighed, scope: int, judged: Judged, k: int, apart: Twins, covariance: FloatArray
) -> tuple[Value, ...]:
    """A cause's parameters with intervals."""
    term, state = apart.chosen, weighed.state
    commands = state.tracks.only(state.members(scope)).commands
    if term.cause.smooth:
        at = apart.fit.part(term)
        return values(term, apart.fit.coordinates[0, at], covariance)
    found = list(judged.fit.coordinates)
    fitter = Fitter(weighed, scope)

    def deviance(threshold: float) -> float:
        found[k] = np.array([threshold])
        return fitter.square(judged.terms, found)

    edges = bracket(commands, float(judged.fit.coordinates[k][0]), deviance, state.rules.odds)
    return (told(term.cause.parameters[0], edges.mean, edges.low, edges.high),)


def _given(term: Term, healthy: Motion) -> tuple[Value, ...]:
    """What a term's values are told against."""
    if term.cause.told_against is None:
        return ()
    pairs = zip(term.cause.given, term.cause.told_against(healthy).tolist(), strict=True)
    return tuple(told(p, value, value, value) for p, value in pairs)
