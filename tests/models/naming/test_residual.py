"""What the errors of a window are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.noise import PoseNoise
from realitygap.models.naming.channels.motion.residual import Residuals
from realitygap.models.naming.channels.motion.tracks import Tracks

QUIET = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)


def random_windows(
    seed: int, lengths: list[int], noise: tuple[float, float], error: float
) -> tuple[Tracks, FloatArray]:
    """Tracks of curved windows measured somewhere else, and their prediction (n, 3).

    Args:
        seed: Of everything drawn.
        lengths: Rows of each window.
        noise: (m, rad) that errors are weighted by.
        error: Standard deviation of the errors, in that noise.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    rows = sum(lengths)
    first = np.cumsum([0, *lengths[:-1]])
    turn = rng.normal(0.0, 0.2, rows)
    yaw = rng.uniform(-3.0, 3.0) + np.cumsum(turn)
    ahead = rng.uniform(0.0, 0.02, rows)
    predicted = np.column_stack(
        [np.cumsum(ahead * np.cos(yaw)), np.cumsum(ahead * np.sin(yaw)), yaw]
    )
    window = np.repeat(np.arange(len(lengths)), lengths)
    swing = rng.uniform(-3.0, 3.0, len(lengths))[window]
    c, s = np.cos(swing), np.sin(swing)
    spread = error * np.array([noise[0], noise[0], noise[1]])
    apart = rng.normal(0.0, 1.0, (rows, 3)) * spread
    x, y = predicted[:, 0] + apart[:, 0], predicted[:, 1] + apart[:, 1]
    place = rng.uniform(-1.0, 1.0, (len(lengths), 2))[window]
    measured = np.column_stack([c * x - s * y, s * x + c * y, yaw + swing + apart[:, 2]])
    measured[:, :2] += place
    measured[:, 2] = np.angle(np.exp(1j * measured[:, 2]))
    tracks = Tracks(
        robots=(0,),
        t=np.arange(rows) * 0.04,
        commands=np.zeros((rows, 2)),
        start=np.array([0, rows]),
        segment_robot=np.zeros(1, dtype=np.int64),
        encoders=None,
        rows=np.arange(rows),
        first=first,
        measured=measured,
        about=np.zeros((rows, 0)),
        columns=(),
        noise=PoseNoise(*noise),
        step=0.04,
        part=np.zeros(rows, dtype=np.int64),
    )
    return tracks, predicted


LENGTHS = st.lists(st.integers(3, 30), min_size=1, max_size=5)
NOISE = st.tuples(st.floats(1e-4, 2e-2), st.floats(1e-3, 0.3))


@QUIET
@given(st.integers(0, 2**31), LENGTHS, NOISE, st.floats(-3.0, 3.0))
def test_turning_and_shifting_a_whole_prediction_changes_no_error(
    seed: int, lengths: list[int], noise: tuple[float, float], swing: float
) -> None:
    tracks, predicted = random_windows(seed, lengths, noise, 1.0)
    c, s = np.cos(swing), np.sin(swing)
    x, y, yaw = predicted.T
    turned = np.column_stack([c * x - s * y + 0.3, s * x + c * y - 0.2, yaw + swing])
    fitter = Residuals(tracks)
    assert fitter(turned) == pytest.approx(fitter(predicted), abs=1e-6)
