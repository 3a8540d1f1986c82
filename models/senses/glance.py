"""What every term promises beyond a hypothesis: one linear step each, judged on held-out blocks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes.withheld import withheld
from realitygap.models.information import inverted
from realitygap.models.senses.causes import sense_causes
from realitygap.models.senses.problem import (
    STRETCH,
    SWARM,
    Column,
    Fit,
    Problem,
    Term,
    spanned,
)

FITTED = ("ps", "ls", "both")
NO_COMMANDS: FloatArray = np.zeros((0, 2))


class Promise(NamedTuple):
    """One term beyond a hypothesis."""

    term: Term
    gain: float
    """Held-out deviance that one linear step takes off."""
    coordinates: FloatArray
    """(p,) of the term alone, after that step."""
    start: FloatArray
    """(p0 + p,) of the whole hypothesis with the term, after that step."""
    error: FloatArray
    """(p,) standard errors of the coordinates, by blocks."""


def promises(
    problem: Problem,
    kept: Fit,
    *,
    swarm: bool = True,
    private: bool = True,
    wanted: Term | None = None,
) -> list[Promise]:
    """Every term's promise for the swarm and for each robot, best first; or that of one alone."""
    found: list[Promise] = []
    for cause in sense_causes().values():
        if cause.kind not in FITTED or withheld(cause.name):
            continue
        if not _visible(problem, cause.kind) or (wanted and wanted.cause.name != cause.name):
            continue
        taken = {(t.cause.name, t.robot) for t in kept.terms}
        for variant in cause.variants:
            if wanted and wanted.variant != variant:
                continue
            term = Term(cause, variant)
            starts = cause.starts(NO_COMMANDS) or [np.zeros(term.size)]
            best: dict[int, Promise] = {}
            for start in starts:
                columns, pulled = _columns(problem, kept, term, start)
                scopes = [SWARM] if swarm else []
                if private and not cause.place:
                    scopes += range(len(problem.sight.robots))
                for robot in scopes if wanted is None else [wanted.robot]:
                    if (cause.name, robot) in taken and len(cause.variants) == 1:
                        continue
                    mine = term._replace(robot=robot)
                    if mine in kept.terms or not any(
                        c.values[problem.rows(mine)].any() for c in columns
                    ):
                        continue
                    one = _step(problem, kept, mine, pulled, columns)
                    if robot not in best or one.gain > best[robot].gain:
                        best[robot] = one
            found += best.values()
    return sorted(found, key=lambda one: -one.gain)


def _visible(problem: Problem, kind: str) -> bool:
    half = problem.use.shape[1] // 2
    ps, ls = problem.use[:, :half].any(), problem.use[:, half:].any()
    return bool({"ps": ps, "ls": ls, "both": ps or ls}[kind])


def _columns(
    problem: Problem, kept: Fit, term: Term, start: FloatArray
) -> tuple[list[Column], FloatArray]:
    """Changes of the errors with the term's coordinates, and the coordinates they start from.

    A second lamp cannot be moved while it is dark: it is lit a little to see what it would do, and
    its brightness alone is what a first step changes.
    """
    whole = (*kept.terms, term)
    null = np.concatenate([kept.coordinates, np.zeros(term.size)])
    if not start.any():
        return problem.columns(whole, null, kept.residual, len(kept.terms)), start
    lit = np.concatenate([kept.coordinates, start])
    last = term.cause.parameters[-1]
    change = (problem.residual(whole, lit) - kept.residual) / start[-1]
    dark = start.copy()
    dark[-1] = last.coordinate(last.null)
    return [Column(slice(0, None), change)], dark


def _step(
    problem: Problem, kept: Fit, term: Term, start: FloatArray, columns: list[Column]
) -> Promise:
    """One linear step of the kept terms and this one together, for one robot or all."""
    rows = problem.rows(term)
    mine = [Column(rows, c.values[rows]) for c in columns]
    together = [*kept.columns, *mine]
    slope, bend = problem.normal(kept.residual, together)
    inverse = inverted(bend.sum(axis=0))
    step = -inverse.step(slope.sum(axis=0))
    centred = slope - slope.mean(axis=0)
    error = np.sqrt(np.diag(inverse.sandwich(centred.T @ centred)))
    span = spanned(together, len(kept.residual))
    moved = problem.moved(kept.residual, together, problem.left_out(slope, bend), span)
    touched = np.bincount(problem.sight.block[span], minlength=problem.blocks) > 0
    won = np.where(touched, kept.held_out - problem.deviance(moved, span), 0.0)
    own = step[len(kept.columns) :]
    coordinates = start.copy()
    coordinates[len(start) - len(own) :] += STRETCH * own
    last = term.cause.parameters[-1]
    possible = not start.any() or last.bounds[0] < coordinates[-1] < last.bounds[1]
    gain = float(won.sum()) if possible else -np.inf
    wide = np.zeros(len(start))
    wide[len(start) - len(own) :] = STRETCH * error[len(kept.columns) :]
    begun = np.concatenate([kept.coordinates + step[: len(kept.columns)], coordinates])
    return Promise(term, gain, coordinates, begun, wide)
