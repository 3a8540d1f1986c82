"""Rules of the diagnosis of motion, each by itself."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import replay
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.robot import robots_of
from realitygap.models.naming.channels.motion.tracks import TURNED
from realitygap.models.naming.engine.seen import away
from realitygap.models.naming.engine.state import State
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.health.learned import NOBODY
from tests.models.naming.test_identify import HEALTHY, diagnosed, names, table, tracks
from tests.models.small import random_commands

STEP, ROWS = 0.04, 1500


def driven(seed: int, commands: np.ndarray, turned: np.ndarray) -> pd.DataFrame:
    """One robot's log of some commands whose wheels turn at other speeds, (rows, 2) rad/s."""
    t = STEP * np.arange(len(commands))
    poses = replay(t, turned, [0, len(t)], np.zeros((1, 3)), drive=HEALTHY).poses
    poses = poses + np.random.default_rng(seed).normal(0, 1, poses.shape) * [5e-4, 5e-4, 5e-3]
    columns = dict(zip(("x", "y", "yaw"), poses.T, strict=True))
    columns |= dict(zip(("cmd_left", "cmd_right"), commands.T, strict=True))
    return pd.DataFrame({"run": "a", "robot": 0, "t": t, **columns})


def test_a_cause_that_a_quantity_replaces_is_not_named_and_the_quantity_is() -> None:
    frame = table(31, {}, rows=ROWS)
    commands = frame.loc[frame["robot"] == 1, ["cmd_left", "cmd_right"]].to_numpy()
    lost = commands * (1.0 - 0.02 * np.abs(commands) / 6.28)
    strange = driven(31, commands, lost).assign(robot=1)
    found = diagnosed(pd.concat([frame[frame["robot"] != 1], strange], ignore_index=True))
    assert "motor_saturation" not in dict(names(found))
    assert [one.robots for one in found.unexplained] == [(1,)]
    assert found.unexplained[0].quantity in ("wheel_speed", "speed", "speed_squared")


def test_what_follows_a_wheels_angle_is_seen_by_the_angle_that_encoders_tell() -> None:
    """A wheel that slowly turns further than believed has lost its believed angle in a minute."""
    commands = random_commands(np.random.default_rng(32), ROWS)
    angle, turned = np.zeros(2), np.zeros((ROWS, 2))
    for row, told in enumerate(commands):
        turned[row] = 1.03 * told * (1.0 + [0.1, 0.0] * np.cos(angle))
        angle += STEP * turned[row]
    frame = driven(32, commands, turned)
    measured = np.vstack([np.zeros(2), turned[:-1]])  # mean speed since the row before
    encoded = frame.assign(wheel_left=measured[:, 0], wheel_right=measured[:, 1])
    strength = {}
    for name, one in (("commands", frame), ("encoders", encoded)):
        cut = tracks(one)
        healthy = (Motion(drive=HEALTHY),)
        robots = tuple(robots_of(cut, healthy, doses=False))
        (far,) = away(Weighed(State(cut, healthy, robots, NOBODY)))[SWINGS]
        strength[name] = float(far**2)
        if name == "encoders":
            told = cut.about[:, [cut.columns.index(column) for column in TURNED]]
            np.testing.assert_allclose(told, STEP * np.cumsum(measured, axis=0), atol=1e-9)
    assert strength["encoders"] > 5.0 * strength["commands"]


SWINGS = "wheels/left_wheel_angle"


@pytest.mark.parametrize(("seconds", "said"), [(20.0, True), (45.0, False)])
def test_a_robot_that_hardly_moved_is_not_called_sound(seconds: float, said: bool) -> None:
    frame = table(33, {})
    still = (frame["robot"] == 1) & (frame["t"] > seconds)
    frame.loc[still, ["cmd_left", "cmd_right"]] = 0.0
    rest = frame[(frame["robot"] == 1) & (frame["t"] <= seconds)].iloc[-1]
    frame.loc[still, ["x", "y", "yaw"]] = rest[["x", "y", "yaw"]].to_numpy(dtype=float)
    noise = np.random.default_rng(33).normal(0, 1, (int(still.sum()), 3)) * [5e-4, 5e-4, 5e-3]
    frame.loc[still, ["x", "y", "yaw"]] += noise
    told = [text for text in diagnosed(frame).not_checked if "of free motion" in text]
    assert bool(told) == said
    assert all(text.startswith("motion of robots 1:") for text in told)


@pytest.mark.parametrize("rows", [1, 2])
def test_a_robot_that_was_never_free_keeps_nobody_from_a_diagnosis(rows: int) -> None:
    """Two poses make no window."""
    frame = table(11, {})
    other = frame[frame["robot"] == 0].iloc[:rows].assign(robot=9)
    found = diagnosed(pd.concat([frame, other], ignore_index=True))
    assert names(found) == []
    assert not found.unexplained
