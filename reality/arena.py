"""The arena: where its wall, its nest and its lamps are, and how much food lies in it.

The nominal one is the paper's. A larger one has the same food on a square metre, and its nest and
lamps stand to its wall as they do there.
"""

from __future__ import annotations

from dataclasses import dataclass

from realitygap.reality import constants as k


@dataclass(frozen=True)
class ForagingArena:
    """A circle about the origin."""

    radius: float = k.ARENA_RADIUS
    """m, to the middles of the wall's facets."""

    @property
    def wider(self) -> float:
        """m beyond the nominal radius."""
        return self.radius - k.ARENA_RADIUS

    @property
    def nest(self) -> tuple[float, float, float]:
        """m: x, y, radius; on +x."""
        x, y, radius = k.NEST
        return x + self.wider, y, radius

    @property
    def lamps(self) -> tuple[tuple[float, float] | None, ...]:
        """m: where the lamp stands for each of `embedded_sim.SCENARIOS`."""
        out = k.LAMP_RADIUS + self.wider
        return (-out, 0.0), None, (out, 0.0)

    @property
    def food_items(self) -> int:
        """As many on a square metre as in the nominal arena."""
        return round(k.FOOD_ITEMS * (self.radius / k.ARENA_RADIUS) ** 2)
