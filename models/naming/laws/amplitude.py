"""How large a law is in each robot, and how surely.

Its inner constants are the same in all its robots, and as unknown as they leave them.

Beside the laws stands a smooth curve of a quantity: what any law of it could take off at most. It
is made of straight lines between evenly spaced nodes, finer than any law of the grammar, drawn
towards none. Where a curve does clearly better than the best law, its shape is not in the grammar.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.laws import Atom, Channel, Quantity
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.marginal import EMPTY
from realitygap.models.naming.laws.found import Amount
from realitygap.models.naming.laws.grammar import Candidate
from realitygap.models.naming.laws.judged import Judgement, Sums
from realitygap.models.naming.laws.selection import LawRobot, guarded

NORMAL = 1.959963984540054
"""Standard deviations to either side of 95 % of a normal variable. No rule, as all numbers here: of
statistics and numerics."""
STEP = 1e-3
"""Of an inner constant, or of a tenth where it is smaller, that a slope is taken over."""
TENTH = 0.1
EDGE = 5e-3
"""m, or rad: over which a slope is taken of an edge, at which a row is inside or outside."""
CONSTANTS = {
    "power": (1,),
    "fade": (0,),
    "over": (0,),
    "cosine": (1,),
    "slope": (1,),
    "below": (0,),
    "half": (0, 1),
    "disc": (0, 1, 2),
}
"""Inner constants of a form."""
EDGED = ("below", "half", "disc")


class _Told(NamedTuple):
    """Of one robot, at a law's constants."""

    value: float
    variance: float
    """With the constants known."""
    pull: FloatArray
    """(q,) what the amplitude changes per change of each constant."""
    information: FloatArray
    """(q, q) of the constants, the amplitude being free."""
    meat: FloatArray
    """(q, q) covariance of their score, by blocks."""


def amounts(
    robots: Sequence[LawRobot], law: Candidate, most: int, at: Sequence[float] = ()
) -> list[Amount]:
    """Amplitudes with their intervals; of a wheel's angle the length of both its phases.

    Args:
        robots: Whose.
        law: At one phase, or of a wheel's angle.
        most: Robots, the first ones, that told the inner constants; 0: these are given.
        at: Amplitudes that the robots' motions have already; none: 0.
    """
    have = at or [0.0] * len(robots)
    told = [_told(robot, law, own) for robot, own in zip(robots, have, strict=True)]
    shared = np.zeros((0, 0)) if not most else _shared(told[:most])
    found = []
    for one in told:
        pull = one.pull if most else one.pull[:0]
        error = NORMAL * float(np.sqrt(one.variance + pull @ shared @ pull))
        found.append(Amount(one.value, one.value - error, one.value + error))
    return found


def _shared(told: Sequence[_Told]) -> FloatArray:
    """(q, q) covariance of the inner constants."""
    whole = np.sum([one.information for one in told], axis=0)
    if not len(whole):
        return np.zeros((0, 0))
    scale = np.sqrt(np.maximum(np.diag(whole), np.finfo(float).tiny))
    inverse = np.linalg.pinv(whole / scale[:, None] / scale, rcond=STEP, hermitian=True)
    inverse = inverse / scale[:, None] / scale
    meat = np.sum([one.meat for one in told], axis=0)
    excess = float(np.trace(inverse @ meat)) / len(whole)
    return np.asarray(inverse * max(excess, 1.0))


def _told(robot: LawRobot, law: Candidate, at: float) -> _Told:
    columns, panel = robot.columns(law), robot.panel
    if columns.shape[1] > 1:
        both = panel.told(panel.sums(columns, together=True)).value
        half = len(both) // 2
        size = float(np.hypot(both[:half], both[half:]).mean())
        columns = (columns @ both / size)[:, None]
    more = float(panel.told(panel.sums(columns, together=True)).value[0])
    value = at + more
    wide = np.column_stack([columns, value * _slopes(robot, law)])
    information = panel.told(panel.sums(wide, together=True)).information
    scores = panel.scores(wide, more * columns[:, 0])
    width = max(float(information[0, 0]), EMPTY)  # else a robot never met what the law is of
    pull = -information[1:, 0] / width
    own = information[1:, 1:] - np.outer(pull, pull) * width
    clear = scores[:, 1:] + scores[:, :1] * pull
    variance = max(float((scores[:, 0] ** 2).sum()) / width, 1.0) / width
    return _Told(value, variance, pull, own, clear.T @ clear)


def _slopes(robot: LawRobot, law: Candidate) -> FloatArray:
    """(rows, q) white columns of what a law changes with its inner constants."""
    atom = law.atoms[0]
    which = CONSTANTS.get(atom.form, ()) if len(law.atoms) == 1 else ()
    if atom.form == "cosine" and atom.of == "time":
        which = (0, 1)
    found = [np.zeros((len(robot.panel.left), 0))]
    for k in which:
        by = EDGE if atom.form in EDGED else STEP * max(abs(atom.parameters[k]), TENTH)
        sides = []
        for change in (by, -by):
            numbers = list(atom.parameters)
            numbers[k] += change
            moved = Atom(atom.of, atom.form, tuple(numbers))
            sides.append(robot.columns(Candidate(law.channel, (moved,))))
        found.append((sides[0] - sides[1]) / (2.0 * by))
    return np.concatenate(found, axis=1)


NODES = 16
"""Of a curve; C takes as many. No rule, as all numbers here: four for each swing of the fastest
harmonic."""
GRID = 8
"""Nodes of a surface over the floor, along each axis."""
ROUND = 2.0 * np.pi
REACH = {"gap": 0.3, "since": 5.0}
"""m, s: beyond it a curve stays as it is."""
WEIGHTS = (0.003, 0.03, 0.3)
"""Information that a node has beforehand, of what it has; the best is kept."""
WITHOUT = ("left_angle", "right_angle")
"""Quantities whose phase is another in every run: no one curve holds for them."""


class CurveOf(NamedTuple):
    """A curve of some robots together."""

    channel: Channel
    of: Quantity
    atom: Atom | None
    """Its values, the largest 1; None: it is a surface over the floor, or of a wheel's angle."""
    gain: FloatArray
    """(folds,) deviance taken off held-out blocks."""

    @property
    def worth(self) -> float:
        return guarded(self.gain)


def curve(robots: Sequence[LawRobot], channel: Channel, of: Quantity) -> CurveOf | None:
    """The best curve of a quantity in a channel, one shape for all robots; None: there is none."""
    span = _span(robots, of)
    if of in WITHOUT or span is None:
        return None
    columns = [_columns(robot, channel, of, span) for robot in robots]
    sums = [r.panel.sums(c, together=True) for r, c in zip(robots, columns, strict=True)]
    best: CurveOf | None = None
    for weight in WEIGHTS:
        told = [
            robot.panel.told(one, np.full(len(one.slope[0]), weight * _usual(one)))
            for robot, one in zip(robots, sums, strict=True)
        ]
        gain = np.sum([one.gain for one in told], axis=0)
        if best is None or guarded(gain) > best.worth:
            atom = None if of == "place" else _atom(of, span, told)
            best = CurveOf(channel, of, atom, np.asarray(gain))
    return best


def _usual(sums: Sums) -> float:
    """Information of a node in the mean."""
    return float(np.diag(sums.own.sum(axis=0)).mean())


def _atom(of: Quantity, span: tuple[float, float], told: Sequence[Judgement]) -> Atom:
    information = np.sum([one.information for one in told], axis=0)
    slope = np.sum([one.slope for one in told], axis=0)
    values = np.linalg.lstsq(information, slope, rcond=None)[0]
    values = values / max(float(np.abs(values).max()), EMPTY)
    if of == "heading":
        values = np.append(values, values[0])
    return Atom(of, "curve", (*span, *(float(v) for v in values)))


def _span(robots: Sequence[LawRobot], of: Quantity) -> tuple[float, float] | None:
    """Where a curve begins and ends."""
    if of == "heading":
        return 0.0, ROUND
    if of == "place":
        return 0.0, 1.0
    sides = (0, 1) if of == "wheel_speed" else (-1,)
    every = np.concatenate([r.shown.of_side(side)[of] for r in robots for side in sides])
    low, high = np.quantile(every, (0.005, 0.995))
    high = min(float(high), REACH.get(of, float(high)))
    return (float(low), high) if high - low > 1e-6 else None


def _columns(
    robot: LawRobot, channel: Channel, of: Quantity, span: tuple[float, float]
) -> FloatArray:
    """(rows, nodes) white, one for each node."""
    sides = {"left": (0,), "right": (1,), "both": (0, 1)}.get(channel, (-1,))
    hats = [_hats(robot.shown.of_side(side)[of], of, span) for side in sides]
    return robot.shown.white(channel, np.stack(hats, axis=1))


def _hats(q: FloatArray, of: Quantity, span: tuple[float, float]) -> FloatArray:
    """(n, nodes) each 1 at its node and 0 at the others, straight between."""
    if of == "place":
        low, high = np.quantile(q, (0.005, 0.995), axis=0)
        x, y = (_straight(q[:, k], low[k], high[k], GRID) for k in (0, 1))
        return np.asarray((x[:, :, None] * y[:, None, :]).reshape(len(q), -1))
    if of != "heading":
        return _straight(q, *span, NODES)
    hats = _straight(np.mod(q, ROUND), *span, NODES + 1)
    hats[:, 0] += hats[:, -1]
    return hats[:, :-1]


def _straight(q: FloatArray, low: float, high: float, nodes: int) -> FloatArray:
    place = (np.clip(q, low, high) - low) / (high - low) * (nodes - 1)
    return np.maximum(1.0 - np.abs(place[:, None] - np.arange(nodes)), 0.0)
