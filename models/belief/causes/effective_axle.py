"""How a robot of skid steer turns: as one on two wheels further apart, by which its wheels scrub.

The same term as the separation of the wheels, which nobody can move on such a robot.
"""

from __future__ import annotations

from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.causes.wheel_separation import change

CAUSE = Cause(
    name="effective_axle",
    meaning="the robot turns as one on two wheels further apart or nearer: all four wheels scrub",
    plain="{Whose} wheels scrub in turns: it turns as one on two wheels {scale:further apart/"
    "nearer together} than the model's axle. Look at the floor, the tyres and the load.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.3, high=10.0, step=1e-3, link="factor"),
    ),
    change=change,
    where="skid",
    geometric=True,
    confusable_with=("slip", "wheel_radius_mismatch"),
    experiment="spins",
)
