"""Effects hidden in sensors, lamp and nest are named by a process that has the log alone."""

from __future__ import annotations

import pytest

from realitygap.studies.blind.trials import Hidden
from tests.blind.test_naming import check, hide, told


def everywhere(name: str, **values: float | str) -> Hidden:
    return Hidden(name, values, (), 0.0, 1.5)


def test_six_robots_with_six_faults_of_their_senses_are_told_apart() -> None:
    check(
        *told(
            hide("ir_rotation", 0, angle=0.05),
            hide("ir_offset", 2, counts=6.0),
            hide("ir_noise", 4, scale=1.8),
            hide("light_gamma", 5, exponent=0.93),
            hide("ir_dead_sensor", 7, sensor="1"),
            hide("ls_dead_sensor", 8, sensor="4"),
            seed=803,
        )
    )


@pytest.mark.blind
@pytest.mark.parametrize("seed", [811, 812])
@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("lamp_intensity", {"scale": 1.045}),
        ("lamp_height", {"height": 0.103}),
        ("light_falloff", {"exponent": 1.94}),
        ("lamp_moved", {"x": 0.0, "y": 0.015}),
        ("ambient_light", {"level": 0.015}),
        ("second_lamp", {"x": 0.1, "y": 0.69, "intensity": 0.08}),
        ("lamp_decay", {"rate": 6e-4}),
        ("light_gamma", {"exponent": 1.075}),
        ("wall_albedo", {"scale": 0.85}),
        ("nest_moved", {"x": 0.0, "y": 0.015}),
        ("nest_radius", {"scale": 1.045}),
    ],
)
def test_each_effect_of_the_place_is_named(name: str, values: dict[str, float], seed: int) -> None:
    check(*told(everywhere(name, **values), seed=seed))
