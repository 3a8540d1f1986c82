"""What a diagnosis claims of the senses: readings of parts that no value was fitted to."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from realitygap.models.belief.catalogue import sense_causes
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.senses import Belief
from realitygap.models.naming.channels.senses.claims import sense_claims
from realitygap.models.naming.channels.senses.diagnose import SenseExamination
from tests.models.naming.test_senses import MODEL, examined, table

FILE = read_model_file("epuck")
LAMP = sense_causes()["lamp_intensity"]


@cache
def with_lamp(scale: float) -> SenseExamination:
    """Four robots of a minute whose lamp is brighter than believed."""
    brighter = LAMP.sense(Belief(), np.array([scale]), "")
    return examined(table({}, everybody=brighter))


def test_a_brighter_lamp_is_exported_because_the_other_half_is_predicted_better() -> None:
    senses = with_lamp(1.3)
    named, ended, gains = sense_claims(senses, FILE, MODEL.tables, seed=0)
    assert ended == ()
    [lamp] = [one for one in named if one.term.cause == LAMP]
    assert lamp.exported
    light = gains["light_reading"]
    assert light.low <= light.after <= light.high
    assert light.after < 0.5 * light.before
    assert gains["infrared_reading"].after == gains["infrared_reading"].before
    values = [part[lamp.key][0].value for part in senses.by_part]
    assert values == pytest.approx([1.3, 1.3], rel=0.03)
    assert values[0] != values[1]


def test_where_no_sense_is_ill_readings_gain_nothing_to_the_last_bit() -> None:
    senses = with_lamp(1.0)
    assert senses.named == ()
    named, ended, gains = sense_claims(senses, FILE, MODEL.tables, seed=0)
    assert (named, ended) == ((), ())
    assert set(gains) == {"infrared_reading", "light_reading"}
    assert all(gain.before == gain.after for gain in gains.values())


def test_readings_say_how_much_more_light_would_have_shown() -> None:
    told = {one.cause: one for one in with_lamp(1.0).detectable}
    assert 0.0 < told["lamp_intensity"].size < 0.3
    assert told["lamp_intensity"].robot is None
    assert told["ir_rotation"].robot in range(4)
