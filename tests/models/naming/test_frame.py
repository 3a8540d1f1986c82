"""The frame of a log's tracker, found again from what sensors read in the model's arena."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import PointModel, readings
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.frame import Witnessed, frame_of, in_arena
from tests.models.small import tables

ROWS = 1500
BLOCKS = 50
ANGLES = st.floats(-3.1, 3.1)
METRES = st.floats(-5.0, 5.0)


def placed_at(poses: FloatArray, place: FloatArray) -> FloatArray:
    """Poses in the arena as a tracker gives them whose frame sees the arena at `place`."""
    turn, x, y = place
    c, s = np.cos(turn), np.sin(turn)
    return np.column_stack(
        [
            c * poses[:, 0] - s * poses[:, 1] + x,
            s * poses[:, 0] + c * poses[:, 1] + y,
            poses[:, 2] + turn,
        ]
    )


def seen(
    place: tuple[float, float, float],
    *,
    lamp: tuple[float, float] = (0.0, 0.0),
    senses: bool = True,
    nest: bool = True,
) -> Witnessed:
    """What robots tell that stood all over an arena; `lamp` is how far that was moved."""
    rng = np.random.default_rng(np.random.SeedSequence(5))
    model = PointModel(tables=tables())
    reach = model.arena_radius - model.body_radius
    far, way = reach * np.sqrt(rng.uniform(0, 1, ROWS)), rng.uniform(-np.pi, np.pi, ROWS)
    poses = np.column_stack([far * np.cos(way), far * np.sin(way), rng.uniform(-3, 3, ROWS)])
    scenario, time = np.zeros(ROWS, dtype=np.int32), np.zeros(ROWS)
    first = np.add(model.lamps[0] or (0.0, 0.0), lamp).tolist()
    there = PointModel(tables=tables(), lamps=((first[0], first[1]), *model.lamps[1:]))
    both = readings(poses, scenario, time, model=there)
    read = np.hstack([both.ps, both.ls]) + rng.normal(0, 5, (ROWS, 16))
    x, y, radius = model.nest
    inside = (np.hypot(poses[:, 0] - x, poses[:, 1] - y) < radius).astype(float)
    return Witnessed(
        model=model,
        reach=reach,
        poses=placed_at(poses, np.array(place)),
        block=np.arange(ROWS) * BLOCKS // ROWS,
        inside=inside if nest else np.full(ROWS, np.nan),
        some=np.arange(ROWS),
        scenario=scenario,
        time=time,
        read=read if senses else np.full_like(read, np.nan),
    )


@given(turn=ANGLES, x=METRES, y=METRES)
def test_a_frame_is_taken_off_as_it_was_put_on(turn: float, x: float, y: float) -> None:
    place = np.array([turn, x, y])
    poses = np.array([[0.1, 0.2, 0.3], [-0.4, 0.0, 3.0]])
    np.testing.assert_allclose(in_arena(placed_at(poses, place), place), poses, atol=1e-12)


@pytest.mark.parametrize(
    "place", [(np.pi / 2, 0.0, 0.0), (0.65, 0.0, 0.0), (-2.8, 2.0, -1.0), (0.02, 0.0, 0.01)]
)
def test_turned_and_shifted_frames_are_found(place: tuple[float, float, float]) -> None:
    found = frame_of(seen(place))
    assert found is not None
    np.testing.assert_allclose([found.turn, found.x, found.y], place, atol=1e-3)
    off = np.abs([found.turn, found.x, found.y] - np.array(place)) / found.sd
    assert np.all(off < 5.0)
    assert {"light", "nest"} <= set(found.witnesses)


def test_the_models_own_frame_is_none() -> None:
    assert frame_of(seen((0.0, 0.0, 0.0))) is None


def test_a_lamp_that_was_moved_alone_is_no_frame() -> None:
    assert frame_of(seen((0.0, 0.0, 0.0), lamp=(0.05, 0.1))) is None


def test_light_alone_may_show_a_turn_and_says_that_it_is_alone() -> None:
    dark = seen((0.3, 0.0, 0.0), nest=False)
    found = frame_of(dark)
    assert found is not None
    assert found.witnesses == ("light",)
    assert found.turn == pytest.approx(0.3, abs=1e-3)


def test_poses_alone_show_a_shift_that_the_wall_forbids() -> None:
    found = frame_of(seen((0.0, 2.0, 0.5), senses=False, nest=False))
    assert found is not None
    assert found.witnesses == ("poses",)
    assert (found.x, found.y) == pytest.approx((2.0, 0.5), abs=0.02)
    assert found.turn == pytest.approx(0.0, abs=0.01)
    assert found.sd[0] > 1.0  # nothing shows it
    assert frame_of(seen((0.0, 0.0, 0.0), senses=False, nest=False)) is None
