"""A named cause with its values, as a model file has it; values at a bound, which none may have."""

from __future__ import annotations

import math
from collections.abc import Sequence

from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.extension import NamedCause, ParameterValue
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.findings import Named

AT = 1e-6
"""Of a parameter's range, within which a value is at its bound. No rule: rounding."""


def written(named: Named, values: Sequence[Value]) -> NamedCause:
    """A name as an extension's cause.

    Args:
        named: Of whom and what.
        values: Its own, or those of a part of the log.
    """
    cause = named.term.cause
    return NamedCause(
        name=cause.name,
        robots="all" if named.whole_swarm else named.robots,
        word=named.term.variant,
        parameters={
            p.name: ParameterValue(value=v.value, low=v.low, high=v.high, unit=p.unit)
            for p, v in zip((*cause.parameters, *cause.given), (*values, *named.given), strict=True)
        },
    )


def at_bound(named: Named) -> tuple[Parameter, float] | None:
    """A parameter whose value, or whose fitted coordinate, ends at a bound, and that bound.

    The null is no bound in this sense: there is nothing beyond it to be missed.
    """
    coordinates = named.evidence.coordinates
    for k, (p, v) in enumerate(zip(named.term.cause.parameters, named.values, strict=False)):
        seen = [v.value]
        if named.evidence.term == named.term and k < len(coordinates):
            seen.append(p.value(float(coordinates[k])))
        for bound in (p.low, p.high):
            if bound == p.null or not math.isfinite(bound):
                continue
            near = AT * max(abs(bound), abs(p.zero - bound))
            if any(s <= bound + near if bound == p.low else s >= bound - near for s in seen):
                return p, bound
    return None
