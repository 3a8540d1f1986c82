"""Motors that do not turn as they are told to."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter, sides
from realitygap.models.belief.motion import Motion
from realitygap.models.log.schema import ENCODERS


def _motor_gain(motion: Motion, values: FloatArray, variant: str) -> Motion:
    gain = tuple(values.tolist())
    radius, turned = motion.drive.wheel_radius, motion.wheel_gain
    return replace(
        motion,
        drive=replace(motion.drive, wheel_radius=(radius[0] * gain[0], radius[1] * gain[1])),
        wheel_gain=(turned[0] * gain[0], turned[1] * gain[1]),
    )


MOTOR_GAIN = Cause(
    name="motor_gain",
    meaning="the wheels turn at another speed than they are told to, in proportion",
    plain="{Whose} left wheel turns at {left:%} of the speed that it is told, the right at "
    "{right:%}. Calibrate the motors' controller.",
    parameters=tuple(
        Parameter(name=side, unit="1", null=1.0, low=0.2, high=3.0, step=1e-3, link="factor")
        for side in ("left", "right")
    ),
    change=_motor_gain,
    columns=ENCODERS,
    where="unmeasured",
    confusable_with=("wheel_radius_scale", "wheel_radius_mismatch"),
    experiment="straights",
)


SCANNED = 14
"""Thresholds tried: between neighbouring commanded speeds, evenly by how often they occur."""
SEEN = 0.01
"""Share of a log's commands that must be slower than a dead zone for it to show: a second or two of
each wheel in two minutes. In less, one bad start of a motor looks like a dead zone."""
SLOW = 0.6
"""Of the fastest command: a wheel that needs more to turn at all is another fault."""


def _motor_dead_zone(motion: Motion, values: FloatArray, variant: str) -> Motion:
    threshold = float(values[0])
    affected = sides(variant)
    pair = motion.drive.dead_zone
    left, right = (max(p, threshold) if a else p for p, a in zip(pair, affected, strict=True))
    return motion.driving(dead_zone=(left, right))


def _motor_dead_zone_starts(commands: FloatArray) -> list[FloatArray]:
    speed = np.sort(np.abs(commands).ravel())
    speed = speed[speed > 0.0]
    slow = speed[(speed >= least_seen(commands)) & (speed < SLOW * speed.max(initial=0.0))]
    if not len(slow):
        return []
    # finer towards the slowest: a dead zone is small
    levels = np.quantile(slow, np.linspace(0.0, 1.0, SCANNED) ** 2)
    return [np.array([level * (1.0 + 1e-6)]) for level in np.unique(levels)]


def least_seen(commands: FloatArray) -> float:
    """rad/s: the smallest dead zone that this log could show; infinite where nothing is slow."""
    speed = np.sort(np.abs(commands).ravel())
    moving = speed[speed > 0.0]
    rank = int(np.ceil(SEEN * len(moving)))
    return float(moving[rank]) if rank < len(moving) else math.inf


MOTOR_DEAD_ZONE = Cause(
    name="motor_dead_zone",
    meaning="a motor does not turn when told to turn slowly",
    plain="Commands below {threshold} do not turn {whose} {which}. Look for friction in the gears.",
    parameters=(
        Parameter(name="threshold", unit="rad/s", null=0.0, low=0.0, high=1000.0, step=2e-2),
    ),
    change=_motor_dead_zone,
    variants=("left", "right", "both"),
    word="wheel",
    confusable_with=("wheel_radius_scale",),
    experiment="slow-ramp",
    smooth=False,
    starts=_motor_dead_zone_starts,
)


STARTS = (0.97, 0.85, 0.6)
"""Shares of the fastest command to start from."""
FASTEST = 1000.0
"""rad/s: no small robot's wheel turns faster."""


def _motor_saturation(motion: Motion, values: FloatArray, variant: str) -> Motion:
    limit = float(values[0])
    affected = sides(variant)
    pair = motion.drive.speed_limit
    left, right = (min(p, limit) if a else p for p, a in zip(pair, affected, strict=True))
    return motion.driving(speed_limit=(left, right))


def _motor_saturation_starts(commands: FloatArray) -> list[FloatArray]:
    """(1,) limits to start from, rad/s."""
    fastest = float(np.abs(commands).max(initial=0.0))
    return [np.array([share * fastest]) for share in STARTS]


MOTOR_SATURATION = Cause(
    name="motor_saturation",
    meaning="a motor cannot turn as fast as it is told to",
    plain="{Whose} {which} cannot turn faster than {limit}. Check the battery, the motor and its "
    "gear.",
    parameters=(
        Parameter(name="limit", unit="rad/s", null=math.inf, low=1e-3, high=FASTEST, step=2e-2),
    ),
    change=_motor_saturation,
    variants=("left", "right", "both"),
    word="wheel",
    confusable_with=("wheel_radius_scale", "wheel_radius_mismatch"),
    experiment="straights",
    starts=_motor_saturation_starts,
)


def _turn_first(motion: Motion, values: FloatArray, variant: str) -> Motion:
    limit = min(motion.drive.turn_first, float(values[0]))
    return motion.driving(turn_first=limit)


TURN_FIRST = Cause(
    name="turn_first",
    meaning="where a wheel would be too fast, the robot keeps its turn rate and gives up speed",
    plain="{Whose} controllers let no wheel turn faster than {limit}: they keep the turn rate and "
    "give up speed. Command less, or raise the limit in the firmware.",
    parameters=(
        Parameter(name="limit", unit="rad/s", null=math.inf, low=1e-3, high=FASTEST, step=2e-2),
    ),
    change=_turn_first,
    confusable_with=("motor_saturation", "wheel_radius_scale"),
    experiment="figure-eight",
    starts=_motor_saturation_starts,
)


def _speed_droop(motion: Motion, values: FloatArray, variant: str) -> Motion:
    rate = motion.drive.droop_rate + float(values[0])
    return motion.driving(droop_rate=rate)


SPEED_DROOP = Cause(
    name="speed_droop",
    meaning="the motors lose speed as time passes, as on a battery that empties",
    plain="{Whose} motors lose {rate} of their speed. Charge the battery, or replace it.",
    parameters=(
        Parameter(name="rate", unit="1/s", null=0.0, low=-0.01, high=0.05, step=1e-5, sign=1),
    ),
    change=_speed_droop,
    confusable_with=("wheel_radius_scale",),
    experiment="straights",
)
