"""From readings and answers to named causes: the mixed model of motion, on the senses' channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief
from realitygap.models.log.held_out import PARTS
from realitygap.models.naming.channels.motion.fitted import Values
from realitygap.models.naming.channels.senses.robot import LATE, SenseLog, SenseRobot
from realitygap.models.naming.engine.differing import differing
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Mask
from realitygap.models.naming.engine.search import search
from realitygap.models.naming.engine.seen import away, least_seen
from realitygap.models.naming.engine.state import SWARM, Kept, State, with_kept
from realitygap.models.naming.engine.subject import Subject
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.engine.value import values
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.findings import Follows, Named
from realitygap.models.naming.health.senses import SenseReference
from realitygap.models.naming.rules import Rules
from realitygap.models.naming.verdict import Judged, evidence_of, following, settle, standing


@dataclass(frozen=True, eq=False, kw_only=True)
class SensesFound:
    """What was found in the senses of one log."""

    named: tuple[Named, ...]
    follows: tuple[Follows, ...]
    state: State
    """With every cause named."""
    judged: dict[int, Judged]
    """The causes by scope."""
    known: Mask
    """(k,) columns that health was measured for."""
    gates: Gates
    away: dict[str, FloatArray]
    """(robots,) by channel and quantity, distance from health of what follows it."""
    least: dict[str, FloatArray]
    """(robots, p) by key of a term, coordinates from which on it would have been seen."""


@one_thread
def identify(
    log: SenseLog,
    reference: SenseReference,
    believed: Sequence[Belief],
    *,
    alike: bool = True,
    begun: tuple[Term, FloatArray] | None = None,
) -> SensesFound:
    """Name what is wrong with the senses of the whole swarm, of each robot, and with the place.

    Args:
        log: Of at least one robot.
        reference: What healthy robots do.
        believed: Of each robot.
        alike: Whether the log was recorded as those of the reference were.
        begun: A cause of the place, with its coordinates, that the search begins with.
    """
    base = tuple(believed)
    robots = tuple(log.at(range(len(base)), base))
    start = State(log, base, robots, reference.learned)
    if not alike:
        start = differing(replace(start, unsure=unsure(log.step, robots[0].names, log.rules)))
    if begun is not None:
        term, place = begun
        item = next(one for one in start.items if one.term == term and one.dose is None)
        start = with_kept(start, SWARM, [Kept(item, place)])
    known = reference.knows(start.robots[0].names)
    windows = sum(one.learned for one in robots)
    gates = reference.gates.under(log.rules)
    gates = gates.of(windows) if windows else gates
    state, found = settle(search(start, gates, known), gates, known)
    named: list[Named] = []
    follows: list[Follows] = []
    for scope, judged in sorted(found.items()):
        follows += following(Weighed(state), scope, sum(judged.gains), gates)
        named += _named(state, scope, judged, known)
    weighed = Weighed(state)
    return SensesFound(
        named=tuple(standing(named, follows, log.rules)),
        follows=tuple(follows),
        state=state,
        judged=found,
        known=known,
        gates=gates,
        away=away(weighed),
        least=least_seen(weighed, gates, known),
    )


def unsure(step: float, names: Sequence[str], rules: Rules) -> dict[str, float]:
    """By name of a column, the standard deviation with which it is believed to be null of a swarm
    whose recording is unknown: poses up to a row late, which make readings scatter otherwise.

    Args:
        step: s between rows.
        names: Of the columns that there are.
        rules: How sure one is.
    """
    scattered = [name for name in names if name.startswith(("ir_noise", "infrared/noise/"))]
    return {LATE: step} | dict.fromkeys(scattered, rules.record_dose)


def _named(state: State, scope: int, judged: Judged, known: Mask) -> list[Named]:
    """The causes of a scope."""
    weighed = Weighed(state)
    ids = tuple(state.tracks.robots[k] for k in state.members(scope))
    found, begin = [], 0
    for k, term in enumerate(judged.terms):
        part = slice(begin, begin + len(term.cause.parameters))
        begin = part.stop
        covariance = judged.fit.covariance[part, part]
        evidence = evidence_of(weighed, scope, judged, k, covariance, known)
        own = values(term, evidence.coordinates, covariance)
        shared = scope == SWARM and len(state.robots) >= state.rules.least_swarm
        found.append(
            Named(
                term=term,
                robots=ids,
                whole_swarm=term.cause.place or shared,
                values=own,
                evidence=evidence,
                twins=(),
            )
        )
    return found


def _tells(robot: Subject, term: Term) -> bool:
    """Whether a robot's rows say anything of a term."""
    at = [k for k, n in enumerate(robot.names) if n.startswith((f"{term.key}.", f"{term.key}@"))]
    return bool(np.diag(robot.information)[at].any())


@one_thread
def by_part(found: SensesFound) -> tuple[Values, ...]:
    """The names' values that each part of the log gives by itself, begun at the whole log's."""
    keys = {one.key for one in found.named}
    parts = []
    for part in range(PARTS):
        told = {}
        robots = []
        for one in found.state.robots:
            assert isinstance(one, SenseRobot)
            robots.append(one.of_part(part))
        state = replace(found.state, robots=tuple(robots))
        for scope, judged in found.judged.items():
            members = state.members(scope)
            if not judged.terms or not any(state.robots[k].own_errors.any() for k in members):
                continue
            ids = tuple(state.tracks.robots[k] for k in members)
            fit = Fitter(Weighed(state), scope).fit(judged.terms, judged.fit.coordinates)
            begin = 0
            for k, term in enumerate(judged.terms):
                size = len(term.cause.parameters)
                at = slice(begin, begin + size)
                begin += size
                told_of = not size or any(_tells(state.robots[k], term) for k in members)
                if fit is not None and (term, ids) in keys and told_of:
                    here, wide = fit.coordinates[k], fit.covariance[at, at]
                    told[term, ids] = values(term, here, wide)
        parts.append(told)
    return tuple(parts)
