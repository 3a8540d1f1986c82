"""The tracker's noise, out of the log itself."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive
from realitygap.models.gap.replay import replay_log
from realitygap.models.log.measured import make_log
from realitygap.models.log.noise import PoseNoise, pose_noise
from tests.models.small import driven_log

TRUE = PoseNoise(5e-4, 5e-3)


def noise_of(frame: pd.DataFrame) -> PoseNoise:
    log = make_log(frame, drive=Drive())
    return pose_noise(log, replay_log(log, Drive()))


def drive_noisily() -> pd.DataFrame:
    return driven_log(
        7, robots=1, rows=3000, position_noise=TRUE.position, heading_noise=TRUE.heading
    )


def interpolated(frame: pd.DataFrame, step: float) -> pd.DataFrame:
    """At another rate: poses on straight lines, commands as they were."""
    t = np.arange(frame["t"].iloc[0], frame["t"].iloc[-1], step)
    at = np.searchsorted(frame["t"], t + 1e-9, side="right") - 1
    made = frame.iloc[at].assign(t=t)
    for name in ("x", "y"):
        made[name] = np.interp(t, frame["t"], frame[name])
    made["yaw"] = np.interp(t, frame["t"], np.unwrap(frame["yaw"]))
    return made.reset_index(drop=True)


def test_white_noise_is_found_to_a_tenth() -> None:
    found = noise_of(drive_noisily())
    assert found.position == pytest.approx(TRUE.position, rel=0.1)
    assert found.heading == pytest.approx(TRUE.heading, rel=0.1)


@pytest.mark.parametrize("rate", [50.0, 100.0])
def test_rows_between_poses_make_no_tracker_better_than_it_is_by_more_than_averages(
    rate: float,
) -> None:
    """Half way between two poses noise is smaller by the root of two, and hangs together."""
    found = noise_of(interpolated(drive_noisily(), 1.0 / rate))
    assert 0.4 * TRUE.position < found.position < 1.1 * TRUE.position
    assert 0.4 * TRUE.heading < found.heading < 1.1 * TRUE.heading
