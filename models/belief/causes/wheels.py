"""Wheels on a floor: how far they roll, how far apart they stand."""

from __future__ import annotations

from realitygap.embedded_sim.laws import Atom, Law
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion


def _wheel_radius_scale(motion: Motion, values: FloatArray, variant: str) -> Motion:
    scale = float(values[0])
    left, right = motion.drive.wheel_radius
    return motion.driving(wheel_radius=(left * scale, right * scale))


WHEEL_RADIUS_SCALE = Cause(
    name="wheel_radius_scale",
    meaning="both wheels are larger or smaller than the model has them, or all speeds are scaled",
    plain="{Whose} wheels are {scale:larger/smaller} than in the model, or all its speeds are "
    "scaled. Measure their diameter.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.3, high=3.0, step=1e-3, link="factor"),
    ),
    change=_wheel_radius_scale,
    where="differential",
    confusable_with=("speed_droop", "motor_saturation", "motor_dead_zone", "wheel_separation"),
    experiment="straights",
)


def _wheel_radius_mismatch(motion: Motion, values: FloatArray, variant: str) -> Motion:
    ratio = float(values[0])
    left, right = motion.drive.wheel_radius
    share = 2.0 / (1.0 + ratio)  # the mean radius is kept
    return motion.driving(wheel_radius=(left * share, right * share * ratio))


WHEEL_RADIUS_MISMATCH = Cause(
    name="wheel_radius_mismatch",
    meaning="the two wheels differ in radius: the robot bends away from the larger one",
    plain="{Whose} right wheel is {ratio:larger/smaller} than its left. Measure both.",
    parameters=(
        Parameter(
            name="ratio", unit="right/left", null=1.0, low=0.5, high=2.0, step=1e-3, doubt=0.03
        ),
    ),
    change=_wheel_radius_mismatch,
    confusable_with=("tracker_yaw_offset", "wheel_separation"),
    experiment="straights",
)


def _wheel_separation(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return motion.driving(axle=motion.drive.axle * float(values[0]))


WHEEL_SEPARATION = Cause(
    name="wheel_separation",
    meaning="the wheels touch the floor further apart or nearer than the model has them",
    plain="{Whose} wheels touch the floor {scale:further apart/nearer together} than in the "
    "model. Measure between the tyres.",
    parameters=(
        Parameter(
            name="scale",
            unit="1",
            null=1.0,
            low=0.3,
            high=3.0,
            step=1e-3,
            link="factor",
            doubt=0.04,
        ),
    ),
    change=_wheel_separation,
    where="differential",
    confusable_with=("wheel_radius_scale", "wheel_radius_mismatch"),
    experiment="spins",
)


SLIP = Cause(
    name="slip",
    meaning="the body moves by a share only of what the wheels turn, or all speeds are scaled",
    plain="{Whose} body moves by {share:%} of what its wheels are told. Look at the floor, the "
    "tyres and their pressure.",
    parameters=(
        Parameter(name="share", unit="1", null=1.0, low=0.05, high=1.5, step=1e-3, link="factor"),
    ),
    change=_wheel_radius_scale,
    where="skid",
    confusable_with=("motor_saturation", "motor_dead_zone", "effective_axle"),
    experiment="straights",
)
"""The same term as a wheel's radius. Of four wheels that slip in every turn nobody can say more,
and a radius is what they keep."""


EFFECTIVE_AXLE = Cause(
    name="effective_axle",
    meaning="the robot turns as one on two wheels further apart or nearer: all four wheels scrub",
    plain="{Whose} wheels scrub in turns: it turns as one on two wheels {scale:further apart/"
    "nearer together} than the model's axle. Look at the floor, the tyres and the load.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.3, high=10.0, step=1e-3, link="factor"),
    ),
    change=_wheel_separation,
    where="skid",
    confusable_with=("slip", "wheel_radius_mismatch"),
    experiment="spins",
)
"""The same term as the separation of the wheels, which nobody can move on such a robot."""


TURN_RATE = (Atom("turn", "sign"), Atom("turn", "power", (1.0, 1.0)))
"""rad/s, with its sign."""


def _side_slip(motion: Motion, values: FloatArray, variant: str) -> Motion:
    seconds = float(values[0])
    if seconds == 0.0:
        return motion
    law = Law("aside", -seconds, TURN_RATE)  # to the right where it turns to the left
    return motion.driving(laws=(*motion.drive.laws, law))


SIDE_SLIP = Cause(
    name="side_slip",
    meaning="the robot drifts out of its curves, in step with its speed and its turn rate",
    plain="{Whose} body drifts out of every curve, by {seconds} times its speed and turn rate. "
    "Look at the floor and at the tyres.",
    parameters=(Parameter(name="seconds", unit="s", null=0.0, low=-2.0, high=2.0, step=5e-3),),
    change=_side_slip,
    where="skid",
    confusable_with=("tracker_offset",),
    experiment="circle",
)


def _floor_tilt(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return motion


FLOOR_TILT = Cause(
    name="floor_tilt",
    meaning="the floor is not level; wheels that hold their speed hide it, so it is never named",
    plain="The floor slopes by {slope}. Level it.",
    parameters=(
        Parameter(name="slope", unit="rad", null=0.0, low=0.0, high=0.3, step=1e-2),
        Parameter(name="direction", unit="rad", null=0.0, low=-3.2, high=3.2, step=0.1),
    ),
    change=_floor_tilt,
    confusable_with=("low_friction",),
    experiment="straights",
    identifiable=False,
)
