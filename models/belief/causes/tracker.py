"""What the tracker says: where a robot is, and where the nest."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import Belief, SenseCause


def _tracker_offset(motion: Motion, values: FloatArray, variant: str) -> Motion:
    lever = (motion.lever[0] + float(values[0]), motion.lever[1] + float(values[1]))
    return replace(motion, lever=lever)


TRACKER_OFFSET = Cause(
    name="tracker_offset",
    meaning="the tracker's markers are mounted off the middle of the axle",
    plain="{Whose} marker sits {x:ahead/behind} and {y:to the left/to the right} of the axle's "
    "middle. Mount it there.",
    parameters=(
        Parameter(
            name="x",
            unit="m",
            null=0.0,
            low=-0.5,
            high=0.5,
            step=5e-4,
            doubt=0.03,
        ),
        Parameter(
            name="y",
            unit="m",
            null=0.0,
            low=-0.5,
            high=0.5,
            step=5e-4,
            doubt=0.03,
        ),
    ),
    change=_tracker_offset,
    confusable_with=("wheel_separation",),
    experiment="spins",
)


def _tracker_yaw_offset(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return replace(motion, yaw_offset=motion.yaw_offset + float(values[0]))


TRACKER_YAW_OFFSET = Cause(
    name="tracker_yaw_offset",
    meaning="the tracker's markers are mounted rotated about the vertical",
    plain="{Whose} marker is turned {angle:counter-clockwise/clockwise}. Mount it straight.",
    parameters=(
        Parameter(
            name="angle",
            unit="rad",
            null=0.0,
            low=-3.2,
            high=3.2,
            step=2e-3,
            doubt=0.03,
        ),
    ),
    change=_tracker_yaw_offset,
    confusable_with=("wheel_radius_mismatch", "ir_rotation"),
    experiment="straights",
)


def _nest_moved(belief: Belief, values: FloatArray, variant: str) -> Belief:
    x, y = belief.nest_shift
    return replace(belief, nest_shift=(x + float(values[0]), y + float(values[1])))


NEST_MOVED = SenseCause(
    name="nest_moved",
    meaning="the virtual sensor says nest at another place than believed",
    plain="{Whose} virtual sensor has the nest {x} along x and {y} along y from where the model "
    "has it. Set it anew.",
    parameters=(
        Parameter(name="x", unit="m", null=0.0, low=-2.0, high=2.0, step=0.001),
        Parameter(name="y", unit="m", null=0.0, low=-2.0, high=2.0, step=0.001),
    ),
    sense=_nest_moved,
    kind="nest",
    columns=("nest",),
    confusable_with=("nest_radius",),
    experiment="tour",
)


def _nest_radius(belief: Belief, values: FloatArray, variant: str) -> Belief:
    return replace(belief, nest_scale=belief.nest_scale * float(values[0]))


NEST_RADIUS = SenseCause(
    name="nest_radius",
    meaning="the virtual sensor says nest within another radius than believed",
    plain="{Whose} virtual sensor has a nest whose radius is {scale:larger/smaller} than the "
    "model's. Set it anew.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.05, high=5.0, step=0.01, link="factor"),
    ),
    sense=_nest_radius,
    kind="nest",
    columns=("nest",),
    confusable_with=("nest_moved",),
    experiment="tour",
)
