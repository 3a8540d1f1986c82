"""How large a law is in each robot, and how surely.

Its inner constants are the same in all its robots, and as unknown as they leave them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.laws import Atom
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.marginal import EMPTY
from realitygap.models.naming.laws.found import Amount
from realitygap.models.naming.laws.grammar import Candidate
from realitygap.models.naming.laws.selection import LawRobot

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
