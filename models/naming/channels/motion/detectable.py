"""What this very log would have shown: per cause and robot, the size from which it is seen.

Of sizes in a fit's coordinates (`engine.seen`) those in the units of a cause's parameters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes, withheld
from realitygap.models.belief.cause import Cause
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.rules import Rules


class Seen(NamedTuple):
    """From which size on one cause would have been seen."""

    cause: Cause
    size: FloatArray
    """(robots,) departure of its first parameter from the null, in its unit; of a limit (infinite
    null) its value, below which it is seen. NaN where it could not have been seen."""


def detectable(least: Mapping[str, FloatArray], motions: Sequence[Motion]) -> list[Seen]:
    """Every cause of motion that can be named, by name.

    Args:
        least: (robots, p) by key of a term, coordinates from which it is seen.
        motions: (robots,) what each is believed to do; a cause is looked for beyond it.
    """
    by_name: dict[str, list[FloatArray]] = {}
    for key, found in least.items():
        by_name.setdefault(key.partition("/")[0], []).append(found.T)
    seen = []
    for name, cause in causes().items():
        if not cause.identifiable or withheld(name):
            continue
        own = by_name.get(name)
        stands = next((t for t in cause.twins if t in by_name), None)
        if own is not None:
            sizes = [_worst(cause, found) for found in own]
            size = (
                np.max(sizes, axis=0)
                if np.isfinite(cause.parameters[0].null)
                else np.min(sizes, axis=0)
            )
        elif stands is not None:
            size = _of_twin(cause, causes()[stands], by_name[stands][0], motions)
        else:
            size = np.full(len(motions), np.nan)
        seen.append(Seen(cause, size))
    return seen


def core(rules: Rules) -> dict[str, float]:
    """Sizes (1, 1, 1, s) of the causes that every robot on two wheels can have, from which on they
    must show before a robot is called sound."""
    wheels = ("wheel_radius_scale", "wheel_radius_mismatch", "wheel_separation")
    return {**dict.fromkeys(wheels, rules.core_share), "command_latency": rules.core_late}


def untold(seen: Sequence[Seen], robots: Sequence[int], rules: Rules) -> dict[int, tuple[str, ...]]:
    """By robot that cannot be called sound, the core causes that it could have unseen."""
    least = core(rules)
    missed: dict[int, tuple[str, ...]] = {}
    for one in seen:
        if one.cause.name in least:
            unseen = ~(one.size <= least[one.cause.name])
            for k in np.flatnonzero(unseen).tolist():
                missed[robots[k]] = (*missed.get(robots[k], ()), one.cause.name)
    return missed


def _worst(cause: Cause, coordinates: FloatArray) -> FloatArray:
    """(robots,) sizes of a cause out of (p, robots) coordinates: of its parameters the worst."""
    sizes = []
    for p, found in zip(cause.parameters, coordinates, strict=True):
        if not np.isfinite(p.null):
            sizes.append(found)
            continue
        side = -1.0 if p.sign < 0 else 1.0
        low, high = p.bounds
        possible = np.isfinite(found) & (side * found >= low) & (side * found <= high)
        value = np.array(
            [p.value(side * u) if ok else np.nan for u, ok in zip(found, possible, strict=True)]
        )
        sizes.append(np.abs(value - p.null))
    return np.asarray(np.max(sizes, axis=0))


def _of_twin(
    cause: Cause, stands: Cause, coordinates: FloatArray, motions: Sequence[Motion]
) -> FloatArray:
    """(robots,) the same of a cause for which another stood in the search."""
    if cause.as_twin is None:
        return np.full(len(motions), np.nan)
    (p,), (of,) = cause.parameters, stands.parameters
    side = -1.0 if of.sign < 0 else 1.0
    found = []
    for motion, u in zip(motions, coordinates[0], strict=True):
        value = None
        if np.isfinite(u) and of.bounds[0] <= side * u <= of.bounds[1]:
            value = cause.as_twin(motion, stands.applied(motion, np.array([side * u])))
        found.append(np.nan if value is None else abs(value - p.null))
    return np.array(found)
