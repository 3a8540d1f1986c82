"""Stretches in which something else than the log's commands drove a robot."""

from __future__ import annotations

import numpy as np
import pandas as pd

from realitygap.embedded_sim import Drive, replay
from realitygap.models.log.measured import MeasuredLog, make_log
from realitygap.models.log.overridden import overridden

STEP = 0.05
ROWS = 1200


def log(*, by_hand: slice = slice(0), off: slice = slice(0), dead_zone: float = 0.0) -> MeasuredLog:
    """A minute of one robot, its commands as logged and its wheels as they turned."""
    rng = np.random.default_rng(5)
    t = np.arange(ROWS) * STEP
    told = np.repeat(rng.uniform(-5.0, 5.0, (ROWS // 60, 2)), 60, axis=0)
    told[by_hand] = 0.0
    turned = np.where(np.abs(told) < dead_zone, 0.0, told)
    turned[by_hand] = 3.0
    told[off], turned[off] = 4.0, 0.0
    poses = replay(t, turned, [0, ROWS], [[0, 0, 0]], drive=Drive()).poses
    poses += rng.normal(0.0, 1e-4, poses.shape)
    frame = pd.DataFrame({"run": "a", "robot": 0, "t": t, "cmd_left": told[:, 0]})
    counted = np.vstack([turned[:1], turned[:-1]])
    return make_log(
        frame.assign(
            cmd_right=told[:, 1],
            x=poses[:, 0],
            y=poses[:, 1],
            yaw=poses[:, 2],
            wheel_left=counted[:, 0],
            wheel_right=counted[:, 1],
        ),
        drive=Drive(),
    )


def test_a_robot_that_obeys_is_used_wholly() -> None:
    assert log().tracked.mean() > 0.99
    assert "encoders" not in " ".join(log().notes)


def test_a_robot_driven_by_hand_is_set_aside_and_said() -> None:
    made = log(by_hand=slice(400, 600))
    assert not made.tracked[402:600].any()
    assert made.tracked[:399].mean() > 0.99
    assert made.tracked[602:].mean() > 0.99
    assert "s set aside: by the encoders" in " ".join(made.notes)
    assert made.stretch[700] != made.stretch[300]


def test_a_robot_that_is_switched_off_is_set_aside() -> None:
    made = log(off=slice(900, 1100))
    assert not made.tracked[905:1100].any()
    assert made.tracked[:899].mean() > 0.99


def test_a_dead_zone_is_no_disobedience() -> None:
    assert log(dead_zone=2.0).tracked.mean() > 0.99


def test_a_robot_that_rolls_out_for_a_second_obeys() -> None:
    t = np.arange(200) * STEP
    told = np.where(t[:, None] < 5.0, 4.0, 0.0) * np.ones(2)
    rolls = np.where(t[:, None] < 6.0, 4.0, 0.0) * np.ones(2)
    start = np.array([0, 200])
    assert not overridden(t, told, rolls, start).any()
