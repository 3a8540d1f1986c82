"""Which law: scanned over the grammar on held-out blocks, refined, and set against its rivals."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from scipy.optimize import minimize

from realitygap.embedded_sim.laws import Atom, Channel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.fitter import FOLDS
from realitygap.models.naming.laws.columns import LawColumns
from realitygap.models.naming.laws.grammar import (
    Candidate,
    at_phase,
    inner,
    possible,
    step_of,
    swinging,
    swings,
)
from realitygap.models.naming.laws.judged import Judgement, Panel

REFINED = 5
"""Families that are refined, the best of the scan. No rule: it bounds the work."""
PRICE = 6.0
"""Deviance that each inner constant costs. No rule: as `Rules.price` asks of a second parameter,
and inner constants were chosen from a grid besides."""
ANGLES = ("left_angle", "right_angle")
"""Quantities that begin anew in every run."""
TRIES = 60
"""Evaluations of a refinement. No rule: a limit of iterations."""

Change = Callable[[LawColumns, Channel, Sequence[Atom]], FloatArray]


@dataclass(frozen=True)
class LawRobot:
    """One robot as laws are tried in it."""

    shown: LawColumns
    panel: Panel

    def columns(self, one: Candidate) -> FloatArray:
        """(rows, q) white."""
        return self.shown.white(one.channel, self.strength(one))

    def strength(self, one: Candidate) -> FloatArray:
        """(n, sides, q); a wheel's angle begins anew in every run, with a phase of its own."""
        strength = np.stack(
            [self.shown.strength(one.channel, [atom]) for atom in one.atoms], axis=2
        )
        if self.by_run(one):
            runs = [self.shown.segment == run for run in np.unique(self.shown.segment)]
            strength = np.concatenate([strength * run[:, None, None] for run in runs], axis=2)
        return np.asarray(strength)

    def by_run(self, one: Candidate) -> bool:
        """Whether a law has a phase of its own in each of several runs."""
        return one.atoms[0].of in ANGLES and len(np.unique(self.shown.segment)) > 1

    def told(self, one: Candidate) -> Judgement:
        """What a law takes off."""
        return self.panel.told(self.panel.sums(self.columns(one), together=True))


@dataclass(frozen=True)
class Offered:
    """A law of some robots, with what it takes off held-out blocks."""

    law: Candidate
    gain: FloatArray
    """(folds,) of all robots together."""

    @property
    def worth(self) -> float:
        """Deviance taken off held-out blocks but the best fold, less what its constants cost."""
        return guarded(self.gain) - PRICE * len(inner(self.law.atoms[0]))


def guarded(gain: FloatArray) -> float:
    """A gain over folds as if the best fold were like the others: no single place may carry it."""
    return float((gain.sum() - gain.max()) * len(gain) / (len(gain) - 1.0))


def scanned(robots: Sequence[LawRobot], laws: Sequence[Candidate]) -> list[Offered]:
    """All of a grammar, best first."""
    found = []
    by_run = [one for one in laws if any(robot.by_run(one) for robot in robots)]
    for one in by_run:
        gain = np.sum([robot.told(one).gain for robot in robots], axis=0)
        found.append(Offered(one, np.asarray(gain)))
    apart = set(by_run)
    by_kind = sorted((one for one in laws if one not in apart), key=_kind)
    for (channel, phases), group in groupby(by_kind, _kind):
        mine = list(group)
        total = np.zeros((FOLDS, len(mine)))
        for robot in robots:
            strength = [
                np.stack([robot.shown.strength(channel, [one.atoms[p]]) for one in mine], axis=2)
                for p in range(phases)
            ]
            columns = robot.shown.white(channel, np.concatenate(strength, axis=2))
            total += robot.panel.gains(columns.reshape(len(columns), phases, len(mine)))
        found += [Offered(one, g) for one, g in zip(mine, total.T, strict=True)]
    return sorted(found, key=lambda one: -one.worth)


def _kind(one: Candidate) -> tuple[Channel, int]:
    return one.channel, len(one.atoms)


def best_of_families(offered: Sequence[Offered], most: int = REFINED) -> list[Offered]:
    """The best of each family, best first."""
    found: dict[object, Offered] = {}
    for one in offered:
        found.setdefault(one.law.family, one)
    return list(found.values())[:most]


def refined(robots: Sequence[LawRobot], one: Offered, seconds: float) -> Offered:
    """The same family at the inner constants that fit best."""
    atom, which = one.law.atoms[0], inner(one.law.atoms[0])
    if not which:
        return one
    start: FloatArray = np.array([atom.parameters[k] for k in which], dtype=np.float64)
    steps = np.array(step_of(atom, seconds))

    def at(values: FloatArray) -> Candidate:
        numbers = list(atom.parameters)
        for k, value in zip(which, values, strict=True):
            numbers[k] = float(value)
        moved = Atom(atom.of, atom.form, tuple(numbers))
        return Candidate(one.law.channel, swinging(moved) if swings(moved) else (moved,))

    def left(values: FloatArray) -> float:
        law = at(values)
        if not possible(law.atoms[0]):
            return 0.0
        return -sum(robot.told(law).deviance for robot in robots)

    end = minimize(
        left,
        start,
        method="Nelder-Mead",
        options={
            "maxfev": TRIES,
            "initial_simplex": np.vstack([start, start + np.diag(steps)]),
            "xatol": 1e-4,
            "fatol": 0.05,
        },
    )
    law = at(np.asarray(end.x, dtype=np.float64))
    gain = np.sum([robot.told(law).gain for robot in robots], axis=0)
    return Offered(law, np.asarray(gain))


def phased(robots: Sequence[LawRobot], law: Candidate) -> Candidate:
    """A swing at one phase for all its robots; of wheels' angles, as it is."""
    if len(law.atoms) == 1 or law.atoms[0].of in ANGLES:
        return law
    square = np.zeros((2, 2))
    for robot in robots:
        told = robot.told(law)
        square += np.outer(told.value, told.slope) + np.outer(told.slope, told.value)
    size, turn = np.linalg.eigh(square)
    direction = turn[:, int(np.argmax(size))]
    value = robots[0].told(law).value
    if len(robots) > 1:
        value = sum((robot.told(law).value for robot in robots), np.zeros(2))
    if direction @ value < 0.0:
        direction = -direction
    phase = float(np.arctan2(direction[1], direction[0]))
    return Candidate(law.channel, (at_phase(law.atoms[0], phase),))


def explored(
    robots: Sequence[LawRobot], laws: Sequence[Candidate], seconds: float
) -> list[Offered]:
    """The best families, refined, best first."""
    best = best_of_families(scanned(robots, laws))
    return sorted((refined(robots, one, seconds) for one in best), key=lambda one: -one.worth)


def names(robots: Sequence[LawRobot]) -> Iterator[str]:
    """Quantities that all robots' logs hold."""
    held = set.intersection(*(set(robot.shown.known) for robot in robots))
    yield from sorted(held | {"wheel_speed"})
