"""How far apart rivals are in every manoeuvre of the menu, and which of them to choose.

A *separation* is the distance between what two rivals predict for a manoeuvre of two minutes, in
standard deviations of the noise that the log shows, after the second has been allowed to move its
parameters as far as the log leaves them open. Its square is what the wrong rival will lose in
deviance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import CONTROL_STEP, InputError, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.pilot import fly
from realitygap.embedded_sim.probes import MENU, Probe
from realitygap.models.gap.conditions import NEAR_ROBOT, NEAR_WALL
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.information import inverted
from realitygap.models.naming.proposal.ground import Ground

SECONDS = 120.0
"""s of a proposed run: as long as the logs that the diagnosis is made for. No rule: the
menu's."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Flight:
    """A manoeuvre as the point model has it."""

    probe: Probe
    poses: FloatArray
    """(steps, robots, 3) m, m, rad."""
    commands: FloatArray
    """(steps, robots, 2) rad/s."""
    clear: npt.NDArray[np.bool_]
    """(steps, robots) away from the wall and from one another."""


@dataclass(frozen=True, kw_only=True)
class Option:
    """One manoeuvre and what it promises."""

    name: str
    separation: float
    """Of the nearest rival, standard deviations."""


class Rival(NamedTuple):
    """A cause as it would have to be to explain the log."""

    name: str
    word: str
    """Such as which wheel; empty: none."""
    values: Mapping[str, float]
    """By parameter, as fitted: nothing that healthy robots show is taken off."""

    @classmethod
    def fitted(cls, term: Term, coordinates: FloatArray) -> Rival:
        """A term at coordinates (p,)."""
        values = term.cause.values(coordinates).tolist()
        names = (p.name for p in term.cause.parameters)
        return cls(term.cause.name, term.variant, dict(zip(names, values, strict=True)))


class Expected(NamedTuple):
    """What one channel will read where it tells rivals apart best."""

    robot: int | None
    """Index; None: any, whenever it happens."""
    begin: float
    """s."""
    end: float
    channel: str
    unit: str
    values: tuple[float, ...]
    """Under each rival."""
    apart: float
    """Between the first and the nearest other, in standard deviations of the log's noise."""


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """The manoeuvre to perform, for one ambiguous cause."""

    separates: tuple[str, ...]
    """The named cause first, then its rivals."""
    options: tuple[Option, ...]
    """The menu, best first."""
    needs: tuple[str, ...] = ()
    """Columns that must be logged and were not."""
    rivals: tuple[Rival, ...] = ()
    """What is to be told apart, the named cause first."""
    expected: tuple[Expected, ...] = ()
    """What the best manoeuvre will show under each, the channel that tells most first."""

    @property
    def best(self) -> Option:
        """The manoeuvre that separates most."""
        return self.options[0]

    @property
    def probe(self) -> Probe:
        """The same, with what it does."""
        return MENU[self.best.name]

    def promises(self, least: float) -> bool:
        """Whether it will do: rivals are so many standard deviations apart."""
        return self.best.separation >= least


def flights(robots: int, model: PointModel, ground: Ground) -> list[Flight]:
    """Every manoeuvre that so many robots find room for and that means something for them."""
    found = []
    for probe in MENU.values():
        if robots < probe.least or (probe.walled and not ground.walled):
            continue
        try:
            found.append(flight(probe, robots, model, ground))
        except InputError:
            continue
    return found


def flight(probe: Probe, robots: int, model: PointModel, ground: Ground) -> Flight:
    """A manoeuvre of two minutes as robots of this size and speed drive it, about the middle.

    Raises:
        InputError: so many robots do not find room.
    """
    steps = round(SECONDS * ground.pace / CONTROL_STEP)
    poses, commands = ground.full(*fly(probe, robots, ground.believed(model), steps))
    reach = float(np.hypot(poses[..., 0], poses[..., 1]).max()) + ground.body_radius
    if reach > ground.radius:
        raise InputError("room", f"{ground.radius:g} m", f"{reach:g} m for {probe.name}")
    wall = ground.radius if ground.walled else np.inf
    clear = _clear(poses, wall, ground.body_radius)
    return Flight(probe=probe, poses=poses, commands=commands, clear=clear)


def _clear(poses: FloatArray, wall: float, body: float) -> npt.NDArray[np.bool_]:
    """(steps, robots) where nothing but floor and wheels has a part in the motion."""
    steps, robots = poses.shape[:2]
    nearest = np.full((steps, robots), np.inf)
    for k in range(robots):
        away = np.hypot(*(poses[:, :, :2] - poses[:, k : k + 1, :2]).transpose(2, 0, 1))
        away[:, k] = np.inf
        nearest[:, k] = away.min(axis=1, initial=np.inf)
    reach = wall - body - NEAR_WALL
    alone = nearest > 2.0 * body + NEAR_ROBOT
    return np.asarray(alone & (np.hypot(poses[..., 0], poses[..., 1]) < reach))


def distance(errors: FloatArray, columns: FloatArray, covariance: FloatArray) -> float:
    """Standard deviations between two predictions once the second may follow the first.

    Args:
        errors: (n,) of the second about the first, in noise.
        columns: (n, p) their change with the second's coordinates.
        covariance: (p, p) of those coordinates, as the log leaves them; infinite where it does not
            tell.
    """
    square = float(errors @ errors)
    if columns.shape[1]:
        pull = columns.T @ errors
        told = np.isfinite(np.diag(covariance))
        inside = covariance[np.ix_(told, told)]
        known = np.zeros_like(covariance)
        known[np.ix_(told, told)] = np.linalg.inv(
            inside + 1e-12 * np.eye(len(inside)) * np.trace(inside)
        )
        square -= float(pull @ inverted(columns.T @ columns + known).step(pull))
    return float(np.sqrt(max(square, 0.0)))


def ranked(separations: Mapping[str, Sequence[float]]) -> tuple[Option, ...]:
    """The menu by the nearest rival's separation, best first."""
    options = [Option(name=name, separation=min(far)) for name, far in separations.items()]
    return tuple(sorted(options, key=lambda one: -one.separation))
