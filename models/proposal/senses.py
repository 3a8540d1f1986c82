"""Rivals in the senses and the nest: what a manoeuvre would let robots read under each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim import CONTROL_STEP, SCENARIOS, SENSORS, PointModel
from realitygap.models.naming.findings import Named
from realitygap.models.proposal.menu import Flight, Proposal, distance, flights, ranked
from realitygap.models.rules import Rules
from realitygap.models.senses import nest
from realitygap.models.senses.cause import SenseCause
from realitygap.models.senses.diagnose import SenseExamination
from realitygap.models.senses.direct import SQUARE
from realitygap.models.senses.glance import NO_COMMANDS
from realitygap.models.senses.neighbours import FAR, Neighbours
from realitygap.models.senses.predicted import predict
from realitygap.models.senses.problem import SWARM, Fit, Problem, Term
from realitygap.models.senses.sight import BLOCK_SECONDS, Sight, lamp_in_sight

STRIDE = 5
"""Control steps from one row looked at to the next. No rule: it bounds the work."""
DARK = SCENARIOS.index("none")
ONLY_ROBOTS_TELL = {"ir_gain", "wall_albedo"}
"""Causes that readings of the wall cannot separate."""


def propose(
    senses: SenseExamination, named: Named, model: PointModel, rules: Rules
) -> Proposal | None:
    """The manoeuvres that separate an ambiguous cause from its rivals; None: none can be flown.

    Args:
        senses: The log's.
        named: One of its causes in the senses, with alternatives.
        model: What is believed, with sensor tables where sensors were judged.
        rules: What naming is tuned to.
    """
    rivals = tuple(named.evidence.rivals)
    separates = (named.term.cause.name, *dict.fromkeys(t.cause.name for t in rivals))
    robots = len(senses.sight.robots) if senses.sight is not None else len(named.robots)
    separations = {}
    prepared = _prepared(senses, named)
    for flight in flights(robots, model):
        if named.term.cause.name in nest.CAUSES:
            far = [_edges_apart(flight, named, model, rival.cause.name) for rival in rivals]
        elif prepared is None:
            return None
        else:
            own, fits = prepared
            far = [
                _apart(senses, flight, model, own, fit, named, rival, rules) for fit, rival in fits
            ]
        separations[flight.probe.name] = far
    return Proposal(separates=separates, options=ranked(separations)) if separations else None


def _prepared(senses: SenseExamination, named: Named) -> tuple[Fit, list[tuple[Fit, str]]] | None:
    """The named cause and each rival fitted to the log beside everything else found."""
    problem, kept, sight = senses.problem, senses.fit, senses.sight
    if problem is None or kept is None or sight is None:
        return None
    alone = len(named.robots) == 1 and len(sight.robots) > 1
    scope = sight.robots.index(named.robots[0]) if alone else SWARM
    hypotheses = [
        Term(t.cause, t.variant, scope)
        for t in (named.term, *named.evidence.rivals)
        if isinstance(t.cause, SenseCause)
    ]
    names = {t.cause.name for t in hypotheses}
    rest = tuple(t for t in kept.terms if not (t.cause.name in names and t.robot == scope))
    given = np.concatenate([kept.coordinates[kept.part(t)] for t in rest] or [np.zeros(0)])
    fits = []
    for term in hypotheses:
        starts = term.cause.starts(NO_COMMANDS) or [np.zeros(term.size)]
        if term.cause.name == named.term.cause.name:
            starts = [*starts, named.evidence.coordinates]
        tried = [problem.fit((*rest, term), np.concatenate([given, start])) for start in starts]
        fits.append(min(tried, key=lambda fit: float(problem.deviance(fit.residual).sum())))
    return fits[0], [(f, t.cause.name) for f, t in zip(fits[1:], hypotheses[1:], strict=True)]


def _apart(
    senses: SenseExamination,
    flight: Flight,
    model: PointModel,
    own: Fit,
    rival: Fit,
    named: Named,
    name: str,
    rules: Rules,
) -> float:
    """Separation in readings, the smaller of either being true."""
    assert senses.problem is not None
    assert senses.sight is not None
    sight = _sight(flight, senses.sight, model)
    if {named.term.cause.name, name} == ONLY_ROBOTS_TELL:
        size = abs(float(named.evidence.coordinates[0]))
        number = _seen_of_robots(sight, model)
        return float(size * np.sqrt(number) / rules.of_robots)
    found = []
    for truth, asked in ((own, rival), (rival, own)):
        beliefs = senses.problem.beliefs(truth.terms, truth.coordinates)
        told = replace(sight, read=predict(sight, model, beliefs))
        flown = Problem(told, model, senses.problem.base, sight.free)
        residual = flown.residual(asked.terms, asked.coordinates)
        columns = np.zeros((residual.size, len(asked.coordinates)))
        for k, one in enumerate(flown.columns(asked.terms, asked.coordinates, residual)):
            whole = np.zeros_like(residual)
            whole[one.rows] = one.values
            columns[:, k] = whole.ravel()
        grown = np.sqrt(STRIDE)
        found.append(distance(grown * residual.ravel(), grown * columns, asked.covariance))
    return min(found)


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
        scenario=scenario,
        poses=flat,
        spread=np.tile(each, (len(who), 1)),
        read=np.zeros((len(who), 2 * SENSORS)),
        free=free & read,
        block=np.unique(block, return_inverse=True)[1],
        neighbours=neighbours,
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


def _edges_apart(flight: Flight, named: Named, model: PointModel, rival: str) -> float:
    """Separation in the virtual sensor's answers: what the best fitting rival gets wrong."""
    change = np.zeros(3)
    change[list(nest.CAUSES[named.term.cause.name])] = named.evidence.coordinates
    x, y, radius = model.nest
    place = flight.poses[..., :2].reshape(-1, 2)
    inside = np.hypot(place[:, 0] - x - change[0], place[:, 1] - y - change[1]) < radius * np.exp(
        change[2]
    )
    rows = np.arange(len(place), dtype=np.int64)
    seen = nest.Answers(np.ascontiguousarray(place), inside, rows, rows, rows)
    return float(np.sqrt(max(nest.lost_by(seen, model.nest, change, rival), 0.0)))
