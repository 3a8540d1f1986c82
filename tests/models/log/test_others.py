"""Where other robots were at a robot's moments."""

from __future__ import annotations

import numpy as np
import pandas as pd

from realitygap.embedded_sim import Drive
from realitygap.models.log.measured import MeasuredLog, make_log
from realitygap.models.log.others import others


def straight(robot: int, t: np.ndarray, y: float, run: str = "a") -> pd.DataFrame:
    """A robot that drives along x by 0.0205 m/s from 0."""
    return pd.DataFrame(
        {"run": run, "robot": robot, "t": t, "x": 0.0205 * t, "y": y, "yaw": 0.0}
        | {"cmd_left": 1.0, "cmd_right": 1.0}
    )


def log_of(*parts: pd.DataFrame) -> MeasuredLog:
    return make_log(pd.concat(parts), drive=Drive())


def test_a_robot_is_where_it_was_at_that_moment_whatever_its_own_stamps() -> None:
    early, late = np.arange(0.0, 10.0, 0.04), np.arange(0.013, 10.0, 0.1)
    log = log_of(straight(3, early, 0.0), straight(5, late, 1.0))
    rows = np.arange(len(log.t))
    for segment, at, place in others(log, rows):
        assert set(log.segment[at]) == {1 - segment}
        np.testing.assert_allclose(place[:, 1], float(segment))
        inside = log.t[at] <= (late if segment else early)[-1]
        inside &= log.t[at] >= (late if segment else early)[0]
        np.testing.assert_allclose(place[inside, 0], 0.0205 * log.t[at][inside], atol=1e-12)


def test_a_pose_that_was_lost_is_between_those_around_it() -> None:
    t = np.arange(0.0, 10.0, 0.04)
    lost = straight(5, t, 1.0)
    lost.loc[100:110, ["x", "y", "yaw"]] = np.nan
    log = log_of(straight(3, t, 0.0), lost)
    seen = {segment: (at, place) for segment, at, place in others(log, np.arange(len(t)))}
    at, place = seen[1]
    assert len(at) == len(t)
    np.testing.assert_allclose(place[:, 0], 0.0205 * t[at], atol=1e-12)


def test_robots_of_other_runs_and_of_other_times_are_nobody() -> None:
    t = np.arange(0.0, 4.0, 0.04)
    log = log_of(straight(3, t, 0.0), straight(5, t, 1.0, run="b"), straight(7, t + 100.0, 1.0))
    assert all(len(at) == 0 for _, at, _ in others(log, np.arange(len(log.t))))
