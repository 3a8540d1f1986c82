"""What robots believe of a wider arena: what a lab would have measured there."""

from __future__ import annotations

import math
from dataclasses import replace

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim._core import lib
from realitygap.reality.arena import ForagingArena


def widened(model: PointModel, arena: ForagingArena) -> PointModel:
    """A model of the nominal arena as one of a wider one: nest and lamps move out with the wall.

    What else it believes of them stays. Food is as dense, up to what a foraging state can hold.
    """
    if not arena.wider:
        return model
    x, y, radius = model.nest
    first, second, third = (lamp and _outwards(lamp, arena.wider) for lamp in model.lamps)
    dense = model.food_items * (arena.radius / (arena.radius - arena.wider)) ** 2
    return replace(
        model,
        arena_radius=model.arena_radius + arena.wider,
        nest=(*_outwards((x, y), arena.wider), radius),
        lamps=(first, second, third),
        food_items=min(round(dense), lib.RG_FOOD_MAX),
    )


def _outwards(place: tuple[float, float], more: float) -> tuple[float, float]:
    """A place (m) so much (m) further from the origin."""
    far = math.hypot(*place)
    return place[0] * (1.0 + more / far), place[1] * (1.0 + more / far)
