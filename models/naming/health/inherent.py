"""What every healthy robot does that the minimal model leaves out: finite torque, slip, a lag.

Six numbers, fitted together on healthy logs: speed and turn scale (slip, effective axle), latency,
lag, the wheels' acceleration, and how far ahead of the axle the point lies that does not slip
sideways. They are no fault, and no cause of the catalogue is taken for one. A negative latency is
how a motor that answers in steps looks to a continuous model.
"""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import ALL, Cause, Parameter
from realitygap.models.belief.motion import Motion

ACCELERATION = 200.0
"""rad/s^2 to start from: what 4 m/s^2 is on 20 mm wheels. No rule: where a fit begins."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    scale, axle, latency, lag, acceleration, centre = (float(v) for v in values)
    drive = motion.drive
    left, right = drive.wheel_radius
    limits = (min(drive.acceleration[0], acceleration), min(drive.acceleration[1], acceleration))
    changed = replace(
        drive,
        wheel_radius=(left * scale, right * scale),
        axle=drive.axle * axle,
        time_constant=max(0.0, drive.time_constant + lag),
        acceleration=limits,
    )
    return replace(
        motion,
        drive=changed,
        motor_delay=motion.motor_delay + latency,
        lever=(motion.lever[0] + centre, motion.lever[1]),
    )


INHERENT = Cause(
    name="inherent",
    meaning="what healthy robots do that the minimal model leaves out",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.2, high=1.5, step=1e-3, link="factor"),
        Parameter(name="axle", unit="1", null=1.0, low=0.3, high=10.0, step=1e-3, link="factor"),
        Parameter(name="latency", unit="s", null=0.0, low=-0.1, high=0.5, step=1e-3),
        Parameter(name="lag", unit="s", null=0.0, low=0.0, high=2.0, step=1e-3),
        Parameter(
            name="acceleration",
            unit="rad/s^2",
            null=ACCELERATION,
            low=1.0,
            high=1e5,
            step=2e-2,
            link="factor",
        ),
        Parameter(name="centre", unit="m", null=0.0, low=-0.02, high=0.02, step=5e-4),
    ),
    change=_change,
    variants=(ALL,),
)
