"""Commands reach the motors late."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion

UNSURE = 3e-4
"""s: measured by injecting latencies of 2 to 25 ms into searching swarms of the rigid-body world:
they came out up to 0.7 ms short."""
FEIGNS = {"weak_motor": 0.04, "motor_lag": 0.002}
"""Measured by injecting latencies of 2 to 25 ms into swarms of the rigid-body world: beside late
commands or poses motors seemed up to 15 % weaker and to lag by up to 8 ms, and latency up to 5 ms
shorter; by itself it is told within 0.7 ms. A quarter of the former, for names begin at 4.5 such
deviations."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    latency = max(0.0, motion.drive.latency + float(values[0]))
    return replace(motion, drive=replace(motion.drive, latency=latency))


EARLY = -1e-3
"""s; commands cannot arrive before they are sent: an earlier value is not a latency."""


def _as_twin(without: Motion, stamped: Motion) -> float | None:
    seconds = stamped.pose_delay - without.pose_delay
    return seconds if without.drive.latency + seconds >= EARLY else None


CAUSE = Cause(
    name="command_latency",
    meaning="commands reach the motors later than the model believes",
    plain="Commands reach {whose} motors {seconds:later/earlier} than the model believes. Look "
    "at the radio link and at the control loop.",
    parameters=(
        Parameter(
            name="seconds",
            unit="s",
            null=0.0,
            low=-0.1,
            high=1.0,
            step=1e-3,
            unsure=UNSURE,
        ),
    ),
    change=_change,
    family="transient",
    feigns=FEIGNS,
    exact=True,
    confusable_with=("motor_lag", "clock_offset"),
    twins=("clock_offset",),
    as_twin=_as_twin,
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
)
