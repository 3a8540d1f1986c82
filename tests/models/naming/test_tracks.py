"""Logs cut for identification."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.errors import InputError
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.motion import Motion
from realitygap.models.log.measured import make_log
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.tracks import Tracks, cut_tracks
from realitygap.models.naming.rules import Rules
from tests.models.small import driven_log

MODEL = read_model_file("epuck").model_copy(update={"arena": None})
SLOW = Drive(acceleration=(160.0, 160.0), time_constant=0.05, latency=0.03, droop_rate=1e-3)


FEW = Rules(all_windows=150, few_windows=20)
"""So few windows that most of a log is left out."""


def long_tracks(rules: Rules = Rules()) -> Tracks:
    frame = driven_log(5, robots=3, rows=6000, drive=SLOW, position_noise=5e-4, heading_noise=5e-3)
    return cut_tracks(make_log(frame, drive=MODEL.motion().drive), MODEL, rules=rules)


def test_of_a_long_log_some_windows_are_used_evenly_over_its_time() -> None:
    some = long_tracks(FEW)
    begun = some.t[some.rows[some.first]]
    assert np.bincount(some.robot).tolist() == [50, 50, 50]
    assert np.ptp(begun) > 0.9 * 6000 * 0.04
    assert np.bincount(some.block).tolist() == [5] * 30
    assert len(some.t) < 0.5 * 3 * 6000


@pytest.mark.parametrize("pose_delay", [0.0, 0.1, -0.1])
def test_rows_left_out_between_windows_change_no_error(
    monkeypatch: pytest.MonkeyPatch, pose_delay: float
) -> None:
    lean = long_tracks(FEW)
    monkeypatch.setattr(Tracks, "needed", lambda whole: whole)
    whole = long_tracks(FEW)
    assert len(lean.t) < len(whole.t)
    motions = [Motion(drive=SLOW, pose_delay=pose_delay)] * 3
    errors = [Problem(one, motions).residual((), np.zeros((3, 0))) for one in (lean, whole)]
    np.testing.assert_allclose(*errors, atol=1e-6)


def test_the_tracks_of_some_robots_are_theirs_alone() -> None:
    every = long_tracks()
    some = every.only([0, 2])
    assert some.robots == (0, 2)
    motions = [Motion(drive=replace(SLOW, axle=axle)) for axle in (0.05, 0.053, 0.056)]
    errors = Problem(every, motions).residual((), np.zeros((3, 0)))
    theirs = Problem(some, [motions[0], motions[2]]).residual((), np.zeros((2, 0)))
    np.testing.assert_array_equal(theirs, errors[every.robot[every.window] != 1])


def test_a_log_that_lies_outside_the_models_arena_is_refused_by_that() -> None:
    frame = driven_log(5, robots=2, rows=300)
    away = frame.assign(x=frame["x"] + 100.0)
    file = read_model_file("epuck")
    with pytest.raises(InputError, match=r"every pose beyond the wall of model 'e-puck'"):
        cut_tracks(make_log(away, drive=file.motion().drive), file)
