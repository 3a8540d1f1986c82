"""What a log can tell is said with what a diagnosis makes of it, and changes no answer."""

from __future__ import annotations

from functools import cache
from typing import get_args

import numpy as np
import pandas as pd
import pytest

from realitygap.models.belief.catalogue import every_cause, sense_causes
from realitygap.models.log.measured import make_log
from realitygap.models.log.preflight.entry import Follows, PreflightEntry
from realitygap.models.log.schema import LS, PS
from realitygap.models.naming.channels.motion.diagnose import diagnose
from realitygap.models.naming.diagnosis import as_json
from tests.models.naming.test_identify import MODEL, RECORDER, STEP, reference, table

POSE = ["x", "y", "yaw"]


def entries(
    frame: pd.DataFrame, *, recorder: str = "", known: bool = True
) -> dict[str, PreflightEntry]:
    frame.attrs["recorder"] = recorder
    log = make_log(frame, drive=MODEL.motion().drive)
    found = diagnose(log, MODEL, reference() if known else None).diagnosis
    return {one.name: one for one in found.preflight}


@cache
def alike() -> dict[str, PreflightEntry]:
    return entries(table(43, {}), recorder=RECORDER)


def test_every_entry_has_a_value_a_unit_and_what_follows() -> None:
    for one in alike().values():
        assert one.follows in get_args(Follows)
        assert one.meaning
        assert one.follows == "nothing" or one.why or one.value is None
        assert (one.unit == "") == isinstance(one.value, str | bool) or one.value is None
        assert set(one.causes) <= set(every_cause())
        assert one.value is not None or one.why or one.name.startswith("reference_")


def test_diagnosis_json_has_every_entry() -> None:
    log = make_log(table(7, {}, rows=500), drive=MODEL.motion().drive)
    found = diagnose(log, MODEL, reference()).diagnosis
    content = as_json(found)["log"]["preflight"]
    assert [one["name"] for one in content] == [one.name for one in found.preflight]
    assert len({one["name"] for one in content}) == len(content)
    keys = {"name", "meaning", "value", "unit", "low", "high", "follows", "why", "causes"}
    assert all(set(one) == keys for one in content)


def test_a_log_as_the_references_is_said_to_be_and_nothing_of_its_recording_is_fitted() -> None:
    found = alike()
    assert found["recorded_like_reference"].value is True
    assert found["reference_step"].value == STEP
    assert found["reference_robots"].value == reference().robots
    for name in ("delay", "rate", "smear", "scale"):
        assert found[f"recording_{name}"].value is None
        assert "as the reference's" in found[f"recording_{name}"].why


def test_how_a_foreign_log_was_recorded_is_told_with_intervals() -> None:
    scaled = table(43, {})
    scaled[["x", "y"]] *= 1.01
    found = entries(scaled)
    assert found["recorded_like_reference"].value is False
    assert found["recorded_like_reference"].follows == "modelled"
    for name, value in (("delay", 0.0), ("rate", 0.0), ("scale", 1.01)):
        one = found[f"recording_{name}"]
        assert one.follows == "modelled"
        assert one.low is not None
        assert one.high is not None
        assert one.low < value < one.high
    assert found["recording_scale"].low > 1.0
    assert "clock_offset" in found["recording_delay"].causes


def test_without_a_reference_that_is_why_nothing_is_fitted() -> None:
    found = entries(table(43, {}, rows=500), known=False)
    assert found["reference_robots"].value == 0
    assert "no healthy reference" in found["recording_delay"].why
    assert found["recorded_like_reference"].follows == "nothing"


def test_what_is_not_logged_silences_causes_by_name() -> None:
    found = alike()
    of = {"infrared": PS, "light": LS, "nest": ("nest",)}
    silenced = set()
    for name, columns in of.items():
        assert (found[name].value, found[name].follows) == (False, "silences")
        assert all(every_cause()[cause].columns[0] in columns for cause in found[name].causes)
        silenced |= set(found[name].causes)
    assert silenced == set(sense_causes())
    pairs = {"clock_offset", "command_latency", "low_friction", "weak_motor"}
    assert set(found["encoders"].causes) == pairs
    sensed = table(43, {}, rows=500).assign(wheel_left=1.0, wheel_right=1.0, ps0=5.0, nest=True)
    there = entries(sensed)
    assert {name: there[name].value for name in ("encoders", *of)} == {
        "encoders": True,
        "infrared": True,
        "light": False,
        "nest": True,
    }
    assert there["encoders"].causes == there["infrared"].causes == ()


def test_what_is_repaired_is_said_to_be_only_where_it_is() -> None:
    clean = alike()
    for name in ("held_poses", "no_pose", "gaps", "outliers"):
        assert (clean[name].value, clean[name].follows) == (0.0, "nothing")
    frame = table(43, {}, rows=900)
    held = np.arange(len(frame)) // 2 * 2
    frame[POSE] = frame[POSE].iloc[held].to_numpy()
    frame.loc[301::50, "x"] += 0.5
    frame = frame[~frame["t"].between(20.0, 22.0)]
    found = entries(frame)
    for name in ("held_poses", "gaps"):
        assert found[name].follows == "repaired"
        assert found[name].value


def test_the_noise_that_is_told_is_the_trackers() -> None:
    found = alike()
    assert found["position_noise"].value == pytest.approx(5e-4, rel=0.1)
    assert found["heading_noise"].value == pytest.approx(5e-3, rel=0.1)
    for name in ("position", "heading"):
        one = found[f"{name}_noise_correlation"]
        assert one.low is not None
        assert one.high is not None
        assert one.low < 0.0 < one.high
