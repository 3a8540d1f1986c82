import numpy as np
import pytest

from realitygap.embedded_sim import Drive
from realitygap.models.gap.replay import HORIZONS, errors, replay_log, windows
from realitygap.models.log.frames import Windows
from realitygap.models.log.measured import make_log
from tests.models.small import driven_log

DRIVE = Drive()


@pytest.mark.parametrize("length", HORIZONS.values(), ids=HORIZONS.keys())
def test_a_log_of_the_point_model_itself_is_replayed_without_error(length):
    log = make_log(driven_log(1, rows=600), drive=DRIVE)
    pairs = windows(log, length)
    error = errors(log.poses, replay_log(log, DRIVE), pairs)
    assert len(pairs.first) > 100
    assert np.abs(error).max() < 1e-9


def test_windows_never_leave_their_robot_or_cross_a_gap():
    frame = driven_log(2, rows=300)
    frame = frame.drop(index=range(100, 130))
    log = make_log(frame, drive=DRIVE)
    for length in (0.0, 0.4, 1.0):
        pairs = windows(log, length)
        assert (log.segment[pairs.first] == log.segment[pairs.last]).all()
        assert (log.t[pairs.last] - log.t[pairs.first] < length + 0.06).all()
    assert any("gap" in note for note in log.notes)


def test_windows_on_irregular_time_end_at_the_row_nearest_to_their_length():
    rng = np.random.default_rng(np.random.SeedSequence(3))
    t = np.cumsum(rng.uniform(0.02, 0.06, 400))
    log = make_log(driven_log(3, rows=400, robots=1, t=t), drive=DRIVE)
    pairs = windows(log, 1.0)
    for first, last in zip(pairs.first, pairs.last, strict=True):
        assert last == np.argmin(np.abs(log.t - log.t[first] - 1.0))


def test_windows_apart_do_not_overlap():
    log = make_log(driven_log(4, rows=500), drive=DRIVE)
    pairs = windows(log, 1.0, apart=True)
    same = log.segment[pairs.first[1:]] == log.segment[pairs.first[:-1]]
    assert (pairs.first[1:] >= pairs.last[:-1])[same].all()
    assert len(pairs.first) >= 2 * 18


def test_errors_are_in_the_frame_of_the_start_pose():
    measured = np.array([[0.0, 0.0, np.pi / 2], [0.02, 0.1, np.pi / 2 + 0.1]])
    error = errors(measured, np.zeros((2, 3)), Windows(np.array([0]), np.array([1])))
    assert np.allclose(error, [0.1, -0.02, 0.1])
