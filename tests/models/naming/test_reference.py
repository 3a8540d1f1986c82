"""What a reference knows of healthy robots, and what it does not."""

from __future__ import annotations

import pytest

from realitygap.models.naming.health.reference import INHERENT, Column, Reference

NAMES = (
    "motor_lag.time_constant",
    "motor_lag@0.05",
    "weak_motor.share",
    "weak_motor@0.4",
    "motor_saturation/left@4.5",
    "speed@always",
)


def known(*columns: str, robots: int = 10) -> dict[str, bool]:
    one = Reference(
        model="e-puck",
        wheel_radius=0.0205,
        axle=0.053,
        robots=robots,
        swarms=1,
        inherent=(0.0,) * len(INHERENT.parameters),
        columns={name: Column(mean=0.0, sd=1.0, swarm_sd=0.0) for name in columns},
    )
    return dict(zip(NAMES, one.knows(NAMES).tolist(), strict=True))


@pytest.mark.parametrize("measured", ["motor_lag", "weak_motor"])
def test_a_whole_dose_is_known_where_its_causes_coefficients_are(measured: str) -> None:
    (name,) = [n for n in NAMES if n.startswith(f"{measured}.")]
    found = known(name)
    for cause in ("motor_lag", "weak_motor"):
        assert {found[n] for n in NAMES if n.startswith(cause)} == {cause == measured}


def test_what_has_no_coefficient_is_known() -> None:
    found = known()
    assert found["motor_saturation/left@4.5"]
    assert found["speed@always"]


def test_where_no_health_is_asked_for_all_is_known() -> None:
    assert all(known(robots=0).values())
