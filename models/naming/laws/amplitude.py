"""How large a law is in one robot, and how surely."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from realitygap.embedded_sim.laws import Atom
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.laws.found import Amount
from realitygap.models.naming.laws.grammar import Candidate
from realitygap.models.naming.laws.selection import LawRobot

NORMAL = 1.959963984540054
"""Standard deviations to either side of 95 % of a normal variable. No rule, as all numbers here: of
statistics and numerics."""
STEP = 1e-3
"""Of an inner constant, or of a tenth where it is smaller, that a slope is taken over."""
TENTH = 0.1
SMOOTH = {"power": (1,), "fade": (0,), "cosine": (1,), "slope": (1,)}
"""Inner constants of forms that a small change of them changes a little."""


def amount(robot: LawRobot, law: Candidate, robots: int) -> Amount:
    """An amplitude with its interval; of a wheel's angle the length of both its phases.

    Args:
        robot: Whose.
        law: At one phase, or of a wheel's angle.
        robots: How many told the inner constants: what these leave unknown is shared by them.
    """
    columns = robot.columns(law)
    panel = robot.panel
    if columns.shape[1] > 1:
        both = panel.told(panel.sums(columns, together=True)).value
        half = len(both) // 2
        size = float(np.hypot(both[:half], both[half:]).mean())
        columns = (columns @ both / size)[:, None]
    told = panel.told(panel.sums(columns, together=True))
    mid, error = float(told.value[0]), panel.spread(columns[:, 0], told)
    slopes = list(_slopes(robot, law))
    if slopes:
        wide = panel.told(panel.sums(np.column_stack([columns, *slopes]), together=True))
        scale = np.sqrt(np.maximum(np.diag(wide.information), STEP))
        inverse = np.linalg.pinv(wide.information / scale[:, None] / scale, hermitian=True)
        apart = float(inverse[0, 0]) / scale[0] ** 2 * float(told.information[0, 0])
        error *= math.sqrt(1.0 + max(apart - 1.0, 0.0) / robots)
    return Amount(mid, mid - NORMAL * error, mid + NORMAL * error)


def _slopes(robot: LawRobot, law: Candidate) -> Iterator[FloatArray]:
    """(rows,) white columns of what a law changes with its inner constants."""
    if len(law.atoms) > 1:
        return
    atom = law.atoms[0]
    which = SMOOTH.get(atom.form, ())
    for k in (*which, *((0,) if atom.form == "cosine" and atom.of == "time" else ())):
        by = STEP * max(abs(atom.parameters[k]), TENTH)
        sides = []
        for change in (by, -by):
            numbers = list(atom.parameters)
            numbers[k] += change
            moved = Atom(atom.of, atom.form, tuple(numbers))
            sides.append(robot.columns(Candidate(law.channel, (moved,)))[:, 0])
        yield (sides[0] - sides[1]) / (2.0 * by)
