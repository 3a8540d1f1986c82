"""Whatever structures and arrays hold, a call ends with finite numbers or an error in words."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.helpers import ROOT

WORKER = """
import json, math, sys, warnings
from dataclasses import fields, replace
import numpy as np
from realitygap.embedded_sim import (
    Behaviour, Diverged, Drive, PointModel, Senses, Tables, evaluate, readings, replay)
from realitygap.models import load_model

warnings.simplefilter("error")
BASE = load_model()

def ends(call, *outputs):
    try:
        result = call()
    except (ValueError, Diverged) as error:  # InputError is a ValueError
        assert "\\n" not in str(error), error
        return
    for part in result:
        assert np.isfinite(part).all()

for line in sys.stdin:
    own = json.loads(line)
    try:
        drive, senses = Drive(**own["drive"]), Senses(**own["senses"])
        tables = replace(BASE.tables, **own["tables"])
        model = replace(BASE, drive=drive, senses=senses, tables=tables, **own["model"])
        behaviour = Behaviour(**own["behaviour"])
        rows, t = len(own["rows"]), np.arange(len(own["rows"])) * 0.04
        pairs = [row[:2] for row in own["rows"]]
        ends(lambda: replay(t, pairs, [0, rows], [own["pose"]], drive=drive))
        ends(lambda: readings(own["rows"], [own["scenario"]] * rows, t, model=model))
        ends(lambda: evaluate(pairs, [own["scenario"]] * rows, np.ones((rows, 4)),
                              model=model, behaviour=behaviour, seconds=own["seconds"]))
        print("ended", flush=True)
    except Exception as error:
        print(type(error).__name__, error, flush=True)
"""

numbers = st.one_of(
    st.floats(-2.0, 2.0),
    st.floats(allow_nan=True, allow_infinity=True),
    st.sampled_from([0.0, 1e6, 1e300, 5e-324, 1.0649999999, -3.2, 1e12]),
)
lists = st.one_of(st.lists(numbers, min_size=8, max_size=8), st.lists(numbers, max_size=9))
pairs = st.one_of(st.tuples(numbers, numbers), st.lists(numbers, max_size=3))


def some(**values: st.SearchStrategy[object]) -> st.SearchStrategy[dict[str, object]]:
    """None, or a few, of the fields."""
    one = st.sampled_from(sorted(values)).flatmap(
        lambda name: st.tuples(st.just(name), values[name])
    )
    return st.lists(one, max_size=2).map(dict)


cases = st.fixed_dictionaries(
    {
        "drive": some(
            wheel_radius=pairs, axle=numbers, latency=numbers, time_constant=numbers,
            acceleration=pairs, speed_limit=pairs, dead_zone=pairs, droop_rate=numbers,
            turn_first=numbers, start_delay=numbers,
        ),
        "senses": some(
            ps_gain=lists, ps_offset=lists, ls_gain=lists, ps_noise=numbers, wall_albedo=numbers,
            rotation=numbers, lamp_intensity=numbers, lamp_height=numbers, light_exponent=numbers,
            lamp_shift=pairs, lamp_decay=numbers, ambient_light=numbers, light_gamma=numbers,
            second_lamp=st.lists(numbers, min_size=2, max_size=4),
        ),
        "tables": some(
            ps_range=numbers, ls_range=numbers, ls_dark=numbers, counts_max=numbers,
            ps_noise=lists, ps_counts=st.just([[[1.0, 2.0]]]), ls_counts=st.just([[1.0, 2.0]] * 2),
        ),
        "model": some(
            body_radius=numbers, arena_radius=numbers, nest=st.tuples(numbers, numbers, numbers),
            food_radius=numbers, food_items=st.integers(-(2**70), 2**70) | st.integers(0, 32),
            lamps=st.tuples(pairs, st.none(), pairs), lamp_gain=numbers, sensor_angles=lists,
        ),
        "behaviour": some(
            cruise_speed=numbers, avoid_threshold=lists, avoid_duration=numbers,
            avoid_memory=numbers, search_duration=pairs, light_gain=numbers,
        ),
        "rows": st.lists(st.lists(numbers, min_size=3, max_size=3), max_size=4),
        "pose": st.lists(numbers, min_size=3, max_size=3),
        "scenario": st.one_of(st.integers(0, 2), st.integers(-(2**70), 2**70)),
        "seconds": st.one_of(st.floats(0.0, 2.0), numbers.filter(lambda s: not 2.0 < s < 1e5)),
    }
)  # fmt: skip


@pytest.fixture(scope="module")
def worker():
    """A process of its own, whose death is seen and kills nobody else."""
    process = subprocess.Popen(
        [sys.executable, "-c", WORKER],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
    yield process
    process.stdin.close()
    process.stdout.close()
    assert process.wait(60) == 0


@settings(
    max_examples=100,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
@given(case=cases)
def test_any_values_end_in_finite_numbers_or_in_one_line(worker, case) -> None:
    worker.stdin.write(json.dumps(case) + "\n")
    worker.stdin.flush()
    assert worker.stdout.readline() == "ended\n"
