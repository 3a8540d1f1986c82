"""Wheels that slip on the floor: a robot of skid steer moves less than its wheels turn.

The same term as a wheel's radius. Of four wheels that slip in every turn nobody can say more, and
a radius is what they keep.
"""

from __future__ import annotations

from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.causes.wheel_radius_scale import change

CAUSE = Cause(
    name="slip",
    meaning="the body moves by a share only of what the wheels turn, or all speeds are scaled",
    plain="{Whose} body moves by {share:%} of what its wheels are told. Look at the floor, the "
    "tyres and their pressure.",
    parameters=(
        Parameter(name="share", unit="1", null=1.0, low=0.05, high=1.5, step=1e-3, link="factor"),
    ),
    change=change,
    where="skid",
    geometric=True,
    confusable_with=("motor_saturation", "motor_dead_zone", "effective_axle"),
    experiment="straights",
)
