"""The values of named causes in the senses that one part of a log gives by itself."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.held_out import PARTS
from realitygap.models.identify.fitted import Key
from realitygap.models.identify.value import Value
from realitygap.models.senses import nest
from realitygap.models.senses.direct import noise_scale
from realitygap.models.senses.naming import fitted_named, nest_named, noise_named
from realitygap.models.senses.nest import Answers, NestFound
from realitygap.models.senses.problem import Fit, Problem, Term
from realitygap.models.senses.reference import SenseReference
from realitygap.models.senses.select import Found
from realitygap.models.senses.sight import Rows, Sight

Part = dict[Key, tuple[Value, ...]]


def of_fit(
    problem: Problem,
    fit: Fit,
    found: Sequence[tuple[Term, Found]],
    healthy: SenseReference,
) -> tuple[Part, ...]:
    """Of fitted terms, each fit begun at the whole log's.

    Args:
        problem: Of the whole log.
        fit: With every term.
        found: The terms in the fit, and as what they are named.
        healthy: What healthy robots get for them.
    """
    values: list[Part] = []
    for part in range(PARTS):
        some = copy.copy(problem)
        some.use = problem.use & (problem.sight.part == part)[:, None]
        at = some.fit(fit.terms, fit.coordinates)
        names = [
            replace(one, coordinates=at.coordinates[fit.part(term)])
            for term, one in found
            if some.use[problem.rows(term)].any()
        ]
        told = fitted_named(names, problem.sight.robots, healthy)
        values.append({one.key: one.values for one in told})
    return tuple(values)


def of_nest(
    seen: Answers | None, part: Rows, at: tuple[float, float, float], found: Sequence[NestFound]
) -> tuple[Part, ...]:
    """Of the nest.

    Args:
        seen: The log's answers.
        part: (answers,) part of the log of each.
        at: The nest as believed.
        found: What was named, of the swarm first.
    """
    values: list[Part] = []
    for k in range(PARTS):
        told: list[NestFound] = []
        shared = np.zeros(3)
        for robots in dict.fromkeys(one.robots for one in found):
            mine = [one for one in found if one.robots == robots]
            assert seen is not None
            some = nest.only(seen, np.isin(seen.robot, robots) & (part == k))
            if not len(some.rows):
                continue
            free = tuple(c for one in mine for c in nest.CAUSES[one.name])
            change = nest.fitted(nest.near_edge(some, at), at, shared, free) - shared
            told += [one._replace(coordinates=change[list(nest.CAUSES[one.name])]) for one in mine]
            if len(robots) > 1:
                shared = shared + change
        values.append({one.key: one.values for one in nest_named(told)})
    return tuple(values)


def of_noise(problem: Problem, expected: FloatArray, healthy: SenseReference) -> FloatArray:
    """(parts, robots) logarithm of the infrared noise's scale over the healthy one; NaN: unknown.

    Args:
        problem: With what is named but the noise.
        expected: (rows, 16) counts of a healthy robot.
        healthy: What healthy robots show.
    """
    residual = problem.residual((), np.zeros(0))
    found = []
    for part in range(PARTS):
        use = problem.use & (problem.sight.part == part)[:, None]
        found.append(noise_scale(problem.sight, residual, expected, use).value)
    level = np.nan if healthy.noise is None else healthy.noise.mean
    return np.array(found) - level


def noise_values(
    scales: FloatArray, noisy: Sequence[tuple[float, float, bool]], sight: Sight
) -> tuple[Part, ...]:
    """The same as values of those whose noise is named."""
    values: list[Part] = []
    for row in scales:
        told = [
            (float(u) if known[0] != 0.0 and np.isfinite(u) else 0.0, *known[1:])
            for u, known in zip(row, noisy, strict=True)
        ]
        values.append({one.key: one.values for one in noise_named(told, sight.robots)})
    return tuple(values)
