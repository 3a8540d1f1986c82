"""A smooth curve of a quantity: what any law of it could take off at most.

Straight lines between evenly spaced nodes, finer than any law of the grammar, drawn towards none.
Where a curve does clearly better than the best law, its shape is not in the grammar.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.laws import Atom, Channel, Quantity
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.marginal import EMPTY
from realitygap.models.naming.laws.judged import Judgement, Sums
from realitygap.models.naming.laws.selection import LawRobot, guarded

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
