"""What this very log would have shown, and how far from health what follows something lies.

A cause of a size is counted as seen if with 95 % probability its gain passes the gate that a name
needs. Of causes whose effect grows otherwise than in proportion (limits, dead zones) the sizes
tried are those from which fits start.
"""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.engine.items import Mask
from realitygap.models.naming.engine.marginal import EMPTY
from realitygap.models.naming.engine.state import SWARM
from realitygap.models.naming.engine.weighed import Weighed


def least_seen(weighed: Weighed, gates: Gates, known: Mask) -> dict[str, FloatArray]:
    """(robots, p) by key of a term, coordinates from which on it would have been seen; NaN: none.

    Of a limit (infinite null) its value, below which it is seen.
    """
    need = np.sqrt(gates.cause) + weighed.state.rules.surely
    found: dict[str, FloatArray] = {}
    place = weighed.score(SWARM).information
    scopes = (SWARM, *range(len(weighed.state.robots)))
    kept = {scope: {one.item.key for one in weighed.state.of(scope)} for scope in scopes}
    for k in range(len(weighed.state.robots)):
        own = weighed.score(k).information
        for item in weighed.state.items:
            if item.term is None or not known[list(item.columns)].all():
                continue
            told = place if item.term.cause.place else own
            cause = item.term.cause
            if not cause.parameters:
                continue
            shape = (len(weighed.state.robots), len(cause.parameters))
            size = found.setdefault(item.term.key, np.full(shape, np.nan))
            known_of = np.diag(told)[list(item.columns)]
            scope = SWARM if cause.place else k
            if item.key in kept[scope]:
                known_of = np.diag(weighed.information_of(scope, item))
            sure = np.sqrt(np.maximum(known_of, EMPTY))
            if item.dose is None:
                size[k] = np.fmin(size[k], need / sure)
            elif sure[0] >= need:
                dose = np.array(item.dose)
                limit = not np.isfinite(cause.parameters[0].null)
                size[k] = np.fmax(size[k], dose) if limit else np.fmin(size[k], np.abs(dose))
    return found


def away(weighed: Weighed) -> dict[str, FloatArray]:
    """(robots,) by channel and quantity, distance from health of what follows it."""
    found: dict[str, FloatArray] = {}
    items = [item for item in weighed.state.items if item.term is None]
    for k in range(len(weighed.state.robots)):
        score = weighed.with_flexible(k)
        for item in items:
            at = list(item.columns)
            own, pull = score.information[np.ix_(at, at)], score.slope[at]
            far = found.setdefault(item.key, np.zeros(len(weighed.state.robots)))
            far[k] = np.sqrt(max(float(pull @ np.linalg.lstsq(own, pull, rcond=None)[0]), 0.0))
    return found


def scores(weighed: Weighed) -> dict[str, FloatArray]:
    """(robots,) by name of a cause's coefficient, signed standard deviations from health."""
    names = weighed.state.robots[0].names
    found = {name: np.zeros(len(weighed.state.robots)) for name in names if "." in name}
    for k in range(len(weighed.state.robots)):
        told = weighed.score(k)
        size = np.sqrt(np.maximum(np.diag(told.information), EMPTY))
        for column, name in enumerate(names):
            if name in found:
                found[name][k] = told.slope[column] / size[column]
    return found
