"""What was hidden in N m and coefficients, in the shares that a diagnosis tells."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from realitygap.models.belief.catalogue import causes
from realitygap.models.belief.extension import NamedCause, ParameterValue
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.identify import _given
from realitygap.models.naming.diagnosis import Diagnosis, extension
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.findings import Evidence, Named
from realitygap.models.naming.health.reference import shipped_reference
from realitygap.reality import constants as k
from realitygap.reality.effects import parse_effects
from realitygap.studies.blind.scoring import NamedAnswer as Told
from realitygap.studies.blind.scoring import _inside
from realitygap.studies.blind.trials import Hidden
from realitygap.studies.hidden.shares import HEALTHY_ACCELERATION, as_told, oracle
from realitygap.studies.inputs.model import Model
from tests.reality.hidden import drive, straight


def test_half_a_motors_torque_is_told_as_a_half() -> None:
    assert as_told("weak_motor", {"torque": 0.5 * k.MOTOR_TORQUE}) == {"torque": 0.5}
    assert as_told("weak_motor", {"torque": k.MOTOR_TORQUE}) == {"torque": 1.0}


def test_grip_to_spare_does_not_show() -> None:
    assert as_told("low_friction", {"friction": k.WHEEL_FRICTION}) == {"friction": 1.0}
    low, high = (as_told("low_friction", {"friction": f})["friction"] for f in (0.1, 0.2))
    assert 0.0 < float(low) < float(high) < 1.0


def test_other_values_are_told_as_they_are_hidden() -> None:
    values = {"limit": 3.6, "wheel": "left"}
    assert as_told("motor_saturation", values) == values


@pytest.mark.parametrize("share", [0.4, 0.15])
def test_a_share_of_torque_is_a_share_of_the_healthy_acceleration(share: float) -> None:
    path = drive(straight, 0.04, f"weak_motor:torque={share * k.MOTOR_TORQUE},robot=1")
    steps = 4  # of the physics, each at the speed it ends with
    acceleration = path.ahead[-1, 1] / (k.PHYSICS_STEP**2 * steps * (steps + 1) / 2)
    assert acceleration / k.WHEEL_RADIUS == pytest.approx(share * HEALTHY_ACCELERATION, rel=0.08)


def test_an_interval_of_shares_is_judged_by_the_hidden_torque() -> None:
    hidden = Hidden("weak_motor", {"torque": 0.4 * k.MOTOR_TORQUE}, (1,), 0.0, 1.5)

    def said(low: float, high: float) -> Told:
        told = {"torque": {"value": 0.4, "low": low, "high": high, "unit": "1"}}
        return Told("weak_motor", frozenset({1}), False, (), True, told)

    assert _inside(hidden, said(0.35, 0.45)) == [True]
    assert _inside(hidden, said(0.45, 0.5)) == [False]


def test_the_oracle_limits_what_the_minimal_model_accelerates() -> None:
    specs = (
        f"weak_motor:torque={0.25 * k.MOTOR_TORQUE},robot=1",
        "low_friction:friction=0.1,robot=2",
    )
    believed = oracle(parse_effects(specs, 3))
    weak, slipping = (believed.applied(Motion(), robot) for robot in (1, 2))
    assert weak.drive.acceleration == pytest.approx((0.25 * HEALTHY_ACCELERATION,) * 2)
    assert max(slipping.drive.acceleration) < max(weak.drive.acceleration)
    assert slipping.wheels == Motion().drive
    assert believed.applied(Motion(), 0) == Motion()


def named(share: float) -> Named:
    """A weak motor as a diagnosis names it by the shipped reference."""
    healthy = shipped_reference("e-puck")
    assert healthy is not None
    term = Term(causes()["weak_motor"], "")
    evidence = Evidence(
        term=term,
        coordinates=np.log([share]),
        covariance=np.eye(1) * 1e-4,
        gain=90.0,
        share=0.5,
        distance=20.0,
    )
    return Named(
        term=term,
        robots=(1,),
        whole_swarm=False,
        values=(Value("torque", share, 0.9 * share, 1.1 * share, "1"),),
        given=_given(term, healthy.motion(Motion())),
        evidence=evidence,
        twins=(),
    )


def test_a_share_found_in_a_log_is_as_slow_on_board_and_slower_beside_health(
    tmp_path: Path,
) -> None:
    found = extension(Diagnosis(named=(named(0.4),)), log_hash="", command="")
    Model.load("epuck").extended(found).keep(tmp_path)
    loaded = read_model_file(tmp_path / "extended.toml")
    healthy = shipped_reference("e-puck")
    assert healthy is not None
    (limit, _) = healthy.motion(Motion()).drive.acceleration
    assert loaded.motion(1).drive.acceleration == pytest.approx((0.4 * limit,) * 2)
    assert loaded.motion(0) == read_model_file("epuck").motion()
    # diagnosed once more, a healthy robot of that kind still is as slow
    assert healthy.motion(loaded.motion(1)).drive.acceleration[0] == pytest.approx(0.4 * limit)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"torque": ParameterValue(value=0.5, unit="N m")}, "'N m'"),
        ({"torque": ParameterValue(value=0.5)}, "healthy_acceleration"),
        (
            {"torque": ParameterValue(value=0.5), "healthy": ParameterValue(value=100.0)},
            "healthy_acceleration",
        ),
    ],
)
def test_a_share_of_nothing_and_the_old_unit_are_refused(
    parameters: dict[str, ParameterValue], said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        NamedCause(name="weak_motor", parameters=parameters)
