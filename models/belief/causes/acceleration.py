"""How fast wheels change speed: motors that lag or are weak, wheels that slip, ramps.

Nobody who has only a log knows newton metres or coefficients of friction. What a log tells is the
acceleration at which wheels change speed, and a healthy reference tells that of sound robots
(`health.reference`). Weak motors and slipping wheels are told as a share of the latter.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray, Pair
from realitygap.models.belief.cause import Cause, FixedStarts, Parameter
from realitygap.models.belief.motion import Motion

LEAST = 0.003
"""Share of a healthy acceleration, least believed: such a robot needs seconds to reach a speed."""
HEALTHY = Parameter(
    name="healthy_acceleration",
    unit="rad/s^2",
    null=math.inf,
    low=1.0,
    high=1e5,
    step=1.0,
)
"""Of a sound robot's wheels at a start. Bounds as of the inherent motion; infinite: such wheels
have no limit, and a share of it is none."""


def limits(motion: Motion, values: FloatArray) -> Pair:
    """rad/s^2: the wheels' acceleration limits at a share of the healthy ones.

    Args:
        motion: Whose own limits are the healthy ones, if it has any.
        values: The share, and the healthy limit to take where the motion has none.
    """
    share = float(values[0])
    left, right = motion.drive.acceleration
    if math.isinf(left) and len(values) > 1 and share < 1.0:
        left = right = float(values[1])
    return left * share, right * share


def told_against(healthy: Motion) -> FloatArray:
    """(1,) the acceleration that a share is of; infinite where nobody has measured it."""
    return np.array([min(healthy.drive.acceleration)])


RUSH, RUSHED = 0.226, 4.2
"""Largest logarithm of what a lag seems to add to the motors' acceleration, and the rad/s that the
motors would gain in one time constant where it does. The point model's motor lags behind its
command from the first moment; a real one first follows the lag as fast as it can, so that its limit
matters less, and not at all once the lag is slower than the motor. Measured by injecting lags of 8
to 100 ms into the rigid-body world."""
MOTOR_LAG_FEIGNS = {
    "command_latency": 0.0035,
    "clock_offset": 0.0035,
    "weak_motor": 0.1,
    "low_friction": 0.1,
    "wheel_separation": 0.0017,
    "wheel_radius_scale": 0.0009,
    "speed_droop": 1e-5,
}
"""As for `low_friction`, by injecting lags of 15 to 100 ms."""


def _motor_lag(motion: Motion, values: FloatArray, variant: str) -> Motion:
    lag = float(values[0])
    if lag == 0.0:
        return motion
    left, right = motion.drive.acceleration
    faster = _rush(lag, min(left, right))
    return motion.driving(
        time_constant=max(0.0, motion.drive.time_constant + lag),
        acceleration=(left * faster, right * faster),
    )


def _rush(lag: float, acceleration: float) -> float:
    """How much faster the motors seem to change speed."""
    if lag <= 0.0 or math.isinf(acceleration):
        return 1.0
    gained = lag * acceleration / RUSHED
    return math.exp(RUSH * (gained * math.exp(1.0 - gained)) ** 3)


MOTOR_LAG = Cause(
    name="motor_lag",
    meaning="the motors answer as a first-order lag: speed approaches the command gradually",
    plain="{Whose} motors need {time_constant} for two thirds of a change of speed. Check the "
    "battery and the speed controllers.",
    parameters=(
        Parameter(
            name="time_constant",
            unit="s",
            null=0.0,
            low=-0.1,
            high=1.0,
            step=2e-3,
            sign=1,
            doubt=0.04,
        ),
    ),
    change=_motor_lag,
    family="transient",
    feigns=MOTOR_LAG_FEIGNS,
    confusable_with=("command_latency", "weak_motor", "low_friction"),
    experiment="steps",
    starts=FixedStarts((0.02, 0.1)),  # s; at the null a lag hides behind the motors' own
)


LOW_FRICTION_FEIGNS = {
    "command_latency": 0.0105,
    "clock_offset": 0.0105,
    "motor_lag": 0.021,
    "wheel_separation": 0.014,
    "wheel_radius_scale": 0.002,
    "speed_droop": 2.5e-5,
    "tracker_offset": 1e-4,
}
"""Measured by injecting this very effect into the rigid-body world: 25 robots of it with a friction
of 0.05 to 0.3, as what two minutes give beyond their uncertainty; so those of the other causes.
They are that world's, and may be other on other floors."""


def _low_friction(motion: Motion, values: FloatArray, variant: str) -> Motion:
    slipping = limits(motion, values)
    if slipping >= motion.drive.acceleration:
        return motion  # the motors give less than the wheels can hold
    return replace(motion.driving(acceleration=slipping), encoder_drive=motion.wheels)


def _low_friction_as_twin(without: Motion, weak: Motion) -> float | None:
    share = min(weak.drive.acceleration) / min(without.drive.acceleration)
    return share if share < 1.0 else None


LOW_FRICTION = Cause(
    name="low_friction",
    meaning="the wheels slip on the floor when they speed up or brake, from a share of the healthy "
    "acceleration on",
    plain="{Whose} wheels slip beyond {friction:%} of a healthy robot's acceleration. Clean "
    "tyres and floor.",
    parameters=(
        Parameter(
            name="friction",
            unit="1",
            null=1.0,
            low=LEAST,
            high=1.0,
            step=5e-2,
            link="factor",
            sign=-1,
            doubt=0.06,
        ),
    ),
    change=_low_friction,
    given=(HEALTHY,),
    told_against=told_against,
    family="transient",
    feigns=LOW_FRICTION_FEIGNS,
    confusable_with=("weak_motor", "motor_lag"),
    twins=("weak_motor",),
    as_twin=_low_friction_as_twin,
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
    starts=FixedStarts((-0.6, -1.4)),  # a half and a quarter of what healthy wheels' grip gives
)
"""Told is the share of the healthy acceleration at which they begin to slip. A healthy robot's
wheels hold all that its motors give, so that grip beyond that does not show: a share is never above
1, and is no ratio of coefficients of friction, which is smaller."""


WEAK_MOTOR_FEIGNS = {
    "command_latency": 0.0025,
    "clock_offset": 0.0025,
    "motor_lag": 0.008,
    "wheel_separation": 0.0035,
    "wheel_radius_scale": 0.0015,
    "speed_droop": 1.5e-5,
    "tracker_offset": 1e-4,
}
"""As for `low_friction`, by injecting weak motors: with a fifth to two thirds of the torque."""


def _weak_motor(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return motion.driving(acceleration=limits(motion, values))


WEAK_MOTOR = Cause(
    name="weak_motor",
    meaning="the motors give a share only of a healthy robot's torque: the wheels change speed "
    "slowly",
    plain="{Whose} motors give {torque:%} of a healthy robot's torque. Check the battery and the "
    "gears.",
    parameters=(
        Parameter(
            name="torque",
            unit="1",
            null=1.0,
            low=LEAST,
            high=3.0,
            step=5e-2,
            link="factor",
            sign=-1,
            doubt=0.05,
        ),
    ),
    change=_weak_motor,
    given=(HEALTHY,),
    told_against=told_against,
    family="transient",
    feigns=WEAK_MOTOR_FEIGNS,
    confusable_with=("low_friction", "motor_lag"),
    twins=("low_friction",),
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
    starts=FixedStarts((-0.4, -1.5)),  # two thirds and a fifth of the torque
)
"""Told is the share of a healthy robot's torque: acceleration grows in step with it."""


SLEW_LIMIT_STARTS = (0.1, 0.5, 2.0)
"""s from rest to the log's fastest command, to start from."""


def _slew_limit(motion: Motion, values: FloatArray, variant: str) -> Motion:
    left, right = (min(own, float(values[0])) for own in motion.drive.acceleration)
    return motion.driving(acceleration=(left, right))


def _slew_limit_starts(commands: FloatArray) -> list[FloatArray]:
    fastest = float(np.abs(commands).max(initial=0.0))
    return [np.array([fastest / seconds]) for seconds in SLEW_LIMIT_STARTS if fastest > 0.0]


SLEW_LIMIT = Cause(
    name="slew_limit",
    meaning="a ramp, or motors of little torque, limit how fast the wheels change speed",
    plain="{Whose} wheels change speed by at most {rate}. Look for a ramp in the firmware, and at "
    "the motors' torque.",
    parameters=(
        Parameter(
            name="rate", unit="rad/s^2", null=math.inf, low=1e-2, high=HEALTHY.high, step=1e-1
        ),
    ),
    change=_slew_limit,
    where="unmeasured",
    family="transient",
    confusable_with=("motor_lag", "command_latency", "start_delay"),
    experiment="steps",
    starts=_slew_limit_starts,
)
"""The same term as a weak motor's, told in its own unit where nobody knows how fast a healthy
robot's wheels change speed. Where a reference knows, `weak_motor` tells it as a share of that."""
