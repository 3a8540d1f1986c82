"""Rivals in motion: where a manoeuvre would take robots if one or the other were true."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim import CONTROL_STEP, Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes, withheld
from realitygap.models.belief.motion import Motion
from realitygap.models.log.schema import ENCODERS
from realitygap.models.naming.channels.motion.candidates import own_starts
from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.predict import TICK, poses, wheel_angles
from realitygap.models.naming.channels.motion.tracks import LEAST_ROWS, Tracks
from realitygap.models.naming.engine.hypothesis import Fit, Term, Terms
from realitygap.models.naming.findings import Named
from realitygap.models.naming.proposal.expected import flown, moves
from realitygap.models.naming.proposal.ground import Ground
from realitygap.models.naming.proposal.menu import (
    Flight,
    Proposal,
    Rival,
    distance,
    flights,
    ranked,
)

ENCODER_NOISE = TICK / CONTROL_STEP / np.sqrt(6.0)
"""rad/s; a speed is the difference of two rounded angles. No rule: of the sensor."""


OPEN = 10.0
"""By which a coordinate may move where the log is forgotten: any size of any cause. No rule: as
good as free."""


def propose(examined: Examination, named: Named, ground: Ground) -> Proposal | None:
    """The manoeuvres that separate an ambiguous cause from its rivals; None: none can be flown.

    Args:
        examined: The log's.
        named: One of its causes in motion, with alternatives.
        ground: Where it can be flown.
    """
    problem = _problem(examined, named)
    others = tuple(
        one.term
        for one in examined.identified.named
        if one.key != named.key and set(named.robots) <= set(one.robots)
    )
    twins = set(named.twins)
    rivals = [*named.twins, *(t for t in named.evidence.rivals if t.cause != named.term.cause)]
    own = _fitted(problem, others, named.term, named.evidence.coordinates)
    fits = [(rival, _fitted(problem, others, rival)) for rival in rivals]
    if own is None or any(fit is None for _, fit in fits):
        return None
    likes = [_fitted(problem, others, like) for like in _likes((named.term, *rivals))]
    problem.scale = problem.spread(own.residual)
    where = [examined.tracks.robots.index(robot) for robot in named.robots]
    believed = examined.model.point_model()
    separations = {}
    flown_ones = flights(len(examined.tracks.robots), believed, ground)
    for flight in flown_ones:
        tracks = _tracks(flight, where, named.robots, examined.tracks)
        if tracks is None:
            continue
        far = [
            _wheels_apart(problem, tracks, own, fit)
            if rival in twins
            else min(_apart(problem, tracks, own, fit), _apart(problem, tracks, fit, own))
            for rival, fit in fits
            if fit is not None
        ]
        far += [_apart(problem, tracks, own, like, open_by=OPEN) for like in likes if like]
        separations[flight.probe.name] = far
    if not separations:
        return None
    unseen = bool(twins) and examined.tracks.encoders is None
    options = ranked(separations)
    every = [(named.term, own), *((rival, fit) for rival, fit in fits if fit is not None)]
    best = next(one for one in flown_ones if one.probe.name == options[0].name)
    noise = examined.tracks.noise
    return Proposal(
        separates=(named.term.cause.name, *dict.fromkeys(t.cause.name for t in rivals)),
        options=options,
        needs=ENCODERS if unseen else (),
        rivals=tuple(Rival.fitted(t, fit.coordinates[0][fit.part(t)]) for t, fit in every),
        expected=moves(
            flown(best, ground),
            where,
            [problem.motions(fit.terms, fit.coordinates) for _, fit in every],
            (noise.position, noise.heading),
        ),
    )


def _problem(examined: Examination, named: Named) -> Problem:
    """The log of the robots concerned, all with one value."""
    chosen = [examined.tracks.robots.index(robot) for robot in named.robots]
    base = [examined.identified.base[k] for k in chosen]
    groups = np.zeros(len(chosen), dtype=np.int64)
    return Problem(examined.tracks.only(chosen), base, groups=groups)


def _likes(rivals: Sequence[Term]) -> list[Term]:
    """What else the rivals are confusable with: a manoeuvre alone must not bring it in."""
    known = {t.cause.name for t in rivals} | {name for t in rivals for name in t.cause.twins}
    names = dict.fromkeys(name for t in rivals for name in t.cause.confusable_with)
    return [
        Term(causes()[name], causes()[name].variants[-1])
        for name in names
        if name in causes()
        and name not in known
        and not withheld(name)
        and causes()[name].smooth
        and causes()[name].identifiable
    ]


def _fitted(
    problem: Problem, others: Terms, term: Term, at: FloatArray | None = None
) -> Fit | None:
    """The other causes and one of the rivals, fitted to the log; None where it cannot be."""
    given = [o for o in others if o.cause.name != term.cause.name]
    size = sum(len(o.cause.parameters) for o in given)
    begin = own_starts(term, problem.tracks.commands)
    begin += [at] if at is not None and len(at) == len(term.cause.parameters) else []
    starts = [np.concatenate([np.zeros(size), start])[None] for start in begin]
    try:
        return problem.fit((*given, term), starts) if starts else None
    except Diverged:
        return None


def _tracks(
    flight: Flight, where: Sequence[int], robots: tuple[int, ...], log: Tracks
) -> Tracks | None:
    """The manoeuvre as tracks of some robots; None where they never move freely."""
    steps = len(flight.poses)
    index = np.arange(len(where) * steps)
    robot, step = np.divmod(index, steps)
    free = flight.clear[:, where].T.ravel()
    length = round(log.rules.window / CONTROL_STEP)
    cell = robot * (steps // length + 1) + step // length
    rows = index[free & (np.bincount(cell, free)[cell] >= LEAST_ROWS)]
    if not len(rows):
        return None
    first = np.flatnonzero(np.diff(cell[rows], prepend=-1))
    return Tracks(
        robots=robots,
        t=step * CONTROL_STEP,
        commands=np.ascontiguousarray(flight.commands[:, where].transpose(1, 0, 2)).reshape(-1, 2),
        start=np.arange(len(where) + 1, dtype=np.int64) * steps,
        segment_robot=np.arange(len(where), dtype=np.int64),
        step=CONTROL_STEP,
        encoders=None,
        rows=rows,
        first=first,
        measured=np.zeros((len(rows), 3)),
        about=np.zeros((len(index), 0)),
        columns=(),
        noise=log.noise,
        part=np.zeros(len(index), dtype=np.int64),
        rules=log.rules,
    )


def _apart(
    log: Problem, tracks: Tracks, truth: Fit, rival: Fit, *, open_by: float | None = None
) -> float:
    """Separation in poses if the first is true and the second is asked.

    With `open_by`, the log is forgotten: the second's coordinates may move by so much.
    """
    seen = replace(tracks, measured=poses(tracks, log.motions(truth.terms, truth.coordinates)))
    flown = Problem(seen, log.base, groups=log.groups, scale=log.scale)
    residual = flown.residual(rival.terms, rival.coordinates)
    columns = flown.jacobian(rival.terms, rival.coordinates, residual)
    errors = residual / flown.row_scale
    wide = columns / flown.row_scale[:, :, None]
    covariance = rival.covariance[0]
    if open_by is not None:
        covariance = open_by**2 * np.eye(len(covariance))
    return distance(errors.ravel(), wide.reshape(errors.size, -1), covariance)


def _wheels_apart(log: Problem, tracks: Tracks, truth: Fit, rival: Fit) -> float:
    """Separation of twins: poses say the same of both, encoders do not."""
    speeds = []
    for fit in (truth, rival):
        motions: list[Motion] = log.motions(fit.terms, fit.coordinates)
        angle = wheel_angles(tracks, motions)
        inside = np.diff(tracks.row_robot) == 0
        speeds.append(np.diff(angle, axis=0)[inside] / CONTROL_STEP)
    return float(np.linalg.norm((speeds[0] - speeds[1]) / ENCODER_NOISE))
