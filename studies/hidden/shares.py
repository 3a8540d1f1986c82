"""What is hidden, in the quantities that a diagnosis tells.

Effects and causes have the same parameters, and most of them in the same unit. A motor's torque and
the wheels' friction are hidden in N m and as a coefficient; a log tells neither, but what share of
a healthy robot's acceleration is left. How one follows from the other is physics of the nominal
body, and no diagnosis reads this.

The oracle is the model that a diagnosis would write if it knew everything.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.reality import constants as k
from realitygap.reality.effects import HiddenEffect
from realitygap.reality.effects.effect import Value
from realitygap.studies.inputs.model import Model

HEALTHY_ACCELERATION = k.MOTOR_TORQUE / (k.WHEEL_INERTIA + 0.5 * k.MASS * k.WHEEL_RADIUS**2)
"""rad/s^2 of the wheels of a robot that starts straight on: the torque over a wheel's own inertia
and half the robot's mass at the wheel's radius."""
GRIP = 1.74
"""Share of the healthy acceleration per unit of friction: mean of 14 robots of the nominal world
with 0.05 to 0.4, two minutes of search or co-evolution, told by the shipped reference (s.d. 0.07).
Derived, it is g times the wheels' share of the weight (0.73: the centre of mass lies 8 mm ahead of
the axle, the skid 30 mm) over their radius and the acceleration, 1.9. Wheels that slip also slide
sideways."""


def as_told(name: str, values: Mapping[str, Value]) -> dict[str, Value]:
    """The values of an effect as a diagnosis that is exactly right would tell them.

    Args:
        name: Of the effect.
        values: As `--effect` takes them.
    """
    told = {**values}
    for key, share in SHARES.get(name, {}).items():
        told[key] = share(float(values[key]))
    return told


def given(name: str) -> dict[str, float]:
    """What the values of a cause are told against, in the nominal world."""
    cause = every_cause()[name]
    return {p.name: GIVEN[p.name] for p in cause.given}


def _torque(torque: float) -> float:
    return torque / k.MOTOR_TORQUE


def _friction(friction: float) -> float:
    """Wheels that grip better than healthy motors pull do not slip."""
    return min(1.0, GRIP * friction)


SHARES: Mapping[str, Mapping[str, Callable[[float], float]]] = {
    "weak_motor": {"torque": _torque},
    "low_friction": {"friction": _friction},
}
GIVEN = {"healthy_acceleration": HEALTHY_ACCELERATION}


def oracle(hidden: Iterable[HiddenEffect]) -> Extension:
    """The causes and values of what is hidden, as a model's extension.

    Raises:
        InputError: an effect that the point model has no term for.
    """
    return Extension(command="oracle: true parameters", causes=tuple(map(_cause, hidden)))


def _cause(hidden: HiddenEffect) -> NamedCause:
    name = hidden.effect.name
    cause, values = every_cause()[name], as_told(name, hidden.values)
    asked = (*cause.parameters, *cause.given)
    values |= given(name)
    return NamedCause(
        name=name,
        robots=hidden.robots or "all",
        word=str(values[cause.word]) if cause.word else "",
        parameters={
            p.name: ParameterValue(value=float(values[p.name]), unit=p.unit) for p in asked
        },
    )


def write_oracle(hidden: Iterable[HiddenEffect], out: Path) -> None:
    """Write the shipped e-puck, corrected, as `extended.toml` with its sensor tables."""
    Model.load().extended(oracle(hidden)).keep(out)
