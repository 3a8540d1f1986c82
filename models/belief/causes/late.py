"""Commands, stamps and starts that come late."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, FixedStarts, Parameter
from realitygap.models.belief.motion import Motion

UNSURE = 3e-4
"""s: measured by injecting latencies of 2 to 25 ms into searching swarms of the rigid-body world:
they came out up to 0.7 ms short."""
COMMAND_LATENCY_FEIGNS = {"weak_motor": 0.04, "motor_lag": 0.002}
"""Measured by injecting latencies of 2 to 25 ms into swarms of the rigid-body world: beside late
commands or poses motors seemed up to 15 % weaker and to lag by up to 8 ms, and latency up to 5 ms
shorter; by itself it is told within 0.7 ms. A quarter of the former, for names begin at 4.5 such
deviations."""


def _command_latency(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return motion.driving(latency=max(0.0, motion.drive.latency + float(values[0])))


EARLY = -1e-3
"""s; commands cannot arrive before they are sent: an earlier value is not a latency."""


def _command_latency_as_twin(without: Motion, stamped: Motion) -> float | None:
    seconds = stamped.pose_delay - without.pose_delay
    return seconds if without.drive.latency + seconds >= EARLY else None


COMMAND_LATENCY = Cause(
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
    change=_command_latency,
    family="transient",
    feigns=COMMAND_LATENCY_FEIGNS,
    exact=True,
    confusable_with=("motor_lag", "clock_offset"),
    twins=("clock_offset",),
    as_twin=_command_latency_as_twin,
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
)


def _clock_offset(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return replace(motion, pose_delay=motion.pose_delay + float(values[0]))


CLOCK_OFFSET = Cause(
    name="clock_offset",
    meaning="the tracker's clock is offset from the robots': poses are stamped late (early if < 0)",
    plain="{Whose} poses are stamped {seconds:late/early}. Synchronise the tracker's clock with "
    "the robot's.",
    parameters=(
        Parameter(
            name="seconds",
            unit="s",
            null=0.0,
            low=-1.0,
            high=1.0,
            step=1e-3,
            unsure=UNSURE,
        ),
    ),
    change=_clock_offset,
    family="transient",
    feigns=COMMAND_LATENCY_FEIGNS,
    exact=True,
    confusable_with=("command_latency",),
    twins=("command_latency",),
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
    starts=FixedStarts((0.15, 0.05, -0.05)),  # s; see above
)


def _start_delay(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return motion.driving(start_delay=motion.drive.start_delay + float(values[0]))


START_DELAY = Cause(
    name="start_delay",
    meaning="a wheel stands for a while before it starts, or before it turns the other way",
    plain="{Whose} wheels stand for {seconds} before they start or turn the other way. Look at the "
    "motor driver's enabling and braking, and for play in the gears.",
    parameters=(
        Parameter(
            name="seconds", unit="s", null=0.0, low=0.0, high=3.0, step=5e-3, sign=1, doubt=0.015
        ),
    ),
    change=_start_delay,
    family="transient",
    confusable_with=("command_latency", "motor_lag", "motor_dead_zone"),
    experiment="steps",
    starts=FixedStarts(
        (0.05, 0.2, 0.5)
    ),  # s; longer waits than the commands' steps are far from linear
)
