"""Trials side by side in SIMD lanes have the bits of trials one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim import Behaviour, Drive, InputError, PointModel, Senses, evaluate
from realitygap.embedded_sim.simulator import FORMS, has_form
from realitygap.models import load_model

BASE = load_model()


def pairs(low: float, high: float) -> st.SearchStrategy[tuple[float, float]]:
    side = st.floats(low, high)
    return st.tuples(side, side)


def eights(low: float, high: float) -> st.SearchStrategy[tuple[float, ...]]:
    return st.tuples(*[st.floats(low, high)] * 8)


drives = st.builds(
    Drive,
    wheel_radius=pairs(0.015, 0.03),
    axle=st.floats(0.03, 0.06),
    latency=st.sampled_from([0.0, 0.01, 0.04, 0.1, 2.48]),
    time_constant=st.sampled_from([0.0, 0.003, 0.05, 0.5]),
    acceleration=st.one_of(st.just((float("inf"),) * 2), pairs(5.0, 200.0)),
    speed_limit=pairs(2.0, 12.0),
    dead_zone=pairs(0.0, 2.0),
    droop_rate=st.sampled_from([0.0, 0.001, 0.1]),
    start_delay=st.sampled_from([0.0, 0.03, 0.3]),
    done_curve=st.sampled_from(
        [((), ()), (((-6.0, -5.0), (-1.0, 0.0), (1.0, 0.1), (5.0, 4.0)), ((0.0, 0.0), (9.0, 7.0)))]
    ),
    turn_first=st.one_of(st.just(float("inf")), st.floats(1.0, 12.0)),
)
senses = st.builds(
    Senses,
    ps_gain=eights(0.0, 2.0),
    ps_offset=st.one_of(eights(0.0, 300.0), eights(-100.0, 100.0)),
    ps_noise=st.floats(0.0, 3.0),
    rotation=st.floats(-0.5, 0.5),
    ls_gain=eights(0.0, 2.0),
    lamp_intensity=st.floats(0.2, 3.0),
    lamp_shift=pairs(-0.3, 0.3),
    lamp_decay=st.sampled_from([0.0, 0.01, 0.1]),
    ambient_light=st.floats(0.0, 0.5),
    second_lamp=st.one_of(
        st.none(), st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.1, 2.0))
    ),
)
assert BASE.tables is not None
LIGHT = BASE.tables.ls_counts
captures = st.builds(
    lambda angles, coarser: replace(
        BASE,
        sensor_angles=angles,
        tables=replace(BASE.tables, ls_counts=np.ascontiguousarray(LIGHT[:, ::coarser])),
    ),
    eights(-3.14, 3.14),
    st.sampled_from([1, 6, 36]),
)
"""Sensors anywhere, and 72, 12 or 2 bearings: AVX-512 needs three pairs of registers, or one."""
models = st.one_of(
    st.just(BASE),
    captures,
    st.builds(lambda drive: replace(BASE, drive=drive), drives),
    st.builds(lambda own: replace(BASE, senses=own), senses),
    st.builds(
        lambda drive, own, items: replace(BASE, drive=drive, senses=own, food_items=items),
        drives,
        senses,
        st.integers(0, 32),
    ),
)
behaviours = st.builds(
    lambda scale, speed, spin, gain, curvature, contrast: Behaviour(
        avoid_threshold=tuple(scale * counts for counts in Behaviour().avoid_threshold),
        cruise_speed=speed,
        avoid_speed=spin,
        light_gain=gain,
        search_curvature=curvature,
        light_contrast=contrast,
    ),
    st.floats(0.05, 16.0),
    st.floats(0.0, 30.0),  # far beyond an e-puck: turns that leave the polynomials
    st.floats(1.0, 6.28),
    st.floats(0.1, 4.0),
    st.floats(0.1, 2.0),
    st.floats(5.0, 100.0),
)


@settings(max_examples=40, deadline=None)
@given(
    model=models,
    own=st.one_of(st.just(Behaviour()), st.lists(behaviours, min_size=1, max_size=5)),
    trials=st.integers(2, 40),
    seed=st.integers(0, 2**32 - 1),
)
def test_a_lane_has_the_bits_of_a_trial_alone(
    model: PointModel, own: Behaviour | list[Behaviour], trials: int, seed: int
) -> None:
    random = np.random.default_rng(seed)
    arguments = {
        "genomes": random.uniform(0.0, 0.99, (trials, 2)),
        "scenarios": random.integers(0, 3, trials),
        "seeds": random.integers(0, 2**32, (trials, 4), dtype=np.uint32),
        "model": model,
        "behaviour": own if isinstance(own, Behaviour) else (own * trials)[:trials],
        "seconds": 12.0,
    }
    alone = evaluate(**arguments, form="one_by_one")
    for form in filter(has_form, FORMS):
        together = evaluate(**arguments, form=form)
        assert together.fitness.tobytes() == alone.fitness.tobytes()
        assert together.deposits.tobytes() == alone.deposits.tobytes()


def test_lanes_tell_trials_apart_over_whole_trials() -> None:
    """All controllers under all lamps for 60 s: long enough for one wrong bit to grow."""
    thirds = (0.1, 0.5, 0.9)
    genomes = np.tile([(g0, g1) for g0 in thirds for g1 in thirds], (24, 1))
    trials = len(genomes)
    seeds = np.random.default_rng(3).integers(0, 2**32, (trials, 4), dtype=np.uint32)
    results = [
        evaluate(
            genomes,
            np.arange(trials) // 9 % 3,
            seeds,
            model=BASE,
            behaviour=Behaviour(),
            form=form,
        )
        for form in filter(has_form, FORMS)
    ]
    assert results[0].deposits.sum() > 100
    assert len({result.fitness.tobytes() for result in results}) == 1


def test_food_that_finds_no_room_is_refused_alike_in_every_form() -> None:
    crowded = replace(BASE, nest=(0.5, 0.0, 1.0649999999))
    for form in filter(has_form, FORMS):
        with pytest.raises(InputError, match=r"nest: got no place .* \(trial 0, step 0\)"):
            evaluate(
                np.full((30, 2), 0.5),
                [1] * 30,
                np.arange(120, dtype=np.uint32).reshape(30, 4),
                model=crowded,
                behaviour=Behaviour(),
                form=form,
            )
