"""Stamps that jitter beside motion that does not."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.embedded_sim import Drive
from realitygap.models.log.even import evened
from realitygap.models.log.measured import make_log
from tests.models.small import driven_log

DRIVE = Drive()
ROWS = 1500


def jitter(seconds: float, count: int) -> np.ndarray:
    rng = np.random.default_rng(np.random.SeedSequence(8))
    return np.clip(rng.normal(0.0, seconds, count), -3.0 * seconds, 3.0 * seconds)


@pytest.mark.parametrize("lost", [0.0, 0.1])
def test_stamps_that_jitter_are_made_even_where_the_motion_is(lost: float) -> None:
    frame = driven_log(3, robots=2, rows=ROWS, position_noise=5e-4, heading_noise=5e-3)
    rng = np.random.default_rng(np.random.SeedSequence(9))
    frame = frame[rng.uniform(size=len(frame)) >= lost].reset_index(drop=True)
    stamped = frame.assign(t=frame["t"] + jitter(0.005, len(frame)))
    log = make_log(stamped, drive=DRIVE)
    assert log.jitter == pytest.approx(0.005, rel=0.1)
    assert any("jitter" in note for note in log.notes)
    # even stamps are off by what a line through so many jittered ones is
    assert np.abs(log.t - frame["t"]).max() < 6.0 * 0.005 / np.sqrt(ROWS)


def test_stamps_are_believed_where_poses_were_taken_at_them() -> None:
    t = np.sort(np.arange(ROWS) * 0.04 + jitter(0.005, ROWS))
    frame = driven_log(3, robots=2, rows=ROWS, t=t, position_noise=5e-4, heading_noise=5e-3)
    log = make_log(frame, drive=DRIVE)
    assert log.jitter == 0.0
    np.testing.assert_array_equal(log.t[:ROWS], t)


def test_even_stamps_and_too_few_moves_are_left_alone() -> None:
    t, still = np.arange(50) * 0.04, np.zeros((50, 3))
    commands, start = np.ones((50, 2)), np.array([0, 50])
    assert evened(t, still, commands, start, DRIVE) is None
    assert evened(t + jitter(0.005, 50), still, commands, start, DRIVE) is None
