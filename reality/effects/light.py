"""The light sensors, and the lamps that they see."""

from __future__ import annotations

from realitygap.reality import constants as k
from realitygap.reality.effects.effect import (
    SENSOR,
    Key,
    Robots,
    Values,
    effect,
    number,
    scale,
    sensors,
)
from realitygap.reality.hardware import Hardware, Lamp, facing_counts


@effect(
    kind="light",
    physics="uniform background light on every sensor, as a share of what the lamp gives at 0.5 m",
    per_robot=False,
    level=Key(unit="share of the reading at 0.5 m", low=0.0, high=10.0, null=0.0),
)
def ambient_light(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A room brighter than when the tables were captured."""
    counts = facing_counts(0.5, hardware.lamp.power)
    hardware.light_ambient += number(values, "level") * counts


@effect(
    kind="light",
    physics="the lamp's power falls linearly with time",
    per_robot=False,
    rate=Key(unit="1/s", low=0.0, high=0.1, null=0.0),
)
def lamp_decay(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A lamp that dims."""
    hardware.lamp.decay = number(values, "rate")


@effect(
    kind="light",
    physics="the lamp is moved up or down",
    per_robot=False,
    height=Key(unit="m", low=0.0, high=5.0, null=k.LAMP_HEIGHT),
)
def lamp_height(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A lamp mounted higher or lower."""
    hardware.lamp.height = number(values, "height")


@effect(
    kind="light", physics="the lamp has another power", per_robot=False, scale=scale(0.0, 100.0)
)
def lamp_intensity(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A lamp brighter or dimmer than the one captured."""
    hardware.lamp.scale *= number(values, "scale")


@effect(
    kind="light",
    physics="the lamp is displaced from where the case has it",
    per_robot=False,
    x=Key(unit="m", low=-3.0, high=3.0, null=0.0, default=0.0),
    y=Key(unit="m", low=-3.0, high=3.0, null=0.0, default=0.0),
)
def lamp_moved(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A lamp that does not stand where it should."""
    hardware.lamp.x += number(values, "x")
    hardware.lamp.y += number(values, "y")


@effect(
    kind="light",
    physics="the field falls off with another power of distance, the same at 1 m",
    per_robot=False,
    exponent=Key(low=0.0, high=6.0, null=k.LIGHT_EXPONENT),
)
def light_falloff(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Light that does not fall off with the square of the distance."""
    hardware.lamp.exponent = number(values, "exponent")


@effect(
    kind="light",
    physics="the answer to light is full scale times (light / full scale)^exponent",
    exponent=Key(low=0.2, high=5.0, null=1.0),
)
def light_gamma(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Light sensors that do not answer linearly."""
    hardware.light_response[robots] = number(values, "exponent")


@effect(kind="light", physics="the sensor is covered and reads dark", sensor=SENSOR)
def ls_dead_sensor(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A light sensor that is covered."""
    hardware.light_gain[robots, sensors(values)] = 0.0


@effect(
    kind="light",
    physics="a second source at this place, lit in every case, as high as the lamp",
    per_robot=False,
    x=Key(unit="m", low=-3.0, high=3.0),
    y=Key(unit="m", low=-3.0, high=3.0),
    intensity=Key(unit="share of the lamp", low=0.0, high=100.0, null=0.0),
)
def second_lamp(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Another lamp, as a window in the room."""
    x, y, share = (number(values, key) for key in ("x", "y", "intensity"))
    hardware.windows.append(Lamp(x=x, y=y, power=hardware.lamp.power, scale=share))
