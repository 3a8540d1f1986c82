"""Constants of the hand-coded behaviours (paper, III-F), on the robot and in its simulator."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

from realitygap.embedded_sim._core import lib
from realitygap.embedded_sim.binding import check, refusal, structure
from realitygap.embedded_sim.model import CONTROL_STEP, SENSOR_ANGLES


@dataclass(frozen=True, kw_only=True)
class Behaviour:
    """What avoidance, search and phototaxis are made of. The paper prints no values: all ours."""

    cruise_speed: float = 6.0
    """rad/s of the faster wheel: 12.3 cm/s, just under the e-puck's 6.28 rad/s."""
    avoid_threshold: tuple[float, ...] = (200.0, 60.0, *[math.inf] * 4, 60.0, 200.0)
    """counts: an obstacle about 30 mm before the front pair, 18 mm before the side-front pair; with
    the side and back sensors a robot in a crowd would never be free to go."""
    avoid_speed: float = 4.0
    """rad/s of each wheel, opposed: a spin of about 3.1 rad/s."""
    avoid_duration: float = 0.5
    """s: a robot that does not commit to its turn jams among others."""
    avoid_memory: float = 0.5
    """s after a turn in which the next one goes the same way."""
    search_curvature: float = 1.0
    """In the tightest search turn the inner wheel stands still: slow commands show dead zones."""
    search_duration: tuple[float, float] = (0.4, 2.0)
    """s of one curvature."""
    light_contrast: float = 40.0
    """counts: five times the noise of one light sensor."""
    light_gain: float = 1.2
    """share of slowing per rad of bearing error."""
    light_search: float = 0.5
    """share of search's curvature kept while following light: search is always active."""

    @cached_property
    def struct(self) -> Any:
        """The C struct `rg_behaviour`.

        Raises:
            InputError: a field that C refuses.
        """
        values = {name: getattr(self, name) for name in self.__dataclass_fields__}
        values["sensor_cos"] = [math.cos(a) for a in SENSOR_ANGLES]
        values["sensor_sin"] = [math.sin(a) for a in SENSOR_ANGLES]
        values["control_step"] = CONTROL_STEP
        struct, why = structure("rg_behaviour *", "behaviour", values, _SEVERAL), refusal()
        check(lib.rg_check_behaviour(struct, why), why)
        return struct


_SEVERAL = {
    field.name: len(field.default)
    for field in fields(Behaviour)
    if isinstance(field.default, tuple)
}
