"""Headings from where robots go."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.log.course import SETTLED, courses
from realitygap.models.log.frames import wrapped
from realitygap.models.log.measured import make_log
from realitygap.models.log.schema import LS, PS
from tests.models.small import driven_log

STEP, SPEED, RADIUS = 0.04, 0.12, 0.3
T = np.arange(400) * STEP


def circle(sense: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(rows, 2) places and (rows,) headings on a circle to the left, ahead or back; commands."""
    yaw = sense * SPEED / RADIUS * T + 0.3
    places = RADIUS * np.column_stack([np.sin(yaw), -np.cos(yaw)])
    return places, yaw, np.full((len(T), 2), sense * 5.0)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_on_a_circle_the_course_is_the_heading_also_of_a_robot_that_backs(sense: float) -> None:
    places, yaw, commands = circle(sense)
    found, _ = courses(T, places, commands, np.zeros(len(T), dtype=np.int64))
    known = np.isfinite(found)
    assert known.mean() > 0.9
    assert np.abs(wrapped(found[known] - yaw[known])).max() < 1e-4


def test_it_is_the_heading_at_uneven_times_and_none_is_taken_across_a_gap() -> None:
    places, yaw, commands = circle(1.0)
    rng = np.random.default_rng(np.random.SeedSequence(1))
    kept = np.flatnonzero((rng.random(len(T)) > 0.1) & ~((T > 6.0) & (T < 8.0)))
    found, _ = courses(T[kept], places[kept], commands[kept], np.zeros(len(kept), dtype=np.int64))
    known = np.isfinite(found)
    assert known.mean() > 0.8
    assert np.abs(wrapped(found[known] - yaw[kept][known])).max() < 1e-3
    assert not known[np.abs(T[kept] - 7.0) < 1.0 + STEP / 2].any()


def test_its_noise_is_what_is_said() -> None:
    places, yaw, commands = circle(1.0)
    rng = np.random.default_rng(np.random.SeedSequence(2))
    noisy = places + rng.normal(0.0, 5e-4, places.shape)
    found, noise = courses(T, noisy, commands, np.zeros(len(T), dtype=np.int64))
    off = wrapped(found - yaw)[np.isfinite(found)]
    assert np.std(off) == pytest.approx(noise, rel=0.25)
    assert np.corrcoef(off[:-1], off[1:])[0, 1] == pytest.approx(0.0, abs=0.2)


def test_a_robot_that_stands_turns_or_has_just_reversed_has_none() -> None:
    places, _, commands = circle(1.0)
    still, spun, back = (slice(100, 150), slice(200, 250), slice(300, None))
    places[still], places[spun] = places[100], places[200]
    commands[still], commands[spun], commands[back] = 0.0, [-5.0, 5.0], -5.0
    found, _ = courses(T, places, commands, np.zeros(len(T), dtype=np.int64))
    assert np.isnan(found[still]).all()
    assert np.isnan(found[spun]).all()
    assert np.isnan(found[300 : 300 + round(SETTLED / STEP)]).all()


def test_a_log_without_yaw_is_read_with_a_note_and_its_senses_are_not_judged() -> None:
    frame = driven_log(2, rows=600).assign(ps0=100.0, ls0=3000.0)
    log = make_log(frame.drop(columns="yaw"), drive=Drive())
    assert not log.headed
    assert not set(log.frame) & {*PS, *LS}
    assert "no yaw: taken from where robots go" in log.notes[0]
    empty = make_log(frame.assign(yaw=np.nan), drive=Drive())
    pd.testing.assert_frame_equal(empty.frame, log.frame)


def test_a_heading_under_another_name_is_asked_for_and_robots_that_stand_are_refused() -> None:
    frame = driven_log(3, rows=50)
    with pytest.raises(InputError, match="is it theta"):
        make_log(frame.rename(columns={"yaw": "theta"}), drive=Drive())
    with pytest.raises(InputError, match="robots that move clearly"):
        make_log(frame.drop(columns="yaw").assign(x=0.0, y=0.0), drive=Drive())


def test_a_slow_robot_without_headings_is_not_said_to_have_no_poses() -> None:
    frame = driven_log(3, rows=600, position_noise=2e-3).drop(columns="yaw")
    with pytest.raises(InputError, match="rows without a heading: it stands") as refused:
        make_log(frame, drive=Drive())
    assert "expected a column yaw" in str(refused.value)
