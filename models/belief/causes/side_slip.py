"""A robot of skid steer drifts out of its curves: sideways, in step with speed and turn rate."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.laws import Atom, Law
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion

TURN_RATE = (Atom("turn", "sign"), Atom("turn", "power", (1.0, 1.0)))
"""rad/s, with its sign."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    seconds = float(values[0])
    if seconds == 0.0:
        return motion
    law = Law("aside", -seconds, TURN_RATE)  # to the right where it turns to the left
    return replace(motion, drive=replace(motion.drive, laws=(*motion.drive.laws, law)))


CAUSE = Cause(
    name="side_slip",
    meaning="the robot drifts out of its curves, in step with its speed and its turn rate",
    plain="{Whose} body drifts out of every curve, by {seconds} times its speed and turn rate. "
    "Look at the floor and at the tyres.",
    parameters=(Parameter(name="seconds", unit="s", null=0.0, low=-2.0, high=2.0, step=5e-3),),
    change=_change,
    where="skid",
    confusable_with=("tracker_offset",),
    experiment="circle",
)
