"""Rivals in the senses and the nest: what a manoeuvre would let robots read under each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import CONTROL_STEP, SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.models.log.blocks import BLOCK_SECONDS
from realitygap.models.naming.channels.senses.diagnose import SenseExamination
from realitygap.models.naming.channels.senses.identify import SensesFound
from realitygap.models.naming.channels.senses.levels import SQUARE
from realitygap.models.naming.channels.senses.neighbours import FAR, Neighbours
from realitygap.models.naming.channels.senses.nest import Answers, Crossings
from realitygap.models.naming.channels.senses.predicted import predict
from realitygap.models.naming.channels.senses.readings import KINDS, Eye, ReadingRows
from realitygap.models.naming.channels.senses.sight import Sight, lamp_in_sight
from realitygap.models.naming.channels.senses.terms import columns_of
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.engine.state import SWARM
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.findings import Named
from realitygap.models.naming.proposal.expected import flown, reads
from realitygap.models.naming.proposal.ground import DARK, Ground
from realitygap.models.naming.proposal.menu import (
    Expected,
    Flight,
    Proposal,
    Rival,
    distance,
    flights,
    ranked,
)
from realitygap.models.naming.rules import Rules

STRIDE = 5
"""Control steps from one row looked at to the next. No rule: it bounds the work."""
ONLY_ROBOTS_TELL = {"ir_gain", "wall_albedo"}
"""Causes that readings of the wall cannot separate."""


class _Believed(NamedTuple):
    """What is believed of each robot if one cause is true, and how well its numbers are known."""

    beliefs: tuple[Belief, ...]
    scope: int
    term: Term
    coordinates: FloatArray
    """(p,)."""
    covariance: FloatArray
    """(p, p)."""


def propose(
    senses: SenseExamination, named: Named, model: PointModel, ground: Ground, rules: Rules
) -> Proposal | None:
    """The manoeuvres that separate an ambiguous cause from its rivals; None: none can be flown.

    Args:
        senses: The log's.
        named: One of its causes in the senses, with alternatives.
        model: What is believed, with sensor tables where sensors were judged.
        ground: Where it can be flown.
        rules: What naming is tuned to.
    """
    rivals = tuple(named.evidence.rivals)
    separates = (named.term.cause.name, *dict.fromkeys(t.cause.name for t in rivals))
    if senses.found is None:
        return None
    own, *others = _believed(senses.found, named)
    of_nest = isinstance(named.term.cause, SenseCause) and named.term.cause.kind == "nest"
    if senses.sight is None and not of_nest:
        return None
    separations = {}
    robots = len(senses.found.state.robots)
    flown_ones = flights(robots, model, ground)
    for flight in flown_ones:
        if of_nest:
            far = [_edges_apart(flight, own, rival, model) for rival in others]
        else:
            assert senses.sight is not None
            far = [_apart(senses.sight, flight, model, own, rival, rules) for rival in others]
        separations[flight.probe.name] = far
    if not separations:
        return None
    options, every = ranked(separations), (own, *others)
    best = next(one for one in flown_ones if one.probe.name == options[0].name)
    return Proposal(
        separates=separates,
        options=options,
        rivals=tuple(Rival.fitted(one.term, one.coordinates) for one in every),
        expected=(
            *_of_robots(every, options[0].separation),
            *reads(flown(best, ground), [[b.of(model) for b in one.beliefs] for one in every]),
        ),
    )


def _of_robots(every: Sequence[_Believed], apart: float) -> tuple[Expected, ...]:
    """That louder sensors are louder before other robots too, and a brighter wall is not."""
    if {one.term.cause.name for one in every} != ONLY_ROBOTS_TELL:
        return ()
    factors = [
        1.0 if one.term.cause.name == "wall_albedo" else one.term.cause.values(one.coordinates)[0]
        for one in every
    ]
    channel, unit = "infrared before another robot", "times the model's"
    return (Expected(None, 0.0, 0.0, channel, unit, tuple(map(float, factors)), apart),)


def _believed(found: SensesFound, named: Named) -> list[_Believed]:
    """The named cause and each rival, fitted to the log beside everything else found."""
    state = found.state
    scope = next(
        s
        for s, judged in found.judged.items()
        if named.term in judged.terms
        and tuple(state.tracks.robots[k] for k in state.members(s)) == named.robots
    )
    judged = found.judged[scope]
    fitter = Fitter(Weighed(state), scope)
    rest = [t for t in judged.terms if t != named.term]
    given = [
        c for t, c in zip(judged.terms, judged.fit.coordinates, strict=True) if t != named.term
    ]
    result = []
    for term in (named.term, *named.evidence.rivals):
        doses = [item.dose for item in state.items if item.term == term and item.dose is not None]
        starts = [np.zeros(len(term.cause.parameters)), *(np.array(dose) for dose in doses)]
        if term == named.term:
            starts.append(named.evidence.coordinates)
        fits = [fitter.fit([*rest, term], [*given, start]) for start in starts]
        fit = min((one for one in fits if one is not None), key=lambda one: one.square)
        size = len(term.cause.parameters)
        kept = [(t, c) for t, c in zip([*rest, term], fit.coordinates, strict=True)]
        beliefs = []
        for k, robot in enumerate(state.robots):
            belief = state.motion(k, {scope: ()})
            for t, c in kept if k in state.members(scope) else ():
                belief = robot.applied(belief, t, c)
            beliefs.append(belief)
        covariance = fit.covariance[-size:, -size:] if size else np.zeros((0, 0))
        result.append(_Believed(tuple(beliefs), scope, term, fit.coordinates[-1], covariance))
    return result


def _apart(
    log: Sight, flight: Flight, model: PointModel, own: _Believed, rival: _Believed, rules: Rules
) -> float:
    """Separation in readings, the smaller of either being true."""
    sight = _sight(flight, log, model)
    if {own.term.cause.name, rival.term.cause.name} == ONLY_ROBOTS_TELL:
        size = abs(float(own.coordinates[0]))
        number = _seen_of_robots(sight, model)
        return float(size * np.sqrt(number) / rules.of_robots)
    found = []
    for truth, asked in ((own, rival), (rival, own)):
        told = replace(sight, read=predict(sight, model, truth.beliefs))
        errors, columns = [], []
        for k in range(len(sight.robots)):
            eye = Eye(told.of(k), model)
            for name in KINDS:
                seen = ReadingRows(eye, name, truth.beliefs[k])
                errors.append(seen.errors(asked.beliefs[k]))
                mine = asked.scope in (SWARM, k)
                columns.append(_columns(seen, asked, asked.beliefs[k], mine=mine))
        grown = np.sqrt(STRIDE)
        whole, given = np.concatenate(errors), np.concatenate(columns)
        found.append(distance(grown * whole, grown * given, asked.covariance))
    return min(found)


def _columns(seen: ReadingRows, asked: _Believed, belief: Belief, *, mine: bool) -> FloatArray:
    """(n, p) change of the errors per unit of a cause's numbers."""
    size = len(asked.coordinates)
    if not mine or not size:
        return np.zeros((len(seen.window), size))
    found = columns_of(Item(asked.term, None, "", "", ()), belief, seen.errors)
    return -np.stack(found, axis=1)


def _sight(flight: Flight, log: Sight, model: PointModel) -> Sight:
    """The manoeuvre as a log cut for the senses, under the log's lamp or none."""
    poses = flight.poses[::STRIDE]
    steps, robots = poses.shape[:2]
    who, step = np.divmod(np.arange(robots * steps), steps)
    flat = np.ascontiguousarray(poses.transpose(1, 0, 2).reshape(-1, 3))
    place = poses[step, :, :2].copy()
    place[np.arange(len(who)), who] = FAR
    neighbours = Neighbours(place)
    lit = log.scenario[log.scenario >= 0]
    common = int(np.bincount(lit).argmax()) if len(lit) else DARK
    scenario = np.full(len(who), DARK if flight.probe.dark else common, dtype=np.int32)
    time = step * STRIDE * CONTROL_STEP
    block = who * (steps + 1) + (time / BLOCK_SECONDS).astype(np.int64)
    each = np.nanmedian(log.spread, axis=0) if len(log.spread) else np.zeros(3)
    read = ~np.isnan(log.read).all(axis=0)
    free = np.hstack(
        [~neighbours.in_ray(flat, model), lamp_in_sight(flat, scenario, neighbours, model)]
    )
    return Sight(
        robots=log.robots,
        begin=np.arange(robots + 1, dtype=np.int64) * steps,
        part=np.zeros(len(who), dtype=np.int64),
        time=time,
        run=who,
        scenario=scenario,
        poses=flat,
        spread=np.tile(each, (len(who), 1)),
        read=np.zeros((len(who), 2 * SENSORS)),
        free=free & read,
        block=np.unique(block, return_inverse=True)[1],
        neighbours=neighbours,
        rules=log.rules,
        commanded=np.zeros((len(who), 2)),  # only what is unexplained looks at it
    )


def _seen_of_robots(sight: Sight, model: PointModel) -> int:
    """Readings in which another robot is surely in a sensor's ray."""
    assert model.tables is not None
    radius = model.body_radius
    away = sight.neighbours.place - sight.poses[:, None, :2]
    number = 0
    for angle in model.sensor_angles:
        yaw = sight.poses[:, 2] + angle
        c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
        ahead, aside = c * away[..., 0] + s * away[..., 1], c * away[..., 1] - s * away[..., 0]
        gap = ahead - np.sqrt(np.maximum(radius**2 - aside**2, 0.0)) - radius
        sure = (np.abs(aside) < SQUARE * radius) & (ahead > 0.0)
        number += int((sure & (gap < 0.5 * model.tables.ps_range)).sum())
    return number * STRIDE


def _edges_apart(flight: Flight, own: _Believed, rival: _Believed, model: PointModel) -> float:
    """Separation in the virtual sensor's answers: what the best fitting rival gets wrong."""
    found = 0.0
    for k, (truth, asked) in enumerate(zip(own.beliefs, rival.beliefs, strict=True)):
        place = flight.poses[:, k % flight.poses.shape[1], :2]
        x, y, radius = truth.of(model).nest
        inside = np.hypot(place[:, 0] - x, place[:, 1] - y) < radius
        rows = np.arange(len(place), dtype=np.int64)
        none = np.zeros(len(place), dtype=np.int64)
        told = Answers(place, inside, none, none, rows, none, np.asarray(rows * CONTROL_STEP))
        edge = Crossings(told, 0, model)
        if not len(edge.rows):
            continue
        size = len(rival.coordinates)
        mine = rival.scope in (SWARM, k)
        item = Item(rival.term, None, "", "", ())
        columns = np.zeros((len(edge.rows), size))
        if mine and size:
            columns = -np.stack(columns_of(item, asked, edge.errors), axis=1)
        found += distance(edge.errors(asked), columns, rival.covariance) ** 2
    return float(np.sqrt(found))
