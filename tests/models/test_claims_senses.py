"""What a diagnosis claims of the senses: readings of parts that no value was fitted to."""

from __future__ import annotations

from functools import cache

import pytest

from models.diagnosis import as_json
from models.identify.diagnose import diagnose
from models.log import make_log
from models.modelfile import read_model_file
from models.senses.joined import WholeExamination, with_senses
from tests.models.small import arena_log, tables

TABLES = tables()
MODEL = read_model_file("epuck")


@cache
def examined(scale: float) -> WholeExamination:
    """One robot of a minute whose lamp is brighter than believed; no reference."""
    frame = arena_log(31, robots=1, rows=1000, sensors=TABLES)
    dark = TABLES.ls_dark
    lights = [f"ls{k}" for k in range(8)]
    frame[lights] = dark - scale * (dark - frame[lights])
    log = make_log(frame, drive=MODEL.nominal_drive)
    return with_senses(diagnose(log, MODEL, None), log, TABLES, None)


def test_a_brighter_lamp_is_exported_because_the_other_half_is_predicted_better() -> None:
    found = examined(1.5).diagnosis
    lamp = next(one for one in found.named if one.term.cause.name == "lamp_intensity")
    assert lamp.exported
    gain = found.gain["light_reading"]
    assert gain.low <= gain.after <= gain.high
    assert gain.after < 0.3 * gain.before
    values = [part[lamp.key][0].value for part in examined(1.5).senses.by_part]
    assert values == pytest.approx([1.5, 1.5], rel=0.02)
    assert values[0] != values[1]
    assert as_json(found)["detectable"]["lamp_intensity"]["size"] < 0.2


def test_where_nothing_is_named_readings_gain_nothing_to_the_last_bit() -> None:
    found = examined(1.0).diagnosis
    assert [one.term.cause.name for one in found.named if one.term.cause.columns] == []
    for kind in ("infrared_reading", "light_reading"):
        assert found.gain[kind].before == found.gain[kind].after
        assert found.gain[kind].healthy is None  # no reference
