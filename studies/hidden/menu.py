"""What the battery hides: every effect with a size, and how a size becomes the values of a SPEC.

A size is how far from nominal an effect is, positive, in the unit of its entry. `bar` is the size
that a diagnosis of 120 s must name when one robot of ten has the effect; sizes are drawn around it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from realitygap.embedded_sim import SENSORS
from realitygap.reality import constants as k

Value = float | str
Values = Callable[[float, np.random.Generator], Mapping[str, Value]]

DECAY_SECONDS = 120.0
"""s that droop and decay are stated over."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One effect as the battery hides it."""

    unit: str
    """Of a size."""
    bar: float
    """Size; 0: the effect has no size, as a dead sensor."""
    values: Values
    """(size, random) -> keys of the SPEC."""
    follows: str
    """Measured quantities that it follows without a name, by its physics, any of which is right: as
    `quantity` in `diagnosis.json`. Written down before any of it was tried."""
    swarm_bar: float = 0.0
    """Size that must be named when the whole swarm has it; 0: the swarm never has it in a trial."""
    largest: float = math.inf
    """Size."""
    lit: bool = False
    """Only shows where a lamp is lit."""

    def drawn(self, size: float, random: np.random.Generator) -> dict[str, Value]:
        """Values of that size, as JSON has them."""
        values = self.values(size, random).items()
        return {k: float(v) if isinstance(v, int | float) else str(v) for k, v in values}


def _sign(random: np.random.Generator) -> float:
    return float(random.choice((-1.0, 1.0)))


def _around(key: str, nominal: float) -> Values:
    """More or less than nominal by a share."""
    return lambda size, random: {key: nominal * (1.0 + _sign(random) * size)}


def _less(key: str, nominal: float) -> Values:
    """Nominal over 1 + size."""
    return lambda size, random: {key: nominal / (1.0 + size)}


def _plain(key: str, per: float = 1.0) -> Values:
    return lambda size, random: {key: size / per}


def _signed(key: str) -> Values:
    return lambda size, random: {key: _sign(random) * size}


def _displaced(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    """So far away, in any direction."""
    angle = random.uniform(-math.pi, math.pi)
    return {"x": size * math.cos(angle), "y": size * math.sin(angle)}


def _wheel(random: np.random.Generator) -> str:
    return str(random.choice(("left", "right", "both")))


def _one_sensor(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    return {"sensor": str(random.integers(SENSORS))}


def _gain(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    """Half the time of all sensors, half of one in front, which sees most."""
    sensor = (
        "all" if random.random() < 0.5 else str(random.choice((0, 1, SENSORS - 2, SENSORS - 1)))
    )
    return {"scale": 1.0 + _sign(random) * size, "sensor": sensor}


def _tilt(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    return {"slope": size, "direction": random.uniform(-math.pi, math.pi)}


def _window(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    """A lamp of that share just outside the arena."""
    angle = random.uniform(-math.pi, math.pi)
    reach = k.ARENA_RADIUS + 0.1
    return {"x": reach * math.cos(angle), "y": reach * math.sin(angle), "intensity": size}


def _limit(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    return {**_turn_first(size, random), "wheel": _wheel(random)}


def _turn_first(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    return {"limit": k.WHEEL_SPEED_MAX * (1.0 - size)}


def _threshold(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    return {"threshold": k.WHEEL_SPEED_MAX * size, "wheel": _wheel(random)}


DEGREE = math.radians(1.0)
SHARE = "share"

MENU: Mapping[str, Entry] = {
    # motion: a constant fault of geometry grows with how fast the robot drives or turns
    "wheel_radius_mismatch": Entry(
        unit=SHARE, follows="always speed", bar=0.01, swarm_bar=0.0025, values=_around("ratio", 1.0)
    ),
    "wheel_radius_scale": Entry(
        unit=SHARE, follows="always speed", bar=0.01, swarm_bar=0.0025, values=_around("scale", 1.0)
    ),
    "wheel_separation": Entry(
        unit=SHARE,
        follows="always turning",
        bar=0.01,
        swarm_bar=0.005,
        values=_around("scale", 1.0),
    ),
    "command_latency": Entry(
        unit="s", follows="change", bar=0.040, swarm_bar=0.008, values=_plain("seconds")
    ),
    "start_delay": Entry(
        unit="s", follows="change start turn_side turning", bar=0.1, values=_plain("seconds")
    ),
    "motor_lag": Entry(unit="s", follows="change", bar=0.025, values=_plain("time_constant")),
    "weak_motor": Entry(
        unit="nominal over torque, less 1",
        follows="change",
        bar=1.0,
        values=_less("torque", k.MOTOR_TORQUE),
    ),
    "low_friction": Entry(
        unit="nominal over friction, less 1",
        follows="change",
        bar=5.0,
        values=_less("friction", k.WHEEL_FRICTION),
    ),
    "motor_saturation": Entry(
        unit="share of full speed",
        follows="speed speed_squared turning",
        bar=0.1,
        largest=0.9,
        values=_limit,
    ),
    "turn_first": Entry(
        unit="share of full speed",
        follows="speed speed_squared turning",
        bar=0.1,
        largest=0.9,
        values=_turn_first,
    ),
    "motor_dead_zone": Entry(
        unit="share of full speed", follows="speed turning", bar=0.1, values=_threshold
    ),
    "speed_droop": Entry(
        unit="share in 120 s", follows="time", bar=0.02, values=_plain("rate", DECAY_SECONDS)
    ),
    "tracker_yaw_offset": Entry(
        unit="rad", follows="always speed", bar=DEGREE, values=_signed("angle")
    ),
    "tracker_offset": Entry(unit="m", follows="turning", bar=0.001, values=_displaced),
    "clock_offset": Entry(unit="s", follows="change", bar=0.016, values=_plain("seconds")),
    "floor_tilt": Entry(
        unit="rad", follows="heading", bar=2.0 * DEGREE, largest=0.35, values=_tilt
    ),
    # infrared: all readings of a sensor, or of what it looks at
    "ir_gain": Entry(unit=SHARE, follows="always level sensor", bar=0.1, largest=0.9, values=_gain),
    "wall_albedo": Entry(
        unit=SHARE, follows="always level", bar=0.1, largest=0.9, values=_around("scale", 1.0)
    ),
    "ir_dead_sensor": Entry(unit="", follows="sensor", bar=0.0, values=_one_sensor),
    "ir_rotation": Entry(unit="rad", follows="bearing", bar=2.0 * DEGREE, values=_signed("angle")),
    "ir_offset": Entry(unit="counts", follows="always", bar=5.0, values=_plain("counts")),
    "ir_noise": Entry(
        unit=SHARE, follows="noise", bar=0.5, values=lambda size, random: {"scale": 1.0 + size}
    ),
    # light: what falls with distance is also smaller where little is read
    "lamp_intensity": Entry(
        unit=SHARE, follows="always level", bar=0.03, lit=True, values=_around("scale", 1.0)
    ),
    "lamp_height": Entry(
        unit=SHARE,
        follows="distance level",
        bar=0.02,
        lit=True,
        values=_around("height", k.LAMP_HEIGHT),
    ),
    "light_falloff": Entry(
        unit=SHARE,
        follows="distance level",
        bar=0.02,
        lit=True,
        values=_around("exponent", k.LIGHT_EXPONENT),
    ),
    "lamp_moved": Entry(
        unit="m", follows="bearing place point", bar=0.010, lit=True, values=_displaced
    ),
    "ambient_light": Entry(
        unit="share of the reading at 0.5 m",
        follows="always level",
        bar=0.01,
        values=_plain("level"),
    ),
    "second_lamp": Entry(
        unit="share of the lamp", follows="heading place point", bar=0.05, values=_window
    ),
    "lamp_decay": Entry(
        unit="share in 120 s",
        follows="time",
        bar=0.05,
        lit=True,
        values=_plain("rate", DECAY_SECONDS),
    ),
    "light_gamma": Entry(
        unit=SHARE,
        follows="always level distance",
        bar=0.05,
        lit=True,
        values=_around("exponent", 1.0),
    ),
    "ls_dead_sensor": Entry(unit="", follows="sensor", bar=0.0, values=_one_sensor),
    # task
    "nest_moved": Entry(unit="m", follows="bearing", bar=0.010, swarm_bar=0.010, values=_displaced),
    "nest_radius": Entry(
        unit=SHARE,
        follows="distance",
        bar=0.03,
        swarm_bar=0.03,
        largest=0.9,
        values=_around("scale", 1.0),
    ),
}
"""By name of the effect."""


def _swing(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    return {"share": size, "period": random.uniform(5.0, 40.0)}


def _sunlight(size: float, random: np.random.Generator) -> Mapping[str, Value]:
    return {"counts": size, "direction": random.uniform(-math.pi, math.pi)}


STRANGE: Mapping[str, Entry] = {
    "eccentric_wheel": Entry(
        unit=SHARE,
        follows="left_wheel_angle right_wheel_angle",
        bar=0.05,
        values=lambda size, random: {"share": size, "wheel": _wheel(random)},
    ),
    "carpet": Entry(unit=SHARE, follows="place", bar=0.02, values=_plain("share")),
    "shy_robots": Entry(unit=SHARE, follows="neighbour", bar=0.05, values=_plain("share")),
    "speed_loss": Entry(
        unit="share at full speed",
        follows="speed speed_squared wheel_speed",
        bar=0.02,
        values=_plain("share"),
    ),
    "lens": Entry(
        unit="share at the wall", follows="place radius radial", bar=0.01, values=_plain("share")
    ),
    "low_sun": Entry(unit="counts", follows="heading", bar=20.0, values=_sunlight),
    "flicker": Entry(unit=SHARE, follows="time", bar=0.1, lit=True, values=_swing),
}
"""What no catalogue lists; see `unlisted`. A bar is about 1 mm/s or 5 % of a sensor."""
