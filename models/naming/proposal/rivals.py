"""Rivals with the values that the log gives them, as a model file has causes."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.extension import NamedCause, ParameterValue
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.findings import Named


def rivals_of(
    named: Named, fitted: Iterable[tuple[Term, FloatArray]], healthy: Motion | None = None
) -> tuple[NamedCause, ...]:
    """The named cause and its rivals; empty if one cannot be written into a model.

    Args:
        named: The cause.
        fitted: Each rival with its coordinates (p,).
        healthy: Motion that shares, as of torque, are told against.
    """
    found = [written(named, named.values)]
    for term, coordinates in fitted:
        cause = term.cause
        values = cause.values(coordinates)
        given = np.empty(0)
        if cause.told_against is not None:
            given = np.empty(0) if healthy is None else cause.told_against(healthy)
        values = np.concatenate([values, given])
        parameters = (*cause.parameters, *cause.given)
        if len(values) != len(parameters) or not np.isfinite(values).all():
            return ()
        found.append(
            NamedCause(
                name=cause.name,
                robots="all" if named.whole_swarm else named.robots,
                word=term.variant,
                parameters={
                    p.name: ParameterValue(value=float(value), unit=p.unit)
                    for p, value in zip(parameters, values, strict=True)
                },
            )
        )
    return tuple(found)
