"""How far apart rivals are in every manoeuvre of the menu, and which of them to choose.

A *separation* is the distance between what two rivals predict for a manoeuvre of two minutes, in
standard deviations of the noise that the log shows, after the second has been allowed to move its
parameters as far as the log leaves them open. Its square is what the wrong rival will lose in
deviance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import CONTROL_STEP, InputError, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.pilot import fly
from realitygap.embedded_sim.probes import MENU, Probe
from realitygap.models.belief.extension import NamedCause
from realitygap.models.gap.conditions import NEAR_ROBOT, NEAR_WALL
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


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """The manoeuvre to perform, for one ambiguous cause."""

    separates: tuple[str, ...]
    """The named cause first, then its rivals."""
    options: tuple[Option, ...]
    """The menu, best first."""
    needs: tuple[str, ...] = ()
    """Columns that must be logged and were not."""
    rivals: tuple[NamedCause, ...] = ()
    """What is to be told apart, as fitted to the log, the named cause first."""

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
