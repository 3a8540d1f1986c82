"""Infrared sensors, and the wall that they see."""

from __future__ import annotations

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import FixedStarts, Parameter
from realitygap.models.belief.senses import (
    ONE_SENSOR,
    PS,
    SENSORS_OR_ALL,
    Belief,
    SenseCause,
    chosen,
)


def _ir_dead_sensor(belief: Belief, values: FloatArray, variant: str) -> Belief:
    gain, offset = list(belief.senses.ps_gain), list(belief.senses.ps_offset)
    for k in chosen(variant):
        gain[k] = offset[k] = 0.0
    return belief.sensing(ps_gain=tuple(gain), ps_offset=tuple(offset))


IR_DEAD_SENSOR = SenseCause(
    name="ir_dead_sensor",
    meaning="an infrared sensor is dead: it reads nothing, whatever is in front of it",
    plain="{Whose} infrared {which} reads nothing, whatever is in front of it. Check its cable, "
    "or replace it.",
    parameters=(),
    sense=_ir_dead_sensor,
    kind="ps",
    smooth=False,
    variants=ONE_SENSOR,
    word="sensor",
    columns=PS,
    experiment="tour",
)


def _ir_gain(belief: Belief, values: FloatArray, variant: str) -> Belief:
    gain = list(belief.senses.ps_gain)
    for k in chosen(variant):
        gain[k] *= float(values[0])
    return belief.sensing(ps_gain=tuple(gain))


IR_GAIN = SenseCause(
    name="ir_gain",
    meaning="infrared emitter or receiver of another gain",
    plain="{Whose} infrared {which} reads {scale:more/less} than the captured one. Clean it, and "
    "check its supply.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.02, high=10.0, step=0.01, link="factor"),
    ),
    sense=_ir_gain,
    kind="ps",
    variants=SENSORS_OR_ALL,
    word="sensor",
    columns=PS,
    confusable_with=("wall_albedo",),
    experiment="face-to-face",
)


FEIGNS = {"ir_offset": 1.0, "infrared/counts/always": 1.0}
"""counts: readings are whole numbers not below 0, so that more noise moves their mean by up to
one."""
DOUBT = 0.1
"""Of the logarithm of the scale: what windows have of their own takes a little of loud noise for
its own. Measured by simulated readings: 2.0 was told as 1.9."""


def _ir_noise(belief: Belief, values: FloatArray, variant: str) -> Belief:
    return belief.sensing(ps_noise=belief.senses.ps_noise * float(values[0]))


IR_NOISE = SenseCause(
    name="ir_noise",
    meaning="the infrared readings are noisier, or less noisy, than the captured ones",
    plain="{Whose} infrared readings scatter {scale:more/less} than the captured ones. Look for "
    "flickering lamps and a weak supply.",
    parameters=(
        Parameter(
            name="scale",
            unit="1",
            null=1.0,
            low=0.01,
            high=100.0,
            step=0.01,
            link="factor",
            doubt=DOUBT,
        ),
    ),
    sense=_ir_noise,
    kind="noise",
    columns=PS,
    experiment="face-to-face",
    feigns=FEIGNS,
)


IR_OFFSET_ELSEWHERE = 0.15
"""counts that a wall of another albedo or a turned ring makes of noise cut off at zero. Measured by
injecting these two into the rigid-body world: a quarter and a half were seen."""


def _ir_offset(belief: Belief, values: FloatArray, variant: str) -> Belief:
    offset = tuple(one + float(values[0]) for one in belief.senses.ps_offset)
    return belief.sensing(ps_offset=offset)


IR_OFFSET = SenseCause(
    name="ir_offset",
    meaning="infrared in the room adds to every infrared reading",
    plain="{Whose} infrared sensors read {counts:more/less} everywhere. Look for sunlight and "
    "warm lamps in the room.",
    parameters=(
        Parameter(
            name="counts",
            unit="counts",
            null=0.0,
            low=-100.0,
            high=4095.0,
            step=0.5,
            unsure=IR_OFFSET_ELSEWHERE,
        ),
    ),
    sense=_ir_offset,
    kind="ps",
    columns=PS,
    experiment="alone",
)


IR_ROTATION_ELSEWHERE = 2e-3
"""rad that robots seem turned by whose lamp stands a few centimetres higher, or that circle.
Measured by injecting such lamps into the rigid-body world, and in sound robots that circle
there."""


def _ir_rotation(belief: Belief, values: FloatArray, variant: str) -> Belief:
    return belief.sensing(rotation=belief.senses.rotation + float(values[0]))


IR_ROTATION = SenseCause(
    name="ir_rotation",
    meaning="the ring of infrared and light sensors is turned on the body",
    plain="{Whose} ring of sensors is turned {angle:counter-clockwise/clockwise}. Mount it "
    "straight.",
    parameters=(
        Parameter(
            name="angle",
            unit="rad",
            null=0.0,
            low=-3.1,
            high=3.1,
            step=0.03,
            unsure=IR_ROTATION_ELSEWHERE,
        ),
    ),
    sense=_ir_rotation,
    kind="both",
    columns=PS,
    confusable_with=("tracker_yaw_offset",),
    experiment="tour",
    starts=FixedStarts((0.1, -0.1)),  # rad; a small turn says little of a large one
)


def _wall_albedo(belief: Belief, values: FloatArray, variant: str) -> Belief:
    return belief.sensing(wall_albedo=belief.senses.wall_albedo * float(values[0]))


WALL_ALBEDO = SenseCause(
    name="wall_albedo",
    meaning="the wall reflects more or less infrared than the captured one",
    plain="The wall reflects {scale:more/less} infrared than the captured one. Measure its "
    "paint, or capture it again.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.02, high=10.0, step=0.01, link="factor"),
    ),
    sense=_wall_albedo,
    kind="ps",
    place=True,
    columns=PS,
    confusable_with=("ir_gain",),
    experiment="face-to-face",
)
