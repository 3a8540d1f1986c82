"""Whether a cause fits: it must be as strong in one part of a log as in another.

A cause that merely mimics something else is right only where the two agree. The change that a term
makes is cut in two by what the robot was doing (starting, fast or slow, turning or straight, early
or late) and both parts are fitted together with all other terms: a true cause has one strength.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit, Term
from realitygap.models.identify.residual import weights
from realitygap.models.identify.tracks import Tracks
from realitygap.models.information import inverted

Mask = npt.NDArray[np.bool_]

PARTS = {
    "start": "in the first second after a start",
    "speed": "in fast motion",
    "turning": "in sharp turns",
    "turn_side": "in turns to the left",
    "change": "after changes of command",
    "time": "late in the log",
    "run": "in the later runs",
    "heading x": "facing along x",
    "heading y": "facing along y",
    "heading axis": "facing along x or against it",
    "place x": "at larger x",
    "place y": "at larger y",
}
"""Parts of a log, in words."""
STARTING = 1.0
"""s after a start from rest: more than a small robot's motors need to reach a speed."""
DIFFERS = 0.5
"""Of a cause's strength: parts that differ by less agree as well as a point model can ask for."""
ERRORS = 5.0
"""Standard errors by which they must differ; our choice: a dozen parts of every term are compared,
and blocks of a second's windows are not quite independent."""
LEAST_BLOCKS = 6
"""Blocks that a part must have: fewer do not tell their own spread."""


class Misfit(NamedTuple):
    """Two parts of a log that ask for different strengths of one cause."""

    term: Term
    part: str
    """One of `PARTS`."""
    inside: float
    """Strength there; 1: as fitted to the whole log."""
    outside: float
    error: float
    """Standard error of the difference, by blocks."""
    channel: str
    """Of `models.identify.structure.CHANNELS`, the one that the term changes most."""

    @property
    def clear(self) -> bool:
        """Whether the two are neither chance nor what a rough model may do."""
        apart = abs(self.inside - self.outside)
        return apart > DIFFERS and apart > ERRORS * self.error


def misfit(problem: Problem, kept: Fit, term: Term) -> Misfit | None:
    """The part that most surely asks for another strength of a term; None: the term fits.

    Args:
        problem: With a single group.
        kept: The set fitted.
        term: One of it.
    """
    found = [one for one in strengths(problem, kept, term) if one.clear]
    return max(found, key=lambda m: abs(m.inside - m.outside) / m.error, default=None)


def strengths(problem: Problem, kept: Fit, term: Term) -> list[Misfit]:
    """A term's strength in every part of the log and in the rest of it."""
    column, others = leave_one(problem, kept, term)
    w = weights(kept.residual, problem.row_scale)
    window, block = problem.tracks.window, problem.tracks.block
    ahead, _, turn = (w * column**2).sum(axis=0)
    channel = "speed" if ahead > turn else "turn_rate"
    found = []
    for name, inside in parts(problem.tracks).items():
        if min(len(np.unique(block[inside])), len(np.unique(block[~inside]))) < LEAST_BLOCKS:
            continue
        mask = inside[window][:, None]
        both = np.dstack([np.where(mask, column, 0.0), np.where(mask, 0.0, column), others])
        step, covariance = solved(problem, both, kept.residual, w)
        error = float(np.sqrt(covariance[0, 0] + covariance[1, 1] - 2.0 * covariance[0, 1]))
        inner, outer = 1.0 + float(step[0]), 1.0 + float(step[1])
        found.append(Misfit(term, name, inner, outer, error, channel))
    return found


def leave_one(problem: Problem, kept: Fit, term: Term) -> tuple[FloatArray, FloatArray]:
    """What a term changes: (n, 3) the change of the errors that it makes, all of it, and
    (n, 3, p) how they change per unit of the other terms' coordinates.
    """
    at = kept.part(term)
    rest = tuple(t for t in kept.terms if t != term)
    fixed = np.delete(kept.coordinates, np.r_[at], axis=1)
    change = kept.residual - problem.residual(rest, fixed)
    jacobian = problem.jacobian(kept.terms, kept.coordinates, kept.residual)
    return change, np.delete(jacobian, np.r_[at], axis=2)


def parts(tracks: Tracks) -> dict[str, Mask]:
    """(windows,) which windows are in each part."""
    about = {name: tracks.about[:, k] for k, name in enumerate(tracks.columns)}
    count = np.diff(np.append(tracks.first, len(tracks.rows)))

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(np.nan_to_num(values)[tracks.rows], tracks.first) / count)

    def upper(values: FloatArray) -> Mask:
        seen = mean(values)
        return np.asarray(seen > np.median(seen))

    return {
        "start": mean((tracks.since_start <= STARTING).astype(np.float64)) > 0.5,
        "speed": upper(np.abs(about["speed"])),
        "turning": upper(np.abs(about["turn"])),
        "turn_side": mean(about["turn"]) > 0.0,
        "change": upper(about["change"]),
        "time": upper(about["time"]),
        "run": upper(tracks.row_segment.astype(np.float64)),
        "heading x": mean(np.cos(about["heading"])) > 0.0,
        "heading y": mean(np.sin(about["heading"])) > 0.0,
        "heading axis": mean(np.cos(2.0 * about["heading"])) > 0.0,
        "place x": upper(about["x"]),
        "place y": upper(about["y"]),
    }


def solved(
    problem: Problem, columns: FloatArray, errors: FloatArray, w: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(p,) step of weighted least squares that takes the errors off, and its covariance.

    The covariance is by blocks, never less than white noise leaves, and infinite where the log does
    not tell.
    """
    first, block = problem.tracks.first, problem.tracks.block
    p = columns.shape[2]
    weighted = columns * w[:, :, None]
    slope = np.add.reduceat(np.einsum("ncp,nc->np", weighted, errors), first)
    bend = np.einsum("ncp,ncq->npq", weighted, columns).reshape(len(w), p * p)
    bends = np.add.reduceat(bend, first).reshape(-1, p, p)
    inverse = inverted(bends.sum(axis=0))
    step = -inverse.step(slope.sum(axis=0))
    left = slope + bends @ step
    total = np.column_stack([np.bincount(block, left[:, k]) for k in range(p)]).astype(np.float64)
    return step, inverse.sandwich(total.T @ total)
